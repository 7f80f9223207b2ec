"""Definitions of messages as text, as packages and recordings have them: in the form of ROS 2, of ROS 1, or as IDL."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import lru_cache

from ltlc.inputs.messages.definitions import PLACEHOLDER, STRINGS, Constant, FieldType, Message
from ltlc.specification.wire import PRIMITIVES, double_or_integer

PARTS = {".msg": ("",), ".srv": ("_Request", "_Response"), ".action": ("_Goal", "_Result", "_Feedback")}
"""What the sections of a file define, by the end of its name; lines of three dashes stand between them."""

_UUID, _TIME = FieldType("unique_identifier_msgs/msg/UUID"), FieldType("builtin_interfaces/msg/Time")
_EVENT_INFO = FieldType("service_msgs/msg/ServiceEventInfo")

_SEPARATOR = re.compile(r"^={20,}\s*$", re.MULTILINE)
_FIELD = re.compile(r"\s*([A-Za-z][\w/]*)(?:<=\d+)?(\[(?:<=)?\d*\])?\s+([A-Za-z]\w*)\s*(=?)")
_OLD = {"Header": "std_msgs/msg/Header", "time": "builtin_interfaces/msg/Time"}
_OLD["duration"] = "builtin_interfaces/msg/Duration"
_TIMES = {
    name: Message({"sec": FieldType("int32"), "nanosec": FieldType("uint32")}, {})
    for name in ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")
}
"""What ROS 1 has as primitives: no definition in its recordings has them."""

_EMPTY = {PLACEHOLDER: FieldType("uint8")}
"""What a message without fields is sent as."""

_QUOTED = re.compile(r"""\s*(["'])(.*)\1\s*(?:#.*)?""")
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}
_TEXTS = 1000
"""So many definitions are kept: those of one recording are those of the next."""


def full_name(name: str) -> str:
    """`nav_msgs/msg/Odometry`, also of `nav_msgs/Odometry`, as ROS 1 and some recorders write it."""
    package, slash, short = name.partition("/")
    return f"{package}/msg/{short}" if slash and "/" not in short else name


@lru_cache(_TEXTS)
def defined(type_: str, form: str, text: str) -> dict[str, Message]:
    """What `text` in this form defines, `type_` and what it contains; nothing without a text. Raises ValueError."""
    match form:
        case "ros2msg" if text.strip():
            return _messages(type_, text)
        case "ros1msg" if text.strip():
            return _TIMES | _messages(type_, text)
        case "ros2idl" | "omgidl" if text.strip():
            return _from_idl(text)
    return {}


def text_of(type_: str, types: Mapping[str, Message]) -> str:
    """A text in the form `ros2msg` that defines `type_` and what it contains, without constants and defaults."""
    sections, todo = [], [type_]
    for name in todo:
        fields = {} if types[name].fields == _EMPTY else types[name].fields
        lines = [f"{_short(str(of))} {field}\n" for field, of in fields.items()]
        sections.append("".join(lines) or "# no fields\n")
        todo += [
            base for base in dict.fromkeys(of.base for of in fields.values()) if base in types and base not in todo
        ]
    heads = ["", *(f"{'=' * 80}\nMSG: {_short(name)}\n" for name in todo[1:])]
    return "".join(head + section for head, section in zip(heads, sections, strict=True))


def _short(name: str) -> str:
    """As packages write the name of a type: `nav_msgs/Odometry`."""
    return name.replace("octet", "byte").replace("/msg/", "/")


def _messages(name: str, text: str) -> dict[str, Message]:
    """The message `name`, and those that follow it between lines of `=`, each after `MSG: its/name`."""
    found: dict[str, Message] = {}
    for of, lines in _titled(name, text):
        if of == name and any(line.strip() == "---" for line in lines):
            found |= interface(name.rpartition("_")[0], "\n".join(lines))
        else:
            found[of] = _message(lines, of)
    return found


def _titled(name: str, text: str) -> Iterator[tuple[str, list[str]]]:
    """The definitions in one of `name`, each with its lines. Raises ValueError."""
    for number, section in enumerate(_SEPARATOR.split(text)):
        of, lines = name, section.splitlines()
        if number:
            title = next((k for k, line in enumerate(lines) if line.strip()), 0)
            mark, _, of = (lines[title] if lines else "").partition(":")
            if mark.strip() != "MSG":
                raise ValueError("a section does not begin with `MSG:`")
            of, lines = full_name(of.strip()), lines[title + 1 :]
        yield of, lines


