"""Recordings as lines of JSON: an object for each sample, with `time` in s and signals; null is no sample."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

from ltlc.recordings.rows import (
    Column,
    Columns,
    NotAValueError,
    RecordingError,
    Row,
    failure,
    time_of_row,
    value_from_json,
)
from ltlc.runtime.sampling import Value


class _DoubledError(ValueError):
    """An object has a key twice."""


class _Written(float):
    """A number with its decimals as the file has them: a time is not rounded to a double."""

    def __init__(self, text: str) -> None:
        self.text = text


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    doubled = [name for name, count in Counter(name for name, _ in pairs).items() if count > 1]
    if doubled:
        raise _DoubledError(f"`{doubled[0]}` stands twice")
    return dict(pairs)


class JsonlRecording:
    """A file of JSON lines; it is read line by line, twice: which signals it has only its end tells."""

    def __init__(self, path: Path, column_of: Columns) -> None:
        self._path = path
        self._column_of = column_of

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """The keys of all objects, without `time`. Raises RecordingError."""
        keys: dict[str, None] = {}
        for _, sample in self._objects():
            keys |= dict.fromkeys(sample)
        keys.pop("time", None)
        return tuple(keys)

    def rows(self) -> Iterator[Row]:
        """A row for each object."""
        time = None
        for line, sample in self._objects():
            time = time_of_row(self._path, line, time, self._time(line, sample))
            known = [(name, self._column_of(name), value) for name, value in sample.items() if value is not None]
            yield Row(time, {name: self._value(line, name, of, value) for name, of, value in known if of})

    def _objects(self) -> Iterator[tuple[int, dict[str, Any]]]:
        """The objects, with the numbers of their lines; lines with white space only are passed over."""
        line = 0
        try:
            with self._path.open(encoding="utf-8-sig") as file:
                for line, text in enumerate(file, start=1):
                    if text.strip():
                        yield line, self._parsed(line, text)
        except UnicodeDecodeError:
            raise failure("LTL903", self._path, f"`{self._path}` is not UTF-8 text") from None
        except OSError as error:
            raise failure("LTL902", self._path, f"`{self._path}` cannot be read: {error.strerror}") from None

    def _parsed(self, line: int, text: str) -> dict[str, Any]:
        try:
            sample = json.loads(text, object_pairs_hook=_object, parse_float=_Written)
        except _DoubledError as error:
            raise self._error("LTL802", line, str(error)) from None
        except json.JSONDecodeError as error:
            raise self._error("LTL802", line, f"not JSON: {error.msg} at column {error.colno}") from None
        except (ValueError, RecursionError) as error:
            raise self._error("LTL802", line, f"not JSON that can be read: {error}") from None
        if not isinstance(sample, dict):
            help = 'a line looks like {"time": 0.5, "robot.velocity": 1.2}'
            raise self._error("LTL802", line, "not a JSON object", help)
        return sample

    def _error(self, code: str, line: int, message: str, help: str = "") -> RecordingError:
        return failure(code, self._path, f"line {line}: {message}", help)

    def _time(self, line: int, sample: dict[str, Any]) -> str:
        """The time as it is written."""
        if "time" not in sample:
            raise self._error("LTL804", line, "there is no `time`")
        match sample["time"]:
            case _Written(text=text):
                return text
            case other:
                return json.dumps(other)

    def _value(self, line: int, name: str, column: Column, value: Any) -> Value:
        try:
            return value_from_json(value, column)
        except NotAValueError:
            message = f"`{name}`: `{json.dumps(value)}` is not {column.wanted}"
            raise self._error("LTL803", line, message) from None
