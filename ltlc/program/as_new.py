"""The states of a machine that behave like a new one: a slice in one of them need not be kept."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product

from ltlc.program.expressions import News
from ltlc.program.machine import Base, Machine, Outcome
from ltlc.semantics.monitor import Target
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Current, Field, New
from ltlc.specification.specification import PropertySpecification, Slicing, topics

MOST_ATOMS = 12
"""With more, no state is looked at: there are too many letters."""


def states_as_new(machine: Machine, specification: PropertySpecification, slicing: Slicing) -> frozenset[int]:
    """The states without an open obligation from which a message leads where a first one does, if no clock runs.

    There are none unless a message brings all that the property reads: it reads one topic, and no history.
    """
    inputs = specification.inputs()
    is_simple = all(isinstance(i, Current | New) and isinstance(i.signal.definition, Field) for i in inputs)
    is_simple &= not any(i.signal.name in slicing.made - {slicing.variable} for i in inputs)
    has_memory = machine.registers or not all(clock.is_set for clock in machine.clocks)
    if not is_simple or has_memory or len(topics(specification)) != 1 or len(machine.atoms) > MOST_ATOMS:
        return frozenset()
    choices = [(True,) if isinstance(atom, News) else (False, True) for atom in machine.atoms]
    letters = [dict(enumerate(letter)) for letter in product(*choices)]
    first = [_leads(machine, machine.states[0].step, letter) for letter in letters]
    return frozenset(
        number
        for number, state in enumerate(machine.states)
        if state.verdict is Verdict.PRESUMABLY_SATISFIED
        and all(
            outcome is not None and outcome == _leads(machine, state.step, letter)
            for outcome, letter in zip(first, letters, strict=True)
        )
    )


def _leads(machine: Machine, step: Target, letter: Mapping[int, bool]) -> Outcome | None:
    """Where a step with this letter leads, clocks that stop omitted; None if clocks decide that."""
    found: set[Outcome] = set()
    ahead = [step]
    for target in ahead:
        if target >= 0:
            outcome = machine.outcomes[target]
            running = tuple(each for each in outcome.sets if each.base is not Base.NEVER)
            found.add(outcome._replace(sets=running))
            continue
        asked, low, high = machine.decisions[~target]
        ahead += [low, high] if asked not in letter else [high if letter[asked] else low]
    return found.pop() if len(found) == 1 else None
