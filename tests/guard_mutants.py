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


def mutants(source: str) -> Iterator[tuple[str, str]]:
    """Each change of one place in the functions of a guard, and what it is."""
    begin = source.index("/* Whether the guard may be silent")
    for pattern, instead in _CHANGES:
        for found in re.finditer(pattern, source[begin:], re.MULTILINE):
            line = source[: begin + found.start()].count("\n") + 1
            changed = found.expand(instead)
            if changed != found[0]:
                start, end = begin + found.start(), begin + found.end()
                yield f"line {line}: {found[0].strip()} -> {changed.strip()}", source[:start] + changed + source[end:]
