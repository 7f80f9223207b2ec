"""Stepping a track where something can change, and repeating it where nothing does.

For properties with clocks, for those without a table, and for those that leave a trail. A step that leaves the state of
a monitor as it was, and which of its clocks are late, would leave it so again, with the same letter, until a clock
comes due; it would but start the same clocks anew. So of a stretch with one letter, what is taken are the first steps,
up to such a one, and then the last one before each time at which a clock comes due.
"""

from __future__ import annotations

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


def walk(track: Track, found: Stretch) -> None:
    """Take the steps of `found`."""
    base, count, steps = track.steps, len(found), found.steps
    times = steps.times if found.numbers is None else steps.times[found.numbers]
    for start, end in pairwise([*_changes(found), count]):
        step = start
        while step < end and track.decided_at is None:
            time = int(times[step])
            track.hold(time)
            before = _view(track, time)
            track.step(time, values_at(track, steps, found.number(step)))
            step += 1
            if before == _view(track, time) and track.decided_at is None:
                due = _due(track)
                last = end if due >= NEVER else int(times[step:end].searchsorted(due)) + step - 1
                track.repeat(max(0, last - step), ())
                step = max(step, last)
        if track.decided_at is not None:
            break
    track.steps = base + count
    if count and track.decided_at is None:
        track.judged_on = values_at(track, steps, found.number(count - 1))


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
