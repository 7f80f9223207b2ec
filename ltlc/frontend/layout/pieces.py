"""The tokens of a text as they are written in a line, each with the comments that stand before it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import pairwise

from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.frontend.syntax import tree as syntax
from ltlc.frontend.syntax.lexer import END, Token

_COMMENT = re.compile(r"(\s*)(#[^\n]*)")
_BEFORE_LISTS = frozenset({"=", "within", "WITHIN_FIRST", "for"})
"""Behind these, `[` begins corners or an interval, and elsewhere an index."""

_OPENING, _CLOSING = frozenset({"(", "[", "{", "ATTRIBUTES"}), frozenset(")]}")
_RANKS = {"implies": 2, "or": 3, "and": 4, "since": 5}


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment; it `trails` what stands before it on its line, or stands alone there, maybe after a blank line."""

    text: str
    trails: bool
    after_blank_line: bool


@dataclass(frozen=True, slots=True)
class Piece:
    """A token as it is written, and what stands before it.

    It `is_apart` if a blank parts it from the token before it on a line. `level` says how deep in the structure a line
    break before it would be, the least outermost; None if there is none. So many `line_breaks` stand right before it.
    """

    terminal: str
    text: str
    span: Span
    is_apart: bool
    level: tuple[int, int] | None
    comments: tuple[Comment, ...]
    line_breaks: int

    @property
    def begins_line(self) -> bool:
        """Whether nothing but a comment stands on the line from the token before it on."""
        return bool(self.comments or self.line_breaks)


def pieces_of(source: Source, tree: syntax.SyntaxTree, tokens: Sequence[Token]) -> Iterator[Piece]:
    """The pieces of `tokens`, those of `tree`, and one without text for the end of the file."""
    binary = {
        node.operator.span
        for command in tree.commands
        for node, _ in syntax.walk(command)
        if isinstance(node, syntax.Arithmetic)
    }
    start = Token(END, Span(0, 0), "")
    end = Token(END, Span(len(source.text), len(source.text)), "")
    ahead = start
    depth, in_brackets = 0, False
    for before, token in pairwise([start, *tokens, end]):
        depth -= token.terminal in _CLOSING
        is_sign = before.terminal == "-" and before.span not in binary
        comments, line_breaks = _between(source.text[before.span.end : token.span.start], before is not start)
        yield Piece(
            token.terminal,
            token.text if token.terminal == "DURATION" else source.text[token.span.start : token.span.end],
            token.span,
            not (is_sign or in_brackets or _touches(before.terminal, token.terminal)),
            _level(ahead.terminal, before.terminal, token.terminal, depth),
            comments,
            line_breaks,
        )
        depth += token.terminal in _OPENING
        begins_index = token.terminal == "[" and before.terminal not in _BEFORE_LISTS
        in_brackets = begins_index or (in_brackets and token.terminal != "]")
        ahead = before


def _between(gap: str, follows: bool) -> tuple[tuple[Comment, ...], int]:
    """The comments in a gap, which `follows` a token unless it begins the file, and the line breaks after them."""
    found, end = [], 0
    for match in _COMMENT.finditer(gap):
        breaks = match[1].count("\n")
        found.append(Comment(match[2].rstrip(), follows and breaks == 0, breaks > 1))
        end = match.end()
    return tuple(found), gap[end:].count("\n")


def _touches(before: str, terminal: str) -> bool:
    """Whether no blank stands between two tokens."""
    if before in ("(", "[", "ATTRIBUTES", "{", "@", ".") or terminal in (")", "]", "}", ",", ":", "."):
        return True
    if terminal == "[":
        return before not in _BEFORE_LISTS
    if terminal == "(":
        return before in ("FUNCTION", "QUANTIFIER", "rate")
    return terminal == "{" and before not in ("in", "NAME")


def _level(ahead: str, before: str, terminal: str, depth: int) -> tuple[int, int] | None:
    """The level of a line break between `before` and `terminal`, where `ahead` stands before these."""
    if (ahead, before) == ("}", ":") and terminal != "forall":
        return depth, 0
    if before == ",":
        return depth, 1
    return (depth, _RANKS[terminal]) if terminal in _RANKS else None
