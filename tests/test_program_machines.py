"""Machines: their reference does what emitted code does, and equal ones are equal as data."""

from __future__ import annotations

import math
import random

import pytest
from lowered import cases, value_of
from stepping import from_text

from ltlc.backends.python.load import load_plan
from ltlc.program.expressions import Apply, Expression, Held, Kept, Literal
from ltlc.program.functions import Primitive
from ltlc.program.normal import positive
from ltlc.program.properties import machine_of
from ltlc.program.reference import Run, value
from ltlc.program.types import DOUBLE
from ltlc.runtime.times import NEVER

X, Y, ONE = Held("x", 0, DOUBLE), Held("y", 0, DOUBLE), Literal(1.0, DOUBLE)
SUM = Apply(Primitive.ADD, (Y, ONE))


def orderings() -> list[Expression]:
    """Comparisons of the same things in every direction, and their negations."""
    sides = ((X, Y), (Y, X), (X, ONE), (ONE, X), (SUM, X), (X, SUM))
    found = [Apply(p, s) for p in (Primitive.LESS, Primitive.AT_MOST, Primitive.EQUAL) for s in sides]
    return [*found, *(Apply(Primitive.NOT, (each,)) for each in found)]


def test_what_means_the_same_has_one_normal_form() -> None:
    numbers = (-math.inf, -1.0, 0.0, 1.0, 2.0, math.inf)
    values: list[dict[Expression, float]] = [{X: x, Y: y} for x in numbers for y in numbers]
    forms: dict[tuple[bool, ...], set[Expression]] = {}
    for atom in orderings():
        found, holds = positive(atom)
        right = tuple(value(atom, each) for each in values)
        assert tuple(value(found, each) == holds for each in values) == right
        forms.setdefault(right if holds else tuple(not each for each in right), set()).add(found)
    assert all(len(each) == 1 for each in forms.values())
    assert len(set.union(*forms.values())) == len(forms)


def test_what_may_be_nan_at_a_clock_step_is_not_turned_into_its_opposite() -> None:
    kept = Kept("x", 1, "p", DOUBLE)
    quotient = Apply(Primitive.OVER, (X, kept))
    for atom in (Apply(Primitive.LESS, (ONE, quotient)), Apply(Primitive.AT_MOST, (ONE, quotient))):
        found, holds = positive(atom)
        assert not value(atom, {X: 0.0, kept: 0.0})
        assert value(found, {X: 0.0, kept: 0.0}) != holds
    assert not positive(Apply(Primitive.LESS, (ONE, kept))).holds


@pytest.mark.parametrize("number", range(len(cases())), ids=[machine.label for machine, _, _ in cases()])
def test_emitted_code_does_what_the_machine_does(number: int) -> None:
    machine, of, specification = cases()[number]
    (property_,) = load_plan([of], specification).properties
    for seed in range(3):
        chance, time = random.Random(seed), 0
        emitted, run = property_.monitor(*([0] if machine.is_timed else [])), Run(machine)
        for _ in range(60):
            time += chance.choice([0, 1, 10**8, 5 * 10**8, 10**9, 10**9 + 1, 3 * 10**9])
            inputs = [value_of(read.type, machine, chance) for read in machine.inputs]
            if machine.is_timed:
                assert (run.next() or NEVER + 1) == emitted.due + 1
                while emitted.due < time:
                    emitted.expire()
                run.hold(time)
                assert run.verdict is emitted.verdict
            verdict = emitted.step(*([time] if machine.is_timed else []), *inputs)
            assert (run.step(time, inputs), run.invalid) == (verdict, emitted.invalid)


def test_a_value_is_taken_at_a_clock_step_at_which_its_scope_opens_again() -> None:
    machine = next(machine for machine, _, _ in cases() if machine.label == "reopened")
    assert any(outcome.taken for outcome in machine.outcomes)


def test_properties_that_say_the_same_in_other_words_have_equal_machines() -> None:
    declared = "decl x /x Float64.data\ndecl on /on Bool.data\n"
    one, other, third = from_text(
        declared + "always (x > 1 or on)\nnever (x <= 1 and not on)\nalways (x >= 1 or on)\n"
    )[0]
    assert machine_of(one) == machine_of(other) != machine_of(third)


def test_a_machine_has_no_more_than_it_uses() -> None:
    for machine, _, _ in cases():
        targets = [t for _, step, expire in machine.states for t in (step, expire) if t is not None]
        targets += [target for _, low, high in machine.decisions for target in (low, high)]
        assert {*targets} == {*range(len(machine.outcomes)), *(~n for n in range(len(machine.decisions)))}
        assert {question for question, _, _ in machine.decisions} >= {*range(len(machine.atoms))}
