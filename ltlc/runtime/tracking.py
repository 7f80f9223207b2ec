"""What is known of one property while a run goes on: verdict, steps, episodes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
    """A scope of a property that no other scope encloses, and when it is open.

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


@dataclass(frozen=True, slots=True)
class MonitoredProperty:
    """A property, the monitor that judges it and the values that this monitor wants.

    `obligations` are those parts of `text` that a run may leave open.
    """

    label: str
    line: int
    text: str
    inputs: tuple[Input | Slope, ...]
    monitor: Callable[[], Monitor]
    scopes: tuple[Scope, ...] = ()
    obligations: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Moment:
    """A step of a property, counted from 0, and its time in s."""

    step: int
    time: float


@dataclass(frozen=True, slots=True)
class Failure(Moment):
    """The step that decided a property, with the values that it was judged on.

    `opened` is when the latest episode opened, None where there was none.
    """

    values: tuple[tuple[str, Value], ...]
    opened: Moment | None


@dataclass(frozen=True, slots=True)
class Change:
    """A change of verdict, at the step after which `current` held."""

    property: MonitoredProperty
    previous: Verdict
    current: Verdict
    moment: Moment


class Episodes:
    """Counts the episodes of one scope."""

    __slots__ = ("count", "is_open", "opened", "opened_last", "scope")

    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self.count = 0
        self.is_open = False
        self.opened_last = False
        self.opened: Moment | None = None

    def step(self, step: int, time: float, values: Sequence[Value]) -> None:
        """Open or close an episode at this step."""
        scope = self.scope
        self.opened_last = False
        closing = scope.closes is not None and scope.closes(*values)
        if closing:
            self.is_open = False
            return
        if self.is_open and not scope.overlapping:
            return
        if self.count == scope.limit or not scope.opens(*values):
            return
        self.count += 1
        self.opened_last = True
        if not self.is_open:
            self.opened = Moment(step, time)
        self.is_open = True

    def repeat(self, times: int) -> None:
        """Do what the last step did, `times` more times."""
        if self.opened_last and self.scope.overlapping:
            self.count += times


class _Outcome(Enum):
    """What became of the last values that a property was to be judged on."""

    NOTHING = "there have been none"
    INVALID = "one of them was NaN"
    STEP = "a step"


class Track:
    """One property in one run; `verdicts` has one for each step, if they are kept."""

    def __init__(self, property_: MonitoredProperty, keep_verdicts: bool) -> None:
        self.property = property_
        self.verdicts: list[Verdict] | None = [] if keep_verdicts else None
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
    def opened(self) -> Moment | None:
        """When the latest episode opened."""
        moments = [scope.opened for scope in self._episodes if scope.opened is not None]
        return max(moments, key=lambda moment: moment.step, default=None)

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
        step = self.steps
        self.steps += 1
        if self.decided_at is not None:
            return None
        for scope in self._episodes:
            scope.step(step, time, values)
        if verdict is self.verdict:
            return None
        return self._change(verdict, Moment(step, time), values)

    def _change(
        self, verdict: Verdict, moment: Moment, values: Sequence[Value]
    ) -> Change:
        previous, self.verdict = self.verdict, verdict
        is_open = verdict is Verdict.PRESUMABLY_VIOLATED
        self.open_since = moment if is_open else None
        if verdict.is_permanent:
            named = zip(map(str, self.property.inputs), values, strict=True)
            self.decided_at = Failure(
                moment.step, moment.time, tuple(named), self.opened
            )
        return Change(self.property, previous, verdict, moment)

    def repeat(self, times: int) -> None:
        """Judge the last step `times` more times, the monitor having settled on it."""
        if self._last is _Outcome.INVALID:
            self.monitor.invalid += times
        if self._last is not _Outcome.STEP:
            return
        self.steps += times
        if self.verdicts is not None:
            self.verdicts += [self.verdict] * times
        if self.decided_at is None:
            for scope in self._episodes:
                scope.repeat(times)
