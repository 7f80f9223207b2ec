"""What is known of one property while a run goes on: verdict, steps, episodes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

from ltlc.runtime.sampling import Input, Slope, Value
from ltlc.semantics.verdicts import Verdict


class Monitor(Protocol):
    """A generated monitor: `step` takes the values of the property's inputs in order.

    A step that is invalid because some value is NaN changes nothing but `invalid`.
    """

    state: int
    verdict: Verdict
    invalid: int

    def step(self, *values: Value) -> Verdict:
        """Judge one more step."""
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


Decision = tuple[int, int, int]
"""The number of a condition, where it leads if it fails, and where if it holds: to a
state, or, if negative, to the decision with the number `~target`."""


@dataclass(frozen=True, slots=True)
class MonitoredProperty:
    """A property, the monitor that judges it and the values that this monitor wants.

    `scopes` are those that no other encloses, `obligations` those parts of `text` that
    a run may leave open. `edges` has where each state of the monitor leads, through
    `decisions` about what `conditions` gives for the values of the inputs; both are
    empty where nothing violates the property.
    """

    label: str
    file: str
    line: int
    text: str
    inputs: tuple[Input | Slope, ...]
    monitor: Callable[[], Monitor]
    scopes: tuple[Scope, ...] = ()
    obligations: tuple[str, ...] = ()
    conditions: Callable[..., Iterable[Condition]] = lambda *values: ()
    edges: tuple[int, ...] = ()
    decisions: tuple[Decision, ...] = ()


@dataclass(frozen=True, slots=True)
class Moment:
    """A step of a property, counted from 0, and its time in s."""

    step: int
    time: float


@dataclass(frozen=True, slots=True)
class Opening(Moment):
    """The step at which an episode of `scope` opened."""

    scope: str


@dataclass(frozen=True, slots=True)
class Failure(Moment):
    """The step that decided a property, with the values that it was judged on.

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
    """A change of verdict, at the step after which `current` held."""

    property: MonitoredProperty
    previous: Verdict
    current: Verdict
    moment: Moment


def decisive(
    property_: MonitoredProperty, state: int, conditions: Sequence[Condition]
) -> tuple[Condition, ...]:
    """Those of `conditions` that lead from `state` where they all do; no fewer do."""
    holds = {number: found.holds for number, found in enumerate(conditions)}
    asked, target = [], property_.edges[state]
    while target < 0:
        number, low, high = property_.decisions[~target]
        asked.append(number)
        target = high if holds[number] else low
    needed = dict.fromkeys(sorted(asked))
    for number in asked:
        others = {n: holds[n] for n in needed if n != number}
        if _targets(property_, state, others) == {target}:
            del needed[number]
    return tuple(conditions[number] for number in needed)


def _targets(
    property_: MonitoredProperty, state: int, holds: Mapping[int, bool]
) -> set[int]:
    """Where `state` can lead, if of the conditions only those in `holds` are known."""
    reached = [property_.edges[state]]
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

    def step(self, step: int, time: float, values: Sequence[Value]) -> None:
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

    def _open(self, step: int, time: float) -> None:
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
        self.times: list[float] = []
        self.monitor = property_.monitor()
        self.verdict = Verdict.NOT_STARTED
        self.steps = 0
        self.decided_at: Failure | None = None
        self.open_since: Moment | None = None
        self.is_settled = True
        self._episodes = [Episodes(scope) for scope in property_.scopes]
        self._last = _Outcome.NOTHING

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

    def step(self, time: float, values: Sequence[Value]) -> Change | None:
        """Judge one more step; a change of verdict is returned."""
        monitor = self.monitor
        state, invalid = monitor.state, monitor.invalid
        verdict = monitor.step(*values)
        self.is_settled = state == monitor.state
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
        for scope in self._episodes:
            scope.step(step, time, values)
        if verdict is self.verdict:
            return None
        moment = Moment(step, time)
        if verdict.is_permanent:
            self.decided_at = self._failure(verdict, state, moment, values)
        previous, self.verdict = self.verdict, verdict
        is_open = verdict is Verdict.PRESUMABLY_VIOLATED
        self.open_since = moment if is_open else None
        return Change(self.property, previous, verdict, moment)

    def _failure(
        self, verdict: Verdict, state: int, moment: Moment, values: Sequence[Value]
    ) -> Failure:
        """What there is to know of the step that led from `state` to `verdict`."""
        because: tuple[Condition, ...] = ()
        if verdict is Verdict.VIOLATED:
            conditions = tuple(self.property.conditions(*values))
            because = decisive(self.property, state, conditions)
        return Failure(
            moment.step,
            moment.time,
            tuple(zip(map(str, self.property.inputs), values, strict=True)),
            because,
            self.open_since,
            latest(self._episodes),
        )

    def repeat(self, times: int, at: Iterable[float]) -> None:
        """Judge the last step `times` more times, `at` the times that it gives.

        The monitor must have settled on that step.
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
