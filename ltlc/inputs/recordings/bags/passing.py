"""Skipping unread elements of CDR messages, one message after the other.

It is for few messages with many elements: of many messages, `cdr` takes each element in all of them at once.
"""

from __future__ import annotations

from struct import Struct

import numpy as np

from ltlc.inputs.messages.definitions import STRINGS, FieldType, MessageTypes
from ltlc.inputs.recordings.bags.scalars import SCALARS, MisfitError
from ltlc.inputs.recordings.blocks import Array, Places

Step = tuple[int, int, "str | None"]
"""So many bytes of each number, and so many numbers; or with a name, a list of what is called so: of any length if that
is 0, of messages or strings if they have no size. A string is a list of bytes."""

WORTH = 40
"""Of so many messages that have as many elements, it takes no less time than to take all at once."""


def is_worth(counts: Places) -> bool:
    """Whether messages with so many elements are faster stepped over one by one."""
    return bool(counts.size) and int(counts.sum()) < WORTH * int(counts.max())


class Passing:
    """Steps over values in messages of one byte order, none longer than `longest`."""

    def __init__(self, types: MessageTypes, data: Array, order: str, longest: int) -> None:
        self._types = types
        self._data = data.data
        self._count = Struct(f"{order}I").unpack_from
        self._longest = longest
        self._known: dict[str, list[Step]] = {}  # a cache of a method would keep the data until garbage is collected

    def all(self, base: str, counts: Places, starts: Places, at: int | Places) -> Places:
        """Where each message is behind so many values, from its place `at` on. Raises struct.error, MisfitError."""
        places = np.zeros(len(starts), np.int64) + at
        for row, (count, start, place) in enumerate(
            zip(counts.tolist(), starts.tolist(), places.tolist(), strict=True)
        ):
            places[row] = self._past(base, count, start, place)
        return places

    def _past(self, base: str, count: int, start: int, at: int) -> int:
        steps = self._steps(base)
        for _ in range(count):
            for size, length, name in steps:
                if name is None:
                    at = ((at + size - 1) & -size) + size * length
                    continue
                if length == 0:
                    at = (at + 3) & -4
                    (length,) = self._count(self._data, start + at)
                    at += 4
                    if length > self._longest:
                        raise MisfitError
                if size == 0:
                    at = self._past(name, length, start, at)
                elif length:
                    at = ((at + size - 1) & -size) + size * length
        return at

    def _steps(self, base: str) -> list[Step]:
        """How a value is stepped over."""
        if base not in self._known:
            self._known[base] = self._steps_of(base)
        return self._known[base]

    def _steps_of(self, base: str) -> list[Step]:
        if base in STRINGS:
            return [(1, 0, base)]
        if base in SCALARS:
            return [(np.dtype(SCALARS[base]).itemsize, 1, None)]
        found: list[Step] = []
        for type_ in self._types.messages[base].fields.values():
            for size, length, name in self._of_field(type_):
                if found and name is None and found[-1][2] is None and found[-1][0] == size:
                    found[-1] = (size, found[-1][1] + length, None)
                else:
                    found.append((size, length, name))
        return found

    def _of_field(self, type_: FieldType) -> list[Step]:
        if not type_.is_list:
            return self._steps_of(type_.base)
        if type_.base not in SCALARS:
            return [(0, type_.length or 0, type_.base)]
        size = np.dtype(SCALARS[type_.base]).itemsize
        return [(size, type_.length, None) if type_.length else (size, 0, type_.base)]
