"""Comparisons of one column with constants, in parts that stay in the cache, as bits."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ltlc.columns import bits
from ltlc.columns.bits import Bits, Bytes, Mask, differing, packed_bytes
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
        return self.listed * bits.FEW <= len(self.packed)

    def bits(self) -> Bits:
        """What has come out."""
        return Bits(self.packed, np.concatenate(self.places) if self._is_few() else None)


def compared(values: Array, wanted: Sequence[Threshold]) -> tuple[list[Bits], bool]:
    """Each of the `wanted` comparisons of the float64 `values`, which are not empty; whether one of these is NaN."""
    order = sorted(range(len(wanted)), key=lambda number: wanted[number][1])
    count = -(-len(values) // 8)
    found = [_Compared(*wanted[number], np.empty(count, np.uint8)) for number in order]
    size = PIECE * PIECES
    masks = np.empty((min(MANY, len(wanted)), min(size, len(values))), np.bool_)
    has_nan = False
    with np.errstate(invalid="ignore"):
        for start in range(0, len(values), size):
            part = values[start : start + size]
            if len(wanted) > MANY:
                has_nan |= _add_to_many(found, part, start >> 3)
            else:
                has_nan |= _add_part(found, part, start >> 3, masks)
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


def _add_to_many(found: Sequence[_Compared], part: NDArray[np.float64], first: int) -> bool:
    """As `_add_part`, for many comparisons: each looks at those small parts only in which its constant may lie."""
    whole = len(part) // SMALL * SMALL
    small, rest = part[:whole].reshape(-1, SMALL), part[whole:]
    lows, highs = small.min(1), small.max(1)
    middle, end = first + whole // 8, first - (-len(part) // 8)
    for each in found:
        if whole:
            _add_small(each, small, lows, highs, first, middle)
        if len(rest):
            each.add(_FUNCTIONS[each.relation](rest, each.constant), middle, end)
    return bool(np.isnan(highs).any() or np.isnan(rest).any())


def _add_small(
    each: _Compared, small: Array, lows: NDArray[np.float64], highs: NDArray[np.float64], first: int, end: int
) -> None:
    """Add small parts with these least and greatest values to one comparison."""
    is_above, is_below = lows > each.constant, highs < each.constant
    open_ = np.flatnonzero(~(is_above | is_below))
    if not len(open_) and (is_above[0] == is_above).all():
        each.add_constant(each.relation in (_OF_GREATER if is_above[0] else _OF_LESS), first, end)
        return
    packed = each.packed[first:end].reshape(-1, SMALL // 8)
    packed[:] = 0
    if each.relation is not Relation.EQUAL:
        packed[is_above if each.relation in _OF_GREATER else is_below] = 0xFF
    mask = _FUNCTIONS[each.relation](small.take(open_, axis=0), each.constant)
    packed[open_] = np.packbits(mask, axis=1, bitorder="little")
    each.look(first, end)
