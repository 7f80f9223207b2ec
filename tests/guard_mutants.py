"""Changes of an emitted guard in C, of which each is to be noticed."""

from __future__ import annotations

import re
from collections.abc import Iterator

_CHANGES: tuple[tuple[str, str], ...] = (
    (r" && ", " || "),
    (r" \|\| ", " && "),
    (r" < ", " <= "),
    (r" <= ", " < "),
    (r" > ", " >= "),
    (r" >= ", " > "),
    (r" == ", " != "),
    (r" != ", " == "),
    (r"!(?=[a-z(])", ""),
    (r"(?<=[-? ])\b([0-9]+)\b(?=[;: )])", r"1\1"),
    (r" \? (\S+) : (\S+);", r" ? \2 : \1;"),
    (r"INT64_C\((\d+)\)", r"INT64_C(1\1)"),
    (r"= true;", "= false;"),
    (r"= false;", "= true;"),
    (r"return true;", "return false;"),
    (r"return false;", "return true;"),
    (r"^( +)(?!return|\}|const|case|default|break|int |own)(\S.*;)$", r"\1(void)0;"),
    (r"- 1 ", "+ 1 "),
)


_HARMLESS = re.compile(
    r"time > -|ahead < run->monitors.time|is_silent = !|_PRESUMABLY_|!= signals->"
    r"|time <= |> INT64_C|has_lost = !is_calm|\(void\)(?:signals|moment|samples);|which < "
)
"""Times that no caller has, the larger one of two that are equal, topics whose messages have no values.

And one of several properties that a value that is missing blinds; a nanosecond more or less that a guard may be late;
what keeps compilers from warning; a message with nothing in it after the last fallback, which helps no more.
"""


def mutants(source: str) -> Iterator[tuple[str, str]]:
    """Each change of one place in the functions of a guard, and what it is.

    Other tests ask of `catch_up`, which no guard calls that acts in time, and of answers that come too late.
    """
    begin, aside, back = (
        source.index(f"/* {each}") for each in ("Whether the guard may be", "Let deadlines", "Whether `t")
    )
    for pattern, instead in _CHANGES:
        for found in re.finditer(pattern, source, re.MULTILINE):
            start, end = found.span()
            line = source[source.rindex("\n", 0, start) + 1 : source.index("\n", start)]
            changed = found.expand(instead)
            if start < begin or aside < start < back or changed == found[0] or _HARMLESS.search(line):
                continue
            number = source[:start].count("\n") + 1
            yield f"line {number}: {found[0].strip()} -> {changed.strip()}", source[:start] + changed + source[end:]
