"""Rust as text: statements of emitted code, laid out, and comments that hold anything."""

from __future__ import annotations

from ltlc.backends.braces import Braces
from ltlc.backends.trees import LINE_LENGTH, prose, wrapped

lines = Braces("", " {", "// {}").lines
"""Statements as text, all of which are indented."""


def comment(mark: str, *paragraphs: str, indent: str = "") -> list[str]:
    """Paragraphs that may hold anything, as a comment each line of which begins with `mark`."""
    width = LINE_LENGTH - len(indent) - len(mark) - 1
    return [f"{indent}{mark} {line}".rstrip() for line in wrapped(map(prose, paragraphs), width)]
