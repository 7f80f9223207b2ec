"""Lowered machines are compared with their monitors: what is right is found equal, what is wrong is refused."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from conditions_support import CONDITIONS, DECLARED
from edges import drawn as in_range
from hypothesis import given, settings
from hypothesis import strategies as st
from lowered import cases, labels, shown
from machine_mutants import expressions, mutants
from openings_support import drawn
from program_reference import is_nan, value
from stepping import from_text
from timed import Draw
from timed import compiled as compiled_in_time

from ltlc.assurance.gate import Subject, judge
from ltlc.assurance.lowered.equality import Equal, compare
from ltlc.assurance.lowered.letters import Judged
from ltlc.assurance.messages import Messages
from ltlc.assurance.reading.outcomes import Difference
from ltlc.compiler import Compiled
from ltlc.inputs.messages.definitions import MessageTypes, shipped
from ltlc.program.expressions import Apply, Count, Expression
from ltlc.program.functions import Primitive
from ltlc.program.machine import Machine

LABELS = labels()


def compared(machine: Machine, of: Compiled) -> Equal | Difference:
    return compare(machine, Judged(of.specification, of.formula, of.monitor))


@pytest.mark.parametrize("number", range(len(LABELS)), ids=LABELS)
def test_what_a_property_is_lowered_to_is_its_monitor(number: int) -> None:
    machine, of, _ = cases()[number]
    assert isinstance(compared(machine, of), Equal)


@pytest.mark.parametrize("text", CONDITIONS)
def test_every_condition_is_lowered_to_what_it_says(text: str) -> None:
    (of,), _ = from_text(f"{DECLARED}never {text}\n")
    assert isinstance(compared(of.machine, of), Equal)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32))
def test_random_properties_with_clocks_are_lowered_to_their_monitors(seed: int) -> None:
    of = compiled_in_time(Draw(seed).property())
    assert isinstance(compared(of.machine, of), Equal)


@settings(max_examples=5, deadline=None)
@given(st.integers(0, 2**32))
def test_random_properties_with_values_at_openings_are_lowered_to_their_monitors(seed: int) -> None:
    (of,), _ = from_text(drawn(random.Random(seed)).specification)
    assert isinstance(compared(of.machine, of), Equal)


@pytest.mark.parametrize("number", range(len(LABELS)), ids=LABELS)
def test_a_machine_that_is_changed_is_refused_or_does_the_same(number: int) -> None:
    """Some of its changes; `benchmarks/lowering.py` tries all."""
    machine, of, _ = cases()[number]
    changed = list(mutants(machine))
    for what, mutant in random.Random(number).sample(changed, min(20, len(changed))):
        if isinstance(compared(mutant, of), Equal):
            assert all(shown(mutant, machine, seed) == shown(machine, machine, seed) for seed in range(5)), what


@pytest.mark.parametrize("text", CONDITIONS)
def test_a_condition_that_is_changed_is_refused_or_says_the_same(text: str) -> None:
    (of,), _ = from_text(f"{DECLARED}never {text}\n")
    machine, chance = of.machine, random.Random(text)
    samples: list[dict[Expression, Any]] = [
        {each: in_range(each.type, chance) for each in machine.inputs} for _ in range(60)
    ]
    steps = [each for each in samples if not any(is_nan(value(guard, each)) for guard in machine.guards)]
    for number, atom in enumerate(machine.atoms):
        others = list(expressions(atom))
        for other in chance.sample(others, min(15, len(others))):
            changed = (*machine.atoms[:number], other, *machine.atoms[number + 1 :])
            if isinstance(compared(replace(machine, atoms=changed), of), Equal):
                assert all(value(other, each) == value(atom, each) for each in steps), other


FAULTS: dict[str, Callable[[Machine], Machine]] = {
    "other inputs are read": lambda right: replace(right, inputs=right.inputs[::-1]),
    "its guards do not determine which steps are invalid": lambda right: replace(right, guards=right.guards[:1]),
    "it has other clocks, or ages": lambda right: replace(right, clocks=()),
    "in state 1 a clock step is not announced": lambda right: replace(
        right, states=tuple(each._replace(expire=None) for each in right.states)
    ),
    "in state 0 a clock step is announced wrongly": lambda right: replace(
        right, states=tuple(each._replace(expire=each.step) for each in right.states)
    ),
    "clock 0 is due time + 2 instead of": lambda right: replace(
        right,
        outcomes=tuple(each._replace(sets=tuple(s._replace(duration=2) for s in each.sets)) for each in right.outcomes),
    ),
    "whether a clock step comes a nanosecond later is stated wrongly": lambda right: replace(
        right, outcomes=(*right.outcomes[:1], right.outcomes[1]._replace(again=True), *right.outcomes[2:])
    ),
    "something is done after the verdict violated": lambda right: replace(
        right, states=(*right.states[:2], right.states[2]._replace(step=right.states[1].expire or 0))
    ),
}


@pytest.mark.parametrize("reason", FAULTS)
def test_a_difference_says_what_it_is(reason: str) -> None:
    declared = "decl x /x Float64.data\ndecl y /y Float64.data\n"
    (of,), _ = from_text(declared + "always (x < 1 implies eventually y > 2 within 1 s)")
    found = compared(FAULTS[reason](of.machine), of)
    assert isinstance(found, Difference)
    assert reason in str(found)


@pytest.mark.parametrize("counted", ["not scan == x", "not sqrt(xs) == x", "not -xs == y"])
def test_a_machine_that_counts_what_is_nan_is_refused(counted: str) -> None:
    (of,), _ = from_text(f"{DECLARED}never any({counted})\n")
    (atom,) = of.machine.atoms
    assert isinstance(atom, Count)
    assert isinstance(atom.guard, Apply)
    (measured, *rest) = atom.guard.arguments
    assert isinstance(measured, Apply)
    assert measured.primitive is Primitive.MEASURED
    wrong = replace(atom, guard=Apply(Primitive.AND, tuple(rest)))
    assert isinstance(compared(replace(of.machine, atoms=(wrong,)), of), Difference)


def test_a_difference_names_the_condition_that_the_property_does_not_have() -> None:
    (of, other), _ = from_text("decl x /x Float64.data\nnever x > 2\nnever x > 3")
    assert (
        str(compared(replace(of.machine, atoms=other.machine.atoms), of))
        == "`x <= 3.0`: that is not a condition of the property"
    )


def test_a_difference_names_the_conditions_that_hold_there() -> None:
    (of,), _ = from_text("decl x /x Float64.data\nnever x > 2")
    swapped = of.machine.decisions[0]._replace(low=of.machine.decisions[0].high, high=of.machine.decisions[0].low)
    found = compared(replace(of.machine, decisions=(swapped,)), of)
    assert (
        str(found)
        == "in state 0 where none of the conditions holds, the verdict is violated instead of presumably_satisfied"
    )


def test_the_gate_refuses_a_property_that_is_lowered_wrongly() -> None:
    (of, other), _ = from_text("decl x /x Float64.data\nnever x > 2\nnever x > 3")
    messages = Messages(MessageTypes(shipped()))
    right = judge(Subject(of, None, None), messages)
    assert right.passed
    wrong = replace(of)
    wrong.__dict__["machine"] = other.machine
    judged = judge(Subject(wrong, None, None), messages)
    assert isinstance(judged.machine, Difference)
    assert not judged.passed
