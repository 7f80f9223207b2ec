"""A run in time, step by step: which atoms hold at each step and at each clock step between them. The reference.

Between steps, letters change by themselves only where a clock passes a bound, where news is over, or where `previously`
catches up. There the run takes a *clock step*; the moments follow from the steps alone. Since the properties of the
language are next-free, these instants stand for all (`docs/language.md`, Who notices).
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from dataclasses import replace

from ltlc.dataclass import dataclass
from ltlc.semantics import finite
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.instants import Instant
from ltlc.semantics.ltl import Formula
from ltlc.semantics.timed_atoms import Age, News, Occurred, Previously, messages_of
from ltlc.semantics.trackers import ALWAYS, Phase, Scope, Tracker, scopes_around
from ltlc.semantics.words import Letter

Dues = Sequence[tuple[int | None, Nanoseconds]]

Retake = Callable[[Instant, Callable[[Letter], Instant]], Instant]
"""The clock step that is right, given the one with the letter held, and what it would be with another letter."""


def as_held(instant: Instant, _: Callable[[Letter], Instant]) -> Instant:
    """No values are taken at openings: the letter held is that of the clock step."""
    return instant


@dataclass(frozen=True, slots=True)
class Counter:
    """A count along a run: the last times at which its operand `occurred`, and whether that `held` at the last instant.

    There are as many times as are counted, the earliest first, or fewer. Coq: `ring`, in `proofs/Counts.v`. The run
    `began` then.
    """

    of: Occurred
    occurred: tuple[Nanoseconds, ...] = ()
    held: bool = False
    began: Nanoseconds | None = None

    def after(self, time: Nanoseconds, letter: Letter) -> Counter:
        """What it is after an instant."""
        holds = _holds(self.of.operand, letter)
        now = replace(self, held=holds, began=time if self.began is None else self.began)
        if not holds or (self.of.begins and self.held):
            return now
        return replace(now, occurred=(*self.occurred, time)[-self.of.times :])

    def is_reached(self, time: Nanoseconds) -> bool:
        """Whether as many as are counted, all in the time that counts; or that is presumed."""
        since = self._since()
        return since is not None and (self.of.within is None or time - since <= self.of.within)

    def due(self) -> Nanoseconds | None:
        """When that is over, if it will be."""
        since = self._since()
        return None if since is None or self.of.within is None else since + self.of.within + 1

    def _since(self) -> Nanoseconds | None:
        if len(self.occurred) == self.of.times:
            return self.occurred[0]
        return self.began if self.of.presumed else None


class TimedRun:
    """What trackers and `counts` say along one run; the session, from which ages count, began at `session`.

    `retake` decides what is held at a clock step, if letters depend on values taken at openings.
    """

    def __init__(
        self,
        trackers: tuple[Tracker, ...],
        news: Iterable[News],
        session: Nanoseconds | None = None,
        retake: Retake = as_held,
        counts: Iterable[Occurred] = (),
    ) -> None:
        self.trackers = trackers
        self._counters = tuple(map(Counter, counts))
        self._retake = retake
        self.letter: Letter = frozenset()
        self.time: Nanoseconds | None = None
        self._news = messages_of(tracker.subject for tracker in trackers).union(each.name for each in news)
        self._around = scopes_around(trackers)
        self.states = [tracker.initial for tracker in trackers]
        self._started = [session if isinstance(tracker.subject, Age) else None for tracker in trackers]
        self._dues: Dues | None = None

    def hear(self, time: Nanoseconds, news: Container[str]) -> Iterator[Instant]:
        """Messages come that make no step: ages count from them.

        After the clock steps up to and including `time`, it is an instant if an age was late: the letter is held.
        """
        yield from self.hold(time)
        ages = {k: t.subject for k, t in enumerate(self.trackers) if isinstance(t.subject, Age)}
        heard = {k: age.news.name for k, age in ages.items() if age.news.name in news}
        if self.time is not None and any(self.states[k].passed for k in heard):
            yield self._clock_step(time, (self.letter - self._news).union(heard.values()))
        for k in heard:
            self._started[k] = time
        self._dues = None

    def step(self, time: Nanoseconds, letter: Letter) -> Iterator[Instant]:
        """The clock steps up to and including `time`, then the step itself."""
        yield from self.hold(time)
        yield self._instant(time, letter, time)

    def hold(self, until: Nanoseconds) -> Iterator[Instant]:
        """The clock steps up to and including `until`."""
        while (due := self.due()) is not None and due <= until:
            yield self._clock_step(due, self.letter - self._news)

    def due(self) -> Nanoseconds | None:
        """When the letter changes by itself next."""
        return min([moment for _, moment in self.dues()], default=None)

    def dues(self) -> Dues:
        """What changes the letter by itself, and when: a tracker, by number; None: a count, or that news is over."""
        if self._dues is None:  # it is asked several times of each instant
            self._dues = self._found_dues()
        return self._dues

    def _found_dues(self) -> Dues:
        found: list[tuple[int | None, Nanoseconds]] = []
        if self.time is None:
            return found
        if not self._news.isdisjoint(self.letter):
            found.append((None, self.time + 1))
        for k, tracker in enumerate(self.trackers):
            state, start = self.states[k], self._started[k]
            if isinstance(tracker.subject, Previously) and (tracker.atoms[0] in self.letter) != (state == ALWAYS):
                found.append((k, self.time + 1))
            if start is not None and tracker.is_running(state):
                found.append((k, start + tracker.bounds[state.passed] + 1))
        counted = [counter.due() for counter in self._counters if counter.of.name in self.letter]
        return found + [(None, due) for due in counted if due is not None]

    def fork(self, trackers: tuple[Tracker, ...] | None = None, retake: Retake | None = None) -> TimedRun:
        """The same run so far, to go on by itself, with `trackers` whose bounds differ where they have not passed.

        From there on, `retake` decides what it did.
        """
        other = object.__new__(TimedRun)
        vars(other).update(vars(self))  # a tenth of the time of `copy.copy`
        other.trackers, other.states, other._started = trackers or self.trackers, [*self.states], [*self._started]
        other._retake = retake or self._retake
        other._dues = self._dues if trackers is None else None
        return other

    def counts_from(self, k: int, bound: int) -> Nanoseconds | None:
        """From when the clock of tracker k counts, if it does, and its bound with this number is yet to pass."""
        state = self.states[k]
        counts = state.phase in (Phase.FIRST, Phase.RUNNING) and state.passed <= bound
        return self._started[k] if counts else None

    def goes_on_as(self, other: TimedRun) -> bool:
        """Whether, with the same bounds, whatever comes does the same in both."""
        here, there = ((run.time, run.letter, run.states, run._started, run._counters) for run in (self, other))
        return here == there

    def _clock_step(self, time: Nanoseconds, held: Letter) -> Instant:
        """The clock step at `time`, with the letter `held`, and as often as `retake` asks with another one."""
        before = [*self.states], [*self._started], self._counters

        def judged(letter: Letter) -> Instant:
            self.states, self._started, self._counters = [*before[0]], [*before[1]], before[2]
            return self._instant(time, letter, time - 1)

        return self._retake(judged(held), judged)

    def _instant(self, time: Nanoseconds, letter: Letter, held: Nanoseconds) -> Instant:
        """The instant at `time`; the letter before it was held up to `held`."""
        scopes: list[Scope] = []
        if self._counters:
            self._counters = tuple(counter.after(time, letter) for counter in self._counters)
            letter -= {counter.of.name for counter in self._counters}
            letter |= {counter.of.name for counter in self._counters if counter.is_reached(time)}
        for k, tracker in enumerate(self.trackers):
            state, around = self.states[k], self._around[k]
            if state.phase is Phase.HELD:
                self._started[k] = held
            scope = Scope(True, self.time is None) if around is None else scopes[around]
            start = self._started[k]
            passed = bisect_left(tracker.bounds, 0 if start is None else time - start)
            case, letter = tracker.step(state, scope, letter, passed)
            if case.starts:
                self._started[k] = time
            self.states[k] = case.state
            scopes.append(case.scope)
        self.letter, self.time, self._dues = letter, time, None
        return Instant(time, letter, by_time=held < time)


def _holds(predicate: Formula, letter: Letter) -> bool:
    return finite.holds(predicate, (letter,))
