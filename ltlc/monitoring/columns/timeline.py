"""Margins along a run: numbers that stay the same from one instant to a later one.

The instants of a run are numbered: its steps, and each nanosecond at which a letter is held. Nothing is made for each,
only for each *piece*, from one instant up to the next at which something changes.
"""

from __future__ import annotations

from functools import cached_property, reduce
from typing import NamedTuple

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.monitoring.columns.bits import union
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.robustness import FALSE

SEARCHED = 1 << 13
"""So many times are searched for together."""


class Pieces(NamedTuple):
    """A margin from each of the `starts` on, the first of which is 0; and `after`, on no instants."""

    starts: Places
    margins: Array
    after: float = FALSE

    def at(self, instants: Places) -> Array:
        """The margin at each of these instants."""
        return self.margins if instants is self.starts else self.margins[pieces_at(self.starts, instants)]


def pieces_at(starts: Places, instants: Places) -> Places:
    """Which piece each of `instants` is in."""
    if instants is starts:
        return np.arange(len(starts))
    found: Places = starts.searchsorted(instants, "right") - 1
    return found


def together(*parts: Places) -> Places:
    """Where something starts in any of the `parts`; the same object where all are."""
    return parts[0] if all(part is parts[0] for part in parts) else union(parts)


def negated(pieces: Pieces, is_new: bool = False) -> Pieces:
    """By how much it does not hold; where it `is_new`, and nothing else refers to it, in place."""
    margins = np.negative(pieces.margins, out=pieces.margins if is_new else None)
    return Pieces(pieces.starts, margins, -pieces.after)


def least(*parts: Pieces) -> Pieces:
    """By how much all hold."""
    starts = together(*(part.starts for part in parts))
    return Pieces(starts, reduce(np.minimum, [part.at(starts) for part in parts]), min(part.after for part in parts))


def greatest(*parts: Pieces) -> Pieces:
    """By how much one holds."""
    starts = together(*(part.starts for part in parts))
    return Pieces(starts, reduce(np.maximum, [part.at(starts) for part in parts]), max(part.after for part in parts))


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
        if instants is self.steps:
            return self.times
        found: Places = instants - pieces_at(self.steps, instants) + self.times[0]
        return found

    def first_at(self, times: Places) -> Places:
        """The first instant at each of `times` or later; `count` where there is none."""
        before = self.times.searchsorted(times, "left")
        found = np.where(before == 0, 0, before - 1 + times - self.times[0])
        return np.minimum(found, self.count)

    def within(self, starts: Places) -> Places:
        """Those of `starts` that are instants."""
        return starts[starts < self.count]

    def reaching(self, times: Places, duration: Nanoseconds) -> Places:
        """From which instants on a window of `duration` reaches one of `times`."""
        return self.within(self.first_at(times - duration))


class StepsAlone(Timeline):
    """The same run as if time did not pass between its steps: these are its instants."""

    @cached_property
    def steps(self) -> Places:
        """The numbers of the steps."""
        return np.arange(len(self.times))

    @cached_property
    def count(self) -> int:
        """How many steps there are."""
        return len(self.times)

    def time(self, instants: Places) -> Places:
        """The times of steps."""
        return self.times if instants is self.steps else self.times[instants]

    def reaching(self, times: Places, duration: Nanoseconds) -> Places:
        """A window is looked at from every step."""
        return self.steps


def ends_at(times: Places, until: Places) -> Places:
    """How many of `times` are not after each of `until`, both in order: mostly one more from one to the next."""
    found = np.empty(len(until), np.int64)
    for start in range(0, len(until), SEARCHED):
        asked = until[start : start + SEARCHED]
        first, last = times.searchsorted(asked[[0, -1]], "right").tolist()
        is_even = first > 0 and last - first == len(asked) - 1 and last < len(times)
        if is_even and (times[first - 1 : last] <= asked).all() and (asked < times[first : last + 1]).all():
            found[start : start + SEARCHED] = np.arange(first, last + 1)
        elif first == last:
            found[start : start + SEARCHED] = first
        else:
            found[start : start + SEARCHED] = times[first:last].searchsorted(asked, "right") + first
    return found
