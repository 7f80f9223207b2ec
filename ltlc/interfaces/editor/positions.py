"""Places in a text as editors count them: lines from 0, and in a line the units of UTF-8, UTF-16 or UTF-32."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable

_LINE_BREAK = re.compile(r"\r\n|\n|\r")

_UNITS: dict[str, Callable[[str], int]] = {
    "utf-8": lambda text: len(text.encode("utf-8", "surrogatepass")),
    "utf-16": lambda text: len(text) + sum(character > "\uffff" for character in text),
    "utf-32": len,
}
"""How many units a text takes."""


class Lines:
    """The lines of `text`, which end at each line break that editors know, also at a lone carriage return."""

    def __init__(self, text: str, encoding: str = "utf-16") -> None:
        self._text = text
        self._units = _UNITS[encoding]
        breaks = list(_LINE_BREAK.finditer(text))
        self._starts = [0, *(match.end() for match in breaks)]
        self._ends = [*(match.start() for match in breaks), len(text)]

    def position(self, offset: int) -> tuple[int, int]:
        """The line, and how many units stand before the character at `offset` in it."""
        line = bisect_right(self._starts, offset) - 1
        return line, self._units(self._text[self._starts[line] : offset])

    def offset(self, line: int, character: int) -> int:
        """The offset of the character at a position; one that is beyond a line, or the text, is the end of that."""
        if line >= len(self._starts):
            return len(self._text)
        start, end = self._starts[line], self._ends[line]
        places = range(start, end + 1)
        return start + bisect_right(places, character, key=lambda place: self._units(self._text[start:place])) - 1

    def length(self, start: int, end: int) -> int:
        """How many units the text from `start` to `end` takes."""
        return self._units(self._text[start:end])
