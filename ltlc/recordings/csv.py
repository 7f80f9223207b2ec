"""Recordings as comma-separated values: a column `time` in s, and one for each signal; an empty cell is no sample."""

from __future__ import annotations

import csv
import json
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from ltlc.recordings.rows import (
    Column,
    Columns,
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
from ltlc.runtime.sampling import Value
from ltlc.specification.expressions import ValueType
from ltlc.specification.wire import DOUBLES


def _parser(column: Column) -> Callable[[str], Value]:
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


class CsvRecording:
    """A CSV file; it is read row by row, so that its size does not matter."""

    def __init__(self, path: Path, column_of: Columns) -> None:
        self._path = path
        self._column_of = column_of
        _, header = next(self._lines(), (0, []))
        self._header = [name.strip() for name in header]
        self._check_header()

    @property
    def columns(self) -> tuple[str, ...]:
        """The heads of the columns, without `time`."""
        return tuple(name for name in self._header if name != "time")

    def rows(self) -> Iterator[Row]:
        """The rows below the head; lines without any character are passed over."""
        lines = self._lines()
        next(lines)
        wanted = [(i, name, column) for i, name in enumerate(self._header) if (column := self._column_of(name))]
        known = [(name, i, column, _parser(column)) for i, name, column in wanted]
        time_cell = self._header.index("time")
        time = None
        for line, cells in lines:
            if len(cells) != len(self._header):
                raise self._ragged(line, len(cells))
            time = time_of_row(self._path, line, time, cells[time_cell])
            values = {each[0]: self._value(line, *each, cells) for each in known if cells[each[1]].strip()}
            yield Row(time, values)

    def _lines(self) -> Iterator[tuple[int, list[str]]]:
        """The lines that are not empty, with their numbers."""
        reader = None
        try:
            with self._path.open(encoding="utf-8-sig", newline="") as file:
                reader = csv.reader(file, strict=True)
                for cells in reader:
                    if cells:
                        yield reader.line_num, cells
        except UnicodeDecodeError:
            raise failure("LTL903", self._path, f"`{self._path}` is not UTF-8 text") from None
        except csv.Error as error:
            raise self._error("LTL802", reader.line_num if reader else 1, f"not CSV: {error}") from None
        except OSError as error:
            raise failure("LTL902", self._path, f"`{self._path}` cannot be read: {error.strerror}") from None

    def _error(self, code: str, line: int, message: str, help: str = "") -> RecordingError:
        return failure(code, self._path, f"line {line}: {message}", help)

    def _check_header(self) -> None:
        if not self._header:
            raise failure("LTL801", self._path, "the recording is empty", help="its first line heads the columns")
        doubled = [name for name, count in Counter(self._header).items() if count > 1]
        if doubled:
            raise self._error("LTL801", 1, f"two columns are headed `{doubled[0]}`")
        if "time" not in self._header:
            help = "the first line heads the columns: `time` in seconds, and the signals"
            if len(self._header) == 1 and any(c in self._header[0] for c in ";\t"):
                help = "columns are separated by commas"
            raise self._error("LTL801", 1, "there is no column `time`", help)

    def _ragged(self, line: int, cells: int) -> RecordingError:
        message = f"{cells} cells where the head has {len(self._header)}"
        return self._error("LTL802", line, message, "the line may be cut off, or have a comma that wants quotes")

    def _value(
        self, line: int, name: str, place: int, column: Column, parse: Callable[[str], Value], cells: Sequence[str]
    ) -> Value:
        try:
            return parse(cells[place])
        except NotAValueError:
            message = f"column `{name}`: `{cells[place]}` is not {column.wanted}"
            raise self._error("LTL803", line, message) from None
