"""Message definitions: what fields and constants a message type has, for ROS 2 Jazzy and for folders of `.msg` files.

The only importer of rosbags here, and only where `.msg` files have to be read.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

Constant = float | bool | str
"""The value of a constant of a message; whole numbers are floats too."""

NUMERIC = frozenset(
    [
        "byte",
        "char",
        "int8",
        "int16",
        "int32",
        "int64",
        "uint8",
        "uint16",
        "uint32",
        "uint64",
        "octet",
        "float",
        "float32",
        "float64",
        "float128",
        "double",
    ]
)
"""The primitive types whose values are numbers."""

STRINGS = frozenset({"string", "wstring"})
"""The primitive types whose values are strings."""


@dataclass(frozen=True, slots=True)
class FieldType:
    """The type of a field: `base` is a primitive or the full name of a message.

    `length` is None for a single value, 0 for a list of any length, else the number of elements.
    """

    base: str
    length: int | None = None

    @property
    def is_list(self) -> bool:
        """Whether the field has elements."""
        return self.length is not None

    def __str__(self) -> str:
        return self.base if self.length is None else f"{self.base}[{self.length or ''}]"


@dataclass(frozen=True, slots=True)
class Message:
    """The fields of a message type and its constants, by name and in their order."""

    fields: Mapping[str, FieldType]
    constants: Mapping[str, Constant]


@dataclass(frozen=True)
class MessageTypes:
    """All known message types, by full name (`nav_msgs/msg/Odometry`)."""

    messages: Mapping[str, Message]

    @cached_property
    def _by_short_name(self) -> dict[str, list[str]]:
        found: dict[str, list[str]] = {}
        for full in self.messages:
            found.setdefault(full.rpartition("/")[2], []).append(full)
        return found

    @property
    def short_names(self) -> Iterable[str]:
        """The names without packages."""
        return self._by_short_name.keys()

    def find(self, name: str) -> list[str]:
        """The full names that `name` can stand for: `Odometry`, `nav_msgs/Odometry` or `nav_msgs/msg/Odometry`."""
        package, _, short = name.rpartition("/")
        if not package:
            return self._by_short_name.get(short, [])
        full = f"{package.removesuffix('/msg')}/msg/{short}"
        return [full] if full in self.messages else []


@dataclass(frozen=True, slots=True)
class BadPath:
    """A message path, or a file below it, that cannot be used, and why."""

    path: str
    reason: str


def message_types(paths: Sequence[str] = ()) -> tuple[MessageTypes, list[BadPath]]:
    """The messages of Jazzy and those below `paths`, which win; with what could not be read."""
    messages = dict(_shipped())
    problems: list[BadPath] = []
    for path in paths:
        found, bad = _read_folder(Path(path))
        messages.update(found)
        problems.extend(bad)
    return MessageTypes(messages), problems


def _shipped() -> dict[str, Message]:
    data = json.loads((Path(__file__).parent / "jazzy.json").read_bytes())
    return {name: _message(*definition) for name, definition in data["messages"].items()}


def _message(fields: dict[str, str], constants: dict[str, Constant]) -> Message:
    return Message({name: _field_type(text) for name, text in fields.items()}, constants)


def _field_type(text: str) -> FieldType:
    base, bracket, length = text.partition("[")
    return FieldType(base, int(length.removesuffix("]") or 0) if bracket else None)


def jazzy_definitions() -> dict[str, Any]:
    """What `jazzy.json` holds: for each message of rosbags' Jazzy store its fields and constants.

    `gazebo_msgs/ModelStates` is added: Gazebo Classic's ground truth, which is not a part of ROS 2 itself.
    """
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: TID251

    definitions = dict(get_typestore(Stores.ROS2_JAZZY).fielddefs)
    states = "string[] name\ngeometry_msgs/Pose[] pose\ngeometry_msgs/Twist[] twist\n"
    definitions.update(get_types_from_msg(states, "gazebo_msgs/msg/ModelStates"))
    return {"messages": {name: _encode(definitions[name]) for name in sorted(definitions)}}


def _encode(definition: Any) -> tuple[dict[str, str], dict[str, Constant]]:
    """The fields and constants of a message in rosbags' form as text and plain values."""
    constants, fields = definition
    return (
        {name: str(_decode_type(description)) for name, description in fields},
        {name: float(value) if _is_number(value) else value for name, _, value in constants},
    )


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _decode_type(description: Any) -> FieldType:
    """A field's type from rosbags' description: (kind, content), the kinds being base, name, array and sequence."""
    kind, content = description
    match kind.name:
        case "BASE":
            return FieldType(content[0])
        case "NAME":
            return FieldType(content)
        case "ARRAY":
            return FieldType(_decode_type(content[0]).base, content[1])
        case _:
            return FieldType(_decode_type(content[0]).base, 0)


def _read_folder(folder: Path) -> tuple[dict[str, Message], list[BadPath]]:
    """The messages below a folder: packages in it, a package itself, or loose `.msg` files."""
    if not folder.is_dir():
        reason = "is not a folder" if folder.exists() else "does not exist"
        return {}, [BadPath(str(folder), reason)]
    files = sorted(folder.rglob("*.msg"))
    if not files:
        return {}, [BadPath(str(folder), "holds no .msg file")]
    messages: dict[str, Message] = {}
    problems: list[BadPath] = []
    for file in files:
        try:
            messages.update(_read_message(file, _package(file, folder)))
        except (OSError, ValueError) as error:
            problems.append(BadPath(str(file), str(error)))
    return messages, problems


def _package(file: Path, folder: Path) -> str:
    """The package of a `.msg` file: the folder with `package.xml` or around `msg/`, else that of the loose file."""
    for parent in file.parents:
        if (parent / "package.xml").is_file():
            return parent.name
        if parent == folder.parent:
            break
    home = file.parent.parent if file.parent.name == "msg" else file.parent
    return home.resolve().name


def _read_message(file: Path, package: str) -> dict[str, Message]:
    """The message that `file` defines. Raises ValueError if it is not a message definition."""
    from rosbags.typesys import TypesysError, get_types_from_msg  # noqa: TID251

    try:
        found = get_types_from_msg(file.read_text(encoding="utf-8"), f"{package}/msg/{file.stem}")
        return {name: _message(*_encode(definition)) for name, definition in found.items()}
    except UnicodeDecodeError:
        raise ValueError("is not UTF-8") from None
    except TypesysError as error:
        raise ValueError(f"is not a message definition: {error}") from None
