"""Margins along a run: numbers that stay the same from one instant to a later one, and their extremes over windows.

The instants of a run are numbered: its steps, and each nanosecond at which a letter is held. Nothing is made for each,
only for each *piece*, from one instant up to the next at which something changes.

What an operator does at an instant with its value at the next one is a *clamp*, x ↦ max(low, min(high, x)). Clamps are
closed under composition, so that of many is one, and to take it several times at a piece is to take it once.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.monitoring.columns.bits import union
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.robustness import FALSE, TRUE


class Pieces(NamedTuple):
    """A margin from each of the `starts` on, the first of which is 0; and `after`, on no instants."""

    starts: Places
    margins: Array
    after: float = FALSE

    def at(self, instants: Places) -> Array:
        """The margin at each of these instants."""
        if instants is self.starts:
            return self.margins
        found: Array = self.margins[self.starts.searchsorted(instants, "right") - 1]
        return found


def together(*parts: Places) -> Places:
    """Where something starts in any of the `parts`; the same object where all are."""
    return parts[0] if all(part is parts[0] for part in parts) else union(parts)


@dataclass(frozen=True)
class Timeline:
    """The instants of a run with steps at `times`, of which there is one, up to `until`."""

    times: Places
    until: Nanoseconds

    @cached_property
    def steps(self) -> Places:
        """The numbers of the steps."""
        found: Places = np.arange(len(self.times))
        found += self.times
        found -= self.times[0]
        return found

    @cached_property
    def count(self) -> int:
        """How many instants there are."""
        return int(self.until - self.times[0]) + len(self.times)

    def clipped(self, duration: Nanoseconds) -> Nanoseconds:
        """A duration, or a longer one than the run has."""
        return min(duration, int(self.until - self.times[0]) + 1)

    def time(self, instants: Places) -> Places:
        """The times of instants."""
        numbers = (
            np.arange(len(self.times)) if instants is self.steps else self.steps.searchsorted(instants, "right") - 1
        )
        found: Places = instants - numbers + self.times[0]
        return found

    def first_at(self, times: Places) -> Places:
        """The first instant at each of `times` or later; `count` where there is none."""
        before = self.times.searchsorted(times, "left")
        found = np.where(before == 0, 0, before - 1 + times - self.times[0])
        return np.minimum(found, self.count)

    def within(self, starts: Places) -> Places:
        """Those of `starts` that are instants."""
        return starts[starts < self.count]


BLOCK = 1024
"""So many margins are looked at together."""


def least_from(margins: Array) -> Array:
    """The least from each margin on: blocks that have none below what comes after them have that throughout."""
    found, last = np.empty(len(margins)), TRUE
    starts = np.arange(0, len(margins), BLOCK)
    least = np.minimum.reduceat(margins, starts).tolist()
    for start, of_block in zip(starts[::-1].tolist(), reversed(least), strict=True):
        block = slice(start, start + BLOCK)
        if of_block < last:
            np.minimum(np.minimum.accumulate(margins[block][::-1])[::-1], last, out=found[block])
            last = of_block
        else:
            found[block] = last
    return found


class Clamps(NamedTuple):
    """x ↦ max(low, min(high, x)), for each piece."""

    low: Array
    high: Array

    def of(self, inner: Clamps) -> Clamps:
        """These, of what `inner` makes."""
        return Clamps(np.maximum(self.low, np.minimum(self.high, inner.low)), np.minimum(self.high, inner.high))

    def taken(self, places: Places | slice) -> Clamps:
        """Those at `places`."""
        return Clamps(self.low[places], self.high[places])

    def of_value(self, inner: Array | float) -> Array:
        """What they make of a margin."""
        found: Array = np.maximum(self.low, np.minimum(self.high, inner))
        return found


def backwards(clamps: Clamps, last: float) -> Array:
    """For each piece, what all clamps from it on make of `last`, the one at the piece last of all.

    Lanes side by side, then from one lane to the one before, then all of each lane.
    """
    count = len(clamps.low)
    length = max(1, int(count**0.5))
    lanes = -(-count // length)
    low, high = np.full(lanes * length, FALSE), np.full(lanes * length, TRUE)
    low[:count], high[:count] = clamps
    by_place = Clamps(*(np.ascontiguousarray(part.reshape(lanes, length).T) for part in (low, high)))
    for place in range(length - 2, -1, -1):
        by_place.low[place], by_place.high[place] = by_place.taken(place).of(by_place.taken(place + 1))  # type: ignore[arg-type]
    carried = np.empty(lanes)
    for lane in range(lanes - 1, -1, -1):
        carried[lane] = last
        last = max(float(by_place.low[0, lane]), min(float(by_place.high[0, lane]), last))
    found: Array = by_place.of_value(carried).T.reshape(-1)[:count]
    return found


def over_windows(clamps: Clamps, firsts: Places, ends: Places, last: float) -> Array:
    """What the clamps of the pieces from each of `firsts` to before its end make of `last`, that at the first last."""
    found = Clamps(np.full(len(firsts), FALSE), np.full(len(firsts), TRUE))
    at, rest, level = firsts.copy(), ends - firsts, 0
    while rest.any():
        has = np.flatnonzero(rest & 1)
        if len(has):
            found.low[has], found.high[has] = found.taken(has).of(clamps.taken(at[has]))
            at[has] += 1 << level
        rest >>= 1
        half = 1 << level
        clamps = clamps.taken(slice(None, -half)).of(clamps.taken(slice(half, None)))
        level += 1
    return found.of_value(last)


def least_of_windows(margins: Array, firsts: Places, ends: Places) -> Array:
    """The least of the margins of the pieces from each of `firsts` to before its end, infinite where there is none.

    Of two halves that overlap, each a power of two long.
    """
    found = np.full(len(firsts), TRUE)
    levels = np.frexp((ends - firsts).astype(np.float64))[1] - 1
    for level in range(int(levels.max(initial=-1)) + 1):
        at = np.flatnonzero(levels == level)
        if len(at):
            found[at] = np.minimum(margins.take(firsts.take(at)), margins.take(ends.take(at) - (1 << level)))
        margins = np.minimum(margins[: -(1 << level)], margins[1 << level :])
    return found
