"""Arrays in a column: parts of them, and how many elements of each are distinguished by a mask."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Array, Places, Ragged, spans
from ltlc.monitoring.columns.bits import Mask
from ltlc.runtime.sampling import Value

MOST_ELEMENTS = 1 << 18
"""Elements of so many, or of one array, are looked at at a time."""


@dataclass(frozen=True, slots=True)
class Views(Ragged):
    """Arrays that may share elements: each is as many of these as its length says, from one of the `starts` on."""

    starts: Places

    def __getitem__(self, part: slice) -> Views:
        return Views(self.elements, self.lengths[part], self.starts[part])

    def taken(self, places: Places) -> Views:
        """The arrays at `places`, in that order."""
        return Views(self.elements, self.lengths[places], self.starts[places])

    def part(self, start: int | None, stop: int | None) -> Views:
        """Of each the elements from the index `start` up to, not including, `stop`, as `Slice` has it."""
        begins = np.zeros_like(self.lengths) if start is None else self._clipped(start)
        ends = self.lengths if stop is None else self._clipped(stop)
        return Views(self.elements, np.maximum(ends - begins, 0), self.starts + begins)

    def _clipped(self, index: int) -> Places:
        """Where `index` is in each: at its beginning or end, where it is beyond."""
        size = len(self.elements)
        index = min(max(index, -size), size)
        return np.clip(index if index >= 0 else self.lengths + index, 0, self.lengths)

    def packed(self) -> Array:
        """The elements of all, one array after the other."""
        ends = self.starts + self.lengths
        if np.array_equal(self.starts[1:], ends[:-1]):
            return self.elements[self.starts[0] : ends[-1]] if len(ends) else self.elements[:0]
        return spans(self.elements, self.starts, self.lengths)

    def at(self, indexes: Places, counts: Places) -> Array:
        """The elements at these `indexes`, so many of each array, one array after the other."""
        found: Array = self.elements[self.starts.repeat(counts) + indexes]
        return found


@dataclass(frozen=True, slots=True)
class ByStep:
    """An array at each of some steps: of `arrays` the one with one of the `numbers`, which ascend."""

    arrays: Views
    numbers: Places

    def __len__(self) -> int:
        return len(self.numbers)

    def __getitem__(self, part: slice) -> ByStep:
        numbers = self.numbers[part]
        first, last = (int(numbers[0]), int(numbers[-1])) if len(numbers) else (0, -1)
        return ByStep(self.arrays[first : last + 1], numbers - first)

    def part(self, start: int | None, stop: int | None) -> ByStep:
        """A part of each, as `Slice` has it."""
        return ByStep(self.arrays.part(start, stop), self.numbers)


def held_once(arrays: Views) -> ByStep:
    """These `arrays`, those that are the same as the one before them once."""
    is_new = changes(arrays.starts) | changes(arrays.lengths)
    return ByStep(arrays.taken(np.flatnonzero(is_new)), is_new.cumsum() - 1)


def views_of(arrays: Ragged) -> Views:
    """The same `arrays`."""
    return Views(arrays.elements, arrays.lengths, arrays.lengths.cumsum() - arrays.lengths)


def held_for(array: Sequence[Value], count: int) -> ByStep:
    """One array at so many steps."""
    one = Views(side_by_side(array), np.array([len(array)]), np.zeros(1, np.int64))
    return ByStep(one, np.zeros(count, np.int64))


def views_after(before: Sequence[Sequence[Value]], arrays: Views) -> Views:
    """The arrays `before`, and after them these `arrays`."""
    if not before:
        return arrays
    elements = [element for array in before for element in array]
    first = np.array(elements, arrays.elements.dtype) if len(arrays) else side_by_side(elements)
    lengths = np.array([len(array) for array in before], np.int64)
    return Views(
        np.concatenate((first, arrays.elements)) if len(arrays) else first,
        np.concatenate((lengths, arrays.lengths)),
        np.concatenate((lengths.cumsum() - lengths, arrays.starts + len(elements))),
    )


def side_by_side(elements: Sequence[Value]) -> Array:
    """These `elements` in one array."""
    return np.array(elements, object if any(isinstance(each, str) for each in elements) else None)


def changes(column: Array) -> Mask:
    """Where a value is not the one before it, to the bit; the first one is not."""
    column = column.view(np.int64) if column.dtype == np.float64 else column
    found = np.ones(len(column), np.bool_)
    found[1:] = column[1:] != column[:-1]
    return found


def pieces(lengths: Places) -> Iterator[slice]:
    """Arrays with these `lengths` in pieces of a bounded size."""
    ends = np.flatnonzero(changes(lengths.cumsum() // MOST_ELEMENTS)).tolist()
    return (slice(*piece) for piece in pairwise([*ends, len(lengths)]))


def products(lengths: Sequence[Places], most: int) -> Places:
    """How many combinations there are of an index into each of lists with these `lengths`; 0 if more than `most`."""
    found = np.multiply.reduce([each.astype(np.float64) for each in lengths])
    return np.where(found > most, 0.0, found).astype(np.int64)


def combined(lengths: Sequence[Places], counts: Places) -> list[Places]:
    """All combinations of an index into each of lists with these `lengths`, of which there are so many.

    The result has the indexes into each list, all of one place before those of the next; the last list goes fastest.
    """
    rest = np.arange(int(counts.sum())) - (counts.cumsum() - counts).repeat(counts)
    found = []
    for of_list in reversed(lengths):
        rest, index = np.divmod(rest, of_list.repeat(counts))
        found.append(index)
    return found[::-1]


def sums(mask: Mask, lengths: Places) -> Array:
    """How much of the `mask` is true in each of pieces with these `lengths`, one after the other."""
    before, ends = np.concatenate(([0], mask.cumsum())), lengths.cumsum()
    found: Array = before[ends] - before[ends - lengths]
    return found.astype(np.float64)
