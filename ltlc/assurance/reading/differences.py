"""What two machines that are not equal do otherwise, in words: the first thing of it."""

from __future__ import annotations

from typing import NamedTuple

from ltlc.program.machine import Machine, Outcome
from ltlc.semantics.monitor import Decision, Target

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
    if len(found.states) != len(right.states):
        return f"it has {len(found.states)} states instead of {len(right.states)}"
    for number, (state, other) in enumerate(zip(found.states, right.states, strict=True)):
        if state.verdict is not other.verdict:
            return f"in state {number}, the verdict is {state.verdict.name} instead of {other.verdict.name}"
        for target, wanted, instant in ((state.step, other.step, ""), (state.expire, other.expire, " at a clock step")):
            way = _apart(found, right, _Pair(target, wanted))
            if way is not None:
                return f"in state {number}{instant}{way}"
    return "its decisions are not in their normal form"


class _Pair(NamedTuple):
    """Targets of two machines, and which questions, by number, have been answered by yes on the way there."""

    found: Target | None
    right: Target | None
    held: tuple[int, ...] = ()


def _apart(found: Machine, right: Machine, roots: _Pair) -> str | None:
    """Where two targets lead to two outcomes."""
    todo, seen = [roots], set[tuple[Target | None, Target | None]]()
    while todo:
        pair = todo.pop()
        if (pair.found, pair.right) in seen:
            continue
        seen.add((pair.found, pair.right))
        one, other = _asked(found, pair.found), _asked(right, pair.right)
        asked = min((each.atom for each in (one, other) if each is not None), default=None)
        if asked is not None:
            low, high = (
                (_side(pair.found, one, asked, w), _side(pair.right, other, asked, w)) for w in ("low", "high")
            )
            todo += [_Pair(low[0], low[1], pair.held), _Pair(high[0], high[1], (*pair.held, asked))]
            continue
        differs = _outcomes(
            None if pair.found is None else found.outcomes[pair.found],
            None if pair.right is None else right.outcomes[pair.right],
        )
        if differs is not None:
            where = ", ".join(map(str, pair.held)) or "none"
            return f" where of its questions {where} hold, {differs}"
    return None


def _asked(machine: Machine, target: Target | None) -> Decision | None:
    return machine.decisions[~target] if target is not None and target < 0 else None


def _side(target: Target | None, decision: Decision | None, asked: int, side: str) -> Target | None:
    """Where it goes on from a target with the answer to what is `asked`, which it may not ask."""
    return target if decision is None or decision.atom != asked else getattr(decision, side)


_FIELDS = {
    "state": "it goes on in state {} instead of {}",
    "sets": "it sets clocks otherwise",
    "again": "a clock step comes a nanosecond later, or not",
    "taken": "it takes other values at openings",
}


def _outcomes(found: Outcome | None, right: Outcome | None) -> str | None:
    if found is None or right is None:
        return None if found is right else "a clock step is taken, or not"
    for name, said in _FIELDS.items():
        if getattr(found, name) != getattr(right, name):
            return said.format(getattr(found, name), getattr(right, name))
    return None
