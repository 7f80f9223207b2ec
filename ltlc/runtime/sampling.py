"""Samples of signals: what came in last, what came before, what is computed from it."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Sequence
from math import isnan
from operator import itemgetter
from typing import Any

from ltlc.dataclass import dataclass
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
class Recent:
    """The samples of `signal` from `ago` of them ago to the latest, oldest first."""

    signal: str
    ago: int

    def __str__(self) -> str:
        return f"@{{{self.signal}, -{self.ago}:}}"


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


Wanted = Input | Recent | Slope | New
"""What a property or a signal is computed from."""


@dataclass(frozen=True, slots=True)
class Excused:
    """An input of a property that does not wait for it, by its place.

    As long as it has no value, it is `instead`. Where it has `news`, at these places,
    it makes no difference without it; the `conditions` with these numbers read it.
    """

    place: int
    news: tuple[int, ...]
    instead: Value
    conditions: tuple[int, ...] = ()


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
    """A signal that is computed from others: `compute` of the values of `inputs`.

    With `when`, it has samples only where that holds of them.
    """

    name: str
    inputs: tuple[Wanted, ...]
    compute: Callable[..., Value]
    when: Callable[..., bool] | None = None


class Samples:
    """Where the last samples of one signal stand in a list of all that is `known`.

    There are so many values, from the place `first` on, the latest first; None where
    there is none yet. What is `looked_at` as an array stands there, too, and the slope
    of the signal, with the times of two samples; without that, no times are kept.
    """

    __slots__ = ("_arrays", "_slope", "_times", "depth", "first")

    def __init__(self, known: list[Value], looked_at: Collection[Wanted]) -> None:
        """Have places at the end of the list, which grows."""
        depth = max([1, *map(_reach, looked_at)])
        self.depth, self.first = depth, len(known)
        known += [None] * depth
        self._arrays: dict[int, int] = {}
        for wanted in looked_at:
            if isinstance(wanted, Recent) and wanted.ago not in self._arrays:
                self._arrays[wanted.ago] = len(known)
                known.append(None)
        has_slope = any(isinstance(wanted, Slope) for wanted in looked_at)
        self._slope, self._times = (len(known), len(known) + 1) if has_slope else (0, 0)
        known += [None, ()] * has_slope

    def values(self, known: list[Value]) -> list[Value]:
        """Those that there are, the latest first."""
        kept = known[self.first : self.first + self.depth]
        return [value for value in kept if value is not None]

    def times(self, known: list[Value]) -> tuple[int, ...]:
        """Those of the last two, the latest first, if the slope is looked at."""
        found: tuple[int, ...] = known[self._times] if self._times else ()
        return found

    def place(self, wanted: Input | Recent | Slope) -> int:
        """Where the value of `wanted`, which is of this signal, stands."""
        if isinstance(wanted, Input):
            return self.first + wanted.ago
        return self._arrays[wanted.ago] if isinstance(wanted, Recent) else self._slope

    def add(self, known: list[Value], time: int, value: Value) -> None:
        """Take a sample; NaN is one."""
        first = self.first
        del known[first + self.depth - 1]
        known.insert(first, value)
        for ago, place in self._arrays.items():
            if known[first + ago] is not None:
                known[place] = tuple(known[first : first + ago + 1][::-1])
        if not self._times:
            return
        known[self._times] = times = (time, *known[self._times][:1])
        if len(times) > 1:
            known[self._slope] = _slope(value - known[first + 1], *times)


def _slope(change: float, last: int, before: int) -> float:
    """Per second; NaN between samples of the same time."""
    return divide(change, seconds(last - before)) if last != before else math.nan


class Window:
    """What is looked at of some signals: the values of `inputs`, in their order.

    Those are samples of `signals`; of `topics` it wants to know the news only. All of
    it comes from the topics `read`. Of the `values` of what is known one that is
    missing is None; what has a value once, keeps one. If there is only one input, its
    value stands at `place`, which is -1 otherwise.
    """

    __slots__ = ("inputs", "place", "read", "signals", "topics", "values")

    def __init__(self, inputs: Iterable[Wanted], sampler: Sampler) -> None:
        self.inputs = tuple(inputs)
        new = [i.signal for i in self.inputs if isinstance(i, New)]
        self.topics = frozenset().union(*(sampler.topics[name] for name in new))
        self.signals = frozenset(
            i.signal for i in self.inputs if not isinstance(i, New)
        )
        of_signals = (sampler.topics[name] for name in self.signals)
        self.read = self.topics.union(*of_signals)
        places = [sampler.place(wanted) for wanted in self.inputs]
        self.place = places[0] if len(places) == 1 else -1
        self.values = _taker(places)


def _taker(places: Sequence[int]) -> Callable[[list[Value]], Sequence[Value]]:
    """What takes the values at some places of a list."""
    if len(places) > 1:
        return itemgetter(*places)
    # Of one place, `itemgetter` would give no sequence.
    return (lambda known: (known[places[0]],)) if places else (lambda known: ())


Computed = tuple[Samples, Callable[..., Value], Window, Callable[..., bool] | None]
"""Where samples go to, how they are computed, of what, and when if not always."""


@dataclass(frozen=True, slots=True)
class Update:
    """What new samples of some readings lead to, `fresh` being all that may have one.

    Samples go, by the place of their value, to places in the list of all that is known
    if only the latest is ever looked at (`plain`), else to others (`deep`). `arrays`
    are those of numbers; `derived` are those that are computed.
    """

    fresh: frozenset[str]
    plain: tuple[tuple[int, int], ...]
    deep: tuple[tuple[int, Samples], ...]
    arrays: tuple[tuple[int, str], ...]
    derived: tuple[Computed, ...]

    def take(self, known: list[Value], time: int, values: Sequence[Value]) -> None:
        """Add samples of the readings and of all that is computed from them."""
        for place, target in self.plain:
            known[target] = values[place]
        if self.deep or self.derived:
            self.take_more(known, time, values)

    def take_more(self, known: list[Value], time: int, values: Sequence[Value]) -> None:
        """Add those that are computed, or of which more than the latest is kept."""
        for place, samples in self.deep:
            samples.add(known, time, values[place])
        for samples, compute, window, when in self.derived:
            parts = window.values(known)
            if None not in parts and (when is None or when(*parts)):
                samples.add(known, time, compute(*parts))


class Sampler:
    """The samples of all signals; a sample of a part is one of what it is part of.

    What is `known` of them is a list; others with the same places can be kept beside.
    """

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
        looked_at = [*inputs, *(i for s in derived for i in s.inputs)]
        self.topics = topics_of(signals)
        self.not_measured = dict.fromkeys(
            (s.name for s in readings if s.type == "array of numbers"), 0
        )
        self._conversions = {s.name: _CONVERSIONS[s.type] for s in readings}
        by_signal: dict[str, list[Wanted]] = {s.name: [] for s in signals}
        for wanted in looked_at:
            by_signal[wanted.signal].append(wanted)
        self.known: list[Value] = []
        self.samples = {n: Samples(self.known, of) for n, of in by_signal.items()}
        self.reach = sum(each.depth - 1 for each in self.samples.values())
        self._news: dict[str, int] = {}
        self._news_of: dict[str, list[int]] = {}
        self.heard: tuple[int, ...] = ()
        for name in dict.fromkeys(i.signal for i in looked_at if isinstance(i, New)):
            self._news[name] = len(self.known)
            for topic in self.topics[name]:
                self._news_of.setdefault(topic, []).append(len(self.known))
            self.known.append(False)
        self._derived = [
            (s.name, (self.samples[s.name], s.compute, self.window(s.inputs), s.when))
            for s in derived
            if s.inputs
        ]
        self._wholes: dict[str, list[int]] = {}
        self._by_news: dict[str, list[int]] = {}
        for place, (_, (_, _, window, _)) in enumerate(self._derived):
            for part in window.signals:
                self._wholes.setdefault(part, []).append(place)
            for topic in window.topics:
                self._by_news.setdefault(topic, []).append(place)
        self._updates: dict[tuple[tuple[str, ...], frozenset[str]], Update] = {}
        for signal in derived:
            if not signal.inputs:
                self._hold(self.samples[signal.name], signal.compute())

    def _hold(self, samples: Samples, constant: Value) -> None:
        """A signal that is computed from nothing has always had its value."""
        for _ in range(samples.depth):
            samples.add(self.known, 0, constant)

    def window(self, inputs: Iterable[Wanted]) -> Window:
        """A look at `inputs`."""
        return Window(inputs, self)

    def place(self, wanted: Wanted) -> int:
        """Where the value of `wanted` stands among all values."""
        if isinstance(wanted, New):
            return self._news[wanted.signal]
        return self.samples[wanted.signal].place(wanted)

    def values(self, name: str) -> list[Value]:
        """The last samples of a signal, the latest first."""
        return self.samples[name].values(self.known)

    def news(self, topics: Iterable[str]) -> tuple[int, ...]:
        """The places of what is new where messages come in on `topics`."""
        return tuple(p for topic in topics for p in self._news_of.get(topic, ()))

    def hear(self, news: tuple[int, ...]) -> None:
        """What stands at these places is new, and nothing else."""
        mark(self.known, self.heard, is_new=False)
        mark(self.known, news, is_new=True)
        self.heard = news

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

    def count(self, arrays: Iterable[tuple[int, str]], values: Sequence[Value]) -> None:
        """Count the elements that are NaN of `arrays`, whose values have places."""
        for place, name in arrays:
            if not sum(values[place]) <= math.inf:
                self.not_measured[name] += sum(map(isnan, values[place]))

    def take(
        self,
        time: int,
        names: tuple[str, ...],
        values: Sequence[Value],
        topics: frozenset[str],
    ) -> frozenset[str]:
        """Add samples of the readings `names` and of all that is computed from them.

        There may be messages on `topics`. Returns the names of the signals that have a
        new sample, or have none at all.
        """
        update = self.update(names, topics)
        update.take(self.known, time, values)
        return update.fresh

    def update(self, names: tuple[str, ...], topics: frozenset[str]) -> Update:
        """What samples of `names` and news on `topics` lead to; found once."""
        if (names, topics) not in self._updates:
            self._updates[names, topics] = self._update(names, topics)
        return self._updates[names, topics]

    def _update(self, names: tuple[str, ...], topics: frozenset[str]) -> Update:
        places = {n for topic in topics for n in self._by_news.get(topic, ())}
        fresh = [*names, *(self._derived[place][0] for place in places)]
        for name in fresh:
            more = [n for n in self._wholes.get(name, ()) if n not in places]
            places.update(more)
            fresh += [self._derived[place][0] for place in more]
        readings = list(enumerate(self.samples[name] for name in names))
        return Update(
            frozenset(fresh),
            tuple((place, of.first) for place, of in readings if of.depth == 1),
            tuple((place, of) for place, of in readings if of.depth > 1),
            tuple((p, n) for p, n in enumerate(names) if n in self.not_measured),
            tuple(self._derived[place][1] for place in sorted(places)),
        )


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


def mark(known: list[Value], news: tuple[int, ...], *, is_new: bool) -> None:
    """Whether what stands at these places of what is known is new."""
    for place in news:
        known[place] = is_new


def topics_of(signals: Iterable[Reading | Derived]) -> dict[str, frozenset[str]]:
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
    if isinstance(wanted, Input | Recent):
        return wanted.ago + 1
    return 2 if isinstance(wanted, Slope) else 0
