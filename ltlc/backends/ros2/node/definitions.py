"""What messages look like, as text, and how publishers send them, as bags have both."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from ltlc.backends.ros2.node.classes import class_of

PRIMITIVES_OF_MSG = {
    "boolean": "bool",
    "octet": "byte",
    "float": "float32",
    "double": "float64",
}
"""Types of fields that rosidl calls otherwise than definitions of messages do."""

SEQUENCE = re.compile(r"sequence<(.+?)(?:, (\d+))?>")


def definition_text(message: str) -> str:
    """The definition of a type and of what it contains, without constants."""
    sections, todo = [], [message]
    for name in todo:
        package, kind, _ = name.split("/")
        fields = class_of(name).get_fields_and_field_types().items()
        lines = []
        for member, written in fields:
            base, length = base_and_length(written)
            if "/" in base:
                of = base.split("/")
                full = f"{of[0]}/{kind if of[0] == package else 'msg'}/{of[-1]}"
                todo += [full] if full not in todo else []
            lines.append(f"{PRIMITIVES_OF_MSG.get(base, base)}{length} {member}\n")
        sections.append("".join(lines) or "# no fields\n")
    heads = ["", *(f"{'=' * 80}\nMSG: {short_name(name)}\n" for name in todo[1:])]
    return "".join(head + text for head, text in zip(heads, sections, strict=True))


def short_name(message: str) -> str:
    """The name of a type without `msg`."""
    package, _, name = message.split("/")
    return f"{package}/{name}"


def base_and_length(written: str) -> tuple[str, str]:
    """The type of a field, or of its elements, and its length as in `[36]`."""
    sequence = SEQUENCE.fullmatch(written)
    if sequence is not None:
        base, most = sequence.groups()
        length = f"[<={most}]" if most else "[]"
    else:
        base, bracket, rest = written.partition("[")
        length = bracket + rest
    return re.sub(r"<(\d+)>", r"<=\1", base), length


def quality_text(publishers: Iterable[Any]) -> str:
    """The quality of service that publishers offer, as rosbag2 writes it (YAML)."""
    return "".join(one_quality(each.qos_profile) for each in publishers)


def one_quality(profile: Any) -> str:
    """That of one of them; what the network does not provide is the default."""
    endless = "\n    sec: 9223372036\n    nsec: 854775807"
    parts = {
        "history": "unknown",
        "depth": "0",
        "reliability": profile.reliability.name.lower(),
        "durability": profile.durability.name.lower(),
        "deadline": endless,
        "lifespan": endless,
        "liveliness": "automatic",
        "liveliness_lease_duration": endless,
        "avoid_ros_namespace_conventions": "false",
    }
    lines = [f"{key}: {value}".replace(": \n", ":\n") for key, value in parts.items()]
    return "- " + "\n  ".join(lines) + "\n"
