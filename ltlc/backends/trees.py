"""Expressions of emitted code as trees, whatever the language, and text that is fit for comments."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

from ltlc.dataclass import dataclass

LINE_LENGTH = 88
INDENT = "    "


@dataclass(frozen=True, slots=True)
class Text:
    """A name or a literal."""

    text: str


@dataclass(frozen=True, slots=True)
class Prefix:
    """`operator` before its operand: `-` or `not `."""

    operator: str
    operand: Code


@dataclass(frozen=True, slots=True)
class Infix:
    """`operator` between its operands, two or more; `a - b - c` is one tree."""

    operator: str
    operands: tuple[Code, ...]


@dataclass(frozen=True, slots=True)
class Chain:
    """A comparison, as `left < right` or `low <= value <= high`: operands and the operators between them."""

    operands: tuple[Code, ...]
    operators: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Call:
    """A function of arguments."""

    function: str
    arguments: tuple[Code, ...]


@dataclass(frozen=True, slots=True)
class Each:
    """The only argument of a call: `result` for each of the items that `guard` is true of.

    An entry of `loops` is `x in xs`; items of several are combined.
    """

    result: Code
    loops: tuple[Code, ...]
    guard: Code


Code = Text | Prefix | Infix | Chain | Call | Each


def prose(text: str) -> str:
    """`text` fit for a comment or a docstring, where it must neither end it nor look like something else.

    ASCII only, nothing that a terminal or an editor acts on; a backslash or a triple quote cannot be mistaken.
    """
    escaped = "".join(c if c.isascii() and c.isprintable() else ascii(c)[1:-1] for c in text)
    return escaped.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')


def wrapped(paragraphs: Iterable[str], width: int) -> list[str]:
    """Paragraphs as lines of at most `width`, with an empty line between two."""
    lines: list[str] = []
    for text in paragraphs:
        found = textwrap.wrap(text, width, break_long_words=False, break_on_hyphens=False) or [""]
        lines += ["", *found] if lines else found
    return lines
