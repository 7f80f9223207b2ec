"""Arrays in recordings: `scan` from the columns `scan[0]`, `scan[1]`, …, and `scan[3]` from the column `scan`."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Protocol

from ltlc.recordings.blocks import Block, blocks_of
from ltlc.recordings.rows import Column, Columns, Row, failure
from ltlc.runtime.sampling import Value
from ltlc.runtime.times import seconds_text
from ltlc.specification.expressions import ValueType

_ELEMENT = re.compile(r"(.+)\[([0-9]{1,9})\]")


def columns_of(wanted: Mapping[str, Column]) -> Columns:
    """What is in each column from which one of the `wanted` signals can be read; None for other columns."""
    arrays = {type_.element: type_ for type_ in ValueType if type_.element is not None}
    of_elements = {
        array: Column(arrays[one.type], one.numbers)
        for name, one in wanted.items()
        if (array := _array_and_index(name)[0]) and one.type in arrays
    }

    def column_of(name: str) -> Column | None:
        if name in wanted:
            return wanted[name]
        array, _ = _array_and_index(name)
        if array not in wanted:
            return of_elements.get(name)
        element = wanted[array].type.element
        return None if element is None else Column(element, wanted[array].numbers)

    return column_of


def _array_and_index(name: str) -> tuple[str, int]:
    """The array and the index, if `name` is that of an element."""
    match = _ELEMENT.fullmatch(name)
    return (match.group(1), int(match.group(2))) if match else ("", 0)


class Table(Protocol):
    """A recording as text, before its columns are read as signals."""

    @property
    def columns(self) -> tuple[str, ...]:
        """The heads of its columns, in the order of their first use; not `time`."""
        ...

    def rows(self) -> Iterator[Row]:
        """The rows, in the order of the file; times do not decrease. Raises RecordingError."""
        ...


class WithArrays:
    """A table, its columns read as the signals `wanted` have it. Raises RecordingError."""

    def __init__(self, path: Path, recording: Table, wanted: Mapping[str, Column]) -> None:
        self._path = path
        self._recording = recording
        self._columns = recording.columns
        self._wanted = wanted
        self._gathered = {name: self._elements(name) for name in wanted if wanted[name].type.element is not None}
        self._gathered = {name: columns for name, columns in self._gathered.items() if columns}
        given = {name: _array_and_index(name) for name in wanted if name not in self._columns}
        self._taken = {name: place for name, place in given.items() if place[0] in self._columns}

    def _elements(self, array: str) -> list[str]:
        """The columns that have the elements of `array`, in their order; none if it has a column itself."""
        if array in self._columns:
            return []
        indexes = sorted(index for name in self._columns for of, index in [_array_and_index(name)] if of == array)
        missing = next((number for number, index in enumerate(indexes) if number != index), None)
        if missing is not None:
            message = f"there is a column `{array}[{indexes[-1]}]`, but none is headed `{array}[{missing}]`"
            raise failure("LTL801", self._path, message, help="the elements of an array are numbered from 0")
        return [f"{array}[{index}]" for index in indexes]

    @property
    def columns(self) -> tuple[str, ...]:
        """What the recording has values of."""
        used = {name for columns in self._gathered.values() for name in columns} | {a for a, _ in self._taken.values()}
        kept = (name for name in self._columns if name in self._wanted or name not in used)
        return (*kept, *self._gathered, *self._taken)

    def absence(self, name: str) -> str:
        """Why there is no sample of the signal `name`."""
        return f"the recording has no column `{name}`"

    def blocks(self) -> Iterator[Block]:
        """The rows by columns."""
        columns = set(self.columns)
        return blocks_of(self.rows(), {name: of for name, of in self._wanted.items() if name in columns})

    def rows(self) -> Iterator[Row]:
        """The rows, arrays gathered from the columns of their elements, and elements taken from arrays."""
        for row in self._recording.rows():
            values = dict(row.values)
            for array, columns in self._gathered.items():
                elements = [row.values.get(name) for name in columns]
                while elements and elements[-1] is None:
                    elements.pop()
                if elements:
                    values[array] = self._whole(row, columns, elements)
            for name, (array, index) in self._taken.items():
                if len(row.values.get(array, ())) > index:
                    values[name] = row.values[array][index]
            yield Row(row.time, values)

    def _whole(self, row: Row, columns: list[str], elements: list[Value]) -> Value:
        if None not in elements:
            return tuple(elements)
        last, empty = columns[len(elements) - 1], columns[elements.index(None)]
        message = f"at {seconds_text(row.time)} s `{empty}` is empty, but `{last}` is not"
        raise failure("LTL803", self._path, message, help="a shorter array ends earlier; `nan` is no measurement")
