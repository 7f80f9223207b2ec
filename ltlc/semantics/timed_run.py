"""A run in time, step by step: which atoms hold at each step and at each clock step between them. The reference.

Between steps, letters change by themselves only where a clock passes a bound, where news is over, or where `previously`
catches up. There the run takes a *clock step*; the moments follow from the steps alone. Since the properties of the
language are next-free, these instants stand for all (`docs/language.md`, Who notices).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ltlc.semantics import finite
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.instants import Instant
from ltlc.semantics.ltl import Formula
from ltlc.semantics.timed_atoms import Age, News, Previously
from ltlc.semantics.trackers import ALWAYS, Case, Phase, Scope, State, Tracker, scopes_around
from ltlc.semantics.words import Letter


class TimedRun:
    """What trackers say along one run; the session, from which ages count, began at `session`."""

    def __init__(self, trackers: tuple[Tracker, ...], news: Iterable[News], session: Nanoseconds | None = None) -> None:
        self.trackers = trackers
        self.letter: Letter = frozenset()
        self.time: Nanoseconds | None = None
        self._news = frozenset(each.name for each in news)
        self._around = scopes_around(trackers)
        self._states = [tracker.initial for tracker in trackers]
        self._started = [session if isinstance(tracker.subject, Age) else None for tracker in trackers]

    def step(self, time: Nanoseconds, letter: Letter) -> Iterator[Instant]:
        """The clock steps up to and including `time`, then the step itself."""
        yield from self.hold(time)
        yield self._instant(time, letter, time)

    def hold(self, until: Nanoseconds) -> Iterator[Instant]:
        """The clock steps up to and including `until`."""
        while (due := self.due()) is not None and due <= until:
            yield self._instant(due, self.letter - self._news, due - 1)

    def due(self) -> Nanoseconds | None:
        """When the letter changes by itself next."""
        if self.time is None:
            return None
        moments = [self.time + 1] if self.letter & self._news else []
        for tracker, state, start in zip(self.trackers, self._states, self._started, strict=True):
            if isinstance(tracker.subject, Previously) and (tracker.atoms[0] in self.letter) != (state == ALWAYS):
                moments.append(self.time + 1)
            if tracker.is_running(state) and start is not None:
                moments.append(start + tracker.bounds[state.passed] + 1)
        return min(moments, default=None)

    def _instant(self, time: Nanoseconds, letter: Letter, held: Nanoseconds) -> Instant:
        """The instant at `time`; the letter before it was held up to `held`."""
        scopes: list[Scope] = []
        for k, tracker in enumerate(self.trackers):
            state, around = self._states[k], self._around[k]
            if state.phase is Phase.HELD:
                self._started[k] = held
            scope = Scope(True, self.time is None) if around is None else scopes[around]
            case = self._case(tracker, state, scope, letter, self._passed(k, time))
            if case.starts:
                self._started[k] = time
            self._states[k] = case.state
            scopes.append(case.scope)
            letter = (letter - set(tracker.atoms)) | set(case.holding)
        self.letter, self.time = letter, time
        return Instant(time, letter, by_time=held < time)

    def _passed(self, k: int, time: Nanoseconds) -> int:
        start = self._started[k]
        start = time if start is None else start
        return sum(time - start > bound for bound in self.trackers[k].bounds)

    def _case(self, tracker: Tracker, state: State, around: Scope, letter: Letter, passed: int) -> Case:
        fitting = [
            case
            for case in tracker.cases(state, around)
            if case.passed in (None, passed) and _holds(case.guard, letter)
        ]
        (case,) = fitting
        return case


def _holds(predicate: Formula, letter: Letter) -> bool:
    return finite.holds(predicate, (letter,))
