"""What properties read, as code that keeps samples needs to know it: where from, and from when on."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.backends.spelling import NotInTargetError
from ltlc.compiler import Compiled
from ltlc.specification.expressions import Bytes, Each, Field, Match, OfSlice, Parallel, Signal
from ltlc.specification.specification import Instances, Slicing, fields


def is_from_session(compiled: Compiled) -> bool:
    """Whether a property begins with the session: it waits for no value."""
    return not compiled.machine.waits_for


def require_whole_runs(compiled: Sequence[Compiled]) -> None:
    """Raise NotInTargetError if a property is judged for each id or message, or reads an id."""
    for each in compiled:
        match each.specification.slicing:
            case Slicing():
                raise NotInTargetError("`each`, a monitor for each id")
            case Instances(signal):
                raise NotInTargetError(f"`each new`, a monitor for each message of `{signal.name}`")
            case None:
                pass
    require_no_bytes(compiled)


def require_no_bytes(compiled: Sequence[Compiled]) -> None:
    """Raise NotInTargetError if a property reads bytes as an id."""
    for each in compiled:
        read = (field for signal in each.specification.signals() for _, field in fields(signal))
        if any(Bytes() in field.path for field in read):
            raise NotInTargetError("bytes that are read as an id")


def require_topics(compiled: Sequence[Compiled]) -> None:
    """Raise NotInTargetError if a property reads a topic that has no name in ROS 2."""
    for each in compiled:
        for _, field in (reading for signal in each.specification.signals() for reading in fields(signal)):
            if field.topic.endswith("]"):
                raise NotInTargetError(f"`{field.topic}`, an instance of a topic, which only flight logs have")


def origin(signal: Signal) -> str:
    """Where a reading comes from, as in a declaration."""
    assert isinstance(signal.definition, Field)
    steps = []
    for step in signal.definition.path:
        match step:
            case str():
                steps.append(f".{step}")
            case int():
                steps.append(f"[{step}]")
            case Each():
                steps.append("[]")
            case Match(_, value) | Parallel(_, value):
                steps.append(f"[{value}]")
            case Bytes() | OfSlice():
                pass
    return f"{signal.name}: {signal.definition.topic} {signal.definition.message}{''.join(steps)}"
