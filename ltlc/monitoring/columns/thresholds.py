"""Comparisons of one column with constants, in parts that stay in the cache, as bits."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.monitoring.columns.bits import Bits, Bytes, as_bits, is_few, packed_bytes

PIECE = 1 << 16
"""How many values of a column are looked at at a time: their least and greatest tell most comparisons."""

PIECES = 8
"""A sample of so many pieces at a time shows whether they may be looked at together."""

APART = 4091
"""How far the values of a sample are from one another: each costs a look into memory."""

MANY = 8
"""From more comparisons of a column on, the least and the greatest of each small part of it are worth their time."""

SMALL = 64
"""How many values there are in a small part, a multiple of eight."""

WIDER = 4
"""So many times as many there are where fewer constants than one in two parts lie among them."""

MOST = 4
"""If a constant lies in more than one of so many small parts, all of the column is compared with it."""

AT_ONCE = 1 << 16
"""How many values of small parts are compared at a time."""

_OF_LESS = {np.less, np.less_equal}
_OF_GREATER = {np.greater, np.greater_equal}

Threshold = tuple[np.ufunc, float]
"""`compare(x, constant)`: one of `np.less`, `less_equal`, `equal`, `greater_equal`, `greater`; no constant is NaN."""

Among = tuple[int, int]
"""Which of ascending constants, from one to before another, lie among values; with any other, these compare alike."""


@np.errstate(invalid="ignore")
def compared(values: Array, wanted: Sequence[Threshold]) -> tuple[list[Bits], bool]:
    """Each of the `wanted` comparisons of the float64 `values`, which are not empty; whether one of these is NaN."""
    if len(wanted) > MANY:
        return _compared_with_many(values, wanted)
    order = sorted(range(len(wanted)), key=lambda number: wanted[number][1])
    few = _Few([wanted[number] for number in order], values)
    found = dict(zip(order, few.bits(), strict=True))
    return [found[number] for number in range(len(wanted))], few.has_nan


class _Few:
    """Comparisons with a few constants, which ascend, of one part of a column after the other."""

    def __init__(self, wanted: Sequence[Threshold], values: Array) -> None:
        """The column has these values."""
        self.has_nan = False
        self._wanted = wanted
        self._constants = [constant for _, constant in wanted]
        size = -(-len(values) // 8)
        self._packed = np.empty((len(wanted), -(-size // 8) * 8), np.uint8)[:, :size]  # rows begin with a word
        self._mask = np.empty(PIECE, np.bool_)
        self._compare(values)

    def bits(self) -> Iterator[Bits]:
        """Each comparison."""
        return map(as_bits, self._packed)

    def _compare(self, values: Array) -> None:
        """Compare the values."""
        for first in range(0, len(values), PIECE * PIECES):
            part = values[first : first + PIECE * PIECES]
            sampled = _sampled(part, self._constants)
            if sampled[0] == sampled[1] and _among(part, self._constants, sampled) == sampled:
                self._put(first, len(part), sampled)
                continue
            for start in range(first, first + len(part), PIECE):
                self._compare_piece(start, values[start : start + PIECE])

    def _compare_piece(self, start: int, piece: Array) -> None:
        """Compare a piece, which begins at `start`, with what lies among its values."""
        among = _among(piece, self._constants, _sampled(piece, self._constants))
        self.has_nan |= among is None
        begin, end = among or (0, len(self._wanted))
        for number in range(begin, end):
            compare, constant = self._wanted[number]
            packed = packed_bytes(compare(piece, constant, out=self._mask[: len(piece)]))
            self._packed[number, start >> 3 : (start >> 3) + len(packed)] = packed
        self._put(start, len(piece), (begin, end))

    def _put(self, start: int, count: int, among: Among) -> None:
        """Put what is known of so many values from `start` on, but for the constants `among` them."""
        begin, end = among
        for number, (compare, _) in enumerate(self._wanted):
            if not begin <= number < end:
                holds = compare in (_OF_LESS if number >= end else _OF_GREATER)
                self._packed[number, start >> 3 : (start + count + 7) >> 3] = 0xFF * holds


def _sampled(values: Array, constants: Sequence[float]) -> Among:
    """Which of the ascending `constants` lie among a sample of the `values`."""
    sample = values[::APART].tolist()
    return bisect_left(constants, min(sample)), bisect_right(constants, max(sample))


def _among(values: Array, constants: Sequence[float], sampled: Among) -> Among | None:
    """Which of the ascending `constants` lie among the `values`, given those among a sample; None if one is NaN.

    The least value is not looked for where no constant is below the sample, nor the greatest where none is above it;
    one of the two always is, for NaN.
    """
    begin, end = sampled
    if begin:
        low = float(np.minimum.reduce(values))
        if low != low:
            return None
        begin = bisect_left(constants, low)
    if end < len(constants) or not sampled[0]:
        high = float(np.maximum.reduce(values))
        if high != high:
            return None
        end = bisect_right(constants, high)
    return begin, end


def _compared_with_many(values: Array, wanted: Sequence[Threshold]) -> tuple[list[Bits], bool]:
    """As `compared`: where a constant lies in few small parts only, no others are compared with it."""
    parts = _parts(values, SMALL * (1 if _is_busy(values, np.sort([constant for _, constant in wanted])) else WIDER))
    found: dict[int, Bits] = {}
    for compare in dict.fromkeys(compare for compare, _ in wanted):
        numbers = [number for number, each in enumerate(wanted) if each[0] is compare]
        numbers.sort(key=lambda number: wanted[number][1])
        constants = np.array([wanted[number][1] for number in numbers])
        small = _Small(compare, parts, -(-len(values) // 8))
        is_open = small.count(constants) * MOST > len(parts.lows)
        few, many = np.flatnonzero(~is_open).tolist(), np.flatnonzero(is_open).tolist()
        for these, way in ((few, small.crossings), (many, partial(_each, small.function, values))):
            bits = way(constants[these])
            found.update(zip((numbers[each] for each in these), bits, strict=True))
    return [found[number] for number in range(len(wanted))], bool(np.isnan(np.max(parts.highs)))


def _is_busy(values: Array, constants: NDArray[np.float64]) -> bool:
    """Whether one of the ascending `constants` lies in every second small part, to judge by a sample of `values`."""
    ends = values[SMALL::APART]
    passed = constants.searchsorted(ends) - constants.searchsorted(values[::APART][: len(ends)])
    return 2 * int(np.abs(passed).sum()) > len(ends)


@dataclass(frozen=True, slots=True)
class _Parts:
    """The small parts of a column, of `width` values each: those that are `whole`, and the `rest` with its last value
    repeated. Of each, the least and the greatest value, and of the last one before it; and its own last one.
    """

    whole: Array
    rest: Array
    lows: NDArray[np.float64]
    highs: NDArray[np.float64]
    lasts: NDArray[np.float64]
    width: int


def _parts(values: Array, width: int) -> _Parts:
    lows, highs = _extremes(values, width)
    lasts = np.append(values[width - 1 :: width], values[-1])[: len(lows)]
    # With the last value of the part before, which tells whether the first one of a part changes something.
    lows[1:], highs[1:] = np.minimum(lows[1:], lasts[:-1]), np.maximum(highs[1:], lasts[:-1])
    end = len(values) // width * width
    rest = np.append(values[end:], np.full(width - len(values) + end, values[-1]))
    return _Parts(values[:end].reshape(-1, width), rest, lows, highs, lasts, width)


def _extremes(values: Array, width: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The least and the greatest of each `width` values, NaN where one is; looked at twice, but from the cache."""
    found = np.empty((2, -(-len(values) // width)))
    for start in range(0, len(values), max(PIECE, width)):
        piece = values[start : start + max(PIECE, width)]
        places = np.arange(0, len(piece), width)
        for extreme, into in zip((np.minimum, np.maximum), found, strict=True):
            extreme.reduceat(piece, places, out=into[start // width :][: len(places)])
    return found[0], found[1]


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
    """Comparisons, by `function`, with the small `parts` of a column that has `size` bytes of booleans."""

    function: np.ufunc
    parts: _Parts
    size: int

    def _ranges(self, constants: NDArray[np.float64]) -> tuple[Places, Places]:
        """Of each part, the first of the ascending `constants` that may lie in it, and the one after the last."""
        begins, ends = (
            constants.searchsorted(self.parts.lows, "left"),
            constants.searchsorted(self.parts.highs, "right"),
        )
        is_nan = np.isnan(self.parts.highs)
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
        rows = max(1, AT_ONCE // self.parts.width)
        starts = range(0, len(parts), rows)
        found = [self._changes(parts[n : n + rows], numbers[n : n + rows], constants) for n in starts]
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
        width = self.parts.width // 8
        before = np.empty(len(packed), np.int8)
        np.right_shift(packed[:-1].view(np.int8), 7, out=before[1:])
        before[::width] = -self.function(self.parts.lasts[parts - 1], compared_with[:, 0]).astype(np.int8)
        differs = packed.view(np.int8) != before
        differs[::width] |= parts == 0
        at = np.flatnonzero(differs)
        rows = at // width
        return parts[rows] * width + (at - rows * width), packed[at], numbers[rows]

    def _values(self, numbers: Places) -> NDArray[np.float64]:
        whole, rest = self.parts.whole, self.parts.rest
        if not len(whole):
            return rest[None, :].repeat(len(numbers), axis=0)
        found = whole.take(np.minimum(numbers, len(whole) - 1), axis=0)
        found[numbers == len(whole)] = rest
        return found
