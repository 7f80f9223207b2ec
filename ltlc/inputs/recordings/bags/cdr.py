"""Fields of many CDR messages at once: each becomes a column, and unread fields are skipped.

All messages of a topic are walked through side by side, by their definition, to their ends: one that ends elsewhere is
not what is defined. Where they are in step, a position is one number for all; behind a string or a sequence it is one
for each. Only the elements of arrays of messages and strings are a loop: over the elements' numbers, of all messages
that have as many.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltlc.dataclass import dataclass
from ltlc.inputs.messages.definitions import STRINGS, FieldType, MessageTypes
from ltlc.inputs.recordings.bags.choices import Choice, Path, Tree, in_order, tree
from ltlc.inputs.recordings.bags.messages import Messages, gathered, numbers_at
from ltlc.inputs.recordings.bags.passing import Passing, is_worth
from ltlc.inputs.recordings.bags.scalars import SCALARS, MisfitError
from ltlc.inputs.recordings.blocks import MOST_ELEMENTS, Array, Places, Ragged, Samples
from ltlc.runtime.slice_keys import bytes_text
from ltlc.specification.expressions import Bytes, Parallel

_BOOLEANS = {"bool", "boolean"}
_LONGS = {"i8", "u8"}
HEADER = 4
"""The bytes before a message that give its encoding; positions count from after them."""


PADDING = 4
"""Behind a message there may be bytes up to a multiple of this: RTPS sends submessages that are so long, and some
middleware hands them over as they came."""


def columns(types: MessageTypes, message: str, paths: Iterable[Path], messages: Messages) -> dict[Path, Samples]:
    """What is at each of `paths` in `messages`, which are of the type `message`: no sample where it leads nowhere.

    The paths lead to values by the definitions in `types`. Raises MisfitError, also for a message that is longer or
    shorter than its definition says.
    """
    wanted = tree(paths)
    encodings = _encodings(messages)
    found = [
        _Walk(types, messages, order, wanted).columns(message, rows)
        for order, encoding in (("<", 1), (">", 0))
        if (rows := np.flatnonzero(encodings == encoding)).size
    ]
    every = {path for each in found for path in each}
    return {path: in_order([each[path] for each in found if path in each]) for path in every}


def _encodings(messages: Messages) -> NDArray[Any]:
    """1 for each little-endian message, 0 for big-endian ones."""
    if (messages.sizes < HEADER).any():
        raise MisfitError
    encodings = messages.data[messages.starts + 1]
    if messages.data[messages.starts].any() or (encodings > 1).any():
        raise MisfitError
    return encodings


@dataclass(slots=True)
class _Cursor:
    """Where the reading of the messages in `rows` stands: at bytes behind the header, in all the same or in each."""

    rows: Places
    starts: Places
    at: int | Places = 0

    def align(self, size: int) -> None:
        self.at = (self.at + (size - 1)) & -size

    def skip(self, size: int | Places) -> None:
        self.at = self.at + size
        if not isinstance(self.at, int) and self.at.size and (self.at == self.at[0]).all():
            self.at = int(self.at[0])

    def bytes(self) -> Places:
        """The places in the data."""
        return self.starts + self.at

    def of(self, chosen: Places) -> _Cursor:
        """That for some of its messages."""
        at = self.at if isinstance(self.at, int) else self.at[chosen]
        return _Cursor(self.rows[chosen], self.starts[chosen], at)

    def follow(self, other: _Cursor, chosen: Places) -> None:
        """Some have been read on, by `other`."""
        if len(chosen) == len(self.rows):
            self.at = other.at
        else:
            positions = np.zeros(len(self.rows), np.int64) + self.at
            positions[chosen] = other.at
            self.at = positions


class _Walk:
    """One reading of messages of one byte order."""

    def __init__(self, types: MessageTypes, messages: Messages, order: str, wanted: Tree) -> None:
        self._types = types
        self._data = messages.data
        self._text: memoryview = messages.data.data
        self._messages = messages
        self._order = order
        self._wanted = wanted
        self._longest = int(messages.sizes.max())
        self._passing = Passing(types, messages.data, order, self._longest)

    def columns(self, message: str, rows: Places) -> dict[Path, Samples]:
        """What is wanted of the messages in `rows`. Raises MisfitError."""
        cursor = _Cursor(rows, self._messages.starts[rows] + HEADER)
        try:
            found = self._message(cursor, message, self._wanted)
        except (IndexError, ValueError, struct.error):
            raise MisfitError from None
        self._check_ends(cursor)
        return found

    def _check_ends(self, cursor: _Cursor) -> None:
        """Raise MisfitError unless every message ends where it has been read to, padding aside."""
        sizes = self._messages.sizes[cursor.rows] - HEADER
        left = sizes - cursor.at
        if (left < 0).any():
            raise MisfitError(f"is {_bytes(-int(left.min()))} shorter than")
        over = left[(left >= PADDING) | ((left > 0) & (sizes % PADDING > 0))]
        if over.size:
            raise MisfitError(f"is {_bytes(int(over.max()))} longer than")

    def _message(self, cursor: _Cursor, message: str, wanted: Tree) -> dict[Path, Samples]:
        """Read a message to its end."""
        found: dict[Path, Samples] = {}
        if None in wanted:
            found[()] = Samples(cursor.rows, np.ones(len(cursor.rows), np.bool_))
        indexes = self._indexes(cursor, message, wanted)
        for name, type_ in self._types.messages[message].fields.items():
            part = self._value(cursor, type_, wanted.get(name, {}), indexes)
            found |= {(name, *path): samples for path, samples in part.items()}
        if (cursor.at if isinstance(cursor.at, int) else cursor.at.max(initial=0)) > self._longest:
            raise MisfitError  # before the rest of a definition that never ends is stepped over
        return found

    def _indexes(self, cursor: _Cursor, message: str, wanted: Tree) -> dict[Parallel, Places]:
        """In each message, the index of the name by which an element of a parallel list is selected; -1 without it."""
        steps = {step for part in wanted.values() for step in part if isinstance(step, Parallel)}
        found = {}
        for step in steps:
            ahead = _Cursor(cursor.rows, cursor.starts, cursor.at)
            names = self._message(ahead, message, {step.names: {None: {}}})[(step.names,)]
            found[step] = np.full(len(self._messages.starts), -1, np.int64)
            for row, value in zip(names.rows.tolist(), names.listed(), strict=True):
                if step.value in value:
                    found[step][row] = value.index(step.value)
        return found

    def _value(
        self, cursor: _Cursor, type_: FieldType, wanted: Tree, indexes: Mapping[Parallel, Places]
    ) -> dict[Path, Samples]:
        if type_.length and type_.length > self._longest:
            raise MisfitError  # each element takes a byte at least
        if type_.length and type_.base in SCALARS and not wanted:
            size = np.dtype(SCALARS[type_.base]).itemsize
            cursor.align(size)
            cursor.skip(size * type_.length)
            return {}
        if type_.is_list:
            counts = self._count(cursor) if type_.length == 0 else np.full(len(cursor.rows), type_.length, np.int64)
            if type_.base in SCALARS:
                return self._numbers(cursor, type_.base, counts, wanted, indexes)
            return self._elements(cursor, type_.base, counts, wanted, indexes)
        if type_.base in SCALARS:
            return self._scalar(cursor, type_.base, wanted)
        if type_.base in STRINGS:
            return self._string(cursor, wanted)
        return self._message(cursor, type_.base, wanted)

    def _count(self, cursor: _Cursor) -> Places:
        """How many elements or bytes come next."""
        cursor.align(4)
        counts = self._at(cursor.bytes(), "u4").astype(np.int64)
        if (counts > self._longest).any():
            raise MisfitError
        cursor.skip(4)
        return counts

    def _at(self, places: Places, kind: str) -> Array:
        """The numbers at `places` in the data."""
        return numbers_at(self._data, places, self._order + kind)

    def _scalar(self, cursor: _Cursor, base: str, wanted: Tree) -> dict[Path, Samples]:
        size = np.dtype(SCALARS[base]).itemsize
        cursor.align(size)
        found: dict[Path, Samples] = {}
        if None in wanted:
            found = {(): Samples(cursor.rows, _as_kept(self._at(cursor.bytes(), SCALARS[base]), base))}
        cursor.skip(size)
        return found

    def _string(self, cursor: _Cursor, wanted: Tree) -> dict[Path, Samples]:
        lengths = self._count(cursor)
        found: dict[Path, Samples] = {}
        if None in wanted:
            _check_size(lengths, "a string", "bytes")
            starts = cursor.bytes()
            values = np.empty(len(starts), object)
            values[:] = [
                str(self._text[start : start + max(0, length - 1)], "utf-8", "replace")
                for start, length in zip(starts.tolist(), lengths.tolist(), strict=True)
            ]
            found = {(): Samples(cursor.rows, values)}
        cursor.skip(lengths)
        return found

    def _numbers(
        self, cursor: _Cursor, base: str, counts: Places, wanted: Tree, indexes: Mapping[Parallel, Places]
    ) -> dict[Path, Samples]:
        """Read an array of numbers or booleans; before the elements of an empty one there is no padding."""
        kind = SCALARS[base]
        size = np.dtype(kind).itemsize
        begun = _Cursor(cursor.rows, cursor.starts, cursor.at)
        _begin(begun, size, counts)
        found: dict[Path, Samples] = {}
        if None in wanted:
            _check_size(counts, "an array", "elements")
            found[()] = Samples(cursor.rows, self._whole(begun.bytes(), kind, counts, base))
        if Bytes() in wanted:
            found[(Bytes(),)] = Samples(cursor.rows, self._texts(begun.bytes(), counts))
        for step in wanted:
            if isinstance(step, int | Parallel):
                places = indexes[step][cursor.rows] if isinstance(step, Parallel) else np.full(len(counts), step)
                having = np.flatnonzero((places >= 0) & (counts > places))
                values = self._at(begun.of(having).bytes() + places[having] * size, kind)
                found[(step,)] = Samples(cursor.rows[having], _as_kept(values, base))
        cursor.at = begun.at
        cursor.skip(counts * size)
        return found

    def _texts(self, starts: Places, counts: Places) -> Array:
        """So many bytes as text, from each of these places on."""
        texts = np.empty(len(starts), object)
        pairs = zip(starts.tolist(), counts.tolist(), strict=True)
        texts[:] = [bytes_text(bytes(self._text[start : start + count])) for start, count in pairs]
        return texts

    def _only_kind(self, base: str) -> tuple[int, int] | None:
        """The size and the count of the numbers that a message is made of, if they are all of one size."""
        if base in SCALARS:
            return np.dtype(SCALARS[base]).itemsize, 1
        sizes, count = set(), 0
        for type_ in self._types.messages[base].fields.values() if base not in STRINGS else ():
            inner = None if type_.length == 0 else self._only_kind(type_.base)
            if inner is None:
                return None
            sizes.add(inner[0])
            count += inner[1] * (type_.length or 1)
        return (sizes.pop(), count) if len(sizes) == 1 else None

    def _whole(self, starts: Places, kind: str, counts: Places, base: str) -> Ragged:
        sizes = counts * np.dtype(kind).itemsize
        if (starts + sizes > len(self._data)).any():
            raise MisfitError
        elements = gathered(self._data, starts, sizes).view(self._order + kind)
        return Ragged(_as_kept(elements, base), counts)

    def _elements(
        self, cursor: _Cursor, base: str, counts: Places, wanted: Tree, indexes: Mapping[Parallel, Places]
    ) -> dict[Path, Samples]:
        """Read a list of messages or strings, element by element."""
        kind = None if wanted else self._only_kind(base)
        if kind is not None:
            _begin(cursor, kind[0], counts)
            cursor.skip(counts * kind[1] * kind[0])
            return {}
        choice = Choice(wanted, len(self._messages.starts), indexes)
        most = int(counts.max()) if counts.size else 0
        for number in range(min(most, choice.end)):
            chosen = np.flatnonzero(counts > number)
            of = cursor.of(chosen)
            element = self._value(of, FieldType(base), choice.inside, {})
            cursor.follow(of, chosen)
            choice.take(number, of.rows, element)
        if most > choice.end:
            self._pass(cursor, base, np.maximum(counts - choice.end, 0))
        return choice.found(cursor.rows, counts)

    def _pass(self, cursor: _Cursor, base: str, counts: Places) -> None:
        """Step over so many messages or strings, of which nothing is wanted."""
        if is_worth(counts):
            cursor.at = self._passing.all(base, counts, cursor.starts, cursor.at)
            return
        for number in range(int(counts.max())):
            chosen = np.flatnonzero(counts > number)
            of = cursor.of(chosen)
            self._value(of, FieldType(base), {}, {})
            cursor.follow(of, chosen)


def _check_size(counts: Places, what: str, of: str) -> None:
    """Raise MisfitError if more is to be read of a message than can be held."""
    most = int(counts.max(initial=0))
    if most > MOST_ELEMENTS:
        raise MisfitError(f"has {what} of {most} {of}, more than the maximum of {MOST_ELEMENTS}, in")


def _bytes(count: int) -> str:
    return f"{count} byte{'' if count == 1 else 's'}"


def _begin(cursor: _Cursor, size: int, counts: Places) -> None:
    """Go to the first of so many numbers of this size; before none of them there is no padding."""
    before = cursor.at
    cursor.align(size)
    if not counts.all():
        cursor.at = np.where(counts > 0, cursor.at, before)


def _as_kept(values: Array, base: str) -> Array:
    """Numbers that have been taken from the data as samples have them."""
    if base in _BOOLEANS:
        truths: Array = values != 0
        return truths
    kind = SCALARS[base]
    with np.errstate(invalid="ignore"):  # a signalling NaN is one like any other
        return values.astype(kind if kind in _LONGS else np.float64, copy=False)
