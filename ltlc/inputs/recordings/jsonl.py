"""Recordings as lines of JSON: an object for each sample, with `time` in s and signals; null is no sample."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import cached_property, partial
from pathlib import Path
from typing import Any

from ltlc.inputs.recordings.ahead import Ahead, blocks_ahead, lines_in
from ltlc.inputs.recordings.blocks import Block
from ltlc.inputs.recordings.heads import MOST_HEADS, too_many
from ltlc.inputs.recordings.plain_json import PlainJson, keys
from ltlc.inputs.recordings.rows import (
    Column,
    RecordingError,
    Row,
    failure,
    time_of_row,
    value_given,
)
from ltlc.inputs.recordings.text import Text, in_utf8, opened
from ltlc.semantics.durations import Nanoseconds


class _DoubledError(ValueError):
    """An object has a key twice."""


class _Written(float):
    """A number with its decimals as the file has them: a time is not rounded to a double."""

    def __init__(self, text: str) -> None:
        self.text = text


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    doubled = [name for name, count in Counter(name for name, _ in pairs).items() if count > 1]
    if doubled:
        raise _DoubledError(f"`{doubled[0]}` occurs twice")
    return dict(pairs)


class JsonlTable:
    """A file of JSON lines; it is read piece by piece, twice: which signals it has is known only at its end."""

    def __init__(self, path: Path) -> None:
        self._path = path

    @cached_property
    def heads(self) -> tuple[str, ...]:
        """The keys of all objects, without `time`. Raises RecordingError."""
        found: dict[str, None] = {}
        with opened(self._path) as text, Ahead(lambda: text.piece() or None, keys) as pieces:
            while taken := pieces.next():
                piece, together = taken
                if together is None:
                    for _, sample in self._objects(text, piece):
                        found |= dict.fromkeys(sample)
                else:
                    text.line += lines_in(piece)
                    found |= dict.fromkeys(together)
                if len(found) > MOST_HEADS:
                    raise too_many(self._path)
        found.pop("time", None)
        return tuple(found)

    def blocks(self, columns: Mapping[str, Column]) -> Iterator[Block]:
        """A row for each object. Raises RecordingError, after the rows before the mistake."""
        with opened(self._path) as text:
            by_rows = partial(self._rows, text, columns)
            yield from blocks_ahead(text, PlainJson(columns).block, by_rows, columns)

    def _rows(self, text: Text, columns: Mapping[str, Column], piece: bytes, time: Nanoseconds | None) -> Iterator[Row]:
        for line, sample in self._objects(text, piece):
            place = f"line {line}"
            time = time_of_row(self._path, place, time, self._time(line, sample))
            given = [(name, value) for name, value in sample.items() if name in columns and value is not None]
            yield Row(time, {name: value_given(self._path, place, name, value, columns[name]) for name, value in given})

    def _objects(self, text: Text, piece: bytes) -> Iterator[tuple[int, dict[str, Any]]]:
        """The objects, with the numbers of their lines; lines with white space only are passed over."""
        for encoded in piece.splitlines():
            text.line += 1
            line = in_utf8(self._path, encoded)
            if line.strip():
                yield text.line, self._parsed(text.line, line)

    def _parsed(self, line: int, text: str) -> dict[str, Any]:
        try:
            sample = json.loads(text, object_pairs_hook=_object, parse_float=_Written)
        except _DoubledError as error:
            raise self._error("LTL802", line, str(error)) from None
        except json.JSONDecodeError as error:
            raise self._error("LTL802", line, f"not JSON: {error.msg} at column {error.colno}") from None
        except (ValueError, RecursionError) as error:
            raise self._error("LTL802", line, f"unreadable JSON: {error}") from None
        if not isinstance(sample, dict):
            help = 'a line is written {"time": 0.5, "robot.velocity": 1.2}'
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
