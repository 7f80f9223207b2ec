"""What is read of signals: in which order, how far back, and which values come together in a message or in an entry."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from ltlc.specification.expressions import (
    Bytes,
    Each,
    Field,
    Input,
    New,
    OfSlice,
    Parallel,
    Past,
    Recent,
    Signal,
    Slope,
)


class Sample(NamedTuple):
    """The `signals` that each message on `topic` has all of or none."""

    topic: str
    signals: tuple[Signal, ...]


def in_order(wanted: Iterable[Input]) -> list[Signal]:
    """The signals of inputs in the order of first use, each after its parts."""
    found: dict[Signal, None] = {}

    def enter(signal: Signal) -> None:
        if signal in found:
            return
        for part in signal.inputs:
            if not isinstance(part, New):
                enter(part.signal)
        found[signal] = None

    for each in wanted:
        if not isinstance(each, New):
            enter(each.signal)
    return list(found)


def together(signals: Iterable[Signal], is_grouped: bool = True) -> list[Sample]:
    """Those of `signals` that are read from messages, by what they come in; unless `is_grouped`, each by itself."""
    found: dict[object, Sample] = {}
    for signal in signals:
        if isinstance(signal.definition, Field):
            key = entry(signal.definition) if is_grouped else signal
            _, others = found.get(key, Sample(signal.definition.topic, ()))
            found[key] = Sample(signal.definition.topic, (*others, signal))
    return list(found.values())


def reach(wanted: Input) -> int:
    """How many samples of its signal an input looks at."""
    match wanted:
        case Past(_, samples) | Recent(_, samples):
            return samples + 1
        case Slope():
            return 2
        case New():
            return 0
        case _:
            return 1


def depth_of(signal: Signal, read: Iterable[Input]) -> int:
    """How many samples of `signal` are kept for what is `read` of it.

    One more than needed of a signal that has samples only where something holds: counting shows that it has one.
    """
    return max([1 if signal.when is None else 2, *map(reach, read)])


def entry(field: Field) -> object:
    """What a field is always together with: the messages of its topic, or an entry of them."""
    depth = next((n for n, step in enumerate(field.path) if not isinstance(step, str | Each | OfSlice | Bytes)), None)
    if depth is None:
        return field.topic
    step = field.path[depth]
    return (field.topic, step) if isinstance(step, Parallel) else (field.topic, field.path[: depth + 1])
