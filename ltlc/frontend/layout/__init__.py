"""The canonical layout of a specification: the same commands and comments, with blanks and line breaks in one way.

It works on tokens, as the tree has no comments; the parser gives where commands begin, and which `-` is a sign.
"""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.base.diagnostics import Diagnostic
from ltlc.base.source import Source
from ltlc.frontend.language.suppression import suppressions
from ltlc.frontend.layout.lines import Unit, lines_of, written
from ltlc.frontend.layout.pieces import pieces_of
from ltlc.frontend.syntax import tree as syntax
from ltlc.frontend.syntax.parse import parse_with_tokens

__all__ = ["layout"]


def layout(source: Source) -> str | list[Diagnostic]:
    """`source` in the canonical layout, or what is wrong with its syntax.

    The tokens and the comments stay, in their order, and each comment stays with its command. Line breaks are those
    of the first line.
    """
    tree, tokens, diagnostics = parse_with_tokens(source)
    if diagnostics:
        return diagnostics
    *pieces, end = pieces_of(source, tree, tokens)
    lines = lines_of(_units(source, tree), pieces, end)
    return written(lines, "\r\n" if source.line(1) != source.text.partition("\n")[0] else "\n")


def _units(source: Source, tree: syntax.SyntaxTree) -> list[Unit]:
    """The commands of `tree`, in groups that must stay on one line, as `check` reports something about it."""
    suppressed = _suppressed_lines(source, tree)
    units: list[list[syntax.Command]] = []
    for command in tree.commands:
        if units and _shares_line(source, units[-1][-1], command, suppressed):
            units[-1].append(command)
        else:
            units.append([command])
    return [Unit(tuple(unit), _may_break(source, unit, suppressed)) for unit in units]


def _suppressed_lines(source: Source, tree: syntax.SyntaxTree) -> set[int]:
    """The lines that comments are about which suppress findings."""
    properties = [command.whole() for command in tree.commands if isinstance(command, syntax.PropertyCommand)]
    return {line for each in suppressions(source, properties) for line in each.lines or ()}


def _shares_line(source: Source, first: syntax.Command, second: syntax.Command, suppressed: set[int]) -> bool:
    """Whether `second` must stay on the line on which `first` ends: what `check` reports depends on it."""
    if "\n" in source.text[first.span.end : second.span.start]:
        return False
    return syntax.runs_on(source.text, first, second) or source.position(second.span.start).line in suppressed


def _may_break(source: Source, commands: Sequence[syntax.Command], suppressed: set[int]) -> bool:
    """Whether `commands` may go over several lines: those of which a suppression is about a line may not.

    One that touches a property is about all its lines.
    """
    if len(commands) > 1 or isinstance(commands[0], syntax.PropertyCommand):
        return len(commands) == 1
    first, last = (source.position(offset).line for offset in (commands[0].span.start, commands[0].span.end))
    return suppressed.isdisjoint(range(first, last + 1))
