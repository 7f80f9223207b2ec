"""A step together with the clock steps before the next one: a letter has the *pause*, which says what comes then.

Where the end of news, a nanosecond after a step, changes something, steps alone say little. What is too much for a
letter, such as two clocks that come due in one pause, is left to the monitor.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.monitoring.columns.bits import Mask
from ltlc.monitoring.columns.control import Control, Letters
from ltlc.program.machine import Base
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.monitor import below
from ltlc.semantics.verdicts import Verdict

PASSES, STILL, FIRST_LATE = range(3)
"""Pauses: time passes before the next step, none does, and, from here on, a clock comes due in that time."""

MOST_DURATION = 1 << 60
"""Of a clock, in ns: a time and that are still an integer of 64 bits."""


@dataclass(frozen=True, slots=True)
class Setting:
    """Where a clock is set, to be due a `duration` in ns after the step, and where it is stopped.

    It comes due in the `pause`; None for an age: while it is late, there is more to steps than a machine has.
    """

    starts: Mask
    stops: Mask
    duration: int
    pause: int | None = None


@dataclass(frozen=True)
class Rows:
    """By state and letter, the state after a step and its pause, and where clocks are set.

    Some are `left` to the monitor. Where it `settles`, a clock step that comes by itself changes nothing.
    """

    states: Letters
    clocks: tuple[Setting, ...]
    left: Mask
    settles: Mask


def pauses_of(control: Control) -> int:
    """How many pauses there are."""
    return FIRST_LATE + control.clocks.count(None)


def rows_of(control: Control, holds: Mapping[str, Mask], held: Mapping[str, Mask], pause: Letters) -> Rows | None:
    """What comes of steps at letters in which atoms are as in `holds`, then as in `held`, and that have a `pause`.

    None if a clock is set in several ways.
    """
    durations = [_duration(control, clock) for clock in range(len(control.clocks))]
    return None if None in durations else _Composed(control, holds, held, pause).rows([each or 0 for each in durations])


def _duration(control: Control, clock: int) -> Nanoseconds | None:
    """How long after it is set a clock is due; None if there are several such times."""
    sets = [each for outcome in control.outcomes for each in outcome.sets if each.clock == clock]
    durations = {each.duration for each in sets if each.base is not Base.NEVER}
    has_several = len(durations) > 1 or any(each.base is Base.DUE for each in sets)
    return None if has_several or max(durations, default=0) > MOST_DURATION else max(durations, default=0)


class _Sets(NamedTuple):
    """By outcome, whether it sets a clock to count from this instant, or from just before it, or stops it."""

    now: Mask
    before: Mask
    stops: Mask


class _Composed:
    """By state and letter, a step, the clock step that then comes by itself, and that of a clock that comes due."""

    def __init__(self, control: Control, holds: Mapping[str, Mask], held: Mapping[str, Mask], pause: Letters) -> None:
        self._control, self._holds, self._held, self._pause = control, holds, held, pause
        self._state = np.array([outcome.state for outcome in control.outcomes])
        self._again = np.array([outcome.again for outcome in control.outcomes])
        self._count = np.array([len(outcome.sets) for outcome in control.outcomes])
        self._is_owed = np.array([state.verdict is Verdict.PRESUMABLY_VIOLATED for state in control.states])
        self._is_final = np.array([state.verdict.is_permanent for state in control.states])
        self._goes_on = ~self._is_final & np.array([state.expire is not None for state in control.states])
        self._step = control.outcomes_of([state.step for state in control.states], holds)
        self._between = self._state[self._step]
        self._next = self._clock_step(self._between, None)
        self._moves = self._again[self._step] & self._goes_on[self._between] & (pause != STILL)
        self._after = np.where(self._moves, self._state[self._next], self._between)

    def _clock_step(self, states: Letters, late: int | None) -> Letters:
        """The outcomes of clock steps from these `states`, if no clock is late but that one."""
        expire = [state.expire or 0 for state in self._control.states]  # where there is none, it is not looked at
        return self._control.outcomes_of(expire, self._held, late)[states, np.arange(states.shape[1])]

    def _owes(self, before: Letters, after: Letters) -> Mask:
        """Where a clock step opens an obligation, the time of which is not that of a step."""
        found: Mask = self._is_owed[after] & ~self._is_owed[before]
        return found

    def rows(self, durations: Sequence[Nanoseconds]) -> Rows:
        """All of this, of clocks with these `durations`."""
        changes = self._again[self._next] | (self._count[self._next] > 0) | (self._after != self._between)
        left = self._moves & (self._again[self._next] | self._owes(self._between, self._after))
        states, clocks, code = self._after, [], FIRST_LATE
        for clock, kind in enumerate(self._control.clocks):
            if isinstance(kind, tuple):
                heard = np.broadcast_to(self._holds[kind[0]], states.shape)
                clocks.append(Setting(heard, np.zeros_like(heard), kind[1]))
            elif kind is None:
                sets = _Sets(*(self._control.sets(clock, base) for base in (Base.NOW, Base.JUST_BEFORE, Base.NEVER)))
                runs = self._runs(sets)[:, None]
                starts, stops = self._settings(sets)
                clocks.append(Setting(starts, stops, durations[clock], code))
                late, may_run = self._clock_step(self._after, clock), starts | (runs & ~stops)
                is_late = (self._pause == code) & may_run & ~self._is_final[self._after]
                states = np.where(is_late & self._goes_on[self._after], self._state[late], states)
                left |= self._left(clock, sets, late, is_late, runs)
                code += 1
        return Rows(states, tuple(clocks), left, ~(self._moves & changes))

    def _settings(self, sets: _Sets) -> tuple[Mask, Mask]:
        """Where a clock starts and where it stops, before it may come due."""
        starts_next, stops_next = self._moves & sets.before[self._next], self._moves & sets.stops[self._next]
        starts, stops = sets.now[self._step] & ~stops_next, sets.stops[self._step] & ~starts_next
        return starts | starts_next, stops | stops_next

    def _left(self, clock: int, sets: _Sets, late: Letters, is_late: Mask, runs: Mask) -> Mask:
        """Where there is more to a clock, which leads to `late` where it `is_late`, and `runs` in some states."""
        now, before, stops = sets
        left: Mask = before[self._step] | (self._moves & now[self._next])  # due a nanosecond earlier, or later
        is_over = self._goes_on[self._after] & stops[late] & ~self._again[late] & (self._count[late] == 1)
        left |= is_late & (~is_over | self._owes(self._after, self._state[late]))
        # One that is due at the very time of the step is late when news is over.
        is_set, is_set_next = (now | stops)[self._step], (before | stops)[self._next]
        differs = (self._clock_step(self._between, clock) != late) | (self._count[self._next] > 0)
        left |= self._moves & runs & ~is_set & (is_set_next | (is_late & differs))
        return left

    def _runs(self, sets: _Sets) -> Mask:
        """In which states a clock may run, or be late."""
        of, runs = self._control, np.zeros(len(self._control.states), np.bool_)
        targets = [[state.step, *([] if state.expire is None else [state.expire])] for state in of.states]
        ways = [np.array([each for each in below(of.decisions, some) if each >= 0]) for some in targets]
        before, starts = None, sets.now | sets.before
        while before is None or (runs != before).any():
            before = runs.copy()
            for state, outcomes in enumerate(ways):
                runs[self._state[outcomes[starts[outcomes] | (before[state] & ~sets.stops[outcomes])]]] = True
        return runs
