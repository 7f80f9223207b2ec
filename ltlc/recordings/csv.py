"""Recordings as comma-separated values: a column `time` in s, and one for each signal; an empty cell is no sample."""

from __future__ import annotations

import csv
import json
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from ltlc.recordings.rows import (
    WANTED,
    NotAValueError,
    RecordingError,
    Row,
    failure,
    number_from_text,
    time_of_row,
    truth_from_text,
    value_from_json,
)
from ltlc.runtime.sampling import Value
from ltlc.specification.expressions import ValueType


def _array_from_text(text: str) -> Value:
    try:
        return value_from_json(json.loads(text), ValueType.NUMBERS)
    except (ValueError, RecursionError):
        raise NotAValueError from None


_PARSERS: dict[ValueType, Callable[[str], Value]] = {
    ValueType.NUMBER: number_from_text,
    ValueType.BOOLEAN: truth_from_text,
    ValueType.STRING: str,
    ValueType.NUMBERS: _array_from_text,
}


class CsvRecording:
    """A CSV file; it is read row by row, so that its size does not matter."""

    def __init__(self, path: Path, types: Mapping[str, ValueType]) -> None:
        self._path = path
        self._types = types
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
        known = [(i, name, self._types[name]) for i, name in enumerate(self._header) if name in self._types]
        time_cell = self._header.index("time")
        time = None
        for line, cells in lines:
            if len(cells) != len(self._header):
                raise self._ragged(line, len(cells))
            time = time_of_row(self._path, line, time, cells[time_cell])
            values = {name: self._value(line, name, t, cells[i]) for i, name, t in known if cells[i].strip()}
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

    def _value(self, line: int, name: str, type_: ValueType, cell: str) -> Value:
        try:
            return _PARSERS[type_](cell)
        except NotAValueError:
            message = f"column `{name}`: `{cell}` is not {WANTED[type_]}"
            raise self._error("LTL803", line, message) from None
