"""The columns of a table as topics: of the types whose messages have such values."""

from __future__ import annotations

from pathlib import Path

from ltlc.frontend.language.define import is_topic
from ltlc.frontend.starter.names import name_of
from ltlc.frontend.starter.topics import Topic
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
_BY_FIELD = "it does not give the type of the messages: declare the field by hand"


def tabled(path: Path) -> list[Topic]:
    """The columns of the table at `path` as topics, in their order. Raises RecordingError."""
    table = open_recording(path, {})
    assert isinstance(table, FromTable), path
    names = dict.fromkeys(of[0] if (of := array_and_index(head)) else head for head in table.heads)
    return [_topic(path, name) for name in names]


def _topic(path: Path, name: str) -> Topic:
    if name.startswith("/"):
        return Topic(name, "", omitted=_BY_FIELD)
    topic = f"/{name}"
    if not is_topic(topic) or name_of(topic) != name:
        return Topic(name, "", omitted=_DOTTED if "." in name else _ODD_NAME)
    for type_, message in TYPES.items():
        count = _count(path, Signal(name, type_, Field(topic, message, ("data",))))
        if count is not None:
            return Topic(topic, message) if count else Topic(name, "", omitted=_EMPTY)
    return Topic(name, "", omitted="its values are not all numbers, booleans, strings or arrays of numbers")


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
