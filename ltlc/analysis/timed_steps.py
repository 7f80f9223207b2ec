"""Steps of a run as z3 sees them, with times: what the atoms of time and of the past are, by the trackers' definition.

Nothing here knows the reset machine: clocks are numbers, and a run that repeats forever takes time each time. So what
the automata say has no run must have none here, and what is found here are runs with times.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import z3  # noqa: TID251

from ltlc.analysis.errors import DisagreementError
from ltlc.semantics.instants import Instant
from ltlc.semantics.ltl import Formula
from ltlc.semantics.timed_atoms import Occurred, Previously, TimedAtom, atoms_within, news_of
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import Case, Phase, Scope, State, Tracker, scopes_around, trackers_of
from ltlc.semantics.words import Letter

SECOND = 10**9

Term = Any
"""A term of z3's."""

Truth = Callable[[Formula], Sequence[Term]]
"""The truth of a state predicate at each step."""

Step = Mapping[str, Term]
"""Whether each atom holds."""


class TimedSteps:
    """Constrains `steps`, with the loop that leads `back` to one of them, to those of a run in time.

    `times` are those of the steps, in nanoseconds from the first, `round` is what the loop takes.
    """

    def __init__(self, formula: Formula, steps: Sequence[Step], back: Sequence[Term], truth: Truth) -> None:
        self.steps = steps
        self.back = back
        self._truth = truth
        self._pulses = news_of(formula)
        self._news = [atom.name for atom in self._pulses]
        free = (atom for atom in atoms_within(formula) if isinstance(atom, Occurred) or not isinstance(atom, TimedAtom))
        self._signals = [atom.name for atom in free]
        self._trackers = trackers_of(formula)
        self._around = scopes_around(self._trackers)
        self.times = [z3.IntVal(0), *(z3.Int(f"time@{step}") for step in range(1, len(steps)))]
        self.round = z3.Int("round")
        self.held = [z3.BoolVal(False), *(z3.Bool(f"held@{step}") for step in range(1, len(steps)))]
        self._session = z3.Int("session")
        self._round_times = z3.Bool("round times")
        self.preferences = ((self._round_times, z3.Not(z3.Or(self.held))), (self._round_times,))

    def constraints(self) -> Iterator[Term]:
        """All of them."""
        yield z3.Implies(self._round_times, z3.And(*self._round()))
        yield self._session <= 0
        yield self.round > 0
        for step in range(1, len(self.steps)):
            yield from self._goes_on(step - 1, step, self.times[step])
        for step, back in enumerate(self.back):
            again = self._goes_on(len(self.steps) - 1, step, self.times[step] + self.round)
            yield z3.Implies(back, z3.And(*again))
        scopes: list[list[dict[Scope, Term]]] = []
        for k, tracker in enumerate(self._trackers):
            outer = self._around[k]
            around = self._whole_run() if outer is None else scopes[outer]
            timed = _TimedTracker(self, k, tracker, around)
            yield from timed.constraints()
            scopes.append(timed.scopes)

    def _round(self) -> Iterator[Term]:
        """Steps come at whole multiples of half of the smallest bound, and the session begins with the first."""
        bounds = [bound for tracker in self._trackers for bound in tracker.bounds]
        unit = max(1, min(bounds, default=SECOND) // 2)
        yield self._session == 0
        for step, (time, held) in enumerate(zip(self.times, self.held, strict=True)):
            yield z3.Or(held, time == unit * z3.Int(f"units@{step}"))

    def run(self, model: Any, letters: Sequence[Letter], back: int) -> tuple[Instant, ...]:
        """The steps of `model`, whose letters are `letters`, with their times.

        Raises DisagreementError if the reference does not find the same letters, three times round the loop. It takes
        no step where a letter is held and no clock is due.
        """
        times = [model.eval(time, model_completion=True).as_long() for time in self.times]
        held = [z3.is_true(model.eval(each)) for each in self.held]
        round_ = model.eval(self.round, model_completion=True).as_long()
        session = model.eval(self._session, model_completion=True).as_long()
        run = TimedRun(self._trackers, self._pulses, session)
        turns = [(n, times[n] + turn * round_) for turn in range(3) for n in range(back if turn else 0, len(times))]
        by_time: list[bool] = []
        for n, time in turns:
            found = list(run.hold(time) if held[n] else run.step(time, letters[n]))
            if [frozenset(instant) for instant in found] not in ([], [letters[n]]):
                raise DisagreementError("what time decides on a run")
            by_time.append(held[n] and bool(found))
        return tuple(Instant(times[n], letters[n], by_time=by_time[n]) for n in range(len(times)))

    def _whole_run(self) -> list[dict[Scope, Term]]:
        return [{Scope(True, step == 0): z3.BoolVal(True)} for step in range(len(self.steps))]

    def _goes_on(self, before: int, after: int, time: Term) -> Iterator[Term]:
        """The step `after` comes at `time` after the step `before`: where the letter is held, nothing but time has.

        A letter that changes by itself a nanosecond later is followed by that, if time passes.
        """
        here, there = self.steps[before], self.steps[after]
        same = [here[name] == there[name] for name in self._signals]
        no_news = [z3.Not(there[name]) for name in self._news]
        yield z3.Implies(self.held[after], z3.And(*same, *no_news, time > self.times[before]))
        yield time >= self.times[before]
        at_once = z3.Or(time == self.times[before], z3.And(self.held[after], time == self.times[before] + 1))
        yield z3.Or(self._is_settled(before), at_once)

    def _is_settled(self, step: int) -> Term:
        previous = [t.subject for t in self._trackers if isinstance(t.subject, Previously)]
        caught_up = [self.steps[step][past.name] == self._truth(past.operand)[step] for past in previous]
        return z3.And(*caught_up, *(z3.Not(self.steps[step][name]) for name in self._news))

    def truth(self, predicate: Formula, step: int) -> Term:
        """Whether a state predicate holds at a step."""
        return self._truth(predicate)[step]

    def since(self, k: int, step: int) -> Term:
        """The time from which the clock of tracker k counts before a step."""
        if step == 0:
            return self._session
        return z3.Int(f"since@{k}@{step}")


class _TimedTracker:
    """One tracker along the steps; `scopes` are the scopes that it may measure at each step, and when it does."""

    def __init__(self, run: TimedSteps, k: int, tracker: Tracker, around: list[dict[Scope, Term]]) -> None:
        self._run = run
        self._tracker = tracker
        self._k = k
        self._around = around
        states = _reachable(tracker, {scope for of_step in around for scope in of_step})
        count = len(run.steps)
        self._at = [{s: z3.Bool(f"{k}:{s.phase.value}{s.passed}@{n}") for s in states} for n in range(count + 1)]
        self.scopes: list[dict[Scope, Term]] = []

    def constraints(self) -> Iterator[Term]:
        """That it goes on as its cases say, and is as before when the loop begins again."""
        for state, at in self._at[0].items():
            yield at == z3.BoolVal(state == self._tracker.initial)
        for step in range(len(self._run.steps)):
            yield from self._step(step)
        last = len(self._run.steps)
        for step, back in enumerate(self._run.back):
            yield z3.Implies(back, z3.And(*self._as_before(step, last)))

    def _as_before(self, step: int, last: int) -> Iterator[Term]:
        since, again = self._run.since(self._k, step), self._run.since(self._k, last)
        for state, at in self._at[step].items():
            yield at == self._at[last][state]
            if self._tracker.is_running(state):
                yield z3.Implies(at, again == since + self._run.round)

    def _step(self, step: int) -> Iterator[Term]:
        """What happens at a step, of which exactly one case does."""
        taken = list(self._taken(step))
        yield z3.Or([fires for _, _, fires in taken])
        for state, at in self._at[step + 1].items():
            yield at == z3.Or([fires for _, case, fires in taken if case.state == state])
        for name in self._tracker.atoms:
            yield self._run.steps[step][name] == z3.Or([f for _, case, f in taken if name in case.holding])
        for state, case, fires in taken:
            start = self._start(state, step)
            yield z3.Implies(fires, self._run.since(self._k, step + 1) == (self._now(step) if case.starts else start))
            if self._tracker.is_running(state):
                due = start + self._tracker.bounds[state.passed] + 1
                is_due = z3.And(self._run.held[step], self._now(step) == due)
                passes = case.passed is not None and case.passed > state.passed
                yield z3.Implies(fires, is_due if passes else z3.Or(self._now(step) < due, is_due))
        found: dict[Scope, list[Term]] = {}
        for _, case, fires in taken:
            found.setdefault(case.scope, []).append(fires)
        self.scopes.append({scope: z3.Or(fires) for scope, fires in found.items()})

    def _now(self, step: int) -> Term:
        return self._run.times[step]

    def _start(self, state: State, step: int) -> Term:
        """From when time counts: where what it counts from held still, from the last instant at which it did."""
        if state.phase is Phase.HELD:
            return z3.If(self._run.held[step], self._now(step) - 1, self._now(step))
        return self._run.since(self._k, step)

    def _taken(self, step: int) -> Iterator[tuple[State, Case, Term]]:
        for state, at in self._at[step].items():
            for scope, is_around in self._around[step].items():
                for case in self._tracker.cases(state, scope):
                    guard = self._run.truth(case.guard, step)
                    yield state, case, z3.And(at, is_around, guard, *self._passed(state, case, step))

    def _passed(self, state: State, case: Case, step: int) -> Iterator[Term]:
        """As many bounds have passed as `case` says."""
        if case.passed is None:
            return
        elapsed = self._now(step) - self._start(state, step)
        if case.passed > 0:
            yield elapsed > self._tracker.bounds[case.passed - 1]
        if case.passed < len(self._tracker.bounds):
            yield elapsed <= self._tracker.bounds[case.passed]


def _reachable(tracker: Tracker, scopes: set[Scope]) -> list[State]:
    """The states that the tracker can be in, in scopes like these."""
    found = [tracker.initial]
    for state in found:
        for scope in sorted(scopes):
            found += [c.state for c in tracker.cases(state, scope) if c.state not in found]
    return list(dict.fromkeys(found))
