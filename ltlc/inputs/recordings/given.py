"""Rows from a program: mappings of values by name, with `time` in s; None is no sample."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import floor
from pathlib import Path

from ltlc.inputs.recordings.blocks import Block, blocks_of
from ltlc.inputs.recordings.rows import LONGEST_GAP, Column, Row, failure, time_of_row, value_given
from ltlc.runtime.sampling import Value
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.expressions import ValueType

TIME = "time"

DOUBLE = Column(ValueType.NUMBER)
"""What takes any `float` as it is."""


class GivenTable:
    """Rows as a table, called `path` where something is amiss."""

    def __init__(self, path: Path, rows: Sequence[Mapping[str, object]]) -> None:
        self._path = path
        self._rows = rows

    @property
    def heads(self) -> tuple[str, ...]:
        """The names that the rows have, without `time`. Raises RecordingError."""
        names = dict.fromkeys(name for row in self._rows for name in row)
        for name in names:
            if not isinstance(name, str):
                raise failure("LTL801", self._path, f"`{name!r}` is not the name of a signal: names are strings")
        return tuple(name for name in names if name != TIME)

    def blocks(self, columns: Mapping[str, Column]) -> Iterator[Block]:
        """The rows. Raises RecordingError, after those before the mistake."""
        return blocks_of(self._each(columns), columns)

    def _each(self, columns: Mapping[str, Column]) -> Iterator[Row]:
        time = None
        for number, row in enumerate(self._rows, 1):
            time = time_given(self._path, number, time, row.get(TIME))
            yield Row(time, cells(self._path, number, row, columns))


def time_given(path: Path, number: int, previous: Nanoseconds | None, seconds: object) -> Nanoseconds:
    """The time of row `number`, which follows that at `previous`, exactly as it is written. Raises RecordingError."""
    # What `repr` writes, if it is whole nanoseconds below 10^6 s, is found without that text:
    # no two such times, which have 15 digits, are the same double.
    if seconds.__class__ is float and -1e6 < seconds < 1e6:
        time = floor(seconds * 1e9 + 0.5)
        if time / 1e9 == seconds and (previous is None or previous <= time <= previous + LONGEST_GAP):
            return time
    if seconds is None:
        raise failure("LTL804", path, f"row {number}: there is no `{TIME}`")
    return time_of_row(path, f"row {number}", previous, str(seconds))


def cells(path: Path, number: int, row: Mapping[str, object], columns: Mapping[str, Column]) -> dict[str, Value]:
    """The values of row `number` that are in `columns`; numbers and arrays may be numpy's. Raises RecordingError."""
    found = {}
    for name, column in columns.items():
        value = row.get(name)
        if value.__class__ is float and column == DOUBLE:
            found[name] = value
        elif value is not None:
            plain = value.tolist() if hasattr(value, "tolist") else value
            found[name] = value_given(path, f"row {number}", name, plain, column)
    return found
