"""What properties read, as code that keeps samples needs to know it: where from, and from when on."""

from __future__ import annotations

from ltlc.compiler import Compiled
from ltlc.semantics.timed_atoms import timed_atoms
from ltlc.specification.expressions import Bytes, Each, Field, Match, OfSlice, Parallel, Signal


def is_from_session(compiled: Compiled) -> bool:
    """Whether a property begins with the session: it has clocks, and waits for no value."""
    return bool(timed_atoms(compiled.formula)) and not compiled.machine.waits_for


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
            case Bytes() | OfSlice():
                pass
    return f"{signal.name}: {signal.definition.topic} {signal.definition.message}{''.join(steps)}"
