"""A run: samples come in, properties are stepped, verdicts come out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ltlc.runtime.sampling import Derived, Reading, Sampler, Value
from ltlc.runtime.tracking import Change, MonitoredProperty, Track


@dataclass(frozen=True, slots=True)
class Plan:
    """What to monitor: signals (each after its parts), properties and settings.

    `rate` is in Hz and `timeout` in s; None where there is none.
    """

    signals: tuple[Reading | Derived, ...]
    properties: tuple[MonitoredProperty, ...]
    rate: float | None = None
    timeout: float | None = None


class Ticks:
    """Moments at which samples are looked at: `start` + k / `rate` for k = 0, 1, ..."""

    __slots__ = ("count", "rate", "start")

    def __init__(self, rate: float, start: float) -> None:
        self.rate = rate
        self.start = start
        self.count = 0

    def next(self) -> float:
        """When the next tick is due; no error adds up over a long run."""
        return self.at(self.count)

    def at(self, number: int) -> float:
        """When the tick with this number, counted from 0, is due."""
        return self.start + number / self.rate

    def before(self, time: float) -> int:
        """How many ticks, the next one included, are surely due before `time`."""
        return max(0, int((time - self.start) * self.rate) - self.count - 1)


class Session:
    """One run of a plan.

    Without a rate, `message` is a step of every property one of whose signals gets a
    sample by it, from the first on at which all its inputs have values. With a rate of
    f Hz there is a tick k/f s after the first message, for k = 0, 1, ...; a tick is
    a sample of every signal that has a value, and a step of every property whose
    inputs have values. A tick sees the messages up to and including its own time.

    The run is over `timeout` s after its first step: what comes later is not taken.
    Times are in s and must not decrease; after a jump back, begin a new session.
    """

    def __init__(self, plan: Plan, keep_verdicts: bool = False) -> None:
        self.plan = plan
        inputs = [i for p in plan.properties for i in p.inputs]
        self.sampler = Sampler(plan.signals, inputs)
        self.tracks = tuple(Track(p, keep_verdicts) for p in plan.properties)
        self.steps = 0
        self.time: float | None = None
        self.is_over = False
        self._has_begun = False
        self._end = math.inf
        self._windows = [self.sampler.window(p.inputs) for p in plan.properties]
        self._fields = _fields(plan)
        self.messages = dict.fromkeys(self._fields, 0)
        self.lost: dict[str, int | None] = {}
        self._latest: dict[str, Value] = {}
        self._ticks: Ticks | None = None
        self._quiet_ticks = 0

    def fields(self, topic: str) -> tuple[str, ...]:
        """The signals read from `topic`, in the order in which `message` wants them."""
        return self._fields[topic]

    def lose(self, topic: str, count: int | None = None) -> None:
        """`count` messages on `topic` were lost; None: some may have been."""
        known = self.lost.get(topic)
        self.lost[topic] = known if count is None else (known or 0) + count

    def message(self, time: float, topic: str, values: Sequence[Value]) -> list[Change]:
        """A message came in: `values` of the fields of `topic`, None for no sample."""
        self.messages[topic] += 1
        return self.judge(time, topic, values)

    def judge(self, time: float, topic: str, values: Sequence[Value]) -> list[Change]:
        """Judge a message that was counted when it came in."""
        names = self._fields[topic]
        present = [value for value in values if value is not None]
        if len(present) < len(names):
            pairs = zip(names, values, strict=True)
            names = tuple(name for name, value in pairs if value is not None)
        return self.samples(time, names, present)

    def samples(
        self, time: float, names: tuple[str, ...], values: Sequence[Value]
    ) -> list[Change]:
        """Samples of the readings `names` came in, all at the same time."""
        changes = [] if self._ticks is None else self._tick_before(self._ticks, time)
        if not self._go_on(time) or not names:
            return changes
        taken = self.sampler.converted(names, values)
        if self.plan.rate is None:
            self.steps += 1
            return self._step(time, self.sampler.take(time, names, taken))
        if self._ticks is None:
            self._ticks = Ticks(self.plan.rate, time)
        self._latest.update(zip(names, taken, strict=True))
        self._quiet_ticks = 0
        return changes

    def advance(self, time: float) -> list[Change]:
        """It is `time` now: do the ticks that are due, and see whether the run is over.

        Called at the end of a recording, and now and then while a live run goes on.
        """
        ticks = self._ticks
        if ticks is None:
            self._go_on(time)
            return []
        changes = self._tick_before(ticks, time)
        if self._go_on(time) and ticks.next() <= time:
            changes += self._tick(ticks)
        return changes

    def _go_on(self, time: float) -> bool:
        """Set the time; whether the run still goes on at it."""
        if self.is_over:
            return False
        if self.time is not None and time < self.time:
            raise ValueError(f"time goes back from {self.time!r} to {time!r}")
        self.is_over = time > self._end
        if not self.is_over:
            self.time = time
        return not self.is_over

    def _step(self, time: float, fresh: frozenset[str]) -> list[Change]:
        """Step the properties that read a signal with a new sample."""
        changes = []
        for track, window in zip(self.tracks, self._windows, strict=True):
            if window.signals.isdisjoint(fresh):
                continue
            values = window.values()
            if values is None:
                continue
            change = track.step(time, values)
            if not self._has_begun and track.steps:
                self._begin(time)
            if change is not None:
                changes.append(change)
        return changes

    def _begin(self, time: float) -> None:
        """The run begins with its first step; from now on its last moment is known."""
        self._has_begun = True
        if self.plan.timeout is not None:
            self._end = time + self.plan.timeout

    def _tick(self, ticks: Ticks) -> list[Change]:
        time = ticks.next()
        ticks.count += 1
        self._quiet_ticks += 1
        self.steps += 1
        names, values = tuple(self._latest), self._latest.values()
        return self._step(time, self.sampler.take(time, names, values))

    def _tick_before(self, ticks: Ticks, time: float) -> list[Change]:
        """Do the ticks that are due before `time` and within the run."""
        changes: list[Change] = []
        while ticks.next() < time and ticks.next() <= self._end:
            changes += self._tick(ticks)
            if self._is_settled():
                self._repeat(ticks, ticks.before(min(time, self._end)))
        return changes

    def _is_settled(self) -> bool:
        """Whether, without a new message, every further tick does what the last did."""
        if self._quiet_ticks <= self.sampler.reach + 1:
            return False
        return all(track.is_settled for track in self.tracks)

    def _repeat(self, ticks: Ticks, times: int) -> None:
        """Count ticks without doing them, so that a gap of an hour costs no time."""
        numbers = range(ticks.count, ticks.count + times)
        ticks.count += times
        self.steps += times
        for track in self.tracks:
            track.repeat(times, map(ticks.at, numbers))


def _fields(plan: Plan) -> dict[str, tuple[str, ...]]:
    """The readings of each topic."""
    readings = [s for s in plan.signals if isinstance(s, Reading)]
    topics = dict.fromkeys(r.topic for r in readings)
    return {t: tuple(r.name for r in readings if r.topic == t) for t in topics}
