"""Episodes of scopes, and the events that open and close them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Container, Iterable, Sequence
from copy import copy
from typing import Any

from ltlc.runtime.properties import Age, Monitor, Opening, PastEvent, Scope
from ltlc.runtime.sampling import Value
from ltlc.runtime.times import NEVER


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

    def step(
        self,
        step: int,
        time: int,
        values: Sequence[Value],
        past: Sequence[bool] = (),
        *,
        by_time: bool = False,
    ) -> None:
        """Open or close an episode; of the events that the past decides, `past` hold.

        At a clock step, which is `by_time`, nothing opens inside an open one.
        """
        scope = self.scope
        self.opened_last = False
        if scope.closes is not None and _happens(scope.closes, values, past):
            self.is_open = False
            return
        can_open = not self.is_open or (scope.overlapping and not by_time)
        may_open = can_open and self.count != scope.limit
        if may_open and _happens(scope.opens, values, past):
            self._open(Opening(step, time, scope.text, by_time=by_time))
        if self.is_open:
            for inner in self.inner:
                inner.step(step, time, values, past, by_time=by_time)

    def _open(self, opening: Opening) -> None:
        self.count += 1
        self.opened_last = True
        if not self.is_open:
            self.opened = opening
            self.inner = [Episodes(scope) for scope in self.scope.inner]
        self.is_open = True

    def repeat(self, times: int) -> None:
        """Do what the last step did, `times` more times."""
        if self.opened_last and self.scope.overlapping:
            self.count += times


def _happens(
    event: Callable[..., bool] | int, values: Sequence[Value], past: Sequence[bool]
) -> bool:
    return past[event] if isinstance(event, int) else event(*values)


class Watchers:
    """Those of the events of a property that the past decides, in a session.

    There is one of the `machines` for each.
    """

    def __init__(self, events: Sequence[PastEvent], session: int) -> None:
        self._events = events
        self.machines = [event.watcher(session) for event in events]

    def fork(self) -> Watchers:
        """Those that go on from here by themselves."""
        if not self.machines:
            return self
        other = copy(self)
        other.machines = [forked(machine) for machine in self.machines]
        return other

    def hear(self, time: int, signals: Container[str]) -> tuple[Monitor, ...]:
        """Messages come: the ages of these signals count anew; where one was late."""
        pairs = zip(self._events, self.machines, strict=True)
        return tuple(w for e, w in pairs if count_anew(w, e.ages, time, signals))

    def step(self, time: int, values: Sequence[Value]) -> bool:
        """A step is taken; whether it changes nothing, and time alone will not."""
        before = [watcher.state for watcher in self.machines]
        for watcher in self.machines:
            watcher.step(time, *values)
        after = [watcher.state for watcher in self.machines]
        return before == after and self.due() >= NEVER

    def due(self) -> int:
        """When the next event may begin or end, unless a step comes first."""
        return min((watcher.due + 1 for watcher in self.machines), default=NEVER)

    def expire(self) -> None:
        """Take the clock steps that are due."""
        due = self.due()
        for watcher in self.machines:
            if watcher.due + 1 == due:
                watcher.expire()

    def happen(self) -> list[bool]:
        """Whether each event happens."""
        return [watcher.verdict.holds for watcher in self.machines]


NOBODY = Watchers((), 0)
"""Watches no event."""


def forked(monitor: Monitor) -> Monitor:
    """A monitor that goes on from here by itself, and counts by itself."""
    other: Monitor = object.__new__(monitor.__class__)
    for name, value in _attributes(monitor):
        setattr(other, name, value.copy() if value.__class__ is deque else value)
    return other


def state_of(monitor: Monitor) -> tuple[object, ...]:
    """What decides how a monitor goes on."""
    values = (value for _, value in _attributes(monitor))
    return tuple(tuple(v) if v.__class__ is deque else v for v in values)


def _attributes(monitor: Monitor) -> list[tuple[str, Any]]:
    """What a monitor has, by name: values at openings only once there are any."""
    names = monitor.__slots__
    return [(name, getattr(monitor, name)) for name in names if hasattr(monitor, name)]


def count_anew(
    monitor: Monitor, ages: Iterable[Age], time: int, signals: Container[str]
) -> bool:
    """The ages of these signals count from `time`; whether one was late."""
    was_late = False
    for age in ages:
        if age.signal in signals:
            was_late |= time > getattr(monitor, age.due)
            setattr(monitor, age.due, time + age.bound)
    return was_late


def latest(scopes: Sequence[Episodes]) -> tuple[Opening, ...]:
    """The latest episode of `scopes`, the latest inside that one, and so on."""
    opened = [(one.opened.step, one) for one in scopes if one.opened is not None]
    if not opened:
        return ()
    _, last = max(opened, key=lambda pair: pair[0])
    assert last.opened is not None
    return (last.opened, *latest(last.inner))
