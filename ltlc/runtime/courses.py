"""How a property goes on a run, or on a slice of one: step by step, and by time."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from copy import copy

from ltlc.runtime.episodes import NOBODY, Episodes, Watchers, count_anew, latest
from ltlc.runtime.properties import (
    Change,
    Condition,
    Failure,
    Moment,
    Monitor,
    MonitoredProperty,
)
from ltlc.runtime.reasons import Before, because, reason_of_none
from ltlc.runtime.sampling import New, Value
from ltlc.runtime.times import NEVER
from ltlc.semantics.verdicts import Verdict


class Course:
    """One property, judged on a run or on a slice of it.

    `scopes` are its episodes, and `judged_on` the values at the last step before it was
    `decided_at`. With `is_settled`, the last step changed nothing, and neither will the
    next if it is the same.
    """

    __slots__ = (
        "_invalid_last",
        "_lapsed",
        "_passed",
        "_renewed",
        "_since",
        "_since_by_time",
        "_since_step",
        "decided_at",
        "invalid_because",
        "is_settled",
        "judged_on",
        "monitor",
        "property",
        "scopes",
        "steps",
        "verdict",
        "watchers",
    )

    def __init__(
        self,
        property_: MonitoredProperty,
        invalid_because: Counter[str],
        session: int = 0,
    ) -> None:
        """The session begins. The caller counts why there were no steps."""
        self.property = property_
        self.invalid_because = invalid_because
        self.verdict = Verdict.NOT_STARTED
        self.steps = 0
        self.decided_at: Failure | None = None
        self._since = self._since_step = 0
        self._since_by_time = False
        self.is_settled = True
        self.scopes = tuple(map(Episodes, property_.scopes))
        self.judged_on: Sequence[Value] = ()
        self._lapsed: tuple[int | None, ...] = ()
        self._passed: tuple[int, ...] = ()
        self._invalid_last: str | None = None
        self._renewed: tuple[Monitor, ...] = ()
        self.begin(session)

    def begin(self, session: int) -> None:
        """The session begins; ages count from then."""
        make = self.property.monitor
        self.monitor = make(session) if self.property.timed else make()
        events = self.property.events
        self.watchers = Watchers(events, session) if events else NOBODY

    @property
    def open_since(self) -> Moment | None:
        """Since when an obligation has been open; None if none is."""
        if self.verdict is not Verdict.PRESUMABLY_VIOLATED:
            return None
        return Moment(self._since_step, self._since, by_time=self._since_by_time)

    def owe(self, step: int, time: int, *, by_time: bool = False) -> None:
        """An obligation is open from this moment on."""
        self._since_step, self._since, self._since_by_time = step, time, by_time

    def hear(self, time: int, signals: Container[str]) -> None:
        """Messages come: the ages of these signals count anew, whatever the values.

        If one was late and no step is taken now, the next thing is to `renew`.
        """
        if self.decided_at is not None:
            return
        if count_anew(self.monitor, self.property.ages, time, signals):
            self._renewed += (self.monitor,)
        if self.property.events:
            self._renewed += self.watchers.hear(time, signals)

    @property
    def is_renewed(self) -> bool:
        """Whether an age is no longer late, and no step has been taken since."""
        return bool(self._renewed)

    def renew(self, time: int) -> list[Change]:
        """Take the clock step at which a late age is young, by what makes no step."""
        renewed, self._renewed = self._renewed, ()
        if not self.steps:
            return []
        for monitor in renewed:
            monitor.due = time - 1
        return self.hold(time)

    @property
    def invalid(self) -> int:
        """How many steps were none because some value was NaN."""
        return self.monitor.invalid

    @property
    def due(self) -> int:
        """When the next clock step comes, unless a step comes first."""
        return self.monitor.due + 1 if self.property.timed else NEVER

    @property
    def until(self) -> int:
        """Up to this time `hold` has nothing to do, unless a step comes first."""
        last = self.monitor.due if self.property.timed else NEVER
        if self.property.events and self.decided_at is None:
            last = min(last, self.watchers.due() - 1)
        return last

    def deadline(self) -> int | None:
        """When time alone violates the property; None if it never does."""
        ahead, moment = copy(self.monitor), None
        while self.property.timed and ahead.due < NEVER:
            moment = ahead.due + 1
            ahead.expire()
        return moment if ahead.verdict is Verdict.VIOLATED else None

    def hold(self, time: int) -> list[Change]:
        """Take the clock steps up to and including `time`, with no step until then."""
        changes = []
        while self.due <= time:
            moment = Moment(self.steps - 1, self.due, by_time=True)
            self._take(moment.time)
            self._watch(moment.time)
            change = self._expire(moment)
            if change is not None:
                changes.append(change)
        self._watch(time)
        return changes

    def _take(self, time: int) -> None:
        """If a scope opens at `time`, the values at its opening are those held.

        The monitor takes them in clock steps of their own, after which the next one is
        due as before.
        """
        if not self.property.kept:
            return
        self._watch(time - 1)
        while self.due == time:
            ahead = copy(self.monitor)
            ahead.expire()
            if ahead.due + 1 != time:
                return
            self.monitor = ahead

    def _expire(self, moment: Moment) -> Change | None:
        """Take the clock step that is due at `moment`."""
        before = (self.monitor.state, self.property.dues(self.monitor))
        self.monitor.expire()
        change = None
        if self.monitor.verdict is not self.verdict:
            previous = self._change(
                before, moment.step, moment.time, self._held(), by_time=True
            )
            change = Change(self.property, previous, self.verdict, moment)
        if self.property.counts_bounds:
            self._count_bounds(before[1])
        if self.property.recalls:
            pairs = zip(before[1], self.lapsed(), strict=True)
            last = moment.time - 1
            self._lapsed = tuple(due if due == last else was for due, was in pairs)
        return change

    def _watch(self, time: int) -> None:
        """Open and close the episodes that time opens and closes up to `time`."""
        if not self.property.events:
            return
        while self.decided_at is None and (due := self.watchers.due()) <= time:
            self.watchers.expire()
            self._open_and_close(self.steps - 1, due, self._held(), by_time=True)

    def change(self, previous: Verdict, time: int) -> Change:
        """The last step, at `time`, has changed the `previous` verdict."""
        moment = Moment(self.steps - 1, time)
        return Change(self.property, previous, self.verdict, moment)

    def step(self, time: int, values: Sequence[Value]) -> Verdict | None:
        """Judge one more step, to whose time the property was held.

        Comes back with the verdict before if it was another.
        """
        of, given = self.property, values
        if of.excused and None in values:
            if (missed := of.missed(values)) is not None:
                self.monitor.invalid += 1
                self.is_settled = True
                self._count_none(f"a message had no value of {missed}")
                return None
            given, values = of.given(values), of.shown(values)
        monitor = self.monitor
        state, invalid = monitor.state, monitor.invalid
        dues: tuple[int, ...] = ()
        if of.timed:
            dues = of.dues(monitor)
            verdict = monitor.step(time, *given)
        elif len(given) == 1:
            verdict = monitor.step(given[0])  # which takes half the time without `*`
        else:
            verdict = monitor.step(*given)
        self.is_settled = monitor.state == state
        if monitor.invalid != invalid:
            self._count_none(reason_of_none(of, given))
            return None
        self._invalid_last, self._renewed = None, ()
        step = self.steps
        self.steps = step + 1
        if self.decided_at is not None:
            return None
        if of.has_more:
            values = self._scope(step, time, values, given)
        self.judged_on = values
        previous = None
        if verdict is not self.verdict:
            previous = self._change((state, dues), step, time, values)
        if of.counts_bounds:
            self._count_bounds(dues)
        return previous

    def _asked(self, before: Sequence[int]) -> list[int]:
        """When each clock was due as a step asked it, which was due `before` that."""
        of = self.property
        after = of.dues(self.monitor) if of.timed else ()
        triples = zip(of.clocks, before, after, strict=True)
        return [was if clock.bounds else now for clock, was, now in triples]

    def _scope(
        self, step: int, time: int, values: Sequence[Value], given: Sequence[Value]
    ) -> Sequence[Value]:
        """Open and close episodes at a step; its values with those at openings."""
        if self.property.events:
            self.is_settled &= self.watchers.step(time, given)
        if self.property.kept:
            values = (*values, *self.kept())
        if self.scopes:
            self._open_and_close(step, time, values)
        return values

    def _count_none(self, reason: str) -> None:
        """Count a message that makes no step."""
        self._invalid_last = reason
        self.invalid_because[reason] += 1

    def _open_and_close(
        self, step: int, time: int, values: Sequence[Value], *, by_time: bool = False
    ) -> None:
        past = self.watchers.happen() if self.property.events else ()
        if self.property.excused:
            values = self.property.given(values)
        for scope in self.scopes:
            scope.step(step, time, values, past, by_time=by_time)

    def _held(self) -> tuple[Value, ...]:
        """The values of the last step, without its news, and those at openings."""
        # What is not there yet is not read: before the first step no scope is open.
        inputs = zip(self.property.inputs, self.judged_on, strict=False)
        held = (False if isinstance(i, New) else value for i, value in inputs)
        return (*held, *self.kept())

    def kept(self) -> Iterator[Value]:
        """The values at openings, as they are now."""
        return (getattr(self.monitor, each.attribute) for each in self.property.kept)

    def _count_bounds(self, before: Sequence[int]) -> None:
        """Count the bounds that have passed on each clock, which was due `before`."""
        of = self.property
        now = zip(of.clocks, self.passed(), before, of.dues(self.monitor), strict=True)
        self._passed = tuple(clock.passed(*counted) for clock, *counted in now)

    def passed(self) -> tuple[int, ...]:
        """How many bounds of each clock have passed."""
        return self._passed or (0,) * len(self.property.clocks)

    def lapse(self, dues: Mapping[str, int]) -> None:
        """Clock steps were taken last when some clocks were due then, by attribute."""
        if self.property.recalls:
            clocks = zip(self.property.clocks, self.lapsed(), strict=True)
            self._lapsed = tuple(dues.get(clock.due, was) for clock, was in clocks)

    def lapsed(self) -> tuple[int | None, ...]:
        """When each clock was due that a clock step took last; None if none did."""
        return self._lapsed or (None,) * len(self.property.clocks)

    def _change(
        self,
        before: Before,
        step: int,
        time: int,
        values: Sequence[Value],
        *,
        by_time: bool = False,
    ) -> Verdict:
        """The verdict is new, as it is at the first step: comes back with that before.

        Most of the time all is well, and there is nothing to keep of the moment.
        """
        previous, verdict = self.verdict, self.monitor.verdict
        if verdict is Verdict.PRESUMABLY_VIOLATED:
            self.owe(step, time, by_time=by_time)
        elif verdict is not Verdict.PRESUMABLY_SATISFIED:
            moment = Moment(step, time, by_time=by_time)
            self.decided_at = self._failure(before, moment, values)
        self.verdict = verdict
        return previous

    def _failure(
        self, before: Before, moment: Moment, values: Sequence[Value]
    ) -> Failure:
        """What there is to know of the moment that decided the property."""
        of = self.property
        if not moment.by_time:
            before = (before[0], self._asked(before[1]))
        is_violated = self.monitor.verdict is Verdict.VIOLATED
        return Failure(
            moment.step,
            moment.time,
            tuple(zip(map(str, (*of.inputs, *of.kept)), values, strict=True)),
            self._because(before, moment, values) if is_violated else (),
            self.open_since,
            latest(self.scopes),
            by_time=moment.by_time,
        )

    def _because(
        self, before: Before, moment: Moment, values: Sequence[Value]
    ) -> tuple[Condition, ...]:
        of, passed = self.property, self.passed()
        return because(of, before, moment, values, passed, self.lapsed())

    def repeat(self, times: int, at: Iterable[int]) -> None:
        """Judge the last step `times` more times, `at` the times that it gives.

        The monitor must have settled on that step, and no clock step come in between.
        """
        if self._invalid_last is not None:
            self.monitor.invalid += times
            self.invalid_because[self._invalid_last] += times
            return
        if not self.steps:
            return
        self.steps += times
        if self.decided_at is None:
            for scope in self.scopes:
                scope.repeat(times)
