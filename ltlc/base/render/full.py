"""Diagnostics for a person: the message, the lines it is about with a mark under the place, and how to fix it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from unicodedata import category, combining, east_asian_width

from ltlc.base.diagnostics import Diagnostic, Label, Severity
from ltlc.base.render.table import example_lines
from ltlc.base.source import Source
from ltlc.dataclass import dataclass

TAB = 4
"""Every how many columns a tab stops."""

WINDOW = 160
"""How many columns of a line are shown; of a longer one, those around the place."""

_BOLD, _RESET = "\x1b[1m", "\x1b[0m"
_COLOURS = {Severity.ERROR: "\x1b[1;31m", Severity.WARNING: "\x1b[1;33m", Severity.NOTE: "\x1b[1;34m"}
_BLUE = "\x1b[1;34m"


@dataclass(frozen=True, slots=True)
class _Mark:
    """What is to be marked in one line: the characters `start` up to `end` (from 0), and a text after the mark."""

    line: int
    start: int
    end: int
    text: str
    is_primary: bool


def render(diagnostics: Iterable[Diagnostic], colour: bool = False) -> str:
    """All `diagnostics`, each followed by an empty line; with the colours of a terminal if `colour`."""
    return "".join("\n".join(_lines(diagnostic, colour)) + "\n\n" for diagnostic in diagnostics)


def _lines(diagnostic: Diagnostic, colour: bool) -> Iterator[str]:
    """The lines of one diagnostic."""
    paint = _paint if colour else _plain
    tone = _COLOURS[diagnostic.severity]
    head = paint(tone, f"{diagnostic.severity.value}[{diagnostic.code}]")
    yield f"{head}{paint(_BOLD, f': {printable(diagnostic.message)}')}"
    marks = _marks(diagnostic)
    width = len(str(max((mark.line for mark in marks), default=0)))
    if diagnostic.primary is None:
        yield f"{' ' * width}{paint(_BLUE, '-->')} {printable(diagnostic.source.name)}"
    else:
        place = diagnostic.source.position(diagnostic.primary.span.start)
        where = f"{printable(diagnostic.source.name)}:{place.line}:{place.column}"
        yield f"{' ' * width}{paint(_BLUE, '-->')} {where}"
        yield from _excerpt(diagnostic.source, marks, width, tone, colour)
    for title, text in (("help", diagnostic.help), ("example", _example(diagnostic))):
        if text:
            first, *rest = printable(text).split("\n")
            yield f"{' ' * width} {paint(_BLUE, '=')} {paint(_BOLD, title)}: {first}"
            yield from (f"{' ' * (width + 3)}{line}" for line in rest)


def _plain(_: str, text: str) -> str:
    return text


def _paint(colour: str, text: str) -> str:
    return f"{colour}{text}{_RESET}"


def _example(diagnostic: Diagnostic) -> str:
    return "\n".join(example_lines(diagnostic.example)) if diagnostic.example else ""


def _marks(diagnostic: Diagnostic) -> list[_Mark]:
    """The marks of all labels, by line; in a line the primary one comes first."""
    if diagnostic.primary is None:
        return []
    found = list(_marks_of(diagnostic.source, diagnostic.primary, is_primary=True))
    for label in diagnostic.secondary:
        found.extend(_marks_of(diagnostic.source, label, is_primary=False))
    return sorted(found, key=lambda mark: (mark.line, not mark.is_primary, mark.start))


def _marks_of(source: Source, label: Label, is_primary: bool) -> Iterator[_Mark]:
    """One mark, or two for a place of several lines: in its first line and, with the text, in its last."""
    first = source.position(label.span.start)
    last = source.position(max(label.span.start, label.span.end))
    start, end = first.column - 1, last.column - 1
    if first.line == last.line:
        yield _Mark(first.line, start, end, label.text, is_primary)
        return
    yield _Mark(first.line, start, len(source.line(first.line)), "…", is_primary)
    indent = len(source.line(last.line)) - len(source.line(last.line).lstrip())
    yield _Mark(last.line, min(indent, end), end, label.text, is_primary)


def _excerpt(source: Source, marks: list[_Mark], width: int, tone: str, colour: bool) -> Iterator[str]:
    """The marked lines with their marks; dots where lines between them are left out."""
    paint = _paint if colour else _plain
    bar = paint(_BLUE, f"{' ' * width} |")
    yield bar
    previous = 0
    for mark in marks:
        line = source.line(mark.line)
        offset = _window(line, next(m for m in marks if m.line == mark.line))
        if mark.line != previous:
            if previous and mark.line > previous + 1:
                yield paint(_BLUE, "...")
            yield f"{paint(_BLUE, f'{mark.line:>{width}} |')} {_cut(line, offset)}".rstrip()
        previous = mark.line
        yield f"{bar} {_underline(line, mark, offset, tone if mark.is_primary else _BLUE, colour)}"


def _window(line: str, mark: _Mark) -> int:
    """The column from which on `line` is shown: 0 unless it is too long and the mark far to the right."""
    if len(columns(line)) <= WINDOW:
        return 0
    return max(0, len(columns(line[: mark.start])) - WINDOW // 4)


def _cut(line: str, offset: int) -> str:
    shown = "".join(columns(line)[offset : offset + WINDOW])
    before = "…" if offset else ""
    return before + shown[len(before) :] + ("…" if len(columns(line)) > offset + WINDOW else "")


def _underline(line: str, mark: _Mark, offset: int, tone: str, colour: bool) -> str:
    """The mark below `line`, at least one column wide, and its text."""
    start = max(0, len(columns(line[: mark.start])) - offset)
    length = max(1, len(columns(line[: mark.end])) - offset - start)
    sign = ("^" if mark.is_primary else "-") * min(length, WINDOW - min(start, WINDOW - 1))
    text = f"{sign} {printable(mark.text)}".rstrip()
    return " " * start + (_paint(tone, text) if colour else text)


def columns(text: str) -> list[str]:
    """`text` as a terminal shows it, one item for each column; the second column of a wide character is empty.

    Tabs become blanks, combining characters belong to the one before, control characters are shown as `�`.
    """
    shown: list[str] = []
    for character in text:
        if character == "\t":
            shown.extend(" " * (TAB - len(shown) % TAB))
        elif combining(character) and shown:
            shown[-1 if shown[-1] else -2] += character
        elif category(character).startswith("C"):
            shown.append("\N{REPLACEMENT CHARACTER}")
        else:
            shown.extend([character, ""] if east_asian_width(character) in "WF" else [character])
    return shown


def printable(text: str) -> str:
    """`text` without control characters, so that a file cannot command the terminal."""
    return "".join("\N{REPLACEMENT CHARACTER}" if category(c).startswith("C") and c != "\n" else c for c in text)
