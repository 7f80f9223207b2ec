"""Message definitions of the distributions of ROS 2 beside Jazzy, as rosbags ships them: for recordings without any."""

from __future__ import annotations

from rosbags.typesys import Stores, get_typestore  # noqa: TID251

from ltlc.inputs.messages.definitions import Message
from ltlc.inputs.messages.folders import from_rosbags


def messages_of(distribution: str) -> dict[str, Message]:
    """The messages of a distribution, `humble`; none if it is not known."""
    name = f"ROS2_{distribution.upper()}"
    if name not in Stores.__members__:
        return {}
    return {full: from_rosbags(definition) for full, definition in get_typestore(Stores[name]).fielddefs.items()}
