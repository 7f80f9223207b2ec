"""Message definitions of the distributions of ROS 2 beside Jazzy, as rosbags ships them: for recordings without any."""

from __future__ import annotations

from typing import Any

from rosbags.typesys import Stores, get_typestore  # noqa: TID251

from ltlc.inputs.messages.definitions import Constant, FieldType, Message
from ltlc.specification.wire import double_or_integer


def messages_of(distribution: str) -> dict[str, Message]:
    """The messages of a distribution, `humble`; none if it is not known."""
    name = f"ROS2_{distribution.upper()}"
    if name not in Stores.__members__:
        return {}
    return {full: from_rosbags(definition) for full, definition in get_typestore(Stores[name]).fielddefs.items()}


def from_rosbags(definition: Any) -> Message:
    """A message from its constants and fields as rosbags has them."""
    constants, fields = definition
    return Message(
        {name: _field_type(description) for name, description in fields},
        {name: _constant(value) for name, _, value in constants},
    )


def _constant(value: Constant) -> Constant:
    return double_or_integer(value) if isinstance(value, int) and not isinstance(value, bool) else value


def _field_type(description: Any) -> FieldType:
    """A field's type from rosbags' description: (kind, content), the kinds being base, name, array and sequence."""
    kind, content = description
    match kind.name:
        case "BASE":
            return FieldType(content[0])
        case "NAME":
            return FieldType(content)
        case "ARRAY":
            return FieldType(_field_type(content[0]).base, content[1])
        case _:
            return FieldType(_field_type(content[0]).base, 0)
