"""The columns of a table as topics: of the types whose messages have such values, or such fields."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from ltlc.frontend.language.define import is_topic
from ltlc.frontend.starter.names import name_of
from ltlc.frontend.starter.recipes import RECIPES
from ltlc.frontend.starter.topics import Topic
from ltlc.inputs.messages.definitions import MessageTypes
from ltlc.inputs.recordings import RecordingError, open_recording
from ltlc.inputs.recordings.heads import array_and_index
from ltlc.inputs.recordings.signals import FromTable
from ltlc.specification.expressions import Field, Signal, ValueType

TYPES = {
    ValueType.NUMBER: "std_msgs/msg/Float64",
    ValueType.BOOLEAN: "std_msgs/msg/Bool",
    ValueType.NUMBERS: "std_msgs/msg/Float64MultiArray",
    ValueType.STRING: "std_msgs/msg/String",
}
"""The messages for values, in the order in which these are tried: `0` is a number, and any cell of CSV is a string."""

NOT_A_VALUE = "LTL803"
"""The error about a value of another type than its column."""

_ODD_NAME = "a declared name has letters, digits and `_` only, and is not a word of the language: rename it"
_DOTTED = "a declared name has no dot; the language's own, such as `robot.velocity`, need no declaration"
_EMPTY = "it is empty"
_MIXED = "its values are not all numbers, booleans, strings or arrays of numbers"
_BY_FIELD = "no known message type has such fields; `--msg-path` adds the messages of a package"

Steps = tuple[str, ...]
"""A topic and the path of a field in its messages, or one of these, step by step."""


def tabled(path: Path, types: MessageTypes) -> list[Topic]:
    """The columns of the table at `path` as topics. Raises RecordingError."""
    table = open_recording(path, {})
    assert isinstance(table, FromTable), path
    names = dict.fromkeys(of[0] if (of := array_and_index(head)) else head for head in table.heads)
    named = [_named(path, name) for name in names if name[:1] != "/"]
    return [*named, *_by_field(path, [name for name in names if name[:1] == "/"], types)]


def _named(path: Path, name: str) -> Topic:
    """The topic of a column that is called as its signal will be, or why there is none."""
    topic = f"/{name}"
    if not is_topic(topic) or name_of(topic) != name:
        return Topic(name, "", omitted=_DOTTED if "." in name else _ODD_NAME)
    return _valued(path, topic, name)


def _valued(path: Path, topic: str, column: str) -> Topic:
    """The topic whose messages are the values in `column`, or why there is none."""
    for type_, message in TYPES.items():
        count = _count(path, Signal(name_of(topic), type_, Field(topic, message, ("data",))))
        if count is not None:
            return Topic(topic, message) if count else Topic(column, "", omitted=_EMPTY)
    return Topic(column, "", omitted=_MIXED)


def _count(path: Path, signal: Signal) -> int | None:
    """How many values the table has of `signal`; None if it has other ones instead. Raises RecordingError."""
    table = open_recording(path, {signal.name: signal})
    if signal.name not in table.columns:  # its columns are those of elements, and it is not an array
        return None
    try:
        return sum(len(block.samples[signal.name].rows) for block in table.blocks())
    except RecordingError as error:
        if error.diagnostic.code != NOT_A_VALUE:
            raise
        return None


def _by_field(path: Path, heads: Iterable[str], types: MessageTypes) -> list[Topic]:
    """The topics of columns by topic and field, as PlotJuggler has them: the shortest names that leave a message."""
    left = {tuple(re.sub(r"\[\d+\]", "", head)[1:].split("/")): head for head in heads}
    found = []
    for length in range(1, max(map(len, left), default=1)):
        for topic in sorted({steps[:length] for steps in left if len(steps) > length}):
            fields = {steps[length:] for steps in left if steps[:length] == topic and len(steps) > length}
            name = "/".join(("", *topic))
            if fields == {("data",)}:
                found.append(_valued(path, name, f"{name}/data"))
            elif message := message_with(fields, types):
                found.append(Topic(name, message, fields=frozenset(map("/".join, fields))))
            else:
                continue
            left = {steps: head for steps, head in left.items() if steps[:length] != topic}
    return [*found, *(Topic(head, "", omitted=_BY_FIELD) for head in left.values())]


def message_with(fields: set[Steps], types: MessageTypes) -> str | None:
    """The type that has all of `fields`: one with a recipe, then the smallest; None if none has."""
    wanted = {field for field in fields if field[-1] != "stamp"}  # PlotJuggler has a time as one number
    if all(field[0] == "header" for field in wanted):
        return None
    fitting = [name for name in types.messages if all(_has(name, field, types) for field in wanted)]
    return min(fitting, key=lambda name: (name not in RECIPES, _size(name, types), name), default=None)


def _has(message: str, field: Steps, types: MessageTypes) -> bool:
    """Whether `field` leads to a value in such a message."""
    for step in field:
        if message not in types.messages or step not in types.messages[message].fields:
            return False
        message = types.messages[message].fields[step].base
    return message not in types.messages


def _size(message: str, types: MessageTypes) -> int:
    """How many values such a message has, an array being one."""
    if message not in types.messages:
        return 1
    return sum(_size(of.base, types) for of in types.messages[message].fields.values())
