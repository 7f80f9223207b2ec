"""The words of others: a line as other languages, tools and English have it, and the line to write instead.

A table of phrases is put to a line, to what stands in its parentheses, and to the sides of its connectives, again and
again, until what comes of it can be parsed. So phrases may stand in one another.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import NamedTuple

from ltlc.frontend.syntax.lexer import FOREIGN

LONGEST = 200
"""Longer lines are not looked at: they could match in too many ways."""

MOST_ROUNDS = 5
"""So many phrases one line may have."""

MOST_WAYS = 6
"""So many ways to go on are kept."""


@dataclass(frozen=True)
class Phrase:
    """What a whole text is that matches `pattern`, as it is `written` here.

    `differs` says how that is not the same, if it is not. In `written`, groups of the pattern stand in braces: as they
    are with `!r`, else in parentheses where they are more than a comparison.
    """

    pattern: str
    written: str
    differs: str = ""

    @cached_property
    def compiled(self) -> re.Pattern[str]:
        """The pattern, compiled when it is first tried: most files have no phrase."""
        return re.compile(self.pattern)


class Meant(NamedTuple):
    """The line to write instead of one in the words of others, and where it says something else."""

    text: str
    differs: tuple[str, ...]


_P, _Q = r"(?P<p>[^,]+?)", r"(?P<q>[^,]+?)"
_NESTED = r"\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\)"
_ONE, _OTHER = (rf"(?P<{name}>(?:{_NESTED}|(?!\b(?:and|or|implies)\b)[^,()])+?)" for name in "pq")
_DURATION = r"\d+(?:\.\d+)?\s*(?:ns|us|ms|s|min|h)"
_D, _WITHIN = rf"(?P<d>{_DURATION})", rf"(?P<w>\s+within\s+{_DURATION})?"
_TO = r"_?\s*\[?\s*(?:<=?|0?\s*[,:])\s*(?P<n>\d+(?:\.\d+)?)\s*(?:s\b)?\s*\]?"
_FROM = r"_?\s*\[\s*(?P<a>\d+(?:\.\d+)?)\s*(?:s\b)?\s*[,:]\s*(?P<n>\d+(?:\.\d+)?)\s*(?:s\b)?\s*\]"
_SECONDS = "the bound is taken to be in seconds"
_STILL = "in this P still has to hold at the instant at which the interval begins"
_AT_FIRST = "a condition that stands alone is meant always; of the first step alone, it is `initially P`"
_SAMPLES = "`@{}` counts samples of the signal, `X` steps of the run"
_SCOPE = "an `after_until` has an episode each time, HPL's scope is the first"
_EVENT = r"(?P<{}>/[\w/~]+(?:\s*\{{[^{{}}]*\}})?)"
_E, _F = (_EVENT.format(name) for name in "ef")
_GLOBALLY = r"(?:globally\s*:\s*)?"
_SHALL = r"(?:the\s+)?\w+\s+shall\s+"
_ALWAYS, _EVENTUALLY, _PREFIX = "(?:always|globally|G)", "(?:eventually|finally|F)", r"(?:always\s+)?"
_THEN = r"(?:\s*,\s*then\s+|\s*,\s*|\s+then\s+)"
_EVERY = "this is about every moment at which P holds; where it begins to is `P and not previously P`"
_PER_SAMPLE = "this is the change from one sample to the next, not per second"
_FROM_SECOND = "this counts messages, `X` steps of the run"
_FIFTY = "this is of the last 50 samples, however long they took: windows of time are not averaged"
_SUBJECT = r"(?P<v>[A-Za-z]\w*(?:\.\w+)*)"
_COMPARED = r"(?P<c>\s*(?:[<>]=?|[=!]=)\s*[-\w.]+)?"
_WINDOW = rf"\(\s*{_SUBJECT}\s*\)\s+(?:over|within)\s+{_D}"

PHRASES: tuple[Phrase, ...] = (
    # Punctuation and single words.
    Phrase(r"(?P<x>.*\S)\s*;+", "{x!r}"),
    Phrase(r"(?P<l>\w+)\s*:\s*(?P<x>\w+\s*:.*)", "{x!r}", "a property has one label"),
    Phrase(r"(?P<x>.*)\|(?P<v>[^|]+)\|(?P<y>.*)", "{x!r}abs({v!r}){y!r}"),
    Phrase(rf"(?P<x>.*)\bin\s+{_D}(?P<y>.*)", "{x!r}within {d!r}{y!r}"),
    Phrase(r"(?P<x>.*)\bage\(/(?P<t>\w+)\)(?P<y>.*)", "{x!r}age({t!r}){y!r}"),
    Phrase(r"(?P<x>.*)\bmin\((?P<c>[^()]*[<>][^()]*)\)(?P<y>.*)", "{x!r}any({c!r}){y!r}"),
    Phrase(r"(?P<x>.*)\bmax\((?P<c>[^()]*[<>][^()]*)\)(?P<y>.*)", "{x!r}any({c!r}){y!r}"),
    Phrase(r"(?P<x>.*?)(?<![\w.])\.(?P<n>\d+)(?P<y>.*)", "{x!r}0.{n!r}{y!r}"),
    Phrase(
        rf"(?P<x>.*?){_SUBJECT}\s+(?:is\s+)?between\s+(?P<n>[-\w.]+)\s+and\s+(?P<m>[-\w.]+)(?P<y>.*)",
        "{x!r}({v!r} >= {n!r} and {v!r} <= {m!r}){y!r}",
    ),
    Phrase(rf"(?P<x>.*?){_SUBJECT}'(?P<y>.*)", "{x!r}({v!r} - @{{{v!r}, -1}}){y!r}", _PER_SAMPLE),
    Phrase(
        rf"(?P<x>.*?){_SUBJECT}\s+in\s+(?:\[\s*(?P<n>[-\w.]+)\s*,\s*(?P<m>[-\w.]+)\s*\]|(?P<k>-?\d+)\.\.(?P<l>-?\d+))(?P<y>.*)",
        "{x!r}({v!r} >= {n!r}{k!r} and {v!r} <= {m!r}{l!r}){y!r}",
    ),
    # Declarations.
    Phrase(r"(?P<x>decl\s+\w+\s+\S+\s+\w+)(?:::msg)?::(?P<y>\S+)", "{x!r}/{y!r}"),
    Phrase(r"(?P<x>decl\s+\w+\s+\S+\s+[\w/]+)\s+(?P<y>[a-z][\w.\[\]]*)", "{x!r}.{y!r}"),
    # FRET.
    Phrase(rf"(?:whenever)\s+{_P},?\s+(?P<s>{_SHALL}.+)", "always ({p} implies ({s!r}))"),
    Phrase(rf"(?:upon|when|if)\s+{_P},?\s+(?P<s>{_SHALL}.+)", "always ({p} and not previously {p} implies ({s!r}))"),
    Phrase(rf"in\s+(?P<m>\w+)\s+(?:mode,?\s+)?(?P<s>{_SHALL}.+)", "after_until {m}, not {m}, ({s!r})"),
    Phrase(rf"{_SHALL}always\s+satisfy\s+(?P<r>.+)", "always {r}"),
    Phrase(rf"{_SHALL}never\s+satisfy\s+(?P<r>.+)", "never {r}"),
    Phrase(rf"{_SHALL}immediately\s+satisfy\s+(?P<r>.+)", "initially {r}"),
    Phrase(rf"{_SHALL}within\s+{_D}(?:econds?)?\s+satisfy\s+(?P<r>.+)", "eventually {r} within {d!r}"),
    Phrase(rf"{_SHALL}for\s+{_D}(?:econds?)?\s+satisfy\s+(?P<r>.+)", "always {r} for {d!r}"),
    Phrase(rf"{_SHALL}until\s+{_P}\s+satisfy\s+(?P<r>.+)", "(always {r}) or (until {p}, always {r})"),
    Phrase(rf"{_SHALL}before\s+{_P}\s+satisfy\s+(?P<r>.+)", "(never {p}) or (until {p}, eventually {r})"),
    Phrase(rf"{_SHALL}(?:eventually\s+)?(?:satisfy\s+)?(?P<r>.+)", "eventually {r}"),
    # HPL: scopes, then patterns.
    Phrase(rf"after\s+{_E}\s+until\s+{_F}\s*:\s*(?P<x>.+)", "after_until {e}, {f}, {x!r}", _SCOPE),
    Phrase(rf"after\s+{_E}\s*:\s*(?P<x>.+)", "after {e}, {x!r}"),
    Phrase(rf"until\s+{_F}\s*:\s*no\s+{_E}", "(never {e}) or (until {f}, never {e})"),
    Phrase(rf"until\s+{_F}\s*:\s*some\s+{_E}", "until {e}, never {f}"),
    Phrase(rf"until\s+{_F}\s*:\s*(?P<x>.+)", "((never {f}) and ({x!r})) or (until {f}, ({x!r}))"),
    Phrase(rf"{_GLOBALLY}no\s+{_E}", "never {e}"),
    Phrase(rf"{_GLOBALLY}some\s+{_E}{_WITHIN}", "eventually {e}{w!r}"),
    Phrase(rf"{_GLOBALLY}no\s*\{{\s*(?P<p>[^{{}}]+)\}}", "never {p}"),
    Phrase(rf"{_GLOBALLY}some\s*\{{\s*(?P<p>[^{{}}]+)\}}", "eventually {p}"),
    Phrase(rf"{_GLOBALLY}{_P}\s+(?:causes|leads\s+to)\s+{_Q}{_WITHIN}", "always ({p} implies eventually {q}{w!r})"),
    Phrase(rf"{_GLOBALLY}{_P}\s+requires\s+{_Q}{_WITHIN}", "always ({p} implies once {q}{w!r})"),
    Phrase(rf"{_GLOBALLY}{_P}\s+forbids\s+{_Q}{_WITHIN}", "always ({p} implies never {q}{w!r})"),
    # English.
    Phrase(rf"{_PREFIX}(?:if|whenever)\s+{_P}{_THEN}(?P<q>.+)", "always ({p} implies {q!r})"),
    Phrase(rf"{_PREFIX}when\s+{_P}{_THEN}(?P<q>.+)", "always ({p} implies {q!r})", _EVERY),
    Phrase(r"G\s*(?P<x>\(.+\))", "always {x!r}"),
    Phrase(r"F\s*(?P<x>\(.+\))", "eventually {x!r}"),
    Phrase(rf"after\s+{_P}\s+until\s+{_Q}\s*[,:]\s*(?P<x>.+)", "after_until {p}, {q}, {x!r}"),
    Phrase(rf"between\s+{_P}\s+and\s+{_Q}\s*[,:]\s*(?P<x>.+)", "after_until {p}, {q}, {x!r}"),
    Phrase(
        rf"before\s+{_P}\s*[,:]\s*(?P<x>(?:always|never|eventually)\b.+)",
        "((never {p}) and ({x!r})) or (until {p}, ({x!r}))",
    ),
    # Intervals.
    Phrase(
        rf"{_ONE}\s*\b(?:U|until){_TO}\s*{_OTHER}",
        "(until {q}, always {p}) and (eventually {q} within {n!r} s)",
        _SECONDS,
    ),
    Phrase(rf"{_EVENTUALLY}{_TO}\s*{_ONE}", "eventually {p} within {n!r} s", _SECONDS),
    Phrase(rf"{_ALWAYS}{_TO}\s*{_ONE}", "always {p} for {n!r} s", _SECONDS),
    Phrase(rf"(?:once|O|P){_TO}\s*{_ONE}", "once {p} within {n!r} s", _SECONDS),
    Phrase(rf"(?:historically|H){_TO}\s*{_ONE}", "historically {p} for {n!r} s", _SECONDS),
    Phrase(rf"{_EVENTUALLY}{_FROM}\s*{_ONE}", "eventually {p} within [{a!r} s, {n!r} s]", _SECONDS),
    Phrase(rf"{_ALWAYS}{_FROM}\s*{_ONE}", "always {p} for [{a!r} s, {n!r} s]", _SECONDS),
    Phrase(
        rf"{_ONE}\s*\b(?:U|until){_FROM}\s*{_OTHER}",
        "(always {p} for {a!r} s) and (within [{a!r} s, {n!r} s], until {q}, always {p})",
        f"{_SECONDS}; {_STILL}",
    ),
    # Operators between two parts, and `X`.
    Phrase(rf"{_PREFIX}{_ONE}\s+until\s+{_D}", "always {p} for {d!r}"),
    Phrase(rf"never\s+{_ONE}\s+(?:U|until)\s+{_OTHER}", "until {q}, never {p}"),
    Phrase(rf"never\s+{_ONE}\s+(?:W|unless)\s+{_OTHER}", "(until {q}, never {p}) or never {p}"),
    Phrase(rf"{_PREFIX}{_ONE}\s+(?:U|until)\s+{_OTHER}", "until {q}, always {p}"),
    Phrase(r"\[\]\s*(?P<p>.+)", "always {p}"),
    Phrase(r"<>\s*(?P<p>.+)", "eventually {p}"),
    Phrase(rf"{_PREFIX}{_ONE}\s+(?:W|unless|weak_until)\s+{_OTHER}", "(until {q}, always {p}) or always {p}"),
    Phrase(rf"{_ONE}\s+(?:R|V|releases|release)\s+{_OTHER}", "(until {p} and {q}, always {q}) or always {q}"),
    Phrase(rf"{_ONE}\s+S\s+{_OTHER}", "{p} since {q}"),
    Phrase(rf"{_ONE}\s+T\s+{_OTHER}", "not (not {p} since not {q})"),
    Phrase(
        rf"{_SUBJECT}{_COMPARED}\s+(?P<w>implies|and|or)\s+(?:X|next)\b\s*(?P<q>.+)",
        "@{{{v!r}, -1}}{c!r} {w!r} {q}",
        _SAMPLES,
    ),
    Phrase(
        rf"\A(?:always|G)\s+X\s+{_SUBJECT}{_COMPARED}",
        "after once new {v!r} 2 times, always {v!r}{c!r}",
        _FROM_SECOND,
    ),
    Phrase(rf"\AX\s+{_SUBJECT}{_COMPARED}", "after once new {v!r} 2 times, initially {v!r}{c!r}", _FROM_SECOND),
    # Windows of time.
    *(
        Phrase(rf"(?P<x>.*)\b{word}{_WINDOW}\s*{asked}\s*(?P<n>[-\w.]+)(?P<y>|\s.*)", f"{{x!r}}{written}{{y!r}}")
        for word, asked, written in (
            ("max", "(?P<o>>=?)", "once {v!r} {o!r} {n!r} within {d!r}"),
            ("max", "<", "not once {v!r} >= {n!r} within {d!r}"),
            ("max", "<=", "not once {v!r} > {n!r} within {d!r}"),
            ("min", "(?P<o><=?)", "once {v!r} {o!r} {n!r} within {d!r}"),
            ("min", ">", "not once {v!r} <= {n!r} within {d!r}"),
            ("min", ">=", "not once {v!r} < {n!r} within {d!r}"),
        )
    ),
    Phrase(rf"(?P<x>.*)\b(?P<f>mean|median|sum){_WINDOW}(?P<y>.*)", "{x!r}{f!r}(@{{{v!r}, -49:}}){y!r}", _FIFTY),
)
"""In the order in which they are tried, those of whole sentences before those of their parts."""

UNFINISHED = re.compile(r"\b(?:no|some)\s*/")
"""What is left of HPL, and would be a division."""

_OPERATORS = re.compile(r"&&?|\|\||<->|<=>|->|=>|!(?!=)|¬|∧|∨|→|⇒|≤|≥|≠")
_CONNECTIVES = re.compile(r"\s+(?:and|or|implies)\s+")
_TOPIC = re.compile(r"(/[\w/~]+)\s*(?:\{([^{}]*)\})?\Z")
_DECLARED = re.compile(r"\bdecl\s+(\w+)\s+/?(\S+)\s+[\w/]+(?:\.([\w.]+))?")


def meant(line: str, text: str, is_accepted: Callable[[str], bool]) -> Meant | None:
    """What `line` of `text` says in the words of others, as a line that `is_accepted`; None if it is no such line."""
    if len(line) > LONGEST:
        return None
    label, body = _labelled(line)
    for beginning, rest in ((label, body), ("", line)) if label else (("", line),):
        plain = " ".join(_OPERATORS.sub(_operator, rest).split())
        found = _rewritten(plain, text, partial(_is_accepted, is_accepted, beginning))
        if found is not None:
            return found._replace(text=beginning + found.text)
    return None


def _is_accepted(is_accepted: Callable[[str], bool], beginning: str, text: str) -> bool:
    return not UNFINISHED.search(text) and is_accepted(beginning + text)


def _labelled(line: str) -> tuple[str, str]:
    """The label of a line, if it has one that no phrase begins with, and the rest."""
    label = re.match(r"(?!globally\b)\w+\s*(?::|=(?!=))\s*", line)
    return (label.group(), line[label.end() :]) if label else ("", line)


def _operator(found: re.Match[str]) -> str:
    word = FOREIGN[found.group()]
    return "not " if word == "not" else f" {word} " if word.isalpha() else word


def _rewritten(body: str, text: str, is_accepted: Callable[[str], bool]) -> Meant | None:
    """`body` with phrases rewritten until it is accepted, as few as can be."""
    waiting, seen = [Meant(body, ())], {body}
    for _ in range(MOST_ROUNDS):
        waiting = [more for each in waiting for more in _once(each, text) if more.text not in seen]
        seen.update(each.text for each in waiting)
        accepted = next((each for each in waiting if is_accepted(each.text)), None)
        if accepted is not None or not waiting:
            return accepted
        waiting = waiting[:MOST_WAYS]
    return None


def _once(so_far: Meant, text: str) -> Iterator[Meant]:
    """What comes of one phrase in a text, the largest parts first."""
    whole = so_far.text
    for part in _parts(whole):
        for phrase in PHRASES:
            match = phrase.compiled.fullmatch(whole, part.start, part.end)
            if match is None or not all(map(_is_whole, match.groups(""))):
                continue
            written = phrase.written.format(**{name: _Group(of or "", text) for name, of in match.groupdict().items()})
            written = written if part.is_apart else f"({written})"
            differs = (phrase.differs, _AT_FIRST if part.is_beside else "")
            notes = so_far.differs + tuple(filter(None, differs))
            yield Meant(whole[: part.start] + written + whole[part.end :], notes)
            break


class _Part(NamedTuple):
    """A part of a text that a phrase may be: if it `is_apart`, it needs no parentheses; or it `is_beside` others."""

    start: int
    end: int
    is_apart: bool = True
    is_beside: bool = False


def _parts(text: str) -> Iterator[_Part]:
    """The text, what stands in parentheses in it, what stands between connectives there, and behind a keyword."""
    for start, end in [(0, len(text)), *_groups(text)]:
        yield _Part(start, end)
        inner = text[start:end]
        cuts = [m.span() for m in _CONNECTIVES.finditer(inner) if _is_balanced(inner[: m.start()])]
        if cuts:
            yield from (_Part(start + a, start + b, False, not start) for a, b in _between(cuts, len(inner)))
    if keyword := re.match(r"(?:always|never|eventually)\s+", text):
        yield _Part(keyword.end(), len(text), is_apart=False)
    if comma := re.match(r".*,\s+", text):
        yield _Part(comma.end(), len(text))


def _between(cuts: list[tuple[int, int]], length: int) -> Iterator[tuple[int, int]]:
    starts, ends = [0, *(end for _, end in cuts)], [*(start for start, _ in cuts), length]
    return zip(starts, ends, strict=True)


def _groups(text: str) -> list[tuple[int, int]]:
    """The insides of the parentheses, the outer ones first."""
    open_, found = [], []
    for place, character in enumerate(text):
        if character == "(":
            open_.append(place + 1)
        elif character == ")" and open_:
            found.append((open_.pop(), place))
    return sorted(found)


def _is_whole(group: str) -> bool:
    """Whether a group ends in no parentheses but its own, and is in its own alone if it begins and ends with one."""
    return _is_balanced(group) and (group[:1] + group[-1:] != "()" or _is_closed(group))


def _is_balanced(text: str) -> bool:
    return all(text.count(a) == text.count(b) for a, b in ("()", "{}", "[]"))


class _Group:
    """What a group of a phrase has matched: as it is with `!r`, else as a part of something larger."""

    def __init__(self, matched: str, text: str) -> None:
        self._matched = matched
        self._text = text

    def __repr__(self) -> str:
        return self._matched

    def __str__(self) -> str:
        part = _event(self._matched.strip(), self._text)
        is_whole = part[:1] == "(" and part[-1:] == ")" and _is_closed(part)
        return part if is_whole or _SIMPLE.fullmatch(part) else f"({part})"


_SIMPLE = re.compile(r"new \w+|[^\s,]+|(?!.*\b(?:and|or|implies|not|since|new)\b)[^,=<>!]+(?:[<>]=?|[=!]=)[^,=<>!]+")
"""A word, or a comparison."""


def _is_closed(part: str) -> bool:
    """Whether the parenthesis at the beginning is closed at the end."""
    return all(not _is_balanced(part[:place]) for place in range(1, len(part)))


def _event(part: str, text: str) -> str:
    """A message of HPL, `/r {data > 1}`, by the name of a signal of its topic; anything else as it is."""
    topic = _TOPIC.match(part)
    if topic is None:
        return part
    fields = {m[3] or "": m[1] for m in _DECLARED.finditer(text) if m[2] == topic[1].strip("/")}
    name = next(iter(fields.values()), topic[1].rpartition("/")[2])
    if topic[2] is None:
        return f"new {name}"
    condition = topic[2].strip()
    for path, signal in fields.items():
        if path:
            condition = re.sub(rf"(?<![\w.]){re.escape(path)}(?![\w.])", signal, condition)
    return f"new {name} and {condition}"
