"""Pieces of CSV in which nothing is odd, read by columns, by pyarrow.

It reads what it takes as `csv.parser` does: tests compare them. Where anything is odd, even if it may be right, it has
no answer, and the piece is read row by row.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ltlc.base.libraries import is_installed
from ltlc.inputs.recordings.arrow import OddError, Times, from_text, samples, there, whole
from ltlc.inputs.recordings.blocks import Block, Places, Samples, packed
from ltlc.inputs.recordings.rows import Column, NotAValueError
from ltlc.runtime.sampling import Value
from ltlc.specification.expressions import ValueType

if TYPE_CHECKING:
    import pyarrow as pa

Parser = Callable[[str], Value]

WORTH = 1 << 16
"""Bytes from which on the library saves more time than its import takes."""


class Plain:
    """Reads pieces of one file, with these `heads`, into the wanted `columns`, of which each has a parser of cells."""

    def __init__(
        self, heads: Sequence[str], time: str, columns: Mapping[str, Column], parsers: Mapping[str, Parser]
    ) -> None:
        self._heads = heads
        self._time = time
        self._columns = columns
        self._parsers = parsers

    def block(self, piece: bytes) -> Block | None:
        """The rows of `piece`; None if something in it is odd. May be called in several threads."""
        if not is_worth_it(piece) or not _is_regular(piece):
            return None
        table = self._parsed(piece)
        if table is None or not len(table) or table[self._time].null_count or self._has_odd_nan(table, piece):
            return None
        return block_of(table, self._time, from_text, self._columns, self._samples)

    def _parsed(self, piece: bytes) -> pa.Table | None:
        import pyarrow as pa
        from pyarrow import csv

        text = pa.dictionary(pa.int32(), pa.string())
        types = {head: pa.float64() if _is_double(column) else text for head, column in self._columns.items()}
        types[self._time] = pa.string()
        convert = csv.ConvertOptions(
            column_types=types,
            include_columns=list(types),
            null_values=["", " "],
            strings_can_be_null=True,
            check_utf8=False,
        )
        read = csv.ReadOptions(column_names=list(self._heads), block_size=len(piece) + 1, use_threads=False)
        parse = csv.ParseOptions(newlines_in_values=b'"' in piece)
        try:
            return csv.read_csv(pa.py_buffer(piece), read, parse, convert)
        except pa.ArrowInvalid:
            return None

    def _has_odd_nan(self, table: pa.Table, piece: bytes) -> bool:
        """Whether a NaN may be written as in C, `nan(7)`, which is not a number here."""
        from pyarrow import compute

        if b"(" not in piece:
            return False
        doubles = [head for head, column in self._columns.items() if _is_double(column)]
        return any(compute.any(compute.is_nan(table[head])).as_py() for head in doubles)

    def _samples(self, head: str, column: pa.Array) -> Samples:
        wanted = self._columns[head]
        if _is_double(wanted):
            return samples(column, wanted)
        return _parsed_once(*there(column), wanted, self._parsers[head])


def is_worth_it(piece: bytes) -> bool:
    """Whether the library reads `piece` sooner: it is installed, and there is much to read."""
    return len(piece) >= WORTH and is_installed("pyarrow")


def block_of(
    table: pa.Table,
    time: str,
    times_of: Callable[[pa.Array], Times],
    heads: Iterable[str],
    samples_of: Callable[[str, pa.Array], Samples],
) -> Block | None:
    """The rows of `table`; None if something in it is odd."""
    try:
        times = times_of(whole(table[time]))
        return Block(times, {head: samples_of(head, whole(table[head])) for head in heads}, {})
    except OddError:
        return None


def _is_double(column: Column) -> bool:
    return column.type is ValueType.NUMBER and not column.numbers.is_wide


def _is_regular(piece: bytes) -> bool:
    """Whether it is usual text with quotes around whole cells only, so that all readers part it alike."""
    if not is_usual(piece):
        return False
    if b'"' not in piece:
        return True
    text = np.frombuffer(b"\n" + piece + b"\n", np.uint8)
    quotes = np.flatnonzero(text == ord('"'))
    if len(quotes) % 2:
        return False
    opened, closed = text[quotes[::2] - 1], text[quotes[1::2] + 1]
    return bool(np.isin(opened, list(b",\n")).all() and np.isin(closed, list(b",\r\n")).all())


def is_usual(text: bytes) -> bool:
    """Whether `text` is UTF-8, and its lines end in a line feed, which is how lines are counted."""
    if b"\r" in text and text.count(b"\r") != text.count(b"\r\n"):
        return False
    if text.isascii():
        return True
    try:
        text.decode()
    except UnicodeDecodeError:
        return False
    return True


def _parsed_once(rows: Places, column: pa.Array, wanted: Column, parse: Parser) -> Samples:
    """The values of text in these rows, of which each different one is parsed once. Raises OddError."""
    texts, found = column.dictionary.to_pylist(), column.indices.to_numpy()
    is_sample = np.array([bool(text.strip()) for text in texts], np.bool_)
    rows, found = rows[is_sample[found]], found[is_sample[found]]
    try:
        values = [parse(text) if text.strip() else None for text in texts]
    except NotAValueError:
        raise OddError(0) from None
    if wanted.type.element is not None:
        return Samples(rows, packed([values[index] for index in found.tolist()], wanted))
    different = packed([value for value in values if value is not None], wanted)
    return Samples(rows, different[(np.cumsum(is_sample) - 1)[found]])
