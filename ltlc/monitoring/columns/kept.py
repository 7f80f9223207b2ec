"""Letters of a property that reads values at openings: they depend on where its scopes opened, and so on its state."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain

import numpy as np

from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.monitoring.columns.arrays import ByStep, held_for
from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.series import Given, Steps, UnsupportedError
from ltlc.monitoring.columns.values import arrays_at, not_numbers, value
from ltlc.monitoring.later import Later
from ltlc.program.expressions import Expression, Held
from ltlc.runtime.courses import Course
from ltlc.runtime.sampling import Value
from ltlc.specification.wire import EXACT

FIRST = 64
"""So many steps are looked ahead at first, and then four times as many each time."""

Taken = tuple[Value | None, ...]
"""For each value at an opening, what was taken; None where its scope is not open, and it is the latest value."""


Inputs = Mapping[Expression, Array | ByStep]
"""What a property reads at each of its steps."""


def inputs_at(of: Prepared, steps: Steps) -> Inputs:
    """What a property reads at `steps`. Raises UnsupportedError."""
    return {
        read: arrays_at(read, steps) if read.type.is_array else np.asarray(value(read, steps)) for read in of.inputs
    }


def with_taken(of: Prepared, steps: Steps, inputs: Inputs, part: slice, taken: Taken) -> Given:
    """A part of `steps`, at which `inputs` are read, as long as the same values are `taken`."""
    known = {read: column[part] for read, column in inputs.items()}
    for opening, each in zip(of.openings, taken, strict=True):
        latest = known[Held(opening.signal, 0, opening.type)]
        known[opening] = latest if each is None else _repeated(each, latest)
    return Given(steps.columns, steps.base, steps.first, known, count=part.stop - part.start)


class KeptLetters:
    """Where the letter of a property is not that of the step before, as long as no other values are taken."""

    def __init__(self, track: Course, of: Prepared, steps: Steps) -> None:
        """Raises UnsupportedError."""
        self._track, self._of, self._count = track, of, len(steps)
        self._steps = steps
        self._inputs = inputs_at(of, steps)
        taken = [getattr(track.monitor, kept.attribute, None) for kept in track.property.kept]
        numbers = chain.from_iterable(each if isinstance(each, tuple) else (each,) for each in taken)
        if any(isinstance(each, int) and abs(each) > EXACT for each in numbers):
            raise UnsupportedError("integers that are not doubles")
        self._latest = self._compared(0, self._count, (None,) * len(of.openings))
        self._changes = self._latest[:0]
        self._for, self._until = "", 0

    def after(self, step: int) -> int:
        """The first step after this one that is invalid, or has another letter; otherwise the number of steps."""
        taken = self._taken()
        if taken == (None,) * len(taken):
            return _next(self._latest, step, self._count)
        now = repr((taken, self._track.decided_at is None))
        if now != self._for:
            self._for, self._until = now, 0
        if step >= self._until:
            self._changes, self._until = self._latest[:0], step + 1
        size = FIRST
        while (found := _next(self._changes, step, self._until)) == self._until < self._count:
            end = min(self._count, self._until + size)
            self._changes, self._until = self._compared(self._until, end, taken), end
            size *= 4
        return found

    def _taken(self) -> Taken:
        if isinstance(self._track, Later) and self._track.is_out:
            return (None,) * len(self._of.openings)
        monitor, kept = self._track.monitor, self._track.property.kept
        return tuple(
            None if monitor.state in latest else getattr(monitor, each.attribute)
            for latest, each in zip(self._of.openings.values(), kept, strict=True)
        )

    def _compared(self, first: int, end: int, taken: Taken) -> Places:
        """Which steps from `first` to before `end` are none, or have another letter than the one before.

        Once the verdict is permanent, letters do not matter.
        """
        start = max(first - 1, 0)
        given = with_taken(self._of, self._steps, self._inputs, slice(start, end), taken)
        differs = np.zeros(end - start, np.bool_)
        for atom in self._of.atoms if self._track.decided_at is None else ():
            mask = np.broadcast_to(value(atom.holds, given), end - start)
            differs[1:] |= mask[1:] != mask[:-1]
        undefined = not_numbers(self._of.guards, given)
        if undefined is not None:
            differs |= undefined
            differs[1:] |= undefined[:-1]
        return start + np.flatnonzero(differs[first - start :]) + first - start


def _repeated(taken: Value, like: Array | ByStep) -> Array | ByStep:
    """What was `taken`, as often as there are values in `like`."""
    if isinstance(like, ByStep):
        return held_for(taken, len(like))
    return np.full(len(like), taken, like.dtype)


def _next(places: Places, step: int, end: int) -> int:
    """The first of `places` after the `step`; `end` if there is none."""
    number = int(places.searchsorted(step, "right"))
    return int(places[number]) if number < len(places) else end
