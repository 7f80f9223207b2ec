"""Definitions of messages as bags carry them, and whether a field is there as the specification has it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from ltlc.messages.definitions import STRINGS, FieldType, Message, MessageTypes
from ltlc.nearest import did_you_mean
from ltlc.recordings.bags.cdr import SCALARS
from ltlc.recordings.bags.messages import LARGEST, Topic
from ltlc.specification.expressions import Each, Field, Match, Parallel, PathStep, Signal, ValueType
from ltlc.specification.wire import PRIMITIVES

_SEPARATOR = re.compile(r"^={20,}\s*$", re.MULTILINE)
_FIELD = re.compile(r"\s*([A-Za-z][\w/]*)(?:<=\d+)?(\[(?:<=)?\d*\])?\s+([A-Za-z]\w*)\s*(=?)")
_OLD = {"Header": "std_msgs/msg/Header", "time": "builtin_interfaces/msg/Time"}
_OLD["duration"] = "builtin_interfaces/msg/Duration"
_EMPTY = {"structure_needs_at_least_one_member": FieldType("uint8")}
"""What a message without fields is sent as."""

DEEPEST = 64
"""No message has more messages inside one another."""

_READABLE = {*SCALARS, "string"}


class UnknownTypeError(Exception):
    """Why it is not known what the messages of a topic look like, and what helps."""

    def __init__(self, reason: str, help: str) -> None:
        super().__init__(reason)
        self.reason = reason
        self.help = help


class NonsenseError(Exception):
    """What is wrong with the definition of a type that no message can have."""


def full_name(name: str) -> str:
    """`nav_msgs/msg/Odometry`, also of `nav_msgs/Odometry`, as ROS 1 and some recorders write it."""
    package, slash, short = name.partition("/")
    return f"{package}/msg/{short}" if slash and "/" not in short else name


def types_of(topic: Topic, others: MessageTypes) -> MessageTypes:
    """The types that the messages of `topic` are made of: as the recording defines them, else those of `others`.

    Raises UnknownTypeError and NonsenseError.
    """
    try:
        own = _parsed(topic)
    except ValueError as error:
        help = "record it again, or give its definition with `--msg-path DIR` and a recording without one"
        raise UnknownTypeError(f"whose definition in the recording cannot be read: {error}", help) from None
    types = MessageTypes({**others.messages, **own})
    for name in _made_of(topic.type, types):
        if name not in types.messages and name not in _READABLE:
            if name in STRINGS or name in PRIMITIVES:
                raise UnknownTypeError(f"which has a `{name}`: such cannot be read from a bag", "record another topic")
            missing = f"made of `{name}`, which" if name != topic.type else "which"
            help = "`--msg-path DIR` makes the messages of a package known"
            raise UnknownTypeError(f"{missing} neither the recording nor ROS 2 Jazzy defines", help)
    _values_in(topic.type, types, (), {})
    return types


def _values_in(name: str, types: MessageTypes, around: tuple[str, ...], known: dict[str, int]) -> int:
    """How many values a message has at least that is inside those `around` it. Raises NonsenseError.

    Of types that are `known` the number is.
    """
    if name in known:
        return known[name]
    if name in around or len(around) > DEEPEST:
        raise NonsenseError(f"`{name}` contains itself" if name in around else f"`{around[0]}` is nested too deeply")
    count = 0
    for field, type_ in types.messages[name].fields.items() if name in types.messages else ():
        inside = _values_in(type_.base, types, (*around, name), known)
        count += inside * (1 if type_.length is None else type_.length)
        if count > LARGEST:
            raise NonsenseError(f"`{field}` in `{name}` makes messages of more than {LARGEST} bytes")
    known[name] = max(1, count)
    return known[name]


def _made_of(name: str, types: MessageTypes) -> Iterator[str]:
    """`name` and all that is inside it: messages and primitives."""
    found, todo = {name}, [name]
    while todo:
        current = todo.pop()
        yield current
        fields = types.messages[current].fields.values() if current in types.messages else ()
        todo += [base for base in dict.fromkeys(type_.base for type_ in fields) if base not in found]
        found.update(todo)


def _parsed(topic: Topic) -> dict[str, Message]:
    """What the text of a topic's definition defines. Raises ValueError."""
    match topic.form:
        case "ros2msg" | "ros1msg" if topic.definition.strip():
            return _messages(topic.type, topic.definition)
        case "ros2idl" | "omgidl" if topic.definition.strip():
            return _from_idl(topic.definition)
    return {}


