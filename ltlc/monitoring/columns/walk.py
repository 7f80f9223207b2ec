"""Stepping a track where something can change, and repeating it where nothing does.

For properties with clocks, for those without a table, and for those that leave a trail. A step that leaves the state of
a monitor as it was, and which of its clocks are late, would leave it so again, with the same letter, until a clock
comes due; it would but start the same clocks anew. So of a stretch with one letter, what is taken are the first steps,
up to such a one, and then the last one before each time at which a clock comes due; where values are taken at openings,
the last one of the stretch, too, since it may take them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ltlc.monitoring.columns.bits import unpack
from ltlc.monitoring.columns.kept import KeptLetters
from ltlc.monitoring.columns.series import Steps
from ltlc.monitoring.columns.tracks import Stretch, has_ages, values_at
from ltlc.runtime.courses import Course
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
    """Takes the steps of `found`, whose letters have these `changes`.

    Where letters depend on what was taken at openings, that is invalid ones, too.
    """

    def __init__(self, track: Course, found: Stretch, changes: Changes | KeptLetters) -> None:
        self._track = track
        self._found = found
        self._changes = changes
        self._end = track.steps + len(found)
        self._has_ages = has_ages(track)

    def take(self, step: int, end: int) -> None:
        """Take the steps from this one to before the `end`, unless one decides the property."""
        track, times, keeps = self._track, self._found.times, self._found.kept is not None
        while step < end and (track.decided_at is None or keeps):
            time, values = int(times[step]), values_at(track, self._found.steps, self._found.number(step))
            track.hold(time)
            if track.decided_at is not None and not keeps:
                return
            is_heard = self._hear(time, values)
            before = _view(track, time)
            track.step(time, values)
            if track.is_renewed:
                track.renew(time)
            step += 1
            if not is_heard and before == _view(track, time):
                last, due = min(end, self._changes.after(step - 1)), _due(track)
                if due < NEVER or keeps:
                    last = max(step, step + int(times[step:last].searchsorted(due)) - 1)
                track.repeat(last - step, ())
                step = last

    def _hear(self, time: int, values: Sequence[object]) -> bool:
        """Ages count from the messages of a step; whether there are any, which move deadlines that a trail has."""
        if not self._has_ages:
            return False
        inputs = zip(self._track.property.inputs, values, strict=True)
        heard = {wanted.signal for wanted, came in inputs if came and isinstance(wanted, New)}
        self._track.hear(time, heard)
        return bool(heard)

    def finish(self) -> None:
        """All steps are taken, or one decided the property."""
        track, count = self._track, len(self._found)
        if self._found.kept is not None:
            return
        track.steps = self._end
        if count and track.decided_at is None:
            track.judged_on = values_at(track, self._found.steps, self._found.number(count - 1))


def walk(track: Track, found: Stretch) -> None:
    """Take the steps of `found`."""
    steps = Walk(track, found, found.kept or Changes(found))
    steps.take(0, len(found))
    steps.finish()


class Changes:
    """Where the letter is not that of the step before, or something occurs that is counted."""

    def __init__(self, found: Stretch) -> None:
        self._count = len(found)
        differs = np.zeros(len(found), np.bool_)
        for bits in found.atoms:
            mask = unpack(bits, len(found))
            differs[1:] |= mask[1:] != mask[:-1]
        for count in found.counts:
            differs |= count.moves
        self._places = np.flatnonzero(differs)

    def after(self, step: int) -> int:
        """The first such step after this one; if there is none, how many there are."""
        number = int(self._places.searchsorted(step, "right"))
        return int(self._places[number]) if number < len(self._places) else self._count

    def between(self, first: int, end: int) -> int:
        """How many such steps there are after the `first` and before the `end`."""
        after, before = self._places.searchsorted((first + 1, end))
        return max(0, int(before - after))


def _view(track: Course, time: int) -> list[Any]:
    """What decides what a step does with a letter: states, and which clocks are late at `time`."""
    return [
        (one.state, one.verdict, [getattr(one, name) < time for name in one.__slots__ if name.startswith("due")])
        for one in _machines(track)
    ]


def _machines(track: Course) -> Iterator[Any]:
    """The monitor, and what watches for events that the past decides."""
    yield track.monitor
    yield from track.watchers.machines


def _due(track: Course) -> int:
    """When the next clock step comes, unless a step comes first."""
    return min(track.due, track.watchers.due())
