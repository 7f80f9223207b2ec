"""Messages for the replay: those of ROS packages where they are installed, else stand-ins with the same fields."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

from ltlc.backends.ros2.node.classes import class_of
from ltlc.inputs.messages.definitions import STRINGS, FieldType, MessageTypes
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Each, Match, Parallel, PathStep

Path = tuple[PathStep, ...]
Content = Mapping[Path, Value]
"""What stands where in a message; what does not is as it is by default, entries that are not named are absent."""

_CODES = {
    "char": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
"""The numbers of messages as `array` calls them."""

_BYTES = ("byte", "octet")
"""The types whose values are `bytes` in Python."""

_OTHER = "another entry"


class Messages:
    """Makes messages of the types that a specification knows."""

    def __init__(self, types: MessageTypes) -> None:
        self.types = types
        self._classes: dict[str, Any] = {}

    def type_at(self, message: str, path: Path) -> FieldType:
        """The type of the field that `path` leads to in a message."""
        return self.types.along(message, path)[-1]

    def is_installed(self, message: str) -> bool:
        """Whether the package of a message is installed here, and defines it and its parts in the same way."""
        return self._class(message) is not None

    def _class(self, message: str) -> Any:
        if message not in self._classes:
            fields = self.types.messages[message].fields
            try:
                found = class_of(message)
                is_same = [*found.get_fields_and_field_types()] == [*fields]
            except (ImportError, AttributeError):
                is_same = False
            parts = (f.base for f in fields.values() if f.base in self.types.messages)
            self._classes[message] = found if is_same and all(map(self.is_installed, parts)) else None
        return self._classes[message]

    def build(self, message: str, content: Content) -> Any:
        """A message with this content."""
        made = self._empty(message)
        parallel = {step for path in content for step in path[1:2] if isinstance(step, Parallel)}
        entities = sorted({step.value for step in parallel})
        for name, inside in _by_step(content).items():
            assert isinstance(name, str)
            setattr(made, name, self._field(self.types.messages[message].fields[name], inside, entities))
        for names in {step.names for step in parallel}:
            setattr(made, names, [_OTHER, *entities, *entities])
        return made

    def _empty(self, message: str) -> Any:
        """A message as it is by default."""
        found = self._class(message)
        if found is not None:
            return found()
        fields = self.types.messages[message].fields
        return SimpleNamespace(**{name: self._default(type_) for name, type_ in fields.items()})

    def _default(self, type_: FieldType) -> Any:
        if type_.length is not None:
            return _stored(type_, [self._default(FieldType(type_.base)) for _ in range(type_.length)])
        if type_.base in self.types.messages:
            return self._empty(type_.base)
        if type_.base in STRINGS:
            return ""
        return False if type_.base in ("bool", "boolean") else _number(type_, 0.0)

    def _field(self, type_: FieldType, inside: Content, entities: Sequence[str]) -> Any:
        if () in inside:
            return _leaf(type_, inside[()])
        if not type_.is_list:
            return self.build(type_.base, inside)
        element = FieldType(type_.base)
        given = _written_out(_by_step(inside))
        found = {step: self._field(element, rest, ()) for step, rest in given.items()}
        named = [step for step in found if isinstance(step, Match)]
        if named:
            return self._told_apart(element, named, found)
        by_name = {step.value: step for step in found if isinstance(step, Parallel)}
        order: list[PathStep | None] = [None, *(by_name.get(entity) for entity in entities), *(None for _ in entities)]
        if not by_name:
            order = [*range(type_.length or 1 + max((step for step in found if isinstance(step, int)), default=-1))]
        return _stored(type_, [self._default(element) if s not in found else found[s] for s in order])

    def _told_apart(self, element: FieldType, named: Sequence[Match], found: Mapping[PathStep, Any]) -> list[Any]:
        """Entries with a name, behind one with another name and before some with the same: the first one counts."""
        entries = [self._default(element) for _ in range(1 + len(named))]
        for entry, step in zip(entries[1:], named, strict=True):
            setattr(entry, step.key, step.value)
            setattr(found[step], step.key, step.value)
        setattr(entries[0], named[0].key, _OTHER)
        return [entries[0], *(found[step] for step in named), *entries[1:]]


def _by_step(content: Content) -> dict[PathStep, dict[Path, Value]]:
    """The content by the first steps of its paths; a message of which no field is read has none."""
    parts: dict[PathStep, dict[Path, Value]] = {}
    for path, value in content.items():
        if not path:
            continue
        parts.setdefault(path[0], {})[path[1:]] = value
    return parts


def _written_out(given: dict[PathStep, dict[Path, Value]]) -> dict[PathStep, dict[Path, Value]]:
    """What is said of each entry of a list, entry by entry."""
    for path, values in given.pop(Each(), {}).items():
        assert isinstance(values, tuple)
        for index, value in enumerate(values):
            given.setdefault(index, {})[path] = value
    return given


def _leaf(type_: FieldType, value: Value) -> Any:
    if isinstance(value, tuple):
        return _stored(type_, [_leaf(FieldType(type_.base), v) for v in value])
    return value if isinstance(value, bool | str) else _number(type_, value)


def _number(type_: FieldType, value: float) -> Any:
    """A number as rclpy has it: a byte as `bytes`."""
    if type_.base in _BYTES:
        return bytes([int(value)])
    code = _CODES.get(type_.base, "d")
    return value if code in "fd" else int(value)


def _stored(type_: FieldType, items: list[Any]) -> Any:
    """A list as rclpy has it: numbers in an `array`, or if their count is fixed, in one of NumPy's."""
    if type_.base not in _CODES:
        return items
    if not type_.length:
        return array(_CODES[type_.base], items)
    import numpy  # half of a build's start, and few messages have such fields

    return numpy.array(items, dtype=_CODES[type_.base])
