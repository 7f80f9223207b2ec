"""Recordings as Parquet, or as tables of Arrow's: a column of times, and one for each signal; null is no sample."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ltlc.base.limits import at_most
from ltlc.inputs.recordings import arrow
from ltlc.inputs.recordings.arrow import OddError, Times
from ltlc.inputs.recordings.blocks import Block, Samples
from ltlc.inputs.recordings.heads import TIMES, standard, time_head
from ltlc.inputs.recordings.rows import Column, RecordingError, check_order, failure
from ltlc.runtime.times import NEVER, nanoseconds
from ltlc.semantics.durations import Nanoseconds

if TYPE_CHECKING:
    import pyarrow as pa
    from pyarrow.parquet import ParquetFile, RowGroupMetaData

ROWS, SIZE = 1 << 16, 1 << 25
"""How many rows a block has at most, and about how many bytes."""

BUFFER = 1 << 20
"""How many bytes of a column are read at once."""

MEGABYTES = 384
"""What the rows of a block may take in memory: a file can claim anything of their size."""


Batches = Callable[[Sequence[str]], Iterator["pa.RecordBatch"]]
"""Gives the columns with these names, so many rows at a time."""


class ArrowTable:
    """Columns of Arrow's, from the file at `path`, or named like it; read batch by batch. Raises RecordingError."""

    def __init__(self, path: Path, schema: pa.Schema, batches: Batches) -> None:
        self._path = path
        self._names = schema.names
        self._batches = batches
        doubled = [head for head, count in Counter(map(standard, self._names)).items() if count > 1]
        if doubled:
            raise failure("LTL801", path, f"two columns are called `{doubled[0]}`")
        time = time_head(self._names)
        if time is None:
            help = f"times must be in a column {', '.join(f'`{head}`' for head in TIMES)}"
            raise failure("LTL801", path, "there is no column `time`", help)
        type_ = schema.types[self._names.index(time)]
        if not _is_time(type_):
            help = "times are seconds as floating-point numbers or decimals, nanoseconds as integers, or timestamps"
            raise failure("LTL801", path, f"column `{time}` is of type {type_}, which is not a time", help)
        self._time = time

    @cached_property
    def heads(self) -> tuple[str, ...]:
        """The names of the columns but that of the times."""
        return tuple(standard(name) for name in self._names if name != self._time)

    def blocks(self, columns: Mapping[str, Column]) -> Iterator[Block]:
        """The rows, of these `columns`. Raises RecordingError, after the rows before the mistake."""
        named = {standard(name): name for name in self._names}
        first, previous = 0, None
        for batch in self._batches([self._time, *(named[head] for head in columns)]):
            given = {head: (batch[named[head]], column) for head, column in columns.items()}
            for block in self._blocks(first, previous, batch[self._time], given):
                yield block
                previous = int(block.times[-1]) if len(block.times) else previous
            first += len(batch)

    def _blocks(
        self,
        first: int,
        previous: Nanoseconds | None,
        times: pa.Array,
        given: Mapping[str, tuple[pa.Array, Column]],
    ) -> Iterator[Block]:
        """The rows from number `first` on; up to what cannot be taken, for which RecordingError is raised then."""
        try:
            block = self._block(first, previous, times, given)
        except _RowError as error:
            some = {head: (column[: error.row], wanted) for head, (column, wanted) in given.items()}
            yield from self._blocks(first, previous, times[: error.row], some)
            raise error.failure from None
        yield block

    def _block(
        self,
        first: int,
        previous: Nanoseconds | None,
        times: pa.Array,
        given: Mapping[str, tuple[pa.Array, Column]],
    ) -> Block:
        in_ns = self._times(first, previous, times)
        return Block(in_ns, {head: self._samples(first, head, *of) for head, of in given.items()}, {})

    def _samples(self, first: int, head: str, column: pa.Array, wanted: Column) -> Samples:
        try:
            return arrow.samples(column, wanted)
        except OddError as odd:
            is_plain = arrow.is_plain(column.type)
            value = f"`{column[odd.place].as_py()}`" if is_plain else f"a value of type {column.type}"
            message = f"row {first + odd.place + 1}: column `{head}`: {value} is not {wanted.wanted}"
            raise _RowError(odd.place, failure("LTL803", self._path, message)) from None
        except UnicodeDecodeError:
            raise failure("LTL820", self._path, f"column `{head}` has text that is not UTF-8") from None

    def _times(self, first: int, previous: Nanoseconds | None, column: pa.Array) -> Times:
        """The times of the rows. Raises _RowError."""
        times = None
        try:
            times = _in_nanoseconds(column)
            arrow.check_order(times, previous)
        except OddError as odd:
            row = f"row {first + odd.place + 1}"
            raise _RowError(odd.place, self._wrong(row, odd.place, previous, column, times)) from None
        return times

    def _wrong(
        self, row: str, place: int, previous: Nanoseconds | None, column: pa.Array, times: Times | None
    ) -> RecordingError:
        """What is wrong with a time: it is not a time, or does not follow the one before it."""
        if times is None:
            written = column[place : place + 1].cast("string")[0].as_py()
            message = f"{row}: `{written}` is not a time" if written else f"{row}: there is no time"
            help = "times must be before the year 2116: seconds as floating-point numbers, nanoseconds as integers"
            return failure("LTL804", self._path, message, help)
        before = int(times[place - 1]) if place else previous
        try:
            check_order(self._path, row, before, int(times[place]))
        except RecordingError as error:
            return error
        raise AssertionError("times are out of order")


