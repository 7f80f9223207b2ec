"""The words of others: a line as other languages, tools and English have it, and the line to write instead.

A table of phrases is put to a line, to what stands in its parentheses, and to the sides of its connectives, again and
again, until what comes of it can be parsed. So phrases may stand in one another.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

from ltlc.frontend.syntax.lexer import FOREIGN, FOREIGN_UNITS
from ltlc.frontend.syntax.misspelled import UNFINISHED
from ltlc.frontend.syntax.phrasebook import AT_FIRST, PHRASES, SECONDS, TEMPORAL

LONGEST = 200
"""Longer lines are not looked at: they could match in too many ways."""

MOST_ROUNDS = 5
"""So many phrases one line may have."""

MOST_WAYS = 6
"""So many ways to go on are kept."""


class Meant(NamedTuple):
    """The line to write instead of one in another language's words, and where it means something else."""

    text: str
    differs: tuple[str, ...]


_MIXED = re.compile(rf"(?!(?:always|never|eventually)\b)[^()]*?\bimplies\s+\(?{TEMPORAL}.*")
"""What would be asked about: whether the condition is meant at the first step, or always."""

_AT_EACH = "this is about every step; of the first alone, it is `(not initially P) or Q`"

_OPERATORS = re.compile(
    r"\|->|\|=>|-->|~>|\b(?:next|until|eventually)!|&&?|/\\|\\/|\|\||<->|<=>|->|=>|!(?!=)|¬|∧|∨|→|⇒|≤|≥|≠"
)
_FOREIGN_DURATION = re.compile(rf"(?<=\d)\s*({'|'.join(sorted(FOREIGN_UNITS, key=len, reverse=True))})\b")
_SENTENCE = re.compile(r"(?:The|When|Whenever|Upon|If|In|While|Between|After|Before|Globally|Every|At)\b")
_CONNECTIVES = re.compile(r"\s+(?:and|or|implies)\s+")
_TOPIC = re.compile(r"(/[\w/~]+)\s*(?:\{([^{}]*)\})?\Z")
_DECLARED = re.compile(r"\bdecl\s+(\w+)\s+/?(\S+)\s+([\w/]+)(?:\.([\w.]+))?")


def meant(line: str, text: str, is_accepted: Callable[[str], bool]) -> Meant | None:
    """What `line` of `text` means in another language's words, as a line that `is_accepted`; None if nothing."""
    if len(line) > LONGEST:
        return None
    label, body = _labelled(line)
    for beginning, rest in ((label, body), ("", line)) if label else (("", line),):
        plain = " ".join(_OPERATORS.sub(_operator, rest).split())
        plain = _FOREIGN_DURATION.sub(lambda unit: f" {FOREIGN_UNITS[unit[1]]}", plain)
        plain = _SENTENCE.sub(lambda word: word[0].lower(), plain, count=1) if _SENTENCE.match(plain) else plain
        found = _rewritten(plain, text, partial(_is_accepted, is_accepted, beginning))
        if found is not None and _MIXED.fullmatch(found.text):
            differs = tuple(note for note in found.differs if note != AT_FIRST)
            found = Meant(f"always ({found.text})", (*differs, _AT_EACH))
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
    word = FOREIGN.get(found.group(), found.group().rstrip("!"))
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
            groups = {name: _Group(of or "", text) for name, of in match.groupdict().items()}
            in_seconds = match.groupdict().get("u") == ""
            written = phrase.written.format(**groups | ({"u": _Group("s", text)} if in_seconds else {}))
            if written == match.group():
                continue
            written = written if part.is_apart else f"({written})"
            differs = (phrase.differs, SECONDS if in_seconds else "", AT_FIRST if part.is_beside else "")
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

    @property
    def name(self) -> str:
        """What a signal of this topic is called; if none is declared, nothing that could be a name."""
        return next((m[1] for m in _DECLARED.finditer(self._text) if m[2] == self._matched.strip("/")), "?")

    @property
    def type(self) -> str:
        """What another declaration of this topic has as its type."""
        found = (m[3] for m in _DECLARED.finditer(self._text) if m[2] == self._matched.strip("/"))
        return next(found, "")

    @property
    def signal(self) -> str:
        """The signal that is declared with this topic and this path."""
        steps = self.path.split(".")
        declared = ((m[1], [*m[2].split("/"), *(m[4] or "").split(".")]) for m in _DECLARED.finditer(self._text))
        return next((name for name, of in declared if of == steps), self._matched)

    @property
    def zone(self) -> str:
        """It, if it is a zone; else nothing."""
        is_zone = re.search(rf"\bzone\s+{re.escape(self._matched)}\s*=", self._text)
        return self._matched if is_zone else ""

    @property
    def path(self) -> str:
        """With points for slashes."""
        return self._matched.strip("/").replace("/", ".")

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
    fields = {m[4] or "": m[1] for m in _DECLARED.finditer(text) if m[2] == topic[1].strip("/")}
    name = next(iter(fields.values()), topic[1].rpartition("/")[2])
    if topic[2] is None:
        return f"new {name}"
    condition = topic[2].strip()
    for path, signal in fields.items():
        if path:
            condition = re.sub(rf"(?<![\w.]){re.escape(path)}(?![\w.])", signal, condition)
    return f"new {name} and {condition}"