def _messages(name: str, text: str) -> dict[str, Message]:
    """The message `name`, and those that follow it between lines of `=`, each after `MSG: its/name`."""
    found: dict[str, Message] = {}
    for number, section in enumerate(_SEPARATOR.split(text)):
        of, lines = name, section.splitlines()
        if number:
            title = next((k for k, line in enumerate(lines) if line.strip()), 0)
            mark, _, of = (lines[title] if lines else "").partition(":")
            if mark.strip() != "MSG":
                raise ValueError("a section does not begin with `MSG:`")
            of, lines = full_name(of.strip()), lines[title + 1 :]
        elif any(line.strip() == "---" for line in lines):
            found |= _interface(name, section)
            continue
        found[of] = Message(dict(_fields(lines, of)) or _EMPTY, {})
    return found


def _interface(name: str, text: str) -> dict[str, Message]:
    """The messages of the service or action that `name` is one of, from its definition."""
    from ltlc.messages.folders import interface

    return interface(name.rpartition("_")[0], text)


def _fields(lines: list[str], message: str) -> Iterator[tuple[str, FieldType]]:
    """The fields of a message; its constants are passed over, and `seq` of ROS 1's headers, which ROS 2 has not."""
    for line in lines:
        text = line.partition("#")[0]
        if not text.strip():
            continue
        match = _FIELD.match(text)
        if match is None:
            raise ValueError(f"`{line.strip()}` is no field")
        base, length, name, equals = match.groups()
        if not equals and (name, message) != ("seq", "std_msgs/msg/Header"):
            yield name, FieldType(_base(base, message), _length(length))


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

    from ltlc.messages.folders import from_rosbags

    body = re.sub(r"^={20,}\s*\nIDL: [\w/]+\s*$", "", text, flags=re.MULTILINE)
    try:
        return {name: from_rosbags(definition) for name, definition in get_types_from_idl(body).items()}
    except TypesysError as error:
        raise ValueError(str(error).partition("\n")[0]) from None


def misfit(signal: Signal, field: Field, types: MessageTypes) -> str:
    """Why `field` does not lead to a value of `signal` in messages as `types` define them; empty if it does."""
    current = FieldType(field.message)
    for number, step in enumerate(field.path):
        reason = _step_reason(step, current, types)
        if reason:
            return reason
        match step:
            case str():
                outer, current = types.messages[current.base], types.messages[current.base].fields[step]
            case Parallel(names, _) if outer.fields.get(names) != FieldType("string", 0):
                return f"has no list of strings `{names}`"
            case Match(key, _) if types.messages[current.base].fields.get(key) != FieldType("string"):
                return f"has no string `{key}` in `{current.base}`"
            case Each() if number == len(field.path) - 1:
                break
            case _:
                current = FieldType(current.base)
    return _value_reason(signal, field, FieldType(current.base, 0 if Each() in field.path else current.length))


def _step_reason(step: PathStep, type_: FieldType, types: MessageTypes) -> str:
    if not isinstance(step, str):
        return "" if type_.is_list else f"has one `{type_}` where the specification has an array"
    if type_.is_list or type_.base not in types.messages:
        return f"has a `{type_}` where the specification has a message with the field `{step}`"
    fields: Mapping[str, FieldType] = types.messages[type_.base].fields
    if step in fields:
        return ""
    near = did_you_mean(step, fields)
    return f"has no field `{step}` in `{type_.base}`{f' ({near})' if near else ''}"


_TYPES = {"string": ValueType.STRING, "bool": ValueType.BOOLEAN, "boolean": ValueType.BOOLEAN}


def _value_reason(signal: Signal, field: Field, type_: FieldType) -> str:
    """Why what is at the end of the path is no value of the signal; of an array, any length will do."""
    of_one = _TYPES.get(type_.base, ValueType.NUMBER)
    wanted = signal.type.element or signal.type
    is_known = type_.base in _READABLE
    if is_known and of_one is wanted and type_.is_list == (signal.type.element is not None):
        if of_one is not ValueType.NUMBER or PRIMITIVES[type_.base] == field.numbers:
            return ""
        return f"has a `{type_}` there, other numbers than the specification was checked with"
    return f"has a `{type_}` there, not a {signal.type.value}"
