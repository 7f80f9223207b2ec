"""Comparisons of one column with constants, in parts that stay in the cache, as bits."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ltlc.columns import bits
from ltlc.columns.bits import Bits, Bytes, Mask, as_bits, differing, is_few, packed_bytes
from ltlc.recordings.blocks import Array, Places
from ltlc.specification.atoms import Relation

PIECE = 1 << 15
"""How many values of a column are looked at at a time: their least and greatest tell most comparisons."""

PIECES = 8
"""How many pieces are packed at a time."""

MANY = 8
"""From more comparisons of a column on, the least and the greatest of each small part of it are worth their time."""

SMALL = 128
"""How many values there are in a small part, a multiple of eight."""

MOST = 4
"""If a constant lies in more than one of so many small parts, all of the column is compared with it."""

ROWS = 512
"""How many small parts are compared at a time."""

_FUNCTIONS = {
    Relation.LESS: np.less,
    Relation.AT_MOST: np.less_equal,
    Relation.EQUAL: np.equal,
    Relation.AT_LEAST: np.greater_equal,
    Relation.GREATER: np.greater,
}
_OF_LESS = {Relation.LESS, Relation.AT_MOST}
_OF_GREATER = {Relation.GREATER, Relation.AT_LEAST}

Threshold = tuple[Relation, float]
"""`x relation constant`; the constant is not NaN."""


@dataclass(slots=True)
class _Compared:
    """One comparison so far: its bytes, those listed that change, and its last boolean, None before the first."""

    relation: Relation
    constant: float
    packed: Bytes
    places: list[Places] = field(default_factory=list)
    listed: int = 0
    last: bool | None = None

    def add_constant(self, holds: bool, first: int, end: int) -> None:
        """It `holds`, or does not, all over the bytes from `first` to before `end`."""
        self.packed[first:end] = 0xFF if holds else 0
        if self.last is not holds:
            self._list(np.array([first]))
        self.last = holds

    def add(self, mask: Mask, first: int, end: int) -> None:
        """It is as in `mask` over these bytes."""
        self.packed[first:end] = packed_bytes(mask)
        self.look(first, end)

    def look(self, first: int, end: int) -> None:
        """See what changes in these bytes."""
        part = self.packed[first:end]
        if self._is_few():
            self._list(differing(part, self.last) + first)
        self.last = bool(part[-1] >> 7)

    def _list(self, places: Places) -> None:
        self.places.append(places)
        self.listed += len(places)

    def _is_few(self) -> bool:
        return bits.is_few(self.listed, len(self.packed))

    def bits(self) -> Bits:
        """What has come out."""
        if not self._is_few():
            return Bits(self.packed, None, len(self.packed))
        places = np.concatenate(self.places)
        return Bits(self.packed.take(places), places, len(self.packed))


@np.errstate(invalid="ignore")
def compared(values: Array, wanted: Sequence[Threshold]) -> tuple[list[Bits], bool]:
    """Each of the `wanted` comparisons of the float64 `values`, which are not empty; whether one of these is NaN."""
    if len(wanted) > MANY:
        return _compared_with_many(values, wanted)
    order = sorted(range(len(wanted)), key=lambda number: wanted[number][1])
    count = -(-len(values) // 8)
    found = [_Compared(*wanted[number], np.empty(count, np.uint8)) for number in order]
    size = PIECE * PIECES
    masks = np.empty((len(wanted), min(size, len(values))), np.bool_)
    has_nan = False
    for start in range(0, len(values), size):
        has_nan |= _add_part(found, values[start : start + size], start >> 3, masks)
    by_place = sorted(zip(order, found, strict=True), key=lambda pair: pair[0])
    return [each.bits() for _, each in by_place], has_nan


def _add_part(found: Sequence[_Compared], part: NDArray[np.float64], first: int, masks: Mask) -> bool:
    """Add a part, whose bytes begin with `first`, to what was `found`; whether a value in it is NaN."""
    constants = [each.constant for each in found]
    ranges = []
    has_nan = False
    for start in range(0, len(part), PIECE):
        piece = part[start : start + PIECE]
        low, high = float(np.minimum.reduce(piece)), float(np.maximum.reduce(piece))
        is_nan = low != low
        has_nan |= is_nan
        # Of all numbers from `low` to `high`, only comparisons with constants among them are not all alike.
        ranges.append((0, len(found)) if is_nan else (bisect_left(constants, low), bisect_right(constants, high)))
        for number in range(*ranges[-1]):
            each = found[number]
            _FUNCTIONS[each.relation](piece, each.constant, out=masks[number, start : start + len(piece)])
    least, most = min(begin for begin, _ in ranges), max(end for _, end in ranges)
    end = first - (-len(part) // 8)
    for number, each in enumerate(found):
        if not least <= number < most:
            each.add_constant(each.relation in (_OF_GREATER if number < least else _OF_LESS), first, end)
        else:
            _fill(each, number, ranges, masks[number, : len(part)])
            each.add(masks[number, : len(part)], first, end)
    return has_nan


def _fill(each: _Compared, number: int, ranges: Sequence[tuple[int, int]], mask: Mask) -> None:
    """Fill the pieces of `mask` in which the comparison is the same of all values."""
    for piece, (begin, end) in enumerate(ranges):
        if not begin <= number < end:
            mask[piece * PIECE : (piece + 1) * PIECE] = each.relation in (_OF_GREATER if number < begin else _OF_LESS)


def _compared_with_many(values: Array, wanted: Sequence[Threshold]) -> tuple[list[Bits], bool]:
    """As `compared`: where a constant lies in few small parts only, no others are compared with it."""
    whole = len(values) // SMALL * SMALL
    rest = np.full((int(whole < len(values)), SMALL), values[-1])
    rest[:, : len(values) - whole] = values[whole:]
    parts = [part for part in (values[:whole].reshape(-1, SMALL), rest) if len(part)]
    lows, highs = (np.concatenate([of(part, 1) for part in parts]) for of in (np.min, np.max))
    has_nan = bool(np.isnan(np.max(highs)))
    # With the last value of the part before, which tells whether the first one of a part changes something.
    lasts = np.concatenate([part[:, -1] for part in parts])
    lows[1:], highs[1:] = np.minimum(lows[1:], lasts[:-1]), np.maximum(highs[1:], lasts[:-1])
    found: dict[int, Bits] = {}
    for relation in dict.fromkeys(relation for relation, _ in wanted):
        numbers = [number for number, each in enumerate(wanted) if each[0] is relation]
        numbers.sort(key=lambda number: wanted[number][1])
        constants = np.array([wanted[number][1] for number in numbers])
        small = _Small(_FUNCTIONS[relation], parts, lows, highs, lasts, -(-len(values) // 8))
        is_open = small.count(constants) * MOST > len(lows)
        few, many = np.flatnonzero(~is_open).tolist(), np.flatnonzero(is_open).tolist()
        for these, way in ((few, small.crossings), (many, partial(_each, small.function, values))):
            bits = way(constants[these])
            found.update(zip((numbers[each] for each in these), bits, strict=True))
    return [found[number] for number in range(len(wanted))], has_nan


def _each(function: np.ufunc, values: Array, constants: NDArray[np.float64]) -> Iterator[Bits]:
    """Compare all the values, so many at a time that they stay in the cache, with each of the `constants`."""
    packed = np.empty((len(constants), -(-len(values) // 8)), np.uint8)
    for start in range(0, len(values), PIECE):
        piece = values[start : start + PIECE]
        mask = np.empty(len(piece), np.bool_)
        for row, constant in zip(packed, constants, strict=True):
            row[start >> 3 : (start + PIECE) >> 3] = packed_bytes(function(piece, constant, out=mask))
    return map(as_bits, packed)


@dataclass(frozen=True, slots=True)
class _Small:
    """The small `parts` of a column, the least and the greatest of each, and of the last value before it; its last."""

    function: np.ufunc
    parts: Sequence[Array]
    lows: NDArray[np.float64]
    highs: NDArray[np.float64]
    lasts: NDArray[np.float64]
    size: int

    def _ranges(self, constants: NDArray[np.float64]) -> tuple[Places, Places]:
        """Of each part, the first of the ascending `constants` that may lie in it, and the one after the last."""
        begins, ends = constants.searchsorted(self.lows, "left"), constants.searchsorted(self.highs, "right")
        is_nan = np.isnan(self.highs)
        is_nan[0] = True  # Of the first one, all are wanted.
        begins[is_nan], ends[is_nan] = 0, len(constants)
        return begins, ends

    def count(self, constants: NDArray[np.float64]) -> Places:
        """In how many parts each of the ascending `constants` may lie."""
        begins, ends = (np.bincount(each, minlength=len(constants) + 1) for each in self._ranges(constants))
        counts: Places = (begins - ends).cumsum()[:-1]
        return counts

    def crossings(self, constants: NDArray[np.float64]) -> Iterator[Bits]:
        """Compare with the ascending `constants`."""
        if not len(constants):
            return
        begins, ends = self._ranges(constants)
        counts = ends - begins
        parts = np.arange(len(counts)).repeat(counts)
        numbers = np.arange(len(parts)) - (counts.cumsum() - counts - begins).repeat(counts)
        numbers = numbers.astype(np.min_scalar_type(len(constants)))  # Few bits are sorted in one go.
        starts = range(0, len(parts), ROWS)
        found = [self._changes(parts[n : n + ROWS], numbers[n : n + ROWS], constants) for n in starts]
        places, packed, numbers = (np.concatenate(each) for each in zip(*found, strict=True))
        order = numbers.argsort(kind="stable")
        places, packed = places[order], packed[order]
        limits = [0, *np.bincount(numbers, minlength=len(constants)).cumsum().tolist()]
        for first, end in pairwise(limits):
            bits = Bits(packed[first:end], places[first:end], self.size)
            yield bits if is_few(end - first, self.size) else Bits(bits.bytes(), None, self.size)

    def _changes(self, parts: Places, numbers: Places, constants: NDArray[np.float64]) -> tuple[Places, Bytes, Places]:
        """The bytes that change where these parts are compared with these constants: places, bytes, constants."""
        compared_with = constants[numbers][:, None]
        packed = np.packbits(self.function(self._values(parts), compared_with), bitorder="little")
        width = SMALL // 8
        before = np.empty(len(packed), np.int8)
        np.right_shift(packed[:-1].view(np.int8), 7, out=before[1:])
        before[::width] = -self.function(self.lasts[parts - 1], compared_with[:, 0]).astype(np.int8)
        differs = packed.view(np.int8) != before
        differs[::width] |= parts == 0
        at = np.flatnonzero(differs)
        rows = at // width
        return parts[rows] * width + (at - rows * width), packed[at], numbers[rows]

    def _values(self, parts: Places) -> NDArray[np.float64]:
        whole = self.parts[0]
        found: NDArray[np.float64] = whole.take(np.minimum(parts, len(whole) - 1), axis=0)
        if len(self.parts) > 1:
            found[parts == len(whole)] = self.parts[1]
        return found
