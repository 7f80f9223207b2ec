"""What the ticks of a session with a rate see of a block of rows: a block of ticks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ltlc.inputs.recordings.blocks import Array, Block, Places, Samples
from ltlc.monitoring.columns.arrays import Views, views_after
from ltlc.monitoring.columns.series import Columns, Series
from ltlc.runtime.sampling import Value
from ltlc.runtime.ticks import Ticks

MOST = 1 << 20
"""So many ticks a block can always have; more only if it has as many rows."""


def times_of(ticks: Ticks, before: int) -> Places:
    """When the ticks come that are due before a time."""
    numbers = np.arange(ticks.count, ticks.count + ticks.before(before), dtype=np.int64)
    whole, part = divmod(ticks.period.numerator, ticks.period.denominator)
    largest = max(whole, part) * (int(numbers[-1]) + 1 if len(numbers) else 1)
    # Number by number if something does not fit into 64 bits.
    if max(largest, ticks.period.denominator) >= 1 << 62:
        return np.array([ticks.at(number) for number in numbers.tolist()], np.int64)
    return ticks.start + numbers * whole + numbers * part // ticks.period.denominator


def block_of(columns: Columns, times: Places, latest: Mapping[str, Value], heard: Mapping[str, bool]) -> Block:
    """The ticks at `times`; before the rows of `columns` came the `latest` values, and were some topics `heard`."""
    samples = {
        name: _samples(series, times, [latest[name]] if name in latest else [])
        for name, series in columns.series.items()
    }
    return Block(times, samples, {topic: _heard(columns, topic, times, was) for topic, was in heard.items()})


def _samples(series: Series, times: Places, latest: Sequence[Value]) -> Samples:
    """At each tick from the first on that there is one, the last sample up to its time."""
    numbers = series.times.searchsorted(times, "right") + len(latest) - 1
    first = int(numbers.searchsorted(0))
    rows = np.arange(first, len(times))
    if isinstance(series.values, Views):
        return Samples(rows, views_after(latest, series.values).taken(numbers[first:]))
    return Samples(rows, _after(latest, series.values).take(numbers[first:]))


def _after(latest: Sequence[Value], values: Array) -> Array:
    return np.concatenate((np.array(latest, values.dtype), values)) if len(values) else _like(latest)


def _like(values: Sequence[Value]) -> Array:
    is_text = any(isinstance(value, str) for value in values)
    return np.array(values, object if is_text else None)


def _heard(columns: Columns, topic: str, times: Places, was_heard: bool) -> Places:
    """The ticks before which there were messages on `topic`, since the one before."""
    ticks = np.unique(times.searchsorted(columns.times[columns.listed(columns.messages(topic))], "left"))
    ticks = ticks[ticks < len(times)]
    return np.unique(np.concatenate(([0], ticks))) if was_heard and len(times) else ticks


class Seen:
    """Which messages ticks have seen: `counts` by topic; and those that wait for one, by what they are the last of."""

    def __init__(self, times: Places, waiting: Mapping[str, tuple[str, int]]) -> None:
        """There are ticks at `times`, for the first of which messages are `waiting`."""
        self._ticks = times
        self._before = waiting
        self.counts: dict[str, int] = {}
        self.waiting: dict[str, tuple[str, int]] = {}

    def add(self, topic: str, columns: Columns, names: Sequence[str], taken: int) -> None:
        """The messages on `topic`, of which signals `names` are read, after the `taken` ones before the block."""
        rows = columns.listed(columns.messages(topic))
        keys = {topic: rows, **{name: columns.listed(columns.series[name].rows) for name in names}}
        pairs = [
            self._last(key, topic, columns.times[of], rows.searchsorted(of) + taken + 1) for key, of in keys.items()
        ]
        self.counts[topic] = len(np.unique(np.concatenate(pairs), axis=0))

    def _last(self, key: str, topic: str, times: Places, numbers: Places) -> Places:
        """Ticks, and the number of the message that is the last of `key` before each; what is after all ticks waits."""
        ticks = self._ticks
        if key in self._before and (not len(ticks) or not len(times) or times[0] > ticks[0]):
            times = np.concatenate((ticks[:1] if len(ticks) else times[:1] if len(times) else [0], times))
            numbers = np.concatenate(([self._before[key][1]], numbers))
        at = ticks.searchsorted(times, "left")
        is_last = np.append(at[1:] != at[:-1], True)[: len(at)]
        at, numbers = at[is_last], numbers[is_last]
        if len(at) and at[-1] == len(ticks):
            self.waiting[key] = topic, int(numbers[-1])
            at, numbers = at[:-1], numbers[:-1]
        return np.stack((at, numbers), axis=1)
