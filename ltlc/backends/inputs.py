"""What properties read, as code that keeps samples needs to know it: in which order, how far back, from when on."""

from __future__ import annotations

from collections.abc import Iterable

from ltlc.compiler import Compiled
from ltlc.semantics.timed_atoms import timed_atoms
from ltlc.specification import expressions as e
from ltlc.specification.expressions import Each, Field, Input, Match, New, Parallel, Past, Signal, Slope


def is_from_session(compiled: Compiled) -> bool:
    """Whether a property begins with the session: it has clocks, and reads nothing but news."""
    inputs = compiled.specification.inputs()
    return bool(timed_atoms(compiled.formula)) and all(isinstance(i, New) for i in inputs)


def in_order(wanted: Iterable[Input]) -> list[Signal]:
    """The signals of inputs in the order of first use, each after its parts."""
    found: dict[Signal, None] = {}

    def enter(signal: Signal) -> None:
        if signal in found:
            return
        if not isinstance(signal.definition, Field):
            for part in e.inputs(signal.definition):
                enter(part.signal)
        found[signal] = None

    for each in wanted:
        if not isinstance(each, New):
            enter(each.signal)
    return list(found)


def reach(wanted: Input) -> int:
    """How many samples of its signal an input looks at."""
    match wanted:
        case Past(_, samples):
            return samples + 1
        case Slope():
            return 2
        case New():
            return 0
        case _:
            return 1


def entry(field_: Field) -> object:
    """What a field is always together with: the messages of its topic, or an entry of them."""
    depth = next((n for n, step in enumerate(field_.path) if not isinstance(step, str | Each)), None)
    if depth is None:
        return field_.topic
    step = field_.path[depth]
    return (field_.topic, step) if isinstance(step, Parallel) else (field_.topic, field_.path[: depth + 1])


def origin(signal: Signal) -> str:
    """Where a reading comes from, as a declaration would say it."""
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
    return f"{signal.name}: {signal.definition.topic} {signal.definition.message}{''.join(steps)}"
