"""The first difference between two machines that are not equal, in words."""

from __future__ import annotations

from functools import cache

from ltlc.program.machine import Machine
from ltlc.semantics.monitor import Target

_PARTS = {
    "inputs": "what it reads",
    "guards": "what makes a step invalid",
    "clocks": "what its clocks and ages are",
    "registers": "when it takes values at openings",
    "atoms": "what it asks",
}


def difference(found: Machine, right: Machine) -> str | None:
    """What `found` does otherwise than `right`; None if they are equal."""
    if found == right:
        return None
    for name, said in _PARTS.items():
        if getattr(found, name) != getattr(right, name):
            return f"{said} is not what the property says"

    @cache
    def is_same(target: Target | None, wanted: Target | None) -> bool:
        if target is None or wanted is None:
            return target is wanted
        if target >= 0 or wanted >= 0:
            return min(target, wanted) >= 0 and found.outcomes[target] == right.outcomes[wanted]
        (atom, low, high), (asked, otherwise, then) = found.decisions[~target], right.decisions[~wanted]
        return atom == asked and is_same(low, otherwise) and is_same(high, then)

    for number, (state, wanted) in enumerate(zip(found.states, right.states, strict=False)):
        if state.verdict is not wanted.verdict:
            return f"in state {number}, the verdict is {state.verdict.name} instead of {wanted.verdict.name}"
        for instant, *targets in (("step", state.step, wanted.step), ("clock step", state.expire, wanted.expire)):
            if not is_same(*targets):
                return f"in state {number}, a {instant} does something else"
    return "it has other states"
