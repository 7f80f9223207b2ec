"""Columns of Arrow's as times and samples."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ltlc.inputs.recordings.blocks import Array, Places, Ragged, Samples, kind_of, packed
from ltlc.inputs.recordings.rows import LONGEST_GAP, Column, NotAValueError, value_from_json
from ltlc.runtime.times import NEVER
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.expressions import ValueType
from ltlc.specification.wire import DOUBLES, Kind, Numbers

if TYPE_CHECKING:
    import pyarrow as pa

Times = NDArray[np.int64]

SHORT, LONG = (28, 9), (38, 28)
"""Decimal digits of times, and how many of them are fractions of a second: what most have, and the most that fit."""

WHOLE = 10
"""Digits of a time before its point that, in ns, fit into 64 bits, or overflow so that this shows."""


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


def from_text(seconds: pa.Array) -> Times:
    """Times in s as they are written, none of them null, to the nearest ns. Raises OddError for what may be none."""
    import pyarrow as pa
    from pyarrow import compute

    times = _aligned(seconds) if len(seconds) else None
    if times is not None:
        return times
    for digits in (SHORT, LONG):
        try:
            return in_nanoseconds(compute.cast(seconds, pa.decimal128(*digits)))
        except pa.ArrowInvalid:
            seconds = compute.ascii_trim_whitespace(seconds)
    raise OddError(0)


def _aligned(seconds: pa.Array) -> Times | None:
    """Times in s that stand digit below digit and point below point, as most do; None for others.

    This takes a fifth of the time that decimals take.
    """
    text = _matrix(seconds)
    if text is None:
        return None
    width, point = text.shape[1], (text[0].tobytes() + b".").index(b".")
    fractions = max(0, width - point - 1)
    digits = text - np.uint8(ord("0"))
    is_regular = digits <= 9
    is_regular[:, point : point + 1] = text[:, point : point + 1] == ord(".")
    if point > WHOLE or fractions > SHORT[1] or point + fractions == 0 or not is_regular.all():
        return None
    times = np.zeros(len(text), np.int64)
    for place in (*range(point), *range(point + 1, width)):
        times *= 10
        times += digits[:, place]
    times *= 10 ** (SHORT[1] - fractions)
    _refuse((times >= NEVER) | (times < 0))
    return times


def _matrix(texts: pa.Array) -> NDArray[np.uint8] | None:
    """The bytes of `texts`, of which there is one, one below the other, if they are equally long; None otherwise."""
    _, ends, content = texts.buffers()
    ends = np.frombuffer(ends, np.int32)[texts.offset : texts.offset + len(texts) + 1]
    width = int(ends[1] - ends[0])
    if not width or (np.diff(ends) != width).any():
        return None
    return np.frombuffer(content, np.uint8)[ends[0] : ends[-1]].reshape(-1, width)


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
    """The values of a column; null is no sample. Raises OddError at one that is not a value of the signal."""
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
    """`values` as `rows.fitted` makes each. Raises OddError at one that does not fit an integer type."""
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
