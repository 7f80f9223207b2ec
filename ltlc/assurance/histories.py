"""The samples that signals have in a run, by definition: the reference for the runtime, with which it shares nothing.

A run is a sequence of instants. At each some sources have a sample: fields of messages, or whatever is given in the
place of a computed signal. All else is computed from the sources, and the whole of it is kept.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter

from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.words import Letter
from ltlc.specification.evaluation import Value, calculate, evaluate, letter
from ltlc.specification.expressions import Current, Expression, Input, New, Operator, Past, Signal, Slope, inputs
from ltlc.specification.specification import PropertySpecification

Sample = Mapping[Signal, Value]
"""Sources with a sample at the same instant, and its values."""


def sample_text(sample: Sample) -> str:
    """A sample for a reader."""
    return ", ".join(f"{signal.name} = {value!r}" for signal, value in sample.items()) or "nothing"


@dataclass(frozen=True, slots=True)
class Instant:
    """At `time`, in ns, the sources in `taken` have a sample."""

    time: Nanoseconds
    taken: Sample

    def has_news(self, sources: Iterable[Signal]) -> bool:
        """Whether one of `sources` has a sample."""
        return any(source in self.taken for source in sources)


@dataclass(frozen=True, slots=True)
class Step:
    """A step of a property, at the instant with this number: its letter, or None where something is NaN."""

    instant: int
    letter: Letter | None


class Origins:
    """What a property reads, down to the sources: which each signal is computed from, and how."""

    def __init__(self, specification: PropertySpecification, sources: Collection[Signal]) -> None:
        self.specification = specification
        self.wanted = specification.inputs()
        self.parts: dict[Signal, tuple[Input, ...]] = {}
        self._sources: dict[Signal, tuple[Signal, ...]] = {signal: (signal,) for signal in sources}
        for each in self.wanted:
            self._enter(each.signal)
        self.reach = max((self._reach(each) for each in self.wanted), default=1)
        """Over how many samples of the sources, the latest included, the property looks back."""

    def _enter(self, signal: Signal) -> None:
        if signal in self._sources:
            return
        assert isinstance(signal.definition, Expression)
        self.parts[signal] = tuple(inputs(signal.definition))
        for part in self.parts[signal]:
            self._enter(part.signal)
        self._sources[signal] = self.sources(self.parts[signal])

    def sources(self, wanted: Iterable[Input]) -> tuple[Signal, ...]:
        """The sources that the inputs `wanted` are computed from, each once."""
        return tuple(dict.fromkeys(source for each in wanted for source in self._sources[each.signal]))

    def _reach(self, wanted: Input) -> int:
        parts = self.parts.get(wanted.signal, ())
        return _length(wanted) + max((self._reach(part) for part in parts), default=1) - 1

    def steps(self, run: Sequence[Instant]) -> list[Step]:
        """The steps of the property in `run`.

        There is one at each instant at which something that it reads has a sample and all of it has a value.
        """
        history, sources = History(self, run), self.sources(self.wanted)
        found = []
        for number, instant in enumerate(run):
            if instant.has_news(sources) and (values := history.values(self.wanted, number)) is not None:
                found.append(Step(number, letter(self.specification.atoms, values)))
        return found


def _length(wanted: Input) -> int:
    """How many samples of its signal an input needs."""
    match wanted:
        case Current() | New():
            return 1
        case Past(_, samples):
            return samples + 1
        case Slope():
            return 2


class History:
    """All samples of all signals in a run."""

    def __init__(self, origins: Origins, run: Sequence[Instant]) -> None:
        self._origins = origins
        self._run = run
        self._samples: dict[Signal, list[tuple[int, Value]]] = {}

    def samples(self, signal: Signal) -> list[tuple[int, Value]]:
        """The samples of `signal`, each with the number of its instant.

        A sample of a part is a sample of what it is part of, once all parts have a value.
        """
        if signal not in self._samples:
            self._samples[signal] = list(self._made(signal))
        return self._samples[signal]

    def _made(self, signal: Signal) -> Iterator[tuple[int, Value]]:
        parts = self._origins.parts.get(signal)
        sources = (signal,) if parts is None else self._origins.sources(parts)
        for number, instant in enumerate(self._run):
            if not instant.has_news(sources):
                continue
            if parts is None:
                yield number, instant.taken[signal]
            elif (values := self.values(parts, number)) is not None:
                yield number, _computed(signal, values)

    def values(self, wanted: Iterable[Input], instant: int) -> dict[Input, Value] | None:
        """The values of the inputs at the instant; None if one has none yet."""
        found: dict[Input, Value] = {}
        for each in wanted:
            value = self._value(each, instant)
            if value is None:
                return None
            found[each] = value
        return found

    def _value(self, wanted: Input, instant: int) -> Value | None:
        signal = wanted.signal
        if self._origins.parts.get(signal) == ():
            return _computed(signal, {})
        samples = self.samples(signal)
        count = bisect_right(samples, instant, key=itemgetter(0))
        if count < _length(wanted):
            return None
        if isinstance(wanted, Slope):
            return self._slope(samples[count - 2], samples[count - 1])
        return samples[count - _length(wanted)][1]

    def _slope(self, before: tuple[int, Value], now: tuple[int, Value]) -> float:
        """The difference quotient over time, per second; NaN where no time has passed."""
        duration = self._run[now[0]].time - self._run[before[0]].time
        assert isinstance(now[1], float)
        assert isinstance(before[1], float)
        return math.nan if duration == 0 else calculate(Operator.OVER, now[1] - before[1], duration / 10**9)


def _computed(signal: Signal, values: Mapping[Input, Value]) -> Value:
    assert isinstance(signal.definition, Expression)
    return evaluate(signal.definition, values)
