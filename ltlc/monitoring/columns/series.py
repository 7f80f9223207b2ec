"""The samples of a block, signal by signal, and what a property reads of them at each of its steps."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property, reduce
from typing import Any, cast

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Array, Block, Places, Ragged
from ltlc.monitoring.columns.arrays import ByStep, Views, held_once, views_after, views_of
from ltlc.monitoring.columns.bits import Mask, union
from ltlc.runtime.functions import divide
from ltlc.runtime.sampling import Excused, Input, New, Reading, Recent, Sampler, Slope, Value, Wanted
from ltlc.runtime.times import SECOND, seconds
from ltlc.specification.wire import EXACT


class UnsupportedError(Exception):
    """Columns do not support something, so rows are used; the message says what."""


Rows = Places | None
"""Numbers of rows of a block, ascending; None: all of them."""


@dataclass(frozen=True)
class Series:
    """The samples of a signal: `values` in the `rows` of a block, and the last ones before it, oldest first.

    In the rows `fresh` it, or a part of it, has a new sample.
    """

    rows: Rows
    values: Array | Views
    times: Places
    before: Sequence[Value]
    times_before: Sequence[int]
    fresh: Rows

    def __len__(self) -> int:
        return len(self.values)

    @cached_property
    def all(self) -> Array:
        """Those before the block and those in it."""
        assert not isinstance(self.values, Views)
        before = np.empty(len(self.before), self.values.dtype)
        before[:] = self.before
        return np.concatenate((before, self.values))

    @cached_property
    def arrays(self) -> ByStep:
        """Those before the block and those in it, of a signal whose values are arrays."""
        assert isinstance(self.values, Views)
        return held_once(views_after(self.before, self.values))

    @cached_property
    def all_times(self) -> Places:
        """The times of the samples in the block, after those known of the ones before."""
        return np.concatenate((np.array(self.times_before, np.int64), self.times))

    def value(self, number: int) -> Value:
        """A sample, counted from the first in the block; the one before that has the number -1."""
        if number < 0:
            return self.before[number]
        if isinstance(self.values, Views):
            return tuple(self.values[number : number + 1].packed().tolist())
        return cast("Value", self.values.item(number))

    def time(self, number: int) -> int:
        """The time of a sample, counted likewise."""
        return int(self.times[number]) if number >= 0 else self.times_before[number]

    def add_to(self, sampler: Sampler, name: str) -> None:
        """Add those of the samples in the block that are kept of the signal `name`: the last."""
        samples = sampler.samples[name]
        for number in range(max(0, len(self) - samples.depth), len(self)):
            samples.add(sampler.known, self.time(number), self.value(number))


class Columns:
    """A block, as the properties of a session read it. If `are_ticks`, its `messages` tell all the news there is."""

    def __init__(self, block: Block, sampler: Sampler, readings: Iterable[Reading], are_ticks: bool = False) -> None:
        self.times = block.times
        self.count = len(block.times)
        self._sampler = sampler
        self._are_ticks = are_ticks
        self._rows: list[Places] = []
        self.series = {reading.name: self._reading(block, reading) for reading in readings}
        self._messages = {topic: self.shared(rows) for topic, rows in block.messages.items()}
        self._steps: dict[Any, Steps] = {}
        self._lacking: dict[str, str] = {}
        self._heard: dict[str, Rows] = {}

    def _reading(self, block: Block, reading: Reading) -> Series:
        name, found = reading.name, block.samples.get(reading.name)
        if found is None:
            none, before = np.empty(0, np.int64), self._sampler.values(name)
            values = views_of(Ragged(np.empty(0), none)) if "array" in reading.type else _none_like(before)
            return self._series(none, values, name, none)
        rows = self.shared(found.rows)
        return self._series(rows, _as_read(found.values, reading), name, rows)

    def add(self, name: str, steps: Steps, values: Array, has_sample: Mask | None = None) -> None:
        """Add the signal `name`, which has one of the `values` at each of `steps`, or at those with `has_sample`."""
        rows = steps.base if not steps.first else self.shared(steps.rows())
        if has_sample is not None:
            rows, values = self.shared(steps.rows()[has_sample]), values[has_sample]
        self.series[name] = self._series(rows, values, name, steps.base)

    def add_constant(self, name: str) -> None:
        """Add a signal that is computed from nothing, and has always had its value."""
        none = np.empty(0, np.int64)
        self.series[name] = self._series(none, _none_like(self._sampler.values(name)), name, none)

    def lack(self, name: str, reason: str) -> None:
        """There is no column of the signal `name`, for this reason."""
        self._lacking[name] = reason

    def _series(self, rows: Rows, values: Array | Views, name: str, fresh: Rows) -> Series:
        times = self.times if rows is None else self.times[rows]
        samples, known = self._sampler.samples[name], self._sampler.known
        return Series(rows, values, times, samples.values(known)[::-1], samples.times(known)[::-1], fresh)

    def shared(self, rows: Places) -> Rows:
        """`rows`, the same object for equal ones; None for all."""
        if len(rows) == self.count:
            return None
        for known in self._rows:
            if known is rows or (len(known) == len(rows) and np.array_equal(known, rows)):
                return known
        self._rows.append(rows)
        return rows

    def together(self, parts: Iterable[Rows]) -> Rows:
        """The rows in any of the `parts`."""
        distinct: dict[int, Places] = {}
        for rows in parts:
            if rows is None:
                return None
            distinct[id(rows)] = rows
        if len(distinct) == 1:
            return next(iter(distinct.values()))
        return self.shared(union([np.empty(0, np.int64), *distinct.values()]))

    def number_of(self, rows: Rows) -> int:
        """How many rows these are."""
        return self.count if rows is None else len(rows)

    def listed(self, rows: Rows) -> Places:
        """These rows, one by one."""
        return np.arange(self.count) if rows is None else rows

    def messages(self, topic: str) -> Rows:
        """The rows with a message on `topic`."""
        read = () if self._are_ticks else self.series.items()
        of = (series.rows for name, series in read if self._sampler.topics[name] == {topic})
        return self.together([*of, self._messages.get(topic, np.empty(0, np.int64))])

    def steps(
        self,
        inputs: Sequence[Wanted],
        topics: Iterable[str] = (),
        also: Iterable[Rows] = (),
        excused: Iterable[Excused] = (),
    ) -> Steps:
        """The steps of what reads `inputs`, and the news of `topics`, and those at the rows `also`.

        Inputs that are `excused` are not waited for.
        """
        lacking = [self._lacking[i.signal] for i in inputs if i.signal in self._lacking]
        if lacking:
            raise UnsupportedError(lacking[0])
        read = [i for i in inputs if not isinstance(i, New)]
        fresh = [self.series[name].fresh for name in dict.fromkeys(i.signal for i in read)]
        base = self.together([*fresh, *map(self.messages, topics), *also])
        standing = self._standing(inputs, excused)
        first = max((self._first(base, i) for i in read if i.signal not in standing), default=0)
        key = id(base), first, frozenset(standing.items())
        if key not in self._steps:
            self._steps[key] = Steps(self, base, first, standing=standing)
        return self._steps[key]

    def _standing(self, inputs: Sequence[Wanted], excused: Iterable[Excused]) -> dict[str, Value]:
        """What stands in for signals without a value at first. Raises UnsupportedError."""
        found = {}
        for each in excused:
            name = inputs[each.place].signal
            if not self.series[name].before:
                if each.news:
                    self._require_values(name, [inputs[place].signal for place in each.news])
                found[name] = each.instead
        return found

    def _require_values(self, name: str, news: Iterable[str]) -> None:
        """No row before the first value of a signal has all `news` of it. Raises UnsupportedError."""
        rows = self.listed(self.series[name].rows)
        first = int(rows[0]) if len(rows) else self.count
        heard = (self.listed(self.heard(signal)) for signal in news)
        both = reduce(np.intersect1d, (rows[: rows.searchsorted(first)] for rows in heard))
        if len(both):
            raise UnsupportedError(f"messages without a value of {name} before the first with one")

    def release(self) -> None:
        """Let go of the steps, which refer to this: else what they know stays until a collector of garbage comes."""
        self._steps.clear()

    def _first(self, base: Rows, wanted: Input | Recent | Slope) -> int:
        """The first of the rows `base` at which there are as many samples as `wanted` looks at."""
        series = self.series[wanted.signal]
        missing = (1 if isinstance(wanted, Slope) else wanted.ago) + 1 - len(series.before)
        if missing <= 0:
            return 0
        if missing > len(series):
            return self.count if base is None else len(base)
        row = missing - 1 if series.rows is None else int(series.rows[missing - 1])
        return row if base is None else int(base.searchsorted(row))

    def heard(self, signal: str) -> Rows:
        """The rows in which there is a message on a topic of `signal`."""
        if signal not in self._heard:
            self._heard[signal] = self.together(map(self.messages, sorted(self._sampler.topics[signal])))
        return self._heard[signal]

    def last_heard(self, signal: str, end: int) -> int | None:
        """The last of these rows before the row `end`; None if there is none."""
        rows = self.heard(signal)
        before = end if rows is None else int(rows.searchsorted(end))
        if not before:
            return None
        return before - 1 if rows is None else int(rows[before - 1])


@dataclass(frozen=True)
class Steps:
    """Steps at the rows `base`, from the one with the number `first` on: at each of them all that is read has a value.

    All but what is in `standing`: until there is one, that stands in for the value. `known` has what was computed.
    """

    columns: Columns
    base: Rows
    first: int
    known: dict[Any, Any] = field(default_factory=dict)
    standing: Mapping[str, Value] = field(default_factory=dict)

    def __len__(self) -> int:
        return (self.columns.count if self.base is None else len(self.base)) - self.first

    def rows(self) -> Places:
        """The row of each."""
        return np.arange(self.first, self.columns.count) if self.base is None else self.base[self.first :]

    def row(self, step: int) -> int:
        """The row of one of them, counted from 0."""
        return self.first + step if self.base is None else int(self.base[self.first + step])

    def time(self, step: int) -> int:
        """The time of one of them."""
        return int(self.columns.times[self.row(step)])

    @cached_property
    def times(self) -> Places:
        """The time of each."""
        return self.columns.times[self.first :] if self.base is None else self.columns.times[self.rows()]

    def _series(self, wanted: Input | Recent | Slope) -> Series:
        """The samples of a signal, after what stands in for the first."""
        series = self.columns.series[wanted.signal]
        if wanted.signal not in self.standing:
            return series
        before = (self.standing[wanted.signal],)
        has_kind = len(series) or isinstance(series.values, Views)
        values = series.values if has_kind else _none_like(before)
        return replace(series, values=values, before=before, times_before=(0,))

    def is_array(self, wanted: Wanted) -> bool:
        """Whether `wanted` is an array at each of them."""
        is_array = not isinstance(wanted, New) and isinstance(self.columns.series[wanted.signal].values, Views)
        return is_array or isinstance(wanted, Recent)

    def column(self, wanted: Wanted) -> Array:
        """What `wanted` is at each of them. Raises UnsupportedError for an array."""
        if isinstance(wanted, New):
            return self._news(wanted)
        series = self._series(wanted)
        if isinstance(series.values, Views) or isinstance(wanted, Recent):
            raise UnsupportedError("an array")
        if isinstance(wanted, Slope):
            return self._slopes(series)
        if series.rows is not self.base:
            return series.all.take(self._numbers(series) - wanted.ago + len(series.before))
        start = self.first - wanted.ago
        if start >= 0:
            return series.values[start : len(series) - wanted.ago]
        shift = len(series.before) - wanted.ago
        return series.all[shift + self.first : shift + len(series)]

    def arrays(self, wanted: Input | Recent) -> ByStep:
        """The array that `wanted` is at each of them."""
        series = self._series(wanted)
        if isinstance(wanted, Recent):
            latest = self._numbers(series) + len(series.before)
            return held_once(Views(series.all, np.full(len(latest), wanted.ago + 1), latest - wanted.ago))
        found = series.arrays
        return ByStep(found.arrays, found.numbers.take(self._numbers(series) - wanted.ago + len(series.before)))

    def _news(self, wanted: New) -> Mask:
        if wanted not in self.known:
            heard = self.columns.heard(wanted.signal)
            mask = np.zeros(self.columns.count, np.bool_)
            mask[slice(None) if heard is None else heard] = True
            self.known[wanted] = mask[self.first :] if self.base is None else mask[self.rows()]
        news: Mask = self.known[wanted]
        return news

    def _numbers(self, series: Series) -> Places:
        """The number of the sample that is the latest at each step; negative: before the block."""
        if series.rows is self.base:
            return np.arange(self.first, len(series))
        return self.rows() if series.rows is None else series.rows.searchsorted(self.rows(), "right") - 1

    def _slopes(self, series: Series) -> Array:
        numbers = self._numbers(series)
        places, at = numbers + len(series.before), numbers + len(series.times_before)
        duration = series.all_times[at] - series.all_times[at - 1]
        if len(duration) and (duration > EXACT).any():
            raise UnsupportedError("a slope over more than a hundred days")
        with np.errstate(all="ignore"):
            slopes = (series.all[places] - series.all[places - 1]) / (duration / SECOND)
        slopes[duration == 0] = np.nan
        return slopes

    def value(self, wanted: Wanted, step: int) -> Value:
        """What `wanted` is at one of them, as the runtime has it."""
        if isinstance(wanted, New):
            return bool(self._news(wanted)[step])
        row = self.row(step)
        series = self.columns.series[wanted.signal]
        number = row if series.rows is None else int(series.rows.searchsorted(row, "right")) - 1
        if number < 0 and wanted.signal in self.standing:
            return None
        if isinstance(wanted, Input):
            return series.value(number - wanted.ago)
        if isinstance(wanted, Recent):
            return tuple(series.value(n) for n in range(number - wanted.ago, number + 1))
        duration = series.time(number) - series.time(number - 1)
        change = series.value(number) - series.value(number - 1)
        return divide(change, seconds(duration)) if duration else np.nan


@dataclass(frozen=True)
class Given(Steps):
    """Some of the steps, or elements at them: `count`, of which is `known` what is read."""

    count: int = 0

    def __len__(self) -> int:
        return self.count


def _as_read(values: Array | Ragged, reading: Reading) -> Array | Views:
    """`values` in the form in which samples are kept."""
    if isinstance(values, Ragged):
        arrays = values if isinstance(values, Views) else views_of(values)
        return replace(arrays, elements=_doubles(values.elements)) if "numbers" in reading.type else arrays
    if reading.type == "boolean":
        return values.astype(np.bool_, copy=False)
    return _doubles(values) if reading.type == "number" else values


def _doubles(values: Array) -> Array:
    return values.astype(np.float64, copy=False)


def _none_like(values: Sequence[Value]) -> Array:
    """No values, of the kind of `values`."""
    match values:
        case []:
            return np.empty(0)
        case [bool(), *_]:
            return np.empty(0, np.bool_)
        case [int(), *_]:
            return np.empty(0, np.int64 if max(values) <= np.iinfo(np.int64).max else np.uint64)
        case [float(), *_]:
            return np.empty(0)
        case _:
            return np.empty(0, object)
