"""Samples of signals: what came in last, what came before, what is computed from it."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from ltlc.runtime.functions import divide, number

Value = Any
"""A float, a bool, a str, or a tuple of floats; None stands for 'no value'."""


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
class Reading:
    """A signal that is read from the messages of `topic`.

    `type` is `number`, `boolean`, `string` or `array of numbers`. `entry` names the
    entry of the message that it is read from, where there are several, or is None.
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
    """The last samples of one signal, the latest first."""

    __slots__ = ("invalid", "times", "values")

    def __init__(self, depth: int) -> None:
        self.values: deque[Value] = deque(maxlen=depth)
        self.times: deque[float] = deque(maxlen=depth)
        self.invalid = 0

    def add(self, time: float, value: Value) -> None:
        """Take a sample; NaN is one, but counted as invalid."""
        self.values.appendleft(value)
        self.times.appendleft(time)
        if isinstance(value, float) and math.isnan(value):
            self.invalid += 1

    def value(self, wanted: Input | Slope) -> Value:
        """What `wanted` is now; None if there are not yet enough samples."""
        if isinstance(wanted, Slope):
            return self._slope()
        return self.values[wanted.ago] if len(self.values) > wanted.ago else None

    def _slope(self) -> float | None:
        """Per second; NaN if the last two samples have the same time."""
        if len(self.values) < 2:
            return None
        change = self.values[0] - self.values[1]
        duration = self.times[0] - self.times[1]
        return divide(change, duration) if duration != 0 else math.nan


class Sampler:
    """The samples of all signals; a sample of a part is one of what it is part of."""

    def __init__(
        self,
        signals: Sequence[Reading | Derived],
        inputs: Iterable[Input | Slope] = (),
    ) -> None:
        """Keep samples of `signals`, each after its parts, deep enough for `inputs`."""
        readings = [s for s in signals if isinstance(s, Reading)]
        self._derived = [s for s in signals if isinstance(s, Derived)]
        self._conversions = {s.name: _CONVERSIONS[s.type] for s in readings}
        wanted = [*inputs, *(i for s in self._derived for i in s.inputs)]
        self.samples = {
            signal.name: Samples(_depth(signal.name, wanted)) for signal in signals
        }
        self.depth = max((_reach(i) for i in wanted), default=1)
        for signal in self._derived:
            if not signal.inputs:
                self._hold(self.samples[signal.name], signal.compute())

    def _hold(self, samples: Samples, constant: Value) -> None:
        """A signal that is computed from nothing has always had its value."""
        for _ in range(self.depth):
            samples.add(0.0, constant)

    def convert(self, name: str, value: Value) -> Value:
        """`value` in the form in which samples of the signal `name` are kept."""
        return self._conversions[name](value)

    def take(self, time: float, values: Iterable[tuple[str, Value]]) -> set[str]:
        """Add samples of readings and of all that is computed from them.

        Returns the names of the signals that have a new sample.
        """
        fresh = set()
        for name, value in values:
            self.samples[name].add(time, value)
            fresh.add(name)
        for signal in self._derived:
            if all(i.signal not in fresh for i in signal.inputs):
                continue
            parts = self.values(signal.inputs)
            if parts is not None:
                self.samples[signal.name].add(time, signal.compute(*parts))
                fresh.add(signal.name)
        return fresh

    def values(self, inputs: Iterable[Input | Slope]) -> list[Value] | None:
        """The values of `inputs` now; None if one of them has none yet."""
        values = [self.samples[i.signal].value(i) for i in inputs]
        return None if None in values else values

    def missing(self, inputs: Iterable[Input | Slope]) -> list[Input | Slope]:
        """Those of `inputs` that have no value yet."""
        return [i for i in inputs if self.samples[i.signal].value(i) is None]


_CONVERSIONS: dict[str, Callable[[Value], Value]] = {
    "number": number,
    "boolean": bool,
    "string": str,
    "array of numbers": lambda values: tuple(map(number, values)),
}


def _reach(wanted: Input | Slope) -> int:
    """How many samples of its signal `wanted` looks at."""
    return 2 if isinstance(wanted, Slope) else wanted.ago + 1


def _depth(name: str, wanted: Iterable[Input | Slope]) -> int:
    return max((_reach(i) for i in wanted if i.signal == name), default=1)
