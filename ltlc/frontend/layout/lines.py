"""From pieces to lines: which command stands on which lines, what is broken where, and what is aligned."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import groupby, pairwise

from ltlc.base.source import Span
from ltlc.dataclass import dataclass
from ltlc.frontend.layout.pieces import Comment, Piece
from ltlc.frontend.syntax import tree as syntax

WIDTH = 120
"""The columns over which a line is broken, where it can be; the blanks that align it and its comment do not count."""

INDENT = 4


@dataclass(frozen=True, slots=True)
class Unit:
    """Commands that share a line and have to, almost always one; a line may be too long, unless it `may_break`.

    Several keep their line breaks.
    """

    commands: tuple[syntax.Command, ...]
    may_break: bool


@dataclass(frozen=True, slots=True)
class Line:
    """A line: consecutive ones of a `kind` are aligned, cell by cell; a blank line has no cells."""

    cells: tuple[str, ...] = ()
    kind: str = ""
    indent: int = 0
    comment: str = ""


def lines_of(units: Sequence[Unit], pieces: Sequence[Piece], end: Piece) -> list[Line]:
    """The lines of `units`, of whose tokens the `pieces` are, and of what stands before the `end` of the file."""
    lines: list[Line] = []
    taken = 0
    for unit in units:
        first = taken
        while taken < len(pieces) and pieces[taken].span.end <= unit.commands[-1].span.end:
            taken += 1
        _add_comments(lines, pieces[first].comments)
        if lines and pieces[first].line_breaks > 1:
            lines.append(Line())
        _add_unit(lines, unit, pieces[first:taken])
    _add_comments(lines, end.comments)
    return lines


def _add_comments(lines: list[Line], comments: Sequence[Comment], indent: int = 0) -> None:
    """Put `comments` behind the last line or below it, inside a command without blank lines."""
    for comment in comments:
        if comment.trails:
            lines[-1] = replace(lines[-1], comment=comment.text)
            continue
        if lines and comment.after_blank_line and not indent:
            lines.append(Line())
        lines.append(Line((comment.text,), indent=indent))


def _add_unit(lines: list[Line], unit: Unit, pieces: Sequence[Piece]) -> None:
    """Put the lines of `unit` below the others; a comment inside it ends a line."""
    while pieces[0].terminal == "ATTRIBUTES":
        end = next(number for number, piece in enumerate(pieces, 1) if piece.terminal == "]")
        lines.append(Line((_text(pieces[:end]),)))
        pieces = pieces[end:]
        _add_comments(lines, pieces[0].comments)
    rows, several = _rows(unit.commands), len(unit.commands) > 1
    parts = _parted(pieces, lambda piece: piece.span in rows or bool(piece.begins_line if several else piece.comments))
    for number, part in enumerate(parts):
        indent = INDENT if number else 0
        _add_comments(lines, part[0].comments if number else (), INDENT)
        broken = list(_broken(part, indent, indent + INDENT)) if unit.may_break else [(indent, part)]
        if rows and number:
            lines.append(Line(tuple(piece.text for piece in part), "attribute", indent))
        elif len(parts) == len(broken) == 1 and not several:
            lines.append(_aligned_command(unit.commands[0], part))
        else:
            lines.extend(Line((_text(line),), indent=indent) for indent, line in broken)


def _rows(commands: Sequence[syntax.Command]) -> set[Span]:
    """The places at which the lines of a model of several attributes begin; of others none."""
    match commands:
        case [syntax.Model(span, _, [_, _, *_] as attributes)]:
            return {attribute.name.span for attribute in attributes} | {Span(span.end - 1, span.end)}
        case _:
            return set()


def _parted(pieces: Sequence[Piece], begins: Callable[[Piece], bool]) -> list[list[Piece]]:
    """`pieces` in parts, a new one before each piece that `begins` one."""
    parts = [[pieces[0]]]
    for piece in pieces[1:]:
        if begins(piece):
            parts.append([])
        parts[-1].append(piece)
    return parts


def _broken(pieces: Sequence[Piece], first: int, rest: int) -> Iterator[tuple[int, Sequence[Piece]]]:
    """`pieces` on lines with their indents, `first` and then `rest`.

    If they are too long they are broken at the outermost level, and what is still too long then further in.
    """
    levels = {piece.level for piece in pieces[1:] if piece.level is not None}
    if not levels or first + len(_text(pieces)) <= WIDTH:
        yield first, pieces
        return
    outermost = min(levels)
    for number, part in enumerate(_parted(pieces, lambda piece: piece.level == outermost)):
        yield from _broken(part, rest if number else first, rest + INDENT)


def _text(pieces: Sequence[Piece]) -> str:
    return "".join(" " * piece.is_apart + piece.text for piece in pieces).lstrip(" ")


def _aligned_command(command: syntax.Command, pieces: Sequence[Piece]) -> Line:
    """A command on one line: what stands in columns where commands like it follow one another."""
    match command:
        case syntax.Declaration() | syntax.ObjectFromTopic():
            ends = [2, 3, len(pieces)]
        case syntax.PropertyCommand(_, syntax.Word(), is_assumed=True):
            ends = [3, len(pieces)]
        case syntax.ObjectAtPlace() | syntax.PropertyCommand(_, syntax.Word()):
            ends = [2, len(pieces)]
        case syntax.Zone():
            ends = [2, len(pieces)]
        case syntax.Association() | syntax.Setting():
            ends = [1, len(pieces)]
        case _:
            ends = [len(pieces)]
    kind = pieces[0].terminal if pieces[0].terminal in ("object", "assume") else type(command).__name__
    return Line(tuple(_text(pieces[start:end]) for start, end in pairwise([0, *ends])), kind)


def written(lines: Sequence[Line], line_break: str) -> str:
    """The text of `lines`: the cells of a block in columns, and the comments behind consecutive lines."""
    texts = [text for _, block in groupby(lines, lambda line: line.kind) for text in _columns(list(block))]
    finished: list[str] = []
    for commented, block in groupby(zip(texts, lines, strict=True), lambda pair: bool(pair[1].comment)):
        rows = list(block)
        width = max(len(text) for text, _ in rows) if commented else 0
        finished.extend(f"{text:<{width}}  {line.comment}" if commented else text for text, line in rows)
    return "".join(text + line_break for text in finished)


def _columns(block: Sequence[Line]) -> list[str]:
    """The lines of `block`, in which each cell but the last of a line is as wide as those of its column."""
    widths = [
        max((len(line.cells[number]) for line in block if number < len(line.cells) - 1), default=0)
        for number in range(max(len(line.cells) for line in block))
    ]
    return [
        " " * line.indent + " ".join(cell.ljust(w) for cell, w in zip(line.cells, widths, strict=False)).rstrip(" ")
        for line in block
    ]
