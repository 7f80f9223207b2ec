"""Stepping a track where something can change, and repeating it where nothing does.

For properties with clocks, for those without a table, and for those that leave a trail. A step that leaves the state of
a monitor as it was, and which of its clocks are late, would leave it so again, with the same letter, until a clock
comes due; it would but start the same clocks anew. So of a stretch with one letter, what is taken are the first steps,
up to such a one, and then the last one before each time at which a clock comes due.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from ltlc.columns.bits import unpack
from ltlc.columns.series import Steps
from ltlc.columns.tracks import Stretch, values_at
from ltlc.runtime.sampling import New
from ltlc.runtime.times import NEVER
from ltlc.runtime.tracking import Track


def hear(track: Track, steps: Steps) -> None:
    """Messages come before the first of `steps`: if there was none before, ages count from the last of them."""
    if track.steps or not track.property.timed:
        return
    limit = steps.row(0) if len(steps) else steps.columns.count
    for wanted in track.property.inputs:
        if isinstance(wanted, New):
            last = steps.columns.last_heard(wanted.signal, limit)
            if last is not None:
                track.hear(int(steps.columns.times[last]), {wanted.signal})


class Walk:
    """Takes the steps of `found`, one part after the other."""

    def __init__(self, track: Track, found: Stretch) -> None:
        self.times = found.steps.times if found.numbers is None else found.steps.times[found.numbers]
        self._track = track
        self._found = found
        self._changes = _changes(found)
        self._end = track.steps + len(found)

    def take(self, first: int, end: int) -> None:
        """Take the steps from the `first` to before the `end`, unless one decides the property."""
        inside = self._changes[bisect_right(self._changes, first) : bisect_left(self._changes, end)]
        for start, stop in pairwise([first, *inside, end]):
            self._take_alike(start, stop)

    def _take_alike(self, step: int, end: int) -> None:
        """Take steps that have the same letter."""
        track, times = self._track, self.times
        while step < end and track.decided_at is None:
            time = int(times[step])
            track.hold(time)
            before = _view(track, time)
            track.step(time, values_at(track, self._found.steps, self._found.number(step)))
            step += 1
            if before == _view(track, time) and track.decided_at is None:
                due = _due(track)
                last = end if due >= NEVER else int(times[step:end].searchsorted(due)) + step - 1
                track.repeat(max(0, last - step), ())
                step = max(step, last)

    def finish(self) -> None:
        """All steps are taken, or one decided the property."""
        track, count = self._track, len(self._found)
        track.steps = self._end
        if count and track.decided_at is None:
            track.judged_on = values_at(track, self._found.steps, self._found.number(count - 1))


def walk(track: Track, found: Stretch) -> None:
    """Take the steps of `found`."""
    steps = Walk(track, found)
    steps.take(0, len(found))
    steps.finish()


def _changes(found: Stretch) -> list[int]:
    """The steps whose letter is not that of the step before, and the first one."""
    if not len(found):
        return []
    changes = np.zeros(len(found), np.bool_)
    changes[0] = True
    for bits in found.atoms:
        mask = unpack(bits, len(found))
        changes[1:] |= mask[1:] != mask[:-1]
    numbers: list[int] = np.flatnonzero(changes).tolist()
    return numbers


def _view(track: Track, time: int) -> list[Any]:
    """What decides what a step does with a letter: states, and which clocks are late at `time`."""
    return [
        (one.state, one.verdict, [due < time for name, due in vars(one).items() if name.startswith("due")])
        for one in _machines(track)
    ]


def _machines(track: Track) -> Iterator[Any]:
    """The monitor, and what watches for events that the past decides."""
    yield track.monitor
    yield from track.watchers.machines


def _due(track: Track) -> int:
    """When the next clock step comes, unless a step comes first."""
    return min(track.due, track.watchers.due())
