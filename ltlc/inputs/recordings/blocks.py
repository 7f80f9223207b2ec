"""What every recording is read as: blocks of rows, by columns.

A row is what came in at once: in a bag one message, in a table of text a line. Blocks follow one another in the order
of the recording, and so do the rows in them; a reader makes them as large as it likes, and holds one at a time.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.rows import Column, RecordingError, Row
from ltlc.runtime.sampling import Value
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.expressions import ValueType

Places = NDArray[np.int64]
"""Numbers of rows of a block, ascending."""

Array = NDArray[Any]


MOST_ELEMENTS = 1 << 22
"""No array has more elements, and no string more bytes: the session holds each as objects, of 72 bytes at times."""


@dataclass(frozen=True, slots=True)
class Ragged:
    """Arrays of any lengths: the `elements` of all, one array after the other, and the `lengths`."""

    elements: Array
    lengths: Places

    def __len__(self) -> int:
        return len(self.lengths)

    def __getitem__(self, part: slice) -> Ragged:
        ends = np.concatenate(([0], np.cumsum(self.lengths)))
        return Ragged(self.elements[ends[part.start] : ends[part.stop]], self.lengths[part])

    def taken(self, places: Places) -> Ragged:
        """The arrays at `places`, in that order."""
        starts = self.lengths.cumsum() - self.lengths
        return Ragged(spans(self.elements, starts[places], self.lengths[places]), self.lengths[places])


def spans(elements: Array, starts: Places, lengths: Places) -> Array:
    """As many `elements` as each of the `lengths` says, from each of the `starts` on, side by side."""
    pairs = zip(starts.tolist(), (starts + lengths).tolist(), strict=True)
    parts = [elements[start:end] for start, end in pairs]
    return np.concatenate(parts) if parts else elements[:0]


@dataclass(frozen=True, slots=True)
class Samples:
    """The samples of a signal: in each of the `rows` one of the `values`.

    Numbers are float64, where they are integers of 64 bits int64 or uint64; booleans are bool, strings objects.
    """

    rows: Places
    values: Array | Ragged

    def between(self, first: int, end: int) -> Samples:
        """Those in the rows from `first` to before `end`, which are counted from there."""
        rows, part = _between(self.rows, first, end)
        return Samples(rows, self.values[part])

    def taken(self, places: Places) -> Samples:
        """The samples at `places`, in that order."""
        values = self.values.taken(places) if isinstance(self.values, Ragged) else self.values[places]
        return Samples(self.rows[places], values)

    def listed(self) -> list[Value]:
        """The values as the runtime has them, arrays as tuples."""
        if not isinstance(self.values, Ragged):
            listed: list[Value] = self.values.tolist()
            return listed
        elements = iter(self.values.elements.tolist())
        return [tuple(islice(elements, length)) for length in self.values.lengths.tolist()]


@dataclass(frozen=True, slots=True)
class Block:
    """Rows at `times`, in ns, which do not decrease.

    `samples` are by signal. A row in which a signal has a sample is a message on its topic; `messages` has, by topic,
    the rows that are one, where a reader knows of others that have no sample of anything.
    """

    times: NDArray[np.int64]
    samples: Mapping[str, Samples]
    messages: Mapping[str, Places]

    def between(self, since: Nanoseconds | None, until: Nanoseconds | None) -> Block:
        """The rows from the time `since` on, up to and including `until`; None is no limit."""
        first = 0 if since is None else int(self.times.searchsorted(since, "left"))
        end = len(self.times) if until is None else int(self.times.searchsorted(until, "right"))
        return self.part(first, end)

    def part(self, first: int, end: int) -> Block:
        """The rows from `first` to before `end`."""
        if first == 0 and end == len(self.times):
            return self
        samples = {name: of.between(first, end) for name, of in self.samples.items()}
        messages = {topic: _between(rows, first, end)[0] for topic, rows in self.messages.items()}
        return Block(self.times[first:end], samples, messages)

    def rows(
        self, wanted: Container[str]
    ) -> Iterator[tuple[Nanoseconds, tuple[str, ...], list[Value], tuple[str, ...]]]:
        """Each row: its time, those of the `wanted` signals that have samples, these, and the topics of `messages`."""
        count = len(self.times)
        names: list[tuple[str, ...]] = [()] * count
        topics: list[tuple[str, ...]] = [()] * count
        values: list[list[Value]] = [[] for _ in range(count)]
        for name, samples in self.samples.items():
            if name not in wanted:
                continue
            for row, value in zip(samples.rows.tolist(), samples.listed(), strict=True):
                names[row] += (name,)
                values[row].append(value)
        for topic, rows in self.messages.items():
            for row in rows.tolist():
                topics[row] += (topic,)
        return zip(self.times.tolist(), names, values, topics, strict=True)


def _between(rows: Places, first: int, end: int) -> tuple[Places, slice]:
    """Those of `rows` from `first` to before `end`, counted from there, and where they stand."""
    part = slice(int(rows.searchsorted(first)), int(rows.searchsorted(end)))
    return rows[part] - first, part


def joined(parts: Sequence[Samples]) -> Samples:
    """The samples of all `parts`, of which there is one at least; they are of one kind."""
    if len(parts) == 1:
        return parts[0]
    rows = np.concatenate([part.rows for part in parts])
    ragged = [part.values for part in parts if isinstance(part.values, Ragged)]
    if ragged:
        filled = [values.elements for values in ragged if len(values.elements)]  # of no elements the type is not known
        elements = np.concatenate(filled or [ragged[0].elements])
        return Samples(rows, Ragged(elements, np.concatenate([values.lengths for values in ragged])))
    return Samples(rows, np.concatenate([part.values for part in parts if not isinstance(part.values, Ragged)]))


ROWS = 1 << 16
"""How many rows of text a block has."""


def blocks_of(rows: Iterable[Row], columns: Mapping[str, Column]) -> Iterator[Block]:
    """`rows` by columns: of the signals in `columns`, which says what their values are.

    Raises RecordingError where `rows` do, after a block of those before it.
    """
    batch: list[Row] = []
    try:
        for row in rows:
            batch.append(row)
            if len(batch) == ROWS:
                yield _block(batch, columns)
                batch.clear()
    except RecordingError:
        yield _block(batch, columns)
        raise
    yield _block(batch, columns)


def _block(batch: Sequence[Row], columns: Mapping[str, Column]) -> Block:
    times = np.array([row.time for row in batch], np.int64)
    return Block(times, {name: _column(name, column, batch) for name, column in columns.items()}, {})


def _column(name: str, column: Column, batch: Sequence[Row]) -> Samples:
    having = [number for number, row in enumerate(batch) if name in row.values]
    return Samples(np.array(having, np.int64), packed([batch[number].values[name] for number in having], column))


def packed(values: Sequence[Value], column: Column) -> Array | Ragged:
    """`values` of a column side by side."""
    element = column.type.element
    if element is None:
        return np.array(values, kind_of(column))
    lengths = np.array([len(value) for value in values], np.int64)
    elements = [item for value in values for item in value]
    return Ragged(np.array(elements, kind_of(Column(element, column.numbers))), lengths)


def kind_of(column: Column) -> np.dtype[Any]:
    """How the values of a column are kept that are no arrays."""
    match column.type:
        case ValueType.BOOLEAN:
            return np.dtype(np.bool_)
        case ValueType.STRING:
            return np.dtype(object)
        case _ if column.numbers.is_wide:
            return np.dtype(np.int64 if column.numbers.least < 0 else np.uint64)
        case _:
            return np.dtype(np.float64)
