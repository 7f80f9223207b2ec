"""Text with places in it: what a diagnostic points at."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import field
from functools import cached_property

from ltlc.dataclass import dataclass


@dataclass(frozen=True, slots=True, order=True)
class Position:
    """A place in a text as a person counts: line and column, both from 1; a column is one character."""

    line: int
    column: int


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """The characters `start` up to, not including, `end` of one source (offsets from 0)."""

    start: int
    end: int

    def to(self, other: Span) -> Span:
        """The smallest span that holds this one and `other`."""
        return Span(min(self.start, other.start), max(self.end, other.end))


@dataclass(frozen=True)
class Source:
    """A named text, usually a file; `name` is what a diagnostic calls it.

    In the file a `mark` stands before the text: a byte order mark, or nothing.
    """

    name: str
    text: str
    mark: bytes = b""
    _line_starts: list[int] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        starts = [0]
        starts.extend(i + 1 for i, character in enumerate(self.text) if character == "\n")
        object.__setattr__(self, "_line_starts", starts)

    @cached_property
    def sha256(self) -> str:
        """The SHA-256 of the file, in hexadecimal digits, as `sha256sum` prints it."""
        from hashlib import sha256  # takes time, and few commands ask

        return sha256(self.mark + self.text.encode(errors="surrogatepass")).hexdigest()

    def position(self, offset: int) -> Position:
        """The line and column of the character at `offset`; the end of the text is a place too."""
        line = bisect_right(self._line_starts, offset)
        return Position(line, offset - self._line_starts[line - 1] + 1)

    def line(self, number: int) -> str:
        """The text of line `number` (from 1), without its line break."""
        start = self._line_starts[number - 1]
        end = self.text.find("\n", start)
        return self.text[start : len(self.text) if end < 0 else end].rstrip("\r")

    def excerpt(self, span: Span) -> str:
        """The text that `span` covers, its white space and line breaks folded into single blanks."""
        return " ".join(self.text[span.start : span.end].split())

    def replaced(self, span: Span, written: Mapping[Span, str]) -> str:
        """The text that `span` covers, with what is `written` in place of parts of it."""
        text, end = "", span.start
        for part in sorted(part for part in written if span.start <= part.start and part.end <= span.end):
            text += self.text[end : part.start] + written[part]
            end = part.end
        return text + self.text[end : span.end]


def quoted(value: str) -> str:
    """A string as it is written in the language."""
    escaped = value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\t", "\\t")
    return f'"{escaped}"'
