"""Taking a track with clocks forward by many steps at once, as long as none of its clocks comes due.

As long as none does, letters alone say which states a monitor goes through, and where it sets its clocks: tables say
that for many steps, as without clocks. Then the time at which each clock is due is compared with that at which it is
set anew. Where one comes due before, and around that, steps are taken one after the other.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from ltlc.inputs.recordings.blocks import Places
from ltlc.monitoring.columns.follow import run_clocks
from ltlc.monitoring.columns.groups import Settings
from ltlc.monitoring.columns.machine import Setting
from ltlc.monitoring.columns.tracks import Forward, Stretch
from ltlc.monitoring.columns.walk import Changes, Walk
from ltlc.runtime.times import NEVER

FEWEST = 8
"""So many steps are taken one after the other after each leap, twice as many after each that spared little."""

LITTLE = 16
"""A leap takes as long as so many steps of a monitor, which takes one where a letter changes, or a clock starts."""

FURTHER = 8
"""So many times as far the next leap tries to go; after one that a clock cut short, as far as that went."""


def walk_and_leap(forward: Forward, found: Stretch) -> None:
    """Take the steps of `found`."""
    changes, count, step, wait, far = Changes(found), len(found), 0, FEWEST, len(found)
    walk = Walk(forward.track, found, changes)
    while step < count and forward.track.decided_at is None:
        end = min(count, (step + wait) // 8 * 8)
        walk.take(step, end)
        last = min(count - 1, end + far, *(each.until(end) for each in found.counts))
        step = _leap(forward, found, end, last // 8 * 8)
        spared = step - end if forward.tables.machine.restarts else changes.between(end, step)
        wait = FEWEST if spared > LITTLE else 2 * wait
        far = FURTHER * max(FEWEST, step - end)
    walk.finish()


def _leap(forward: Forward, found: Stretch, first: int, end: int) -> int:
    """Take steps from the `first` on, and none after the `end`, which is one of them; the step that comes then."""
    if end <= first or not forward.can_leap:
        return first
    part, times, monitor = found.part(first, end), found.times[first : end + 1], forward.track.monitor
    passed, settings = run_clocks(forward.tables, part.atoms, end - first, forward.state())
    machine, names = forward.tables.machine, forward.of.clocks
    before = [getattr(monitor, name) for name in names]
    dues = [_dues(times, *each) for each in zip(machine.clocks, before, settings, strict=True)]
    nexts = [np.append(times[steps], times[passed.steps]) for _, steps, _ in settings]
    reached = min([passed.steps, *map(partial(_before_due, times), dues, nexts)])
    if reached < passed.steps:
        return _leap(forward, found, first, first + reached // 8 * 8)
    forward.restore(passed, part)
    for name, due in zip(names, dues, strict=True):
        setattr(monitor, name, int(due[-1]))
    at = [each.put(monitor, first + reached - 1) for each in found.counts]
    if forward.of.states[monitor.state].expire is None:
        monitor.due = NEVER
    else:
        monitor.due = min([*at, *(int(due[-1]) for due in dues)], default=NEVER)
    return first + reached


def _dues(times: Places, clock: Setting, before: int, settings: Settings) -> Places:
    """When a clock is due that was due `before`, and after each of its settings, at steps at `times`."""
    _, steps, starts = settings
    return np.concatenate(([before], np.where(starts, times[steps] + clock.duration, NEVER)))


def _before_due(times: Places, dues: Places, nexts: Places) -> int:
    """How many steps come before the last one at which a clock is not past one of its `dues`, which hold until `nexts`.

    That one is left for the monitor itself, which may keep its values for when the clock comes due.
    """
    late = np.flatnonzero(dues < nexts)
    return max(0, int(times.searchsorted(dues[late[0]], "right")) - 1) if len(late) else len(times)
