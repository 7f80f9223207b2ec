"""On a recording: the verdicts that other bounds on time would have given, for all values of a bound in one pass.

A bound decides no more than whether its clock is past it, and the clock starts and stops whatever the bound is. So all
values between two times that were measured do the same. They are one group, which is split where a time is measured
that lies among them, and joined with its neighbour where the monitor forgets the difference.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

from ltlc.analysis.time_bounds import with_bound
from ltlc.automata import translate
from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.encodings import Encoding, encode
from ltlc.semantics.instants import Instant, Observation, Step
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import Historically, atoms_within, news_of, operands
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import Tracker, trackers_of
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.specification import Path

LARGEST: Nanoseconds = 1 << 62
"""A bound of 146 years, which nothing passes."""


MOST_RANGES = 20
"""With more ranges than this, nearly every value of a bound matters, and they are not listed."""


class NotKnownError(ValueError):
    """The results of other bounds are unknown; the message says why."""


class Range(NamedTuple):
    """The bounds from `least` to `most` with which a run ends with `verdict`; `LARGEST` stands for all above, too.

    `step` is the number of the one that comes in time for these, and not for those below; None where no step decides.
    """

    least: Nanoseconds
    most: Nanoseconds
    verdict: Verdict
    step: int | None


@dataclass(frozen=True)
class Group:
    """Bounds with all of which the run is the same so far, up to stuttering; `run` is that with the least."""

    least: Nanoseconds
    most: Nanoseconds
    run: TimedRun
    state: int = 0
    step: int | None = None


@dataclass(frozen=True)
class Bound:
    """The bound at `path` of a property that is judged on letters of `alphabet`, to be replaced by others."""

    property: Property
    path: Path
    encoding: Encoding
    alphabet: Alphabet

    def ranges(self, run: Observation) -> list[Range]:
        """The verdicts at the end of `run` with all bounds from 1 ns on. Raises NotKnownError."""
        groups = [group for least, most in self._alike() for group in _Pass(self, least, most).groups(run)]
        if len(groups) > MOST_RANGES:
            raise NotKnownError(f"it matters at more than {MOST_RANGES} values")
        found: list[Range] = []
        for group in groups:
            verdict = _Pass(self, group.least, group.least).verdict(run)
            if found and found[-1].verdict is verdict:
                found[-1] = found[-1]._replace(most=group.most)
            else:
                found.append(Range(group.least, group.most, verdict, group.step))
        return found

    def formula(self, duration: Nanoseconds) -> Formula:
        """The property in core LTL, with `duration` for the bound."""
        return encode(with_bound(self.property, self.path, duration), self.encoding)

    @cached_property
    def tracker(self) -> int:
        """The number of the tracker that the bound belongs to."""
        trackers = trackers_of(self.formula(LARGEST))
        return next(k for k, tracker in enumerate(trackers) if LARGEST - less(tracker) in tracker.bounds)

    def _alike(self) -> Iterator[tuple[Nanoseconds, Nanoseconds]]:
        """Ranges of bounds that pass no other bound of their clock: there, monitors differ in the bound only."""
        formula = self.formula(LARGEST)
        tracker = trackers_of(formula)[self.tracker]
        read = {a.name for atom in atoms_within(formula) for operand in operands(atom) for a in atoms_within(operand)}
        if not read.isdisjoint(tracker.atoms):
            raise NotKnownError("the times of others depend on it")
        least = 1
        for other in tracker.bounds[:-1]:
            if least < other:
                yield least, other - 1
            yield other, other
            least = other + 1
        yield least, LARGEST


def less(tracker: Tracker) -> Nanoseconds:
    """By how much a bound of `tracker` is less than what is written: a duration that has to be reached, or passed."""
    return int(isinstance(tracker.subject, Historically))


class _Pass:
    """One pass over a run with the bounds from `least` to `most`."""

    def __init__(self, bound: Bound, least: Nanoseconds, most: Nanoseconds) -> None:
        formula = bound.formula(least)
        self._range = least, most
        self._monitor = translate(formula, bound.alphabet)
        self._news = news_of(formula)
        self._trackers = trackers_of(formula)
        self._k = bound.tracker
        self._less = less(self._trackers[self._k])
        self._number = self._trackers[self._k].bounds.index(least - self._less)

    def verdict(self, run: Observation) -> Verdict:
        """That of the least bound, at the end of `run`."""
        first, *_ = self.groups(run)
        return self._monitor.verdicts[first.state]

    def groups(self, run: Observation) -> list[Group]:
        """The bounds that make no difference to one another at the end of `run`, in order."""
        groups = [Group(*self._range, TimedRun(self._trackers, self._news, run.session))]
        for number, step in enumerate(run.steps):
            if number and step.letter == run.steps[number - 1].letter and step.letter.isdisjoint(self._names):
                continue
            groups = list(self._joined(part for group in groups for part in self._stepped(group, number, step)))
        return [part for group in groups for part in self._held(group, run.until, None)]

    @cached_property
    def _names(self) -> frozenset[str]:
        return frozenset(news.name for news in self._news)

    def _stepped(self, group: Group, number: int, step: Step) -> Iterator[Group]:
        for part in self._held(group, step.time, number):
            yield self._after(part, part.run.step(*step)) if self._goes_on(part) else part

    def _goes_on(self, group: Group) -> bool:
        return not self._monitor.verdicts[group.state].is_permanent

    def _held(self, group: Group, time: Nanoseconds, number: int | None) -> Iterator[Group]:
        """`group` up to `time`, that of the step with this `number`, in parts that pass their bounds alike until then.

        Between two steps, that is before, at, or after each moment at which something else changes.
        """
        if not self._goes_on(group):
            yield group
            return
        moment = min([time, *self._moments(group.run)])
        for part in self._split(group, moment, number if moment == time else None):
            held = self._after(part, part.run.hold(moment))
            if moment == time:
                yield held
            else:
                yield from self._held(held, time, number)

    def _moments(self, run: TimedRun) -> Iterator[Nanoseconds]:
        """When something else changes by itself."""
        yield from (moment for k, moment in run.dues() if k != self._k)
        for number, bound in enumerate(self._trackers[self._k].bounds):
            start = run.counts_from(self._k, number)
            if number != self._number and start is not None and run.time is not None and start + bound >= run.time:
                yield start + bound + 1

    def _split(self, group: Group, moment: Nanoseconds, number: int | None) -> Iterator[Group]:
        """`group` in those that are past their bound before `moment`, at it, and not yet."""
        start = group.run.counts_from(self._k, self._number)
        in_time = group.least if start is None else moment - start + self._less
        least = group.least
        for most in (in_time - 2, in_time - 1, group.most):
            most = min(most, group.most)
            if least <= most:
                step = group.step if least == group.least else number
                yield replace(group, least=least, run=group.run.fork(self._bounded(least)), most=most, step=step)
                least = most + 1

    def _bounded(self, duration: Nanoseconds) -> tuple[Tracker, ...]:
        trackers = list(self._trackers)
        bounds = list(trackers[self._k].bounds)
        bounds[self._number] = duration - self._less
        trackers[self._k] = replace(trackers[self._k], bounds=tuple(bounds))
        return tuple(trackers)

    def _after(self, group: Group, instants: Iterable[Instant]) -> Group:
        state = group.state
        for instant in instants:
            state = self._monitor.step(state, instant)
        return replace(group, state=state)

    def _joined(self, groups: Iterable[Group]) -> Iterator[Group]:
        """Neighbours joined that will do the same from now on."""
        last: Group | None = None
        for group in groups:
            if last and last.state == group.state and (not self._goes_on(last) or last.run.goes_on_as(group.run)):
                last = replace(last, most=group.most)
                continue
            if last:
                yield last
            last = group
        if last:
            yield last
