"""What is known of one property while a run goes on: verdict, steps, episodes."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple, Protocol

from ltlc.runtime.sampling import New, Value, Wanted
from ltlc.runtime.times import NEVER
from ltlc.semantics.verdicts import Verdict


class Monitor(Protocol):
    """A generated monitor: `step` takes the values of the property's inputs in order.

    A step that is invalid because some value is NaN changes nothing but `invalid`. That
    of a property with clocks is made for the session that begins at a time; its `step`
    takes the time first. `due` is the last time before the next clock step, the moment
    at which a clock's answer changes, and `expire` takes that step.
    """

    state: int
    verdict: Verdict
    invalid: int
    due: int

    def step(self, *values: Value) -> Verdict:
        """Judge one more step."""
        ...

    def expire(self) -> None:
        """Take the clock step at `due + 1`."""
        ...


@dataclass(frozen=True, slots=True)
class Scope:
    """A scope of a property, and when it is open; `inner` are the scopes of its body.

    `opens` and `closes` judge the values of the property's inputs at a step; without
    `closes` an episode lasts to the end of the run. `limit` is how many episodes can
    open, None for any number. With `overlapping` (the scope is under `always`, `never`
    or `eventually`) an episode opens inside an open one too.
    """

    text: str
    opens: Callable[..., bool]
    closes: Callable[..., bool] | None = None
    limit: int | None = None
    overlapping: bool = False
    inner: tuple[Scope, ...] = ()


@dataclass(frozen=True, slots=True)
class Condition:
    """A condition of a property at a step; `left` and `right` are what it compares.

    They include its margin, and are None where a boolean is not compared to anything.
    """

    text: str
    holds: bool
    left: Value = None
    right: Value = None


@dataclass(frozen=True, slots=True)
class Clock:
    """A clock of a monitor: the attribute with its due time, and the condition it ends.

    Whether the condition `text` holds is `late` from when on the clock is past that.
    """

    due: str
    text: str
    late: bool


Decision = tuple[int, int, int]
"""The number of a condition, where it leads if it fails, and where if it holds: to a
state, or, if negative, to the decision with the number `~target`. What a clock answers
counts as a condition, after the others: whether it is past its due time."""


@dataclass(frozen=True, slots=True)
class Age:
    """An age of `signal` that the monitor counts from before its first step on.

    It is over `bound` after the last message; `due` is the attribute that holds when.
    """

    signal: str
    due: str
    bound: int


@dataclass(frozen=True, slots=True)
class MonitoredProperty:
    """A property, the monitor that judges it and the values that this monitor wants.

    It is `timed` if its monitor has clocks; then it may begin `from_session`, because
    it reads nothing but which messages come. `scopes` are those that no other encloses,
    `obligations` those parts of `text` that a run may leave open. `edges` has where
    each state of the monitor leads at a step, `held_edges` where at a clock step,
    through `decisions` about what `conditions` gives for the values of the inputs, and
    about `clocks`; all are empty where nothing violates the property.
    """

    label: str
    file: str
    line: int
    text: str
    inputs: tuple[Wanted, ...]
    monitor: Callable[..., Monitor]
    timed: bool = False
    from_session: bool = False
    scopes: tuple[Scope, ...] = ()
    obligations: tuple[str, ...] = ()
    conditions: Callable[..., Iterable[Condition]] = lambda *values: ()
    clocks: tuple[Clock, ...] = ()
    ages: tuple[Age, ...] = ()
    edges: tuple[int, ...] = ()
    held_edges: tuple[int, ...] = ()
    decisions: tuple[Decision, ...] = ()


@dataclass(frozen=True, slots=True)
class Moment:
    """A step of a property, counted from 0, or a clock step after it; its time in ns.

    It is a clock step, and no step of the run, if the verdict changed `by_time`.
    """

    step: int
    time: int
    by_time: bool = field(default=False, kw_only=True)


@dataclass(frozen=True, slots=True)
class Opening(Moment):
    """The step at which an episode of `scope` opened."""

    scope: str


@dataclass(frozen=True, slots=True)
class Failure(Moment):
    """What decided a property, with the values that it was judged on.

    `because` are the conditions that violated it, whatever the others were: no fewer of
    them do. `open_since` is when something was owed last, `opened` has the latest
    episode, the latest inside that one, and so on.
    """

    values: tuple[tuple[str, Value], ...]
    because: tuple[Condition, ...]
    open_since: Moment | None
    opened: tuple[Opening, ...]


@dataclass(frozen=True, slots=True)
class Change:
    """A change of verdict, and the moment from which on `current` held."""

    property: MonitoredProperty
    previous: Verdict
    current: Verdict
    moment: Moment


def decisive(
    property_: MonitoredProperty, edge: int, holds: Sequence[bool]
) -> tuple[int, ...]:
    """The conditions that lead from `edge` where all do; no fewer do."""
    asked, target = [], edge
    while target < 0:
        number, low, high = property_.decisions[~target]
        asked.append(number)
        target = high if holds[number] else low
    needed = dict.fromkeys(sorted(asked))
    for number in asked:
        others = {n: holds[n] for n in needed if n != number}
        if _targets(property_, edge, others) == {target}:
            del needed[number]
    return tuple(needed)


def _targets(
    property_: MonitoredProperty, edge: int, holds: Mapping[int, bool]
) -> set[int]:
    """Where `edge` can lead, if of the conditions only those in `holds` are known."""
    reached = [edge]
    for target in reached:
        if target < 0:
            number, low, high = property_.decisions[~target]
            known = holds.get(number)
            next_ = (low, high) if known is None else ((low, high)[known],)
            reached += [t for t in next_ if t not in reached]
    return {target for target in reached if target >= 0}


class Episodes:
    """Counts the episodes of one scope, and those inside its latest one."""

    __slots__ = ("count", "inner", "is_open", "opened", "opened_last", "scope")

    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self.inner: list[Episodes] = []
        self.count = 0
        self.is_open = False
        self.opened_last = False
        self.opened: Opening | None = None

    def step(self, step: int, time: int, values: Sequence[Value]) -> None:
        """Open or close an episode at this step."""
        scope = self.scope
        self.opened_last = False
        closing = scope.closes is not None and scope.closes(*values)
        if closing:
            self.is_open = False
            return
        can_open = scope.overlapping or not self.is_open
        if can_open and self.count != scope.limit and scope.opens(*values):
            self._open(step, time)
        if self.is_open:
            for inner in self.inner:
                inner.step(step, time, values)

    def _open(self, step: int, time: int) -> None:
        self.count += 1
        self.opened_last = True
        if not self.is_open:
            self.opened = Opening(step, time, self.scope.text)
            self.inner = [Episodes(scope) for scope in self.scope.inner]
        self.is_open = True

    def repeat(self, times: int) -> None:
        """Do what the last step did, `times` more times."""
        if self.opened_last and self.scope.overlapping:
            self.count += times


def latest(scopes: Sequence[Episodes]) -> tuple[Opening, ...]:
    """The latest episode of `scopes`, the latest inside that one, and so on."""
    opened = [(one.opened.step, one) for one in scopes if one.opened is not None]
    if not opened:
        return ()
    _, last = max(opened, key=lambda pair: pair[0])
    assert last.opened is not None
    return (last.opened, *latest(last.inner))


class Before(NamedTuple):
    """The state of a monitor before a step, and which clocks are late at the step."""

    state: int
    late: list[bool]


class _Outcome(Enum):
    """What became of the last values that a property was to be judged on."""

    NOTHING = "there have been none"
    INVALID = "one of them was NaN"
    STEP = "a step"


class Track:
    """One property in one run.

    `verdicts` has one for each step and `times` has the time of each, if they are kept.
    """

    def __init__(self, property_: MonitoredProperty, keep_verdicts: bool) -> None:
        self.property = property_
        self.verdicts: list[Verdict] | None = [] if keep_verdicts else None
        self.times: list[int] = []
        self.begin(0)
        self.verdict = Verdict.NOT_STARTED
        self.steps = 0
        self.decided_at: Failure | None = None
        self.open_since: Moment | None = None
        self.delays = 0
        self.longest_delay = 0
        self.is_settled = True
        self._episodes = [Episodes(scope) for scope in property_.scopes]
        self._last = _Outcome.NOTHING
        self._values: Sequence[Value] = ()

    def begin(self, session: int) -> None:
        """The session begins; ages count from then."""
        make = self.property.monitor
        self.monitor = make(session) if self.property.timed else make()

    def hear(self, time: int, news: Container[str]) -> None:
        """Messages came before the first step: the ages of these signals count anew."""
        for age in self.property.ages:
            if not self.steps and age.signal in news:
                setattr(self.monitor, age.due, time + age.bound)

    def count_delay(self, delay: int) -> None:
        """A verdict that time decided was told so much too late."""
        self.delays += 1
        self.longest_delay = max(self.longest_delay, delay)

    @property
    def invalid(self) -> int:
        """How many steps were none because some value was NaN."""
        return self.monitor.invalid

    @property
    def episodes(self) -> int | None:
        """How many episodes opened; None for a property without scopes."""
        if not self._episodes:
            return None
        return sum(scope.count for scope in self._episodes)

    @property
    def never_triggered(self) -> bool:
        """Whether the property holds only because no scope of it ever opened."""
        holds = self.verdict in (Verdict.SATISFIED, Verdict.PRESUMABLY_SATISFIED)
        return holds and self.episodes == 0

    @property
    def due(self) -> int:
        """When the next clock step comes, unless a step comes first."""
        return self.monitor.due + 1 if self.property.timed else NEVER

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
            before = self._before(moment.time)
            self.monitor.expire()
            if self.monitor.verdict is not self.verdict:
                changes.append(self._change(before, moment, self._held()))
        return changes

    def _before(self, time: int) -> Before:
        """The state, and which clocks are late at `time`."""
        monitor = self.monitor
        late = [getattr(monitor, clock.due) < time for clock in self.property.clocks]
        return Before(monitor.state, late)

    def _held(self) -> tuple[Value, ...]:
        """The values of the last step, without its news."""
        inputs = zip(self.property.inputs, self._values, strict=True)
        return tuple(False if isinstance(i, New) else value for i, value in inputs)

    def step(self, time: int, values: Sequence[Value]) -> Change | None:
        """Judge one more step, to whose time the property was held."""
        monitor = self.monitor
        before, invalid = self._before(time), monitor.invalid
        if self.property.timed:
            verdict = monitor.step(time, *values)
        else:
            verdict = monitor.step(*values)
        self.is_settled = before.state == monitor.state
        if monitor.invalid != invalid:
            self._last = _Outcome.INVALID
            return None
        self._last = _Outcome.STEP
        if self.verdicts is not None:
            self.verdicts.append(verdict)
            self.times.append(time)
        step = self.steps
        self.steps += 1
        if self.decided_at is not None:
            return None
        self._values = values
        for scope in self._episodes:
            scope.step(step, time, values)
        if verdict is self.verdict:
            return None
        return self._change(before, Moment(step, time), values)

    def _change(
        self, before: Before, moment: Moment, values: Sequence[Value]
    ) -> Change:
        """The verdict at `moment` is new."""
        verdict = self.monitor.verdict
        if verdict.is_permanent:
            self.decided_at = self._failure(before, moment, values)
        previous, self.verdict = self.verdict, verdict
        is_open = verdict is Verdict.PRESUMABLY_VIOLATED
        self.open_since = moment if is_open else None
        return Change(self.property, previous, verdict, moment)

    def _failure(
        self, before: Before, moment: Moment, values: Sequence[Value]
    ) -> Failure:
        """What there is to know of the moment that decided the property."""
        because: tuple[Condition, ...] = ()
        if self.monitor.verdict is Verdict.VIOLATED:
            because = self._reasons(before, moment, values)
        return Failure(
            moment.step,
            moment.time,
            tuple(zip(map(str, self.property.inputs), values, strict=True)),
            because,
            self.open_since,
            latest(self._episodes),
            by_time=moment.by_time,
        )

    def _reasons(
        self, before: Before, moment: Moment, values: Sequence[Value]
    ) -> tuple[Condition, ...]:
        """The conditions that led to the violation.

        At a clock step some clock is late, which the monitor may well not ask.
        """
        of = self.property
        found = list(of.conditions(*values))
        holds = [*(condition.holds for condition in found), *before.late]
        for clock, is_late in zip(of.clocks, before.late, strict=True):
            found.append(Condition(clock.text, is_late == clock.late))
        edges = of.held_edges if moment.by_time else of.edges
        numbers = decisive(of, edges[before.state], holds)
        first = len(holds) - len(before.late)
        if moment.by_time and not any(number >= first for number in numbers):
            late = (n for n, is_late in enumerate(before.late, first) if is_late)
            numbers = (*numbers, *late)
        return tuple(found[number] for number in numbers)

    def repeat(self, times: int, at: Iterable[int]) -> None:
        """Judge the last step `times` more times, `at` the times that it gives.

        The monitor must have settled on that step, and no clock step come in between.
        """
        if self._last is _Outcome.INVALID:
            self.monitor.invalid += times
        if self._last is not _Outcome.STEP:
            return
        self.steps += times
        if self.verdicts is not None:
            self.verdicts += [self.verdict] * times
            self.times += at
        if self.decided_at is None:
            for scope in self._episodes:
                scope.repeat(times)
