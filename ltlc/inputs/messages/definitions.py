"""Message definitions: what fields and constants a message type has, and those of ROS 2 Jazzy.

Actions and services are made of messages: `nav2_msgs/action/NavigateToPose_FeedbackMessage`.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cache, cached_property
from pathlib import Path

from ltlc.dataclass import dataclass

Constant = float | bool | str
"""The value of a constant of a message; whole numbers are floats too, where there is one."""

STRINGS = frozenset({"string", "wstring"})
"""The primitive types whose values are strings."""


PLACEHOLDER = "structure_needs_at_least_one_member"
"""The field, a `uint8`, that a message without fields has on the wire."""


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
    """The fields of a message type and its constants, by name and in their order.

    If `is_partial`, there are others: nothing is read from the wire by it.
    """

    fields: Mapping[str, FieldType]
    constants: Mapping[str, Constant]
    is_partial: bool = False


@dataclass(frozen=True)
class MessageTypes:
    """All known message types, by full name (`nav_msgs/msg/Odometry`, `std_srvs/srv/SetBool_Event`)."""

    messages: Mapping[str, Message]

    @cached_property
    def _by_short_name(self) -> dict[str, list[str]]:
        found: dict[str, list[str]] = {}
        for full in self.messages:
            found.setdefault(full.rpartition("/")[2], []).append(full)
        return found

    def along(self, message: str, path: Iterable[object]) -> list[FieldType]:
        """The types of what `path` leads through in a message, the message first.

        A step that is the name of a field leads to it, any other to an element of a list.
        """
        found = [FieldType(message)]
        for step in path:
            base = found[-1].base
            found.append(self.messages[base].fields[step] if isinstance(step, str) else FieldType(base))
        return found

    @property
    def short_names(self) -> Iterable[str]:
        """The names without packages."""
        return self._by_short_name.keys()

    def find(self, name: str) -> list[str]:
        """The full names that `name` can stand for: `Odometry`, `nav_msgs/Odometry` or `nav_msgs/msg/Odometry`."""
        package, _, short = name.rpartition("/")
        known = self._by_short_name.get(short, [])
        return [full for full in known if package in ("", full.partition("/")[0], full.rpartition("/")[0])]


@dataclass(frozen=True, slots=True)
class BadPath:
    """A message path, or a file below it, that cannot be used, and why."""

    path: str
    reason: str


JAZZY = "jazzy"
"""The distribution whose messages are known without being asked for."""


@cache
def shipped(distribution: str = JAZZY) -> Mapping[str, Message]:
    """The messages of a distribution of ROS 2; none if it is not known."""
    if distribution != JAZZY:
        from ltlc.inputs.messages.distributions import messages_of

        return messages_of(distribution)
    data = json.loads((Path(__file__).parent / "jazzy.json").read_bytes())
    return {name: _message(*definition) for name, definition in data["messages"].items()}


@cache
def read_by_packs() -> Mapping[str, Message]:
    """The messages beside those of Jazzy from which rule packs read, each with the fields that they read."""
    data = json.loads((Path(__file__).parent / "packs.json").read_bytes())
    return {name: replace(_message(fields, {}), is_partial=True) for name, fields in data.items()}


def _message(fields: dict[str, str], constants: dict[str, Constant]) -> Message:
    return Message({name: _field_type(text) for name, text in fields.items()}, constants)


def _field_type(text: str) -> FieldType:
    base, bracket, length = text.partition("[")
    return FieldType(base, int(length.removesuffix("]") or 0) if bracket else None)
