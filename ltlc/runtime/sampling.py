"""Samples of signals: what came in last, what came before, what is computed from it."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import isnan
from typing import Any

from ltlc.runtime.functions import divide, doubles_of, elements_of, number
from ltlc.runtime.times import seconds

Value = Any
"""A float or int, a bool, a str, or a tuple of such; None stands for 'no value'."""


@dataclass(frozen=True, slots=True)
class Input:
    """The sample of `signal` from `ago` samples of it ago; 0 is the latest."""

    signal: str
    ago: int = 0

    def __str__(self) -> str:
        return f"@{{{self.signal}, -{self.ago}}}" if self.ago else self.signal


@dataclass(frozen=True, slots=True)
class Slope:
    """The difference quotient of the last two samples of `signal`, per second."""

    signal: str

    def __str__(self) -> str:
        return f"slope of {self.signal}"


@dataclass(frozen=True, slots=True)
class New:
    """Whether a message has come in, at this very step, that `signal` is read from."""

    signal: str

    def __str__(self) -> str:
        return f"new {self.signal}"


Wanted = Input | Slope | New
"""What a property or a signal is computed from."""


@dataclass(frozen=True, slots=True)
class Reading:
    """A signal that is read from the messages of `topic`.

    `type` is `number`, `integer`, `boolean`, `string`, or of arrays such as `array of
    numbers` and `array of integers`. `entry` names the entry of the message that it is
    read from, where there are several, or is None.
    """

    name: str
    topic: str
    type: str = "number"
    entry: str | None = None


@dataclass(frozen=True, slots=True)
class Derived:
    """A signal that is computed from others: `compute` of the values of `inputs`."""

    name: str
    inputs: tuple[Input | Slope, ...]
    compute: Callable[..., Value]


class Samples:
    """The last samples of one signal, the latest first, and the times of two."""

    __slots__ = ("times", "values")

    def __init__(self, depth: int) -> None:
        self.values: deque[Value] = deque(maxlen=depth)
        self.times: deque[int] = deque(maxlen=min(depth, 2))

    def add(self, time: int, value: Value) -> None:
        """Take a sample; NaN is one."""
        self.values.appendleft(value)
        self.times.appendleft(time)


class Slopes:
    """The slope of the last two of some samples, where others have their values."""

    __slots__ = ("_samples",)

    def __init__(self, samples: Samples) -> None:
        self._samples = samples

    def __getitem__(self, ago: int) -> float:
        """Per second; NaN if the last two samples have the same time."""
        values, times = self._samples.values, self._samples.times
        change: float = values[ago] - values[ago + 1]
        duration = times[ago] - times[ago + 1]
        return divide(change, seconds(duration)) if duration != 0 else math.nan


class Window:
    """What is looked at of some signals: the values of `inputs`, in their order.

    It waits for samples of `signals`; of `topics` it wants to know the news only.
    """

    __slots__ = ("_is_full", "_places", "_samples", "inputs", "signals", "topics")

    def __init__(self, inputs: Iterable[Wanted], sampler: Sampler) -> None:
        self.inputs = tuple(inputs)
        new = [i.signal for i in self.inputs if isinstance(i, New)]
        self.topics = frozenset().union(*(sampler.topics[name] for name in new))
        self.signals = frozenset(
            i.signal for i in self.inputs if not isinstance(i, New)
        )
        self._samples = sampler.samples
        self._places = [sampler.place(wanted) for wanted in self.inputs]
        self._is_full = False

    def missing(self) -> list[Input | Slope]:
        """The inputs that have no value yet."""
        return [
            i
            for i in self.inputs
            if not isinstance(i, New)
            and len(self._samples[i.signal].values) < _reach(i)
        ]

    def values(self) -> list[Value] | None:
        """The values now; None if one is missing. What has a value once, keeps one."""
        if not self._is_full:
            if self.missing():
                return None
            self._is_full = True
        found = []
        for values, ago in self._places:  # half as long as a comprehension takes
            found.append(values[ago])
        return found


@dataclass(frozen=True, slots=True)
class Update:
    """What new samples of some readings lead to, `fresh` being all that may have one.

    `readings` has where samples go to, each with the place of its value; `derived` has
    that, how they are computed, and of what.
    """

    fresh: frozenset[str]
    readings: tuple[tuple[int, Samples], ...]
    derived: tuple[tuple[Samples, Callable[..., Value], Window], ...]

    def take(self, time: int, values: Sequence[Value]) -> None:
        """Add samples of the readings and of all that is computed from them."""
        for place, samples in self.readings:
            samples.values.appendleft(values[place])  # half as long as `add` takes
            samples.times.appendleft(time)
        for samples, compute, window in self.derived:
            parts = window.values()
            if parts is not None:
                samples.add(time, compute(*parts))


class Sampler:
    """The samples of all signals; a sample of a part is one of what it is part of."""

    def __init__(
        self,
        signals: Sequence[Reading | Derived],
        inputs: Iterable[Wanted] = (),
    ) -> None:
        """Keep samples of `signals`, each after its parts, deep enough for `inputs`.

        What has not changed for more than `reach` samples leaves no trace of a change.
        `topics` has those that a signal is read from, directly or not; `not_measured`
        counts the elements of arrays that were NaN.
        """
        readings = [s for s in signals if isinstance(s, Reading)]
        derived = [s for s in signals if isinstance(s, Derived)]
        inputs = tuple(inputs)
        self.topics = _topics(signals)
        self.not_measured = dict.fromkeys(
            (s.name for s in readings if s.type == "array of numbers"), 0
        )
        self._conversions = {s.name: _CONVERSIONS[s.type] for s in readings}
        depths = _depths([*inputs, *(i for s in derived for i in s.inputs)])
        self.samples = {s.name: Samples(depths.get(s.name, 1)) for s in signals}
        self.reach = sum(max(0, depth - 1) for depth in depths.values())
        self.has_news = any(isinstance(i, New) for i in inputs)
        self._news = {i.signal: Samples(1) for i in inputs if isinstance(i, New)}
        self._heard: list[Samples] = []
        self._news_of: dict[str, list[Samples]] = {}
        for name, samples in self._news.items():
            samples.values.append(False)
            for topic in self.topics[name]:
                self._news_of.setdefault(topic, []).append(samples)
        self._derived = [
            (s.name, (self.samples[s.name], s.compute, self.window(s.inputs)))
            for s in derived
            if s.inputs
        ]
        self._wholes: dict[str, list[int]] = {}
        for place, (_, (_, _, window)) in enumerate(self._derived):
            for part in window.signals:
                self._wholes.setdefault(part, []).append(place)
        self._updates: dict[tuple[str, ...], Update] = {}
        for signal in derived:
            if not signal.inputs:
                self._hold(self.samples[signal.name], signal.compute())

    def _hold(self, samples: Samples, constant: Value) -> None:
        """A signal that is computed from nothing has always had its value."""
        for _ in range(samples.values.maxlen or 1):
            samples.add(0, constant)

    def window(self, inputs: Iterable[Wanted]) -> Window:
        """A look at `inputs`."""
        return Window(inputs, self)

    def place(self, wanted: Wanted) -> tuple[deque[Value] | Slopes, int]:
        """What has the values of `wanted`, the latest first, and how long ago."""
        if isinstance(wanted, New):
            return self._news[wanted.signal].values, 0
        if isinstance(wanted, Slope):
            return Slopes(self.samples[wanted.signal]), 0
        return self.samples[wanted.signal].values, wanted.ago

    def hear(self, topics: Iterable[str]) -> None:
        """The messages since the step before came in on `topics`; if `has_news`."""
        for samples in self._heard:
            samples.values[0] = False
        self._heard = [s for topic in topics for s in self._news_of.get(topic, ())]
        for samples in self._heard:
            samples.values[0] = True

    def converted(
        self, names: Iterable[str], values: Iterable[Value]
    ) -> dict[str, Value]:
        """`values` of the readings `names` in the form in which samples are kept.

        None is no sample.
        """
        convert = self._conversions
        return {
            name: value if value.__class__ is float else convert[name](value)
            for name, value in zip(names, values, strict=True)
            if value is not None
        }

    def count(self, taken: Mapping[str, Value]) -> None:
        """Count the elements that are NaN of the arrays that came in."""
        for name in self.not_measured.keys() & taken.keys():
            if not sum(taken[name]) <= math.inf:
                self.not_measured[name] += sum(map(isnan, taken[name]))

    def take(
        self, time: int, names: tuple[str, ...], values: Sequence[Value]
    ) -> frozenset[str]:
        """Add samples of the readings `names` and of all that is computed from them.

        Returns the names of the signals that have a new sample, or have none at all.
        """
        update = self.update(names)
        update.take(time, values)
        return update.fresh

    def update(self, names: tuple[str, ...]) -> Update:
        """What samples of `names` lead to; found once, for they come again."""
        if names not in self._updates:
            self._updates[names] = self._update(names)
        return self._updates[names]

    def _update(self, names: tuple[str, ...]) -> Update:
        fresh, places = list(names), set[int]()
        for name in fresh:
            more = [n for n in self._wholes.get(name, ()) if n not in places]
            places.update(more)
            fresh += [self._derived[place][0] for place in more]
        readings = tuple(enumerate(self.samples[name] for name in names))
        derived = tuple(self._derived[place][1] for place in sorted(places))
        return Update(frozenset(fresh), readings, derived)


_CONVERSIONS: dict[str, Callable[[Value], Value]] = {
    "number": number,
    "integer": int,
    "boolean": bool,
    "string": str,
    "array of numbers": doubles_of,
    "array of integers": lambda values: tuple(map(int, elements_of(values))),
    "array of booleans": lambda values: tuple(map(bool, elements_of(values))),
    "array of strings": tuple,
}


def _topics(signals: Iterable[Reading | Derived]) -> dict[str, frozenset[str]]:
    """The topics that each of `signals` is read from; each stands after its parts."""
    topics: dict[str, frozenset[str]] = {}
    for signal in signals:
        if isinstance(signal, Reading):
            topics[signal.name] = frozenset({signal.topic})
        else:
            parts = (topics[part.signal] for part in signal.inputs)
            topics[signal.name] = frozenset().union(*parts)
    return topics


def _reach(wanted: Wanted) -> int:
    """How many samples of its signal `wanted` looks at."""
    if isinstance(wanted, Input):
        return wanted.ago + 1
    return 2 if isinstance(wanted, Slope) else 0


def _depths(inputs: Iterable[Wanted]) -> dict[str, int]:
    """How many samples of each signal `inputs` look at."""
    depths: dict[str, int] = {}
    for wanted in inputs:
        name = wanted.signal
        depths[name] = max(depths.get(name, 1), _reach(wanted))
    return depths
