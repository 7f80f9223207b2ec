"""Taking a track with clocks forward by many steps at once.

As long as no clock comes due, letters alone say which states a monitor goes through, and where it sets its clocks:
tables say that for many steps, as without clocks. Then the time at which each clock is due is compared with that at
which it is set anew. Around one that comes due before, steps are taken one after the other.

Where letters have pauses, a leap goes on beyond that: in which pauses a clock comes due is guessed, and guessed again
by what would come of it, until that agrees. Since it depends on what came before only, each guess is right for longer
than the last one; mostly the first is for all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Places
from ltlc.monitoring.columns.bits import Bits, pack
from ltlc.monitoring.columns.follow import run_clocks
from ltlc.monitoring.columns.groups import Passed, Settings
from ltlc.monitoring.columns.pauses import PASSES, STILL, Setting
from ltlc.monitoring.columns.tables import Tables
from ltlc.monitoring.columns.tracks import Forward, Stretch
from ltlc.monitoring.columns.walk import Changes, Walk
from ltlc.runtime.times import NEVER

FEWEST = 8
"""So many steps are taken one after the other after each leap, twice as many after each that spared little."""

LITTLE = 16
"""A leap takes as long as so many steps of a monitor, which takes one where a letter changes, or a clock starts."""

FURTHER = 8
"""So many times as far the next leap tries to go; after one that a clock cut short, as far as that went."""

GUESSES = 8
"""So many guesses are tried."""


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
    if end <= first:
        return first
    forward.track.hold(int(found.times[first]))
    if not forward.can_leap:
        return first
    part, times, tables = found.part(first, end), found.times[first : end + 1], forward.tables
    if tables.machine.pause:
        passed, clocks, right = _guess(forward, part, times)
    else:
        passed, clocks = _run(forward, tables, part, times, ())
        right = min([passed.steps, *(step for clock in clocks for step in clock.steps[:1].tolist())])
    if right < passed.steps and tables.pausing is not None:
        return _leap(replace(forward, tables=tables.pausing), found, first, end)
    if right < passed.steps:
        return _leap(forward, found, first, first + right // 8 * 8)
    forward.restore(passed, part)
    last = first + passed.steps - 1
    _set_clocks(forward, clocks, [each.put(forward.track.monitor, last) for each in found.counts])
    return last + 1


@dataclass(frozen=True, slots=True)
class _Clock:
    """When a clock was due before some steps, and after each of its settings.

    It came due at those of the `dues` with the numbers `over`, in the pauses after these `steps`.
    """

    dues: Places
    over: Places
    steps: Places

    @property
    def due(self) -> int:
        """When it is due after all."""
        is_over = len(self.over) > 0 and self.over[-1] == len(self.dues) - 1
        return NEVER if is_over else int(self.dues[-1])


def _guess(forward: Forward, part: Stretch, times: Places) -> tuple[Passed, list[_Clock], int]:
    """Take the steps of `part`, the pauses after which are guessed; so many of them are right."""
    machine, tables = forward.tables.machine, forward.tables
    still = np.where(times[1:] == times[:-1], np.uint8(STILL), np.uint8(PASSES))
    pauses = still.copy()
    for guess in (tables.lasting, *[tables] * GUESSES):
        bits = [pack((pauses >> bit & 1).view(np.bool_)) for bit in range(machine.pause)]
        passed, clocks = _run(forward, guess, part, times, bits)
        now, right = still[: passed.steps].copy(), passed.steps
        for clock, setting in zip(clocks, machine.clocks, strict=True):
            # What is no letter: an age that comes due, or two clocks in one pause.
            unknown = clock.steps if setting.pause is None else clock.steps[now[clock.steps] != PASSES]
            right = min([right, *unknown[:1].tolist()])
            now[clock.steps] = PASSES if setting.pause is None else setting.pause
        wrong = np.flatnonzero(now[:right] != pauses[:right])
        if guess is tables and not len(wrong):
            return passed, clocks, right
        pauses[: passed.steps] = now
    return passed, clocks, int(wrong[0])


def _run(
    forward: Forward, tables: Tables, part: Stretch, times: Places, pauses: Sequence[Bits]
) -> tuple[Passed, list[_Clock]]:
    """Take the steps of `part` by some tables, with the letters of these `pauses`; and what its clocks did."""
    passed, settings = run_clocks(tables, (*part.atoms, *pauses), len(part), forward.state())
    before = (getattr(forward.track.monitor, name) for name in forward.of.clocks)
    each = zip(tables.machine.clocks, before, settings, strict=True)
    return passed, [_clock(times[: passed.steps + 1], *of) for of in each]


def _clock(times: Places, setting: Setting, before: int, settings: Settings) -> _Clock:
    """What a clock did that was due `before`, at steps at `times`, of which the last one comes after them."""
    _, steps, starts = settings
    dues = np.concatenate(([before], np.where(starts, times[steps] + setting.duration, NEVER)))
    over = np.flatnonzero(dues < np.append(times[steps], times[-1]))
    return _Clock(dues, over, np.maximum(times.searchsorted(dues[over], "right") - 1, 0))


def _set_clocks(forward: Forward, clocks: Sequence[_Clock], counts: Sequence[int]) -> None:
    """Have the monitor as after steps, with its clocks due then; those that count are due at `counts`."""
    monitor, of = forward.track.monitor, forward.of
    for name, clock in zip(of.clocks, clocks, strict=True):
        setattr(monitor, name, clock.due)
    goes_on = of.states[monitor.state].expire is not None
    monitor.due = min([*counts, *(clock.due for clock in clocks)], default=NEVER) if goes_on else NEVER
    over = zip(of.clocks, clocks, strict=True)
    forward.track.lapse({name: int(clock.dues[clock.over[-1]]) for name, clock in over if len(clock.over)})
