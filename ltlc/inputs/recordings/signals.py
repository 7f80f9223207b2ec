"""Which columns of a table signals are read from.

An array is a column, or one for each element: `scan[0]`, `scan[1]`, …; an element is a column, or one of an array's.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property, reduce
from pathlib import Path
from typing import Protocol

import numpy as np

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.nearest import did_you_mean, nearest_first
from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Block, Places, Ragged, Samples, kind_of
from ltlc.inputs.recordings.fence import fenced
from ltlc.inputs.recordings.heads import Spelling, array_and_index, spellings
from ltlc.inputs.recordings.reading import Stamp
from ltlc.inputs.recordings.rows import Column, RecordingError, failure
from ltlc.runtime.sampling import Value
from ltlc.runtime.times import seconds_text
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.expressions import Signal, ValueType
from ltlc.specification.specification import topics_of


class Table(Protocol):
    """A recording in columns that have heads."""

    @property
    def heads(self) -> tuple[str, ...]:
        """The heads of its columns, but that of the times."""
        ...

    def blocks(self, columns: Mapping[str, Column]) -> Iterator[Block]:
        """The rows, in the order of the file, of these columns, samples by heads. Raises RecordingError after them."""
        ...


class _HoleError(Exception):
    """In a row, an element of an array is missing, and a later one is there."""

    def __init__(self, row: int, missing: str, last: str) -> None:
        self.row = row
        self.message = f"`{missing}` is empty, but `{last}` is not"


@dataclass(frozen=True, slots=True)
class _Own:
    """A signal is read from its own column."""

    head: str
    column: Column

    @property
    def columns(self) -> dict[str, Column]:
        return {self.head: self.column}

    def samples(self, block: Block) -> Samples:
        return block.samples[self.head]

    def sample(self, row: Mapping[str, Value]) -> Value | None:
        return row.get(self.head)


@dataclass(frozen=True, slots=True)
class _Marked:
    """Messages without a field are where their column is `true`."""

    head: str
    column: Column

    @property
    def columns(self) -> dict[str, Column]:
        return {self.head: self.column}

    def samples(self, block: Block) -> Samples:
        of = block.samples[self.head]
        assert not isinstance(of.values, Ragged)
        return of.taken(np.flatnonzero(of.values))

    def sample(self, row: Mapping[str, Value]) -> Value | None:
        return row.get(self.head) or None


@dataclass(frozen=True, slots=True)
class _Gathered:
    """An array is read from the columns of its elements, whose last may be empty."""

    heads: tuple[str, ...]
    column: Column

    @property
    def columns(self) -> dict[str, Column]:
        return dict.fromkeys(self.heads, self.column)

    def samples(self, block: Block) -> Samples:
        shape = len(block.times), len(self.heads)
        there, values = np.zeros(shape, np.bool_), np.empty(shape, kind_of(self.column))
        for place, head in enumerate(self.heads):
            of = block.samples[head]
            there[of.rows, place] = True
            values[of.rows, place] = of.values
        lengths = shape[1] - there[:, ::-1].argmax(axis=1)
        lengths[~there.any(axis=1)] = 0
        holes = np.flatnonzero(there.sum(axis=1) != lengths)
        if holes.size:
            row = int(holes[0])
            raise _HoleError(row, self.heads[int(there[row].argmin())], self.heads[int(lengths[row]) - 1])
        rows = np.flatnonzero(lengths)
        return Samples(rows, Ragged(values[there], lengths[rows]))

    def sample(self, row: Mapping[str, Value]) -> Value | None:
        there = [head for head in self.heads if head in row]
        if there and there[-1] != self.heads[len(there) - 1]:
            missing = next(head for head in self.heads if head not in row)
            raise _HoleError(0, missing, there[-1])
        return tuple(row[head] for head in there) or None


@dataclass(frozen=True, slots=True)
class _Taken:
    """An element is read from the column of its array; where this is shorter, there is no sample."""

    head: str
    index: int
    column: Column

    @property
    def columns(self) -> dict[str, Column]:
        return {self.head: self.column}

    def samples(self, block: Block) -> Samples:
        arrays = block.samples[self.head]
        assert isinstance(arrays.values, Ragged)
        lengths = arrays.values.lengths
        long = lengths > self.index
        places = (np.cumsum(lengths) - lengths)[long] + self.index
        return Samples(arrays.rows[long], arrays.values.elements[places])

    def sample(self, row: Mapping[str, Value]) -> Value | None:
        array = row.get(self.head, ())
        return array[self.index] if len(array) > self.index else None


_Source = _Own | _Marked | _Gathered | _Taken

_ARRAYS = {type_.element: type_ for type_ in ValueType if type_.element is not None}


MOST_LISTED = 5
"""So many columns are listed at most."""


class FromTable:
    """A table, its columns read as `signals`. Raises RecordingError."""

    def __init__(self, path: Path, table: Table, signals: Mapping[str, Signal], stamp: Stamp = Stamp.LOG) -> None:
        self._path = path
        self._stamp = stamp
        self._table = table
        self._signals = signals
        self.heads = table.heads
        found = {name: _source(path, set(self.heads), signal) for name, signal in signals.items()}
        self._sources = {name: source for name, source in found.items() if source is not None}

    @property
    def columns(self) -> tuple[str, ...]:
        """The signals that it has values of, and the heads that are read as none.

        Not those by topic and field: exported messages have all of their fields.
        """
        kept = [head for head in self.heads if head in self._sources or (head not in self.cells and head[:1] != "/")]
        return (*kept, *(name for name in self._sources if name not in kept))

    def absence(self, name: str) -> str:
        """Why there is no sample of the signal `name`."""
        by_topic = any(head[:1] == "/" for head in self.heads)
        wholes = [spelling.whole for spelling in spellings(self._signals[name])]
        heads = [f"`{whole}`" for whole in (wholes if by_topic else wholes[:1])]
        return f"the recording has no column {' or '.join(heads)}"

    def remedy(self, name: str) -> str:
        """The column that may be meant by it, or all that no signal is read from, the nearest first."""
        if near := did_you_mean(name, self.columns):
            return near
        _, *by_topic = spellings(self._signals[name])
        unread = [head for head in self.heads if head not in self.cells and (by_topic or head[:1] != "/")]
        if not unread:
            return ""
        sought = by_topic[-1].whole if by_topic and unread[0][:1] == "/" else name
        others = nearest_first(sought, map(_as_array, unread))
        listed = ", ".join(f"`{head}`" for head in others[:MOST_LISTED])
        more = f" and {len(others) - MOST_LISTED} more" if len(others) > MOST_LISTED else ""
        columns, one = ("columns are", "one") if len(others) > 1 else ("column is", "it")
        return f"its other {columns} {listed}{more}: rename {one} to `{name}`, or change the declaration"

    @property
    def beginning(self) -> Nanoseconds | None:
        """That of its first row, unknown before it is read."""
        return None

    @property
    def definitions(self) -> Mapping[str, str]:
        """Nobody: a table has values, and no messages."""
        return {}

    def remarks(self) -> list[Diagnostic]:
        """That there are no headers, if their times are requested; other problems in a table are errors."""
        if self._stamp is not Stamp.HEADER:
            return []
        message = "the rows of a table have no headers: their time is in a column"
        return [diagnostic("LTL815", Source(str(self._path), ""), None, message, help="omit `--stamp header`")]

    def blocks(self) -> Iterator[Block]:
        """The rows by signals. Raises RecordingError, after the rows before the mistake."""
        with fenced(self._path, "LTL820"):
            for block in self._table.blocks(self.cells):
                yield from self._read(block)

    @cached_property
    def cells(self) -> dict[str, Column]:
        """What the signals are read from, by heads."""
        columns: dict[str, Column] = {}
        for source in self._sources.values():
            columns |= source.columns
        return columns

    @cached_property
    def is_plain(self) -> bool:
        """Whether each signal is read from a column of its name."""
        return all(isinstance(source, _Own) and source.head == name for name, source in self._sources.items())

    def row(self, time: Nanoseconds, cells: Mapping[str, Value]) -> dict[str, Value]:
        """The samples of signals in one row, of which these `cells` are not empty. Raises RecordingError."""
        if self.is_plain:
            return dict(cells)
        try:
            found = {name: source.sample(cells) for name, source in self._sources.items()}
        except _HoleError as hole:
            raise self._failure(time, hole) from None
        return {name: value for name, value in found.items() if value is not None}

    def _read(self, block: Block) -> Iterator[Block]:
        try:
            samples = {name: source.samples(block) for name, source in self._sources.items()}
        except _HoleError as hole:
            yield from self._read(block.part(0, hole.row))
            raise self._failure(int(block.times[hole.row]), hole) from None
        yield Block(block.times, samples, self._messages(block))

    def _messages(self, block: Block) -> dict[str, Places]:
        """The rows with an array of which an element is read: messages, also where it is too short to have that."""
        heads: dict[str, set[str]] = {}
        for name, source in self._sources.items():
            if isinstance(source, _Taken):
                for topic in topics_of(self._signals[name]):
                    heads.setdefault(topic, set()).add(source.head)
        return {topic: reduce(np.union1d, (block.samples[head].rows for head in of)) for topic, of in heads.items()}

    def _failure(self, time: int, hole: _HoleError) -> RecordingError:
        message = f"at {seconds_text(time)} s {hole.message}"
        return failure(
            "LTL803",
            self._path,
            message,
            "a shorter array has empty cells at its end only; write `nan` for a missing measurement",
        )


def _as_array(head: str) -> str:
    """The array that `head` is an element of, as `scan[]`, or `head` itself."""
    element = array_and_index(head)
    return f"{element[0]}[]" if element else head


def _source(path: Path, heads: set[str], signal: Signal) -> _Source | None:
    """What `signal` is read from, if it is."""
    for spelling in spellings(signal):
        source = _spelled(path, heads, spelling, Column(signal.type, signal.numbers))
        if isinstance(source, _Own) and signal.is_message:
            return _Marked(source.head, source.column)
        if source is not None:
            return source
    return None


def _spelled(path: Path, heads: set[str], spelling: Spelling, column: Column) -> _Source | None:
    if spelling.whole in heads:
        return _Own(spelling.whole, column)
    if column.type.element is not None:
        gathered = _elements(path, heads, spelling)
        return _Gathered(gathered, Column(column.type.element, column.numbers)) if gathered else None
    taken = array_and_index(spelling.whole)
    if taken is None or taken[0] not in heads:
        return None
    return _Taken(*taken, Column(_ARRAYS[column.type], column.numbers))


def _elements(path: Path, heads: set[str], spelling: Spelling) -> tuple[str, ...]:
    """The heads of the elements, in their order. Raises RecordingError if one is missing between them."""
    indexes: Sequence[int] = sorted(index for head in heads if (index := spelling.index(head)) is not None)
    missing = next((number for number, index in enumerate(indexes) if number != index), None)
    if missing is not None:
        message = f"there is a column `{spelling.element(indexes[-1])}`, but no column `{spelling.element(missing)}`"
        raise failure("LTL801", path, message, help="the elements of an array are numbered from 0")
    return tuple(map(spelling.element, indexes))
