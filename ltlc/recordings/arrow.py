"""Columns of Arrow's as times and samples."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ltlc.recordings.blocks import Array, Places, Ragged, Samples, kind_of, packed
from ltlc.recordings.rows import LONGEST_GAP, Column, NotAValueError, value_from_json
from ltlc.runtime.times import NEVER
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.expressions import ValueType
from ltlc.specification.wire import DOUBLES, Kind, Numbers

if TYPE_CHECKING:
    import pyarrow as pa

Times = NDArray[np.int64]


class OddError(Exception):
    """What stands at `place` in a column cannot be taken as it is."""

    def __init__(self, place: int) -> None:
        self.place = place


def whole(column: pa.ChunkedArray) -> pa.Array:
    """A column of a table in one piece."""
    return column.chunk(0) if column.num_chunks == 1 else column.combine_chunks()


def there(column: pa.Array) -> tuple[Places, pa.Array]:
    """The rows in which there is something, and what that is."""
    if not column.null_count:
        return np.arange(len(column)), column
    return np.flatnonzero(column.is_valid().to_numpy(zero_copy_only=False)), column.drop_null()


def in_nanoseconds(seconds: pa.Array) -> Times:
    """Decimals, none of them null, as times to the nearest ns. Raises OddError for what is beyond the times of runs."""
    import pyarrow as pa
    from pyarrow import compute

    if seconds.type.scale != 9 or seconds.type.bit_width != 128:
        seconds = compute.cast(compute.round(seconds, 9), pa.decimal128(38, 9))
    words = np.frombuffer(seconds.buffers()[1], np.int64)[2 * seconds.offset :][: 2 * len(seconds)]
    times, high = np.ascontiguousarray(words[::2]), words[1::2]
    _refuse((high != times >> 63) | (times >= NEVER) | (times <= -NEVER))
    return times


def check_order(times: Times, previous: Nanoseconds | None) -> None:
    """Raise OddError where a time does not follow that of the row before, as `rows.check_order` has it."""
    if len(times):
        gaps = np.diff(times, prepend=times[0] if previous is None else previous)
        _refuse((gaps < 0) | (gaps > LONGEST_GAP))


def samples(column: pa.Array, wanted: Column) -> Samples:
    """What stands in a column; null is no sample. Raises OddError at what is no value of the signal."""
    rows, column = there(column)
    try:
        return Samples(rows, _values(column, wanted))
    except OddError as odd:
        raise OddError(int(rows[odd.place])) from None


def _values(column: pa.Array, wanted: Column) -> Array | Ragged:
    """The values in a column without nulls: a value means what it means in JSON."""
    from pyarrow import compute, types

    if wanted.type is ValueType.NUMBER and _is_number(column.type):
        return _numbers(column, wanted)
    if wanted.type is ValueType.NUMBERS and types.is_nested(column.type) and is_plain(column.type):
        elements, lengths = column.flatten(), compute.list_value_length(column).to_numpy().astype(np.int64)
        if _is_number(elements.type) and not elements.null_count:
            return _ragged(elements, lengths, Column(ValueType.NUMBER, wanted.numbers))
    if len(column) and not is_plain(column.type):
        raise OddError(0)
    values = []
    for place, value in enumerate(column.to_pylist()):
        try:
            values.append(value_from_json(value, wanted))
        except NotAValueError:
            raise OddError(place) from None
    return packed(values, wanted)


def is_plain(type_: pa.DataType) -> bool:
    """Whether Python has values like those of the type, and JSON, too."""
    from pyarrow import types

    if types.is_dictionary(type_):
        return is_plain(type_.value_type)
    if types.is_list(type_) or types.is_large_list(type_) or types.is_fixed_size_list(type_):
        return is_plain(type_.value_type)
    is_text = types.is_string(type_) or types.is_large_string(type_)
    return bool(is_text or types.is_boolean(type_) or types.is_null(type_) or _is_number(type_))


def _ragged(elements: pa.Array, lengths: Places, wanted: Column) -> Ragged:
    try:
        return Ragged(_numbers(elements, wanted), lengths)
    except OddError as odd:
        raise OddError(int(np.searchsorted(np.cumsum(lengths), odd.place, "right"))) from None


def _is_number(type_: pa.DataType) -> bool:
    from pyarrow import types

    return bool(types.is_integer(type_) or types.is_floating(type_) or types.is_decimal(type_))


def _numbers(column: pa.Array, wanted: Column) -> Array:
    from pyarrow import compute, types

    if types.is_decimal(column.type):
        column = compute.cast(column, "float64")
    values = column.to_numpy()
    if wanted.numbers.is_wide and types.is_integer(column.type):
        least, most = int(wanted.numbers.least), int(wanted.numbers.most)
        _refuse((values < least) | (values > most))
        whole_numbers: Array = values.astype(kind_of(wanted))
        return whole_numbers
    return fitted(values.astype(np.float64, copy=False), wanted.numbers).astype(kind_of(wanted), copy=False)


def fitted(values: NDArray[np.float64], numbers: Numbers) -> NDArray[np.float64]:
    """`values` as `rows.fitted` makes each. Raises OddError at one that is none of an integer's."""
    if numbers == DOUBLES:
        return values
    if numbers.kind is Kind.SINGLE:
        with np.errstate(over="ignore"):
            return values.astype(np.float32).astype(np.float64)
    _refuse(~((values >= numbers.least) & (values <= numbers.most) & (np.trunc(values) == values)))
    return values + 0.0


def _refuse(odd: NDArray[np.bool_]) -> None:
    if odd.any():
        raise OddError(int(odd.argmax()))
