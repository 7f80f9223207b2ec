"""Pieces of JSON lines in which nothing is odd, read by columns, by pyarrow.

As with CSV, tests compare what it takes with what is read row by row. Odd is what pyarrow takes and Python does not, or
only together with what is: several objects in a line, one in several lines, `Inf`, characters of control.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from math import ceil, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ltlc.inputs.recordings.arrow import LONG, SHORT, in_nanoseconds, samples
from ltlc.inputs.recordings.blocks import Block, Samples
from ltlc.inputs.recordings.heads import MOST_HEADS
from ltlc.inputs.recordings.plain import block_of, is_usual, is_worth_it
from ltlc.inputs.recordings.rows import Column
from ltlc.specification.expressions import ValueType

if TYPE_CHECKING:
    import pyarrow as pa

MOST_CELLS = 1 << 22
"""Keys are looked for in tables of so many cells at most: pyarrow has one for each key in each line."""

_INF = re.compile(rb"Inf(?!inity)")
_MINUS_ZERO = re.compile(rb"-0(?![.0-9eE])")
_TIME_IN_QUOTES = re.compile(rb'"time"\s*:\s*"')


class PlainJson:
    """Reads pieces of one file into the wanted `columns`."""

    def __init__(self, columns: Mapping[str, Column]) -> None:
        self._columns = columns
        self._digits = SHORT

    def block(self, piece: bytes) -> Block | None:
        """The rows of `piece`; None if something in it is odd. May be called in several threads."""
        if not is_worth_it(piece) or not _is_regular(piece) or _TIME_IN_QUOTES.search(piece):
            return None
        table = _parsed(piece, self._schema(self._digits))
        if table is None and self._digits == SHORT:
            table = _parsed(piece, self._schema(LONG))
            if table is not None:
                self._digits = LONG
        if table is None or table["time"].null_count:
            return None
        return block_of(table, "time", in_nanoseconds, self._columns, self._samples)

    def _samples(self, head: str, column: pa.Array) -> Samples:
        return samples(column, self._columns[head])

    def _schema(self, digits: tuple[int, int]) -> pa.Schema:
        import pyarrow as pa

        types = {head: _type(column) for head, column in self._columns.items()}
        return pa.schema({**types, "time": pa.decimal128(*digits)})


def keys(piece: bytes) -> list[str] | None:
    """The keys of the objects in `piece`, or more than any table has; None if something in it is odd."""
    if not is_worth_it(piece) or not _is_regular(piece):
        return None
    found: dict[str, None] = {}
    for part in _narrow(piece):
        table = _parsed(part, None)
        if table is None:
            return None
        found |= dict.fromkeys(table.schema.names)
        if len(found) > MOST_HEADS:
            break
    return list(found)


def _narrow(piece: bytes) -> Iterator[bytes]:
    """The lines of `piece` in parts of which no table has too many cells, though each line had keys of its own."""
    count = ceil(sqrt(max(1, piece.count(b":")) * (piece.count(b"\n") + 1) / MOST_CELLS))
    start = 0
    while start < len(piece):
        end = piece.find(b"\n", start + len(piece) // count) + 1 or len(piece)
        part = piece[start:end]
        if len(part) < len(piece):
            yield from _narrow(part)
        else:
            yield part
        start = end


def _parsed(piece: bytes, schema: pa.Schema | None) -> pa.Table | None:
    """The objects, those keys of them that are in `schema`; None is all."""
    import pyarrow as pa
    from pyarrow import json

    read = json.ReadOptions(use_threads=False, block_size=len(piece) + 1)
    parse = json.ParseOptions(schema, unexpected_field_behavior="infer" if schema is None else "ignore")
    try:
        return json.read_json(pa.py_buffer(piece), read, parse)
    except pa.ArrowInvalid:
        return None


def _type(column: Column) -> Any:
    import pyarrow as pa

    match column.type:
        case ValueType.NUMBER if column.numbers.is_wide:
            return pa.int64() if column.numbers.least < 0 else pa.uint64()
        case ValueType.NUMBER:
            return pa.float64()
        case ValueType.BOOLEAN:
            return pa.bool_()
        case ValueType.STRING:
            return pa.string()
        case _:
            pass
    assert column.type.element is not None
    return pa.list_(_type(Column(column.type.element, column.numbers)))


def _is_regular(piece: bytes) -> bool:
    """Whether each line is one object, with arrays in it but nothing deeper, and nothing that only pyarrow takes."""
    text = np.frombuffer(b"\n" + piece.rstrip(b"\r\n"), np.uint8)
    begins = np.flatnonzero(text == ord("\n")) + 1
    return bool(
        text[-1] == ord("}")
        and (text[begins] == ord("{")).all()
        and np.count_nonzero(text == ord("{")) == len(begins)
        and _is_flat(text, piece)
        and not _has_other_numbers(piece)
        and is_usual(piece)
    )


def _is_flat(text: NDArray[np.uint8], piece: bytes) -> bool:
    """Whether no array is in another: pyarrow, asked for all keys, would go as deep as they do."""
    if b"[" not in piece and b"]" not in piece:
        return True
    brackets = text[(text == ord("[")) | (text == ord("]"))]
    return bool((brackets[::2] == ord("[")).all() and (brackets[1::2] == ord("]")).all())


def _has_other_numbers(piece: bytes) -> bool:
    """Whether there may be numbers that Python reads otherwise, `-0` as an integer, or not at all."""
    # One character is found ten times as fast as several, and several patterns sooner than all of them in one.
    has_inf = b"I" in piece and _INF.search(piece)
    return bool(has_inf or (b"N" in piece and b"-NaN" in piece) or _MINUS_ZERO.search(piece))
