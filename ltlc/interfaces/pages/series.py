"""The values of expressions over a run, collected from its blocks: few enough to be drawn, and no spike is lost."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltlc.backends.python.load import load_function
from ltlc.inputs.recordings.blocks import Block, Ragged, Samples
from ltlc.runtime.functions import divide
from ltlc.runtime.sampling import Value
from ltlc.runtime.times import SECOND, seconds
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.evaluation import sample
from ltlc.specification.expressions import Current, Expression, Field, New, Past, Read, Recent, Signal, Slope, reads
from ltlc.specification.specification import fields, topics_of

Times = NDArray[np.int64]
Numbers = NDArray[np.float64]

MOST_NAMES = 200
"""At most so many different strings of one expression are distinguished."""


class Series:
    """The values of an expression over time, at most about `most` of them.

    While there are more, what repeats the value before it is left out, and then, of each so many samples that follow
    one another, all but the first, the least, the greatest, the last, one that is not a number, and those where one of
    the `levels` is crossed first and last. `bucket` is how many that are at most, 1 if nothing was lost. `names` has
    the strings that the values stand for, if they are no numbers.
    """

    def __init__(self, most: int, levels: Iterable[float] = ()) -> None:
        self.count = 0
        self.bucket = 1
        self.names: dict[str, int] = {}
        self._most = max(most, 16)
        self._levels = np.array(sorted(set(levels)), np.float64)
        self._times: list[Times] = []
        self._values: list[Numbers] = []
        self._kept = 0

    def add(self, times: Times, values: NDArray[Any]) -> None:
        """Take samples, later than those before them."""
        if len(times):
            self.count += len(times)
            self._kept += len(times)
            self._times.append(times)
            self._values.append(self._numbers(values))
            if self._kept > 2 * self._most:
                self._thin()

    def samples(self) -> tuple[Times, Numbers]:
        """The times and the values that are left."""
        if self._kept > self._most:
            self._thin()
        return self._joined()

    def _joined(self) -> tuple[Times, Numbers]:
        times = np.concatenate([np.empty(0, np.int64), *self._times])
        return times, np.concatenate([np.empty(0), *self._values])

    def _numbers(self, values: NDArray[Any]) -> Numbers:
        if values.dtype != object:
            return values.astype(np.float64)
        codes = [self.names.setdefault(str(value), len(self.names)) for value in values.tolist()]
        return np.minimum(np.array(codes, np.float64), MOST_NAMES)

    def _thin(self) -> None:
        times, values = self._joined()
        keep = _changing(values)
        if keep.sum() > self._most:
            size = -(-5 * len(values) // self._most)
            keep = _outermost(values, size) | _crossing(self._sides(values), size)
            self.bucket *= size
        self._times, self._values = [times[keep]], [values[keep]]
        self._kept = len(self._times[0])

    def _sides(self, values: Numbers) -> NDArray[np.int64]:
        """Between which levels each value is, or on which; another number for NaN."""
        sides = self._levels.searchsorted(values, "left") + self._levels.searchsorted(values, "right")
        return np.where(np.isnan(values), -1, sides)


def _changing(values: Numbers) -> NDArray[np.bool_]:
    """Which differ from the one before; the first and the last do."""
    keep = np.ones(len(values), np.bool_)
    before, after = values[:-2], values[1:-1]
    keep[1:-1] = (before != after) & ~(np.isnan(before) & np.isnan(after))
    return keep


def _outermost(values: Numbers, size: int) -> NDArray[np.bool_]:
    """Of each `size` that follow one another: the first, least, greatest and last, and one that is NaN."""
    starts = np.arange(0, len(values), size)
    padded = np.pad(values, (0, len(starts) * size - len(values)), mode="edge").reshape(-1, size)
    is_nan = np.isnan(padded)
    columns = [
        np.zeros(len(starts), np.int64),
        np.full(len(starts), size - 1),
        np.where(is_nan, np.inf, padded).argmin(axis=1),
        np.where(is_nan, -np.inf, padded).argmax(axis=1),
        is_nan.argmax(axis=1),
    ]
    keep = np.zeros(len(values), np.bool_)
    for column in columns:
        keep[np.minimum(starts + column, len(values) - 1)] = True
    return keep


def _crossing(sides: NDArray[np.int64], size: int) -> NDArray[np.bool_]:
    """Of each `size` that follow one another: the two of different sides that come first, and that come last."""
    differs = np.zeros(-(-len(sides) // size) * size, np.bool_)
    differs[1 : len(sides)] = sides[1:] != sides[:-1]
    rows = differs.reshape(-1, size)
    starts = np.flatnonzero(rows.any(axis=1))
    keep = np.zeros(len(sides), np.bool_)
    for column in (rows[starts].argmax(axis=1), size - 1 - rows[starts, ::-1].argmax(axis=1)):
        keep[starts * size + column] = True
        keep[starts * size + column - 1] = True
    return keep


_History = tuple[list[Value], list[Nanoseconds]]
"""The last samples of a signal, and their times."""

_Computation = tuple[tuple[Read, ...], Callable[..., Value]]
"""What an expression reads, and the function of it that gives its value."""


class Collector:
    """Collects the values of expressions from the blocks of one recording, as they were judged.

    `series` has those of each, at most about `most`; `wanted` says which levels matter for each.
    """

    def __init__(self, wanted: Mapping[Expression, Iterable[float]], most: int) -> None:
        self.series = {expression: Series(most, levels) for expression, levels in wanted.items()}
        self._reach = max(map(_reach, self.series), default=0)
        self._compute: dict[Expression, _Computation] = {}
        self._before: dict[str, _History] = {}
        self._heard: dict[str, Nanoseconds] = {}

    def take(self, block: Block) -> None:
        """Take the next block."""
        reader = _Reader(block, self._compute, self._before)
        for expression, series in self.series.items():
            samples = reader.of(expression)
            times = block.times[samples.rows]
            if isinstance(expression, New):
                series.add(times, self._gaps(expression.signal.name, times))
            elif not isinstance(samples.values, Ragged):
                series.add(times, samples.values)
        self._before |= reader.last(self._reach + 1)

    def _gaps(self, name: str, times: Times) -> Numbers:
        """Of messages, how long before each, in s, the one before it came; NaN of the first."""
        before = self._heard.get(name)
        gaps = np.diff(times, prepend=times[:1] if before is None else before) / SECOND
        if len(times):
            gaps[0] = math.nan if before is None else gaps[0]
            self._heard[name] = int(times[-1])
        return gaps


def sampled(blocks: Iterable[Block], signals: Sequence[Signal]) -> Iterator[tuple[Block, dict[str, Samples]]]:
    """Blocks with the samples of `signals` in them, also of those that are computed from what is recorded."""
    compute: dict[Expression, _Computation] = {}
    before: dict[str, _History] = {}
    reach = max((_reach(Current(signal)) for signal in signals), default=0)
    for block in blocks:
        reader = _Reader(block, compute, before)
        yield block, {signal.name: reader.of(Current(signal)) for signal in signals}
        before |= reader.last(reach + 1)


def _reach(expression: Expression) -> int:
    """How many samples ago what `expression` is computed from may be."""
    reaches = [0]
    for read in reads(expression):
        ago = read.samples if isinstance(read, Past | Recent) else 1
        definition, when = read.signal.definition, read.signal.when
        parts = [] if isinstance(definition, Field) else [definition, *(when.sides if when else ())]
        reaches.append(max([ago, *map(_reach, parts)]))
    return max(reaches)


_NONE = Samples(np.empty(0, np.int64), np.empty(0))


class _Reader:
    """The values of expressions in one block; `before` has the last samples of signals before it."""

    def __init__(
        self,
        block: Block,
        compute: dict[Expression, _Computation],
        before: dict[str, _History],
    ) -> None:
        self._block = block
        self._compute = compute
        self._before = before
        self._found: dict[str, Samples] = {}
        self._listed: dict[str, _History] = {}

    def of(self, expression: Expression) -> Samples:
        """The values of `expression` at the rows at which something that it reads has a sample, once all has one."""
        if isinstance(expression, Current):
            return self._signal(expression.signal)
        if isinstance(expression, New):
            rows = self._messages(expression.signal)
            return Samples(rows, np.ones(len(rows)))
        return self._computed(expression)

    def last(self, count: int) -> dict[str, _History]:
        """So many samples, the last ones, of each signal that something is computed from."""
        return {name: (values[-count:], times[-count:]) for name, (values, times) in self._listed.items()}

    def _signal(self, signal: Signal) -> Samples:
        if signal.name not in self._found:
            given = self._block.samples.get(signal.name)
            if given is None and not isinstance(signal.definition, Field):
                given = self._computed(signal.definition) if signal.when is None else self._latched(signal)
            self._found[signal.name] = given or _NONE
        return self._found[signal.name]

    def _messages(self, signal: Signal) -> NDArray[np.int64]:
        """The rows in which there is a message that `signal` is read from."""
        rows = [self._block.messages.get(topic, _NONE.rows) for topic in topics_of(signal)]
        parts = [self._signal(part).rows for part, _ in fields(signal)]
        return np.unique(np.concatenate([self._signal(signal).rows, *parts, *rows]))

    def _computed(self, expression: Expression) -> Samples:
        if expression not in self._compute:
            wanted = tuple(dict.fromkeys(reads(expression)))
            self._compute[expression] = wanted, load_function(expression, wanted)
        wanted, function = self._compute[expression]
        if not wanted:
            return _NONE
        rows, aligned = self._side_by_side(wanted)
        return Samples(rows, _packed([function(*row) for row in aligned]))

    def _latched(self, signal: Signal) -> Samples:
        """The values of a signal that has samples only where something holds."""
        rows, aligned = self._side_by_side(signal.inputs)
        found = [sample(signal, dict(zip(signal.inputs, row, strict=True))) for row in aligned]
        has_sample = np.array([value is not None for value in found], np.bool_)
        return Samples(rows[has_sample], _packed([value for value in found if value is not None]))

    def _side_by_side(self, wanted: Sequence[Read]) -> tuple[NDArray[np.int64], Iterator[tuple[Value, ...]]]:
        """The rows at which something of what is read has a sample, once all has one, and the values there."""
        rows = np.unique(np.concatenate([self._rows(read) for read in wanted]))
        columns = [self._column(read, rows) for read in wanted]
        first = max(start for start, _ in columns)
        return rows[first:], zip(*(column[first - start :] for start, column in columns), strict=True)

    def _rows(self, read: Read) -> NDArray[np.int64]:
        return self._messages(read.signal) if isinstance(read, New) else self._signal(read.signal).rows

    def _column(self, read: Read, rows: NDArray[np.int64]) -> tuple[int, list[Value]]:
        """What is read at each of `rows`, from that one on at which there is a value."""
        if isinstance(read, New):
            return 0, np.isin(rows, self._messages(read.signal)).tolist()
        samples = self._signal(read.signal)
        earlier, earlier_times = self._before.get(read.signal.name, ([], []))
        if read.signal.name not in self._listed:
            times = self._block.times[samples.rows].tolist()
            self._listed[read.signal.name] = ([*earlier, *samples.listed()], [*earlier_times, *times])
        values, times = self._listed[read.signal.name]
        reach = read.samples if isinstance(read, Past | Recent) else int(isinstance(read, Slope))
        places = len(earlier) - 1 + np.searchsorted(samples.rows, rows, "right")
        start = int(np.searchsorted(places, reach))
        at = places[start:].tolist()
        if isinstance(read, Slope):
            return start, [_slope(values, times, place) for place in at]
        if isinstance(read, Recent):
            return start, [tuple(values[place - reach : place + 1]) for place in at]
        return start, [values[place - reach] for place in at]


def _slope(values: Sequence[Value], times: Sequence[Nanoseconds], place: int) -> float:
    """Per second, as the runtime computes it."""
    duration = times[place] - times[place - 1]
    return divide(values[place] - values[place - 1], seconds(duration)) if duration else math.nan


def _packed(values: list[Value]) -> NDArray[Any]:
    is_text = bool(values) and isinstance(values[0], str)
    return np.array(values, object if is_text else np.float64)
