"""Recordings as comma-separated values: a column of times in s, and one for each signal; an empty cell is no sample.

The meaning of a cell is defined here, row by row. A piece without unusual contents is read by columns, by a library.
"""

from __future__ import annotations

import csv
import json
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

from ltlc.inputs.recordings.ahead import blocks_ahead
from ltlc.inputs.recordings.blocks import Block
from ltlc.inputs.recordings.heads import MOST_HEADS, standard, time_head, too_many
from ltlc.inputs.recordings.plain import Plain
from ltlc.inputs.recordings.rows import (
    Column,
    NotAValueError,
    RecordingError,
    Row,
    double_from_text,
    failure,
    number_from_text,
    time_of_row,
    truth_from_text,
    value_from_json,
)
from ltlc.inputs.recordings.text import SHORT, Text, in_utf8, opened
from ltlc.runtime.sampling import Value
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.expressions import ValueType
from ltlc.specification.wire import DOUBLES


def parser(column: Column) -> Callable[[str], Value]:
    """What makes a cell of `column` a value. Raises NotAValueError."""
    match column.type:
        case ValueType.NUMBER if column.numbers == DOUBLES:
            return double_from_text
        case ValueType.NUMBER:
            return lambda text: number_from_text(text, column.numbers)
        case ValueType.BOOLEAN:
            return truth_from_text
        case ValueType.STRING:
            return str
        case _:
            return lambda text: _array_from_text(text, column)


def _array_from_text(text: str, column: Column) -> Value:
    try:
        return value_from_json(json.loads(text), column)
    except (ValueError, RecursionError):
        raise NotAValueError from None


class CsvTable:
    """A CSV file; it is read piece by piece, so that its size does not matter. Raises RecordingError."""

    def __init__(self, path: Path) -> None:
        self._path = path
        with opened(path) as text:
            line, cells = self._head(text)
        self._heads = [standard(head.strip()) for head in cells]
        self._time = self._checked(line, cells)

    @property
    def heads(self) -> tuple[str, ...]:
        """The heads of the columns but that of the times."""
        return tuple(head for head in self._heads if head != self._time)

    def blocks(self, columns: Mapping[str, Column]) -> Iterator[Block]:
        """The rows below the head, of these `columns`. Raises RecordingError, after the rows before the mistake."""
        plain = Plain(self._heads, self._time, columns, {head: parser(column) for head, column in columns.items()})
        with opened(self._path) as text:
            self._head(text)
            by_rows = partial(self._rows, text, columns)
            yield from blocks_ahead(text, plain.block, by_rows, columns)

    def _head(self, text: Text) -> tuple[int, list[str]]:
        """The first line that is not empty, with its number; `text` goes on below it."""
        while piece := text.piece(SHORT):
            first = text.line
            for line, cells in self._records(text, piece):
                text.put_back(b"".join(piece.splitlines(keepends=True)[text.line - first :]))
                return line, cells
        return 1, []

    def _rows(self, text: Text, columns: Mapping[str, Column], piece: bytes, time: Nanoseconds | None) -> Iterator[Row]:
        wanted = [
            (head, i, columns[head], parser(columns[head])) for i, head in enumerate(self._heads) if head in columns
        ]
        time_cell = self._heads.index(self._time)
        for line, cells in self._records(text, piece):
            if len(cells) != len(self._heads):
                raise self._ragged(line, len(cells))
            time = time_of_row(self._path, f"line {line}", time, cells[time_cell])
            yield Row(time, {each[0]: self._value(line, *each, cells) for each in wanted if cells[each[1]].strip()})

    def _records(self, text: Text, piece: bytes) -> Iterator[tuple[int, list[str]]]:
        """The lines of `piece` that are not empty, with their numbers; what goes on after `piece` is put back."""
        lines = piece.splitlines(keepends=True)
        reader = csv.reader((in_utf8(self._path, line) for line in lines), strict=True)
        before, done = text.line, 0
        try:
            for cells in reader:
                done = reader.line_num
                text.line = before + done
                if cells:
                    yield text.line, cells
        except csv.Error as error:
            if reader.line_num < len(lines) or text.is_at_end:
                raise self._error("LTL802", before + reader.line_num, f"not CSV: {error}") from None
            text.put_back(b"".join(lines[done:]))

    def _error(self, code: str, line: int, message: str, help: str = "") -> RecordingError:
        return failure(code, self._path, f"line {line}: {message}", help)

    def _checked(self, line: int, cells: Sequence[str]) -> str:
        """The head of the column of times, if the heads are in order."""
        if len(cells) > MOST_HEADS:
            raise too_many(self._path)
        if not cells:
            raise failure("LTL801", self._path, "the recording is empty", help="its first line must name the columns")
        time = time_head(self._heads)
        if time is None:
            raise self._error("LTL801", line, "there is no column `time`", _help_without_time(cells))
        doubled = [head for head, count in Counter(self._heads).items() if count > 1]
        if doubled:
            raise self._error("LTL801", line, f"two columns are called `{doubled[0]}`")
        return time

    def _ragged(self, line: int, cells: int) -> RecordingError:
        message = f"{cells} cells, but the header has {len(self._heads)}"
        return self._error("LTL802", line, message, "the line may be cut off, or contain a comma that needs quotes")

    def _value(
        self, line: int, head: str, place: int, column: Column, parse: Callable[[str], Value], cells: Sequence[str]
    ) -> Value:
        try:
            return parse(cells[place])
        except NotAValueError:
            message = f"column `{head}`: `{cells[place]}` is not {column.wanted}"
            raise self._error("LTL803", line, message) from None


_TIME_LIKE = re.compile(r"(?:t|time|timestamp|stamp|sec|secs|seconds|zeit)\b", re.IGNORECASE)
"""Columns by which others call times."""


def _help_without_time(cells: Sequence[str]) -> str:
    if len(cells) == 1 and any(c in cells[0] for c in ";\t"):
        return "columns are separated by commas, and numbers have a decimal point; docs/recordings.md converts others"
    if any(_is_number(cell) for cell in cells):
        return (
            "`ros2 topic echo --csv` writes no column names or times: record a bag, or export one with PlotJuggler, "
            "which calls columns `__time` and `/odom/twist/twist/linear/x`"
        )
    other = next((cell for cell in map(str.strip, cells) if _TIME_LIKE.match(cell)), None)
    if other is not None:
        return f"is it `{other}`? rename it to `time`; times are in seconds"
    return "the first line names the columns: `time` in seconds, and the signals"


def _is_number(cell: str) -> bool:
    try:
        double_from_text(cell)
    except NotAValueError:
        return False
    return True