def parquet_table(path: Path) -> ArrowTable:
    """The Parquet file at `path`; of it the wanted columns are read only. Raises RecordingError."""
    with _opened(path) as file:
        schema, count = file.schema_arrow, file.metadata.num_rows
        groups = range(file.metadata.num_row_groups)
        size = sum(_size(file.metadata.row_group(group)) for group in groups)
    most = max(1, min(ROWS, SIZE * count // max(1, size)))

    def batches(names: Sequence[str]) -> Iterator[pa.RecordBatch]:
        taken = 0
        with _opened(path) as file:
            found = file.iter_batches(most, columns=names)
            while (batch := _next(found)) is not None:
                yield batch
                taken += len(batch)
        if taken != count:
            message = f"`{path}` is damaged: {taken} of its {count} rows could be read"
            raise failure("LTL820", path, message)

    return ArrowTable(path, schema, batches)


def _size(group: RowGroupMetaData) -> int:
    """About how many bytes a group of rows has: as it is kept, or as it is where equal values are kept once."""
    values = sum(group.column(number).num_values for number in range(group.num_columns))
    return int(max(group.total_byte_size, 8 * values))


def _next(batches: Iterator[pa.RecordBatch]) -> pa.RecordBatch | None:
    """The next one, if there is one. Raises MemoryError if that is larger than it may be."""
    with at_most(MEGABYTES):
        return next(batches, None)


@contextmanager
def _opened(path: Path) -> Iterator[ParquetFile]:
    import pyarrow as pa
    from pyarrow import parquet

    try:
        with _system_memory():
            opened = parquet.ParquetFile(path, buffer_size=BUFFER)
        with opened as file:
            yield file
    except PermissionError as error:
        raise failure("LTL902", path, f"`{path}` cannot be read: {error.strerror}") from None
    except MemoryError:
        message = f"`{path}` has rows that take more than {MEGABYTES} MB of memory together, or is damaged"
        raise failure("LTL820", path, message, "write it with fewer rows per row group, or smaller arrays") from None
    except (pa.ArrowException, OSError) as error:
        what = str(error).splitlines()[0]
        help = "is it cut off? the program that wrote it may not have finished"
        raise failure("LTL820", path, f"`{path}` is not a Parquet file, or is damaged: {what}", help) from None


@contextmanager
def _system_memory() -> Iterator[None]:
    """What is opened meanwhile takes its memory where it can be bounded: others take a gigabyte, and fill it later."""
    import pyarrow as pa

    before = pa.default_memory_pool()
    pa.set_memory_pool(pa.system_memory_pool())
    try:
        yield
    finally:
        pa.set_memory_pool(before)


def arrow_table(path: Path, data: Any) -> ArrowTable:
    """What gives a stream of Arrow's, such as a data frame, as if it were in a Parquet file. Raises RecordingError."""
    import pyarrow as pa

    try:
        table = pa.table(data).unify_dictionaries()
    except (pa.ArrowException, TypeError, ValueError) as error:
        raise failure("LTL807", path, f"not an Arrow table: {error}") from None
    return ArrowTable(path, table.schema, lambda names: iter(table.select(names).to_batches(ROWS)))


class _RowError(Exception):
    """Something in a row of a block is invalid; the error to report."""

    def __init__(self, row: int, failure: RecordingError) -> None:
        self.row = row
        self.failure = failure


def _is_time(type_: pa.DataType) -> bool:
    from pyarrow import types

    is_number = types.is_integer(type_) or types.is_floating(type_) or types.is_decimal(type_)
    return bool(is_number or types.is_timestamp(type_))


def _in_nanoseconds(column: pa.Array) -> Times:
    """Times as they are kept in a column. Raises OddError."""
    from pyarrow import types

    if column.null_count:
        raise OddError(int(np.flatnonzero(column.is_null().to_numpy(zero_copy_only=False))[0]))
    if types.is_decimal(column.type) or types.is_floating(column.type):
        return _from_seconds(column)
    if types.is_timestamp(column.type):
        scale = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}[column.type.unit]
        return _scaled(column.cast("int64").to_numpy(), scale)
    return _scaled(column.to_numpy(), 1)


def _scaled(numbers: np.ndarray, scale: int) -> Times:
    limit = NEVER // scale
    odd = (numbers >= limit) | (numbers <= -limit) if numbers.dtype.kind == "i" else numbers >= limit
    if odd.any():
        raise OddError(int(odd.argmax()))
    return numbers.astype(np.int64) * scale


def _from_seconds(column: pa.Array) -> Times:
    """Seconds as they are written in decimals, the shortest ones: what a table of text would have."""
    import pyarrow as pa
    from pyarrow import types

    try:
        return arrow.in_nanoseconds(column) if types.is_decimal(column.type) else arrow.from_text(column.cast("string"))
    except (pa.ArrowInvalid, OddError):
        return np.array([_from_text(place, text) for place, text in enumerate(column.cast("string").to_pylist())])


def _from_text(place: int, text: str) -> Nanoseconds:
    try:
        return nanoseconds(text)
    except ValueError:
        raise OddError(place) from None
