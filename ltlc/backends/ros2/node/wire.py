"""Fields of messages as they are on the wire (CDR), read without making the message."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from rclpy.serialization import deserialize_message, serialize_message

from ltlc.backends.ros2.node.classes import class_of
from ltlc.backends.ros2.node.topics import Topic
from ltlc.runtime.sampling import Value

CODES = {
    "boolean": "?",
    "octet": "B",
    "char": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float": "f",
    "double": "d",
}
"""The primitive types as `struct` calls them."""

LITTLE_ENDIAN = b"\x00\x01"
"""How a message in plain CDR begins, if its numbers are little-endian."""

HEADER = 4
"""How many bytes stand before what is aligned."""

MOST_ITEMS = 10_000
"""How many fields are looked at before the last that is wanted."""


MALFORMED = (struct.error, ValueError, RuntimeError, MemoryError)
"""Raised for bytes that are not a message of the expected type."""


class UnsupportedError(Exception):
    """Something stands before a field that is wanted that cannot be passed over."""


@dataclass(frozen=True, slots=True)
class Item:
    """A field in its place: `count` values of a code, None for as many as it tells.

    A string has the code `s`. It is wanted as one value if `path` is one that is.
    """

    path: tuple[str, ...]
    code: str
    count: int | None = 1


Reader = Callable[[bytes], Sequence[Value]]
"""Reads the fields of a topic from a serialised message; raises one of `MALFORMED`."""


def message_reader(topic: Topic, type_: Any) -> Reader:
    """What makes the message, of the class `type_`, and takes the fields from it."""

    def values(data: bytes) -> Sequence[Value]:
        found = unpacked(topic.read(deserialize_message(data, type_)))
        for value in found:
            _refuse_replaced(value, data)
        return found

    return values


def unpacked(values: Sequence[Value]) -> Sequence[Value]:
    """`values` with numbers for the ROS type `byte`, which rclpy gives as `bytes`."""
    return [_unpacked(value) for value in values]


def _unpacked(value: Value) -> Value:
    if isinstance(value, list):
        return [_unpacked(part) for part in value]
    return value[0] if isinstance(value, bytes) else value


def _refuse_replaced(value: Value, data: bytes) -> None:
    """Raise ValueError if rclpy has put U+FFFD for what is not UTF-8 in `data`."""
    if isinstance(value, list):
        for part in value:
            _refuse_replaced(part, data)
    elif isinstance(value, str) and "\ufffd" in value and value.encode() not in data:
        raise ValueError(f"{value!r} is not UTF-8")


def fields_reader(topic: Topic, type_: Any, decoded: Reader) -> Reader | None:
    """What reads the fields of `topic` from serialised messages of the class `type_`.

    None where that is not known to give what `topic.read` takes from the message; a
    message in another byte order is left to `decoded`.
    """
    if not topic.paths:
        return None
    try:
        extract = Extractor(type_, topic.paths)
        probe = _filled(type_(), topic.paths)
        same = _plain(extract(serialize_message(probe))) == _plain(topic.read(probe))
    except (UnsupportedError, AttributeError, struct.error):
        return None

    def read(data: bytes) -> Sequence[Value]:
        if data[:2] == LITTLE_ENDIAN:
            return extract(data)
        return decoded(data)

    return read if same else None


def _plain(value: Any) -> Any:
    """A value with arrays as lists, which compare, and numbers for bytes."""
    if isinstance(value, bytes):
        return value[0]
    if isinstance(value, (str, bool, int, float)):
        return value
    return [_plain(item) for item in value]


def _filled(message: Any, paths: Sequence[tuple[str, ...]]) -> Any:
    """`message` with a value of its own in each of `paths`."""
    for number, (*parents, name) in enumerate(dict.fromkeys(filter(None, paths)), 1):
        place = message
        for parent in parents:
            place = getattr(place, parent)
        value = getattr(place, name)
        if isinstance(value, (bool, str, bytes, int, float)):
            of = {bool: True, str: "\u00e9" * number, bytes: bytes([number % 256])}
            new = of.get(type(value), type(value)(number % 100))
        else:
            new = [type(item)(number % 100) for item in value]
            new = new or _three(place, name)
        setattr(place, name, new)
    return message


def _three(message: Any, name: str) -> Any:
    """Three elements, if the array is one of numbers that may have any length."""
    type_ = message.get_fields_and_field_types()[name]
    inner = type_.removeprefix("sequence<").removesuffix(">")
    if inner in ("float", "double"):
        return [0.5, 1.5, 2.5]
    is_number = inner in CODES and inner not in ("boolean", "octet")
    return [1, 2, 3] if is_number else []


class Extractor:
    """Reads the fields at some paths of the messages of a class."""

    def __init__(self, type_: Any, paths: Sequence[tuple[str, ...]]) -> None:
        """Raises UnsupportedError, also if a path leads to no value of such a field."""
        wanted = dict.fromkeys(filter(None, paths))
        self._segments: list[Segment] = []
        found: list[tuple[str, ...]] = []
        run: list[tuple[Item, bool]] = []
        for number, item in enumerate(_items(type_, ())):
            if number > MOST_ITEMS:
                raise UnsupportedError
            is_wanted = item.path in wanted
            if is_wanted:
                found.append(item.path)
            is_whole = is_wanted and item.count != 1
            if item.count is not None and not is_whole:
                run.append((item, is_wanted))
            else:
                self._segments.append(Segment(run, item, is_wanted))
                run = []
            if len(found) == len(wanted):
                break
        else:
            raise UnsupportedError
        if run:
            self._segments.append(Segment(run, None, False))
        self._places = [found.index(path) if path else -1 for path in paths]

    def __call__(self, data: bytes) -> list[Value]:
        """The values in the order of the paths. Raises struct.error."""
        position = HEADER
        found: list[Value] = []
        for segment in self._segments:
            position = segment.read(data, position, found)
        found.append(True)  # what a message says of which no field is wanted
        return [found[place] for place in self._places]


class Segment:
    """Fields of fixed size one after the other, and then a list or a string.

    How far fields are apart depends on where the first one begins, modulo 8.
    """

    __slots__ = ("_is_wanted", "_last", "_layouts")

    def __init__(
        self, run: Sequence[tuple[Item, bool]], last: Item | None, is_wanted: bool
    ) -> None:
        self._last = last
        self._is_wanted = is_wanted
        tells = last is not None and last.count is None
        self._layouts = [_layout(run, start, tells) for start in range(8)]

    def read(self, data: bytes, position: int, found: list[Value]) -> int:
        """Add what is wanted to `found`; where the next segment begins."""
        layout = self._layouts[(position - HEADER) % 8]
        values = layout.unpack_from(data, position)
        position += layout.size
        if self._last is None:
            found += values
            return position
        count = self._last.count
        if count is None:
            values, count = values[:-1], values[-1]
        found += values
        return self._read_last(self._last.code, count, data, position, found)

    def _read_last(
        self, code: str, count: int, data: bytes, position: int, found: list[Value]
    ) -> int:
        if code == "s":
            if self._is_wanted:
                found.append(_text(data[position : position + count], count))
            return position + count
        size = struct.calcsize(code)
        if count:
            position += (HEADER - position) % size
        if self._is_wanted:
            found.append(struct.unpack_from(f"<{count}{code}", data, position))
        return position + count * size


def _text(data: bytes, count: int) -> str:
    """The string in `data`, which should be `count` bytes with a zero at the end."""
    if len(data) < count or data[-1:] not in (b"", b"\0"):
        raise ValueError("a string has no end")
    return data[:-1].decode()


def _layout(run: Sequence[tuple[Item, bool]], start: int, tells: bool) -> struct.Struct:
    """A run that begins at `start` modulo 8, and the length that stands after it."""
    layout, place = "<", start
    items = [*run, (Item((), "I"), True)] if tells else run
    for item, is_wanted in items:
        size = struct.calcsize(item.code)
        gap = -place % size
        whole = size * (item.count or 0)
        layout += f"{gap}x" + (item.code if is_wanted else f"{whole}x")
        place += gap + whole
    return struct.Struct(layout)


def _items(type_: Any, path: tuple[str, ...]) -> Iterator[Item]:
    """The fields of a class of messages, those of messages inside in their places."""
    names = type_.get_fields_and_field_types()
    if not names:
        yield Item(path, "B")  # what is empty is a byte on the wire
    for name, slot in zip(names, type_.SLOT_TYPES, strict=True):
        yield from _parts(slot, (*path, name))


def _parts(slot: Any, path: tuple[str, ...]) -> Iterator[Item]:
    """The parts of a field, by the name of its ROS type."""
    match type(slot).__name__:
        case "BasicType" if slot.typename in CODES:
            yield Item(path, CODES[slot.typename])
        case "UnboundedString" | "BoundedString":
            yield Item(path, "s", None)
        case "NamespacedType":
            yield from _items(class_of("/".join(slot.namespaced_name())), path)
        case "Array" if getattr(slot.value_type, "typename", "") in CODES:
            yield Item(path, CODES[slot.value_type.typename], slot.size)
        case "Array":
            for _ in range(slot.size):
                yield from _parts(slot.value_type, ())
        case "UnboundedSequence" | "BoundedSequence" if (
            getattr(slot.value_type, "typename", "") in CODES
        ):
            yield Item(path, CODES[slot.value_type.typename], None)
        case _:
            raise UnsupportedError