def comments_in(type_: str, form: str, text: str) -> dict[tuple[str, str], str]:
    """The comments on the lines of fields, by message and field, in a definition of `type_`.

    Nothing of a definition that cannot be read, or that is in another form than `.msg` files.
    """
    found: dict[tuple[str, str], str] = {}
    try:
        definitions = list(_titled(type_, text)) if form in ("ros2msg", "ros1msg") else []
    except ValueError:
        return {}
    for name, lines in definitions:
        for line in lines:
            field, _, comment = line.partition("#")
            match = _FIELD.match(field)
            if match and not match[4] and comment.strip(" #\t"):
                found[name, match[3]] = " ".join(comment.strip(" #\t").split())
    return found


def interface(name: str, text: str) -> dict[str, Message]:
    """The messages that a message, service or action is made of. Raises ValueError if `text` does not define it.

    `name` is full, as in `std_srvs/srv/SetBool`.
    """
    package, kind, short = name.split("/")
    parts, sections = PARTS[f".{kind}"], _sections(text)
    if len(sections) != len(parts):
        raise ValueError(f"has {len(sections)} sections separated by ---, but needs {len(parts)}")
    found = {
        f"{name}{part}": _message(section.splitlines(), f"{package}/msg/{short}{part}")
        for part, section in zip(parts, sections, strict=True)
    }
    return found | {"msg": {}, "srv": _event(name), "action": _of_action(name)}[kind]


def _sections(text: str) -> list[str]:
    sections = [""]
    for line in text.splitlines():
        if line.rstrip() == "---":
            sections.append("")
        else:
            sections[-1] += f"{line}\n"
    return sections


def _event(service: str) -> dict[str, Message]:
    """What the introspection of a service publishes on `…/_service_event`."""
    request, response = FieldType(f"{service}_Request", 0), FieldType(f"{service}_Response", 0)
    return {f"{service}_Event": Message({"info": _EVENT_INFO, "request": request, "response": response}, {})}


def _of_action(action: str) -> dict[str, Message]:
    """What an action publishes beside its status, and the two services that it is made of."""
    send, get = f"{action}_SendGoal", f"{action}_GetResult"
    fields = {
        f"{action}_FeedbackMessage": {"goal_id": _UUID, "feedback": FieldType(f"{action}_Feedback")},
        f"{send}_Request": {"goal_id": _UUID, "goal": FieldType(f"{action}_Goal")},
        f"{send}_Response": {"accepted": FieldType("bool"), "stamp": _TIME},
        f"{get}_Request": {"goal_id": _UUID},
        f"{get}_Response": {"status": FieldType("int8"), "result": FieldType(f"{action}_Result")},
    }
    return {name: Message(parts, {}) for name, parts in fields.items()} | _event(send) | _event(get)


def _message(lines: list[str], name: str) -> Message:
    """The message that `lines` define."""
    fields: dict[str, FieldType] = {}
    constants: dict[str, Constant] = {}
    for line in lines:
        text = line.partition("#")[0]
        if not text.strip():
            continue
        match = _FIELD.match(text)
        if match is None:
            raise ValueError(f"`{line.strip()}` is not a field")
        base, length, member, equals = match.groups()
        if equals:
            value = _constant(base, line[match.end() :])
            constants |= {} if value is None else {member: value}
        else:
            fields[member] = FieldType(_base(base, name), _length(length))
    return Message(fields or _EMPTY, constants)


def _constant(base: str, written: str) -> Constant | None:
    """The value of a constant; None of one that cannot be read, which harms no message."""
    text = written.partition("#")[0].strip()
    if base in STRINGS:
        quoted = _QUOTED.fullmatch(written)
        return quoted.group(2) if quoted else written.strip()
    if base in ("bool", "boolean"):
        return _BOOLEANS.get(text.lower())
    try:
        return float(text) if "float" in base else double_or_integer(int(text, 0))
    except ValueError:
        return None


def _base(written: str, message: str) -> str:
    """A primitive, or the full name of a message, which may be of the same package as the `message` around it."""
    if written in _OLD:
        return _OLD[written]
    if written in PRIMITIVES or written in STRINGS or written in ("bool", "boolean"):
        return written
    return full_name(written) if "/" in written else f"{message.partition('/')[0]}/msg/{written}"


def _length(written: str | None) -> int | None:
    if written is None:
        return None
    digits = written.strip("[]")
    return int(digits) if digits.isdigit() else 0


def _from_idl(text: str) -> dict[str, Message]:
    from rosbags.typesys import TypesysError, get_types_from_idl  # noqa: TID251

    from ltlc.inputs.messages.distributions import from_rosbags

    body = re.sub(r"^={20,}\s*\nIDL: [\w/]+\s*$", "", text, flags=re.MULTILINE)
    try:
        return {name: from_rosbags(definition) for name, definition in get_types_from_idl(body).items()}
    except TypesysError as error:
        raise ValueError(str(error).partition("\n")[0]) from None
