"""Machines: their reference does what emitted code does, and equal ones are equal as data."""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Sequence
from typing import Any

import pytest
from lowered import cases, labels, value_of
from program_reference import Run, is_nan, value
from stepping import from_text

from ltlc.backends.python.load import load_plan
from ltlc.compiler import Compiled
from ltlc.program.expressions import Apply, Count, Each, Expression, Held, Kept, Literal, News
from ltlc.program.functions import Primitive
from ltlc.program.normal import normal, positive
from ltlc.program.types import DOUBLE, Scalar, Type
from ltlc.runtime.times import NEVER
from ltlc.semantics.timed_atoms import counts_of, news_that_counts
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import trackers_of
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter
from ltlc.specification import evaluation
from ltlc.specification.expressions import IsTrue, New, Recent

X, Y, ONE = Held("x", 0, DOUBLE), Held("y", 0, DOUBLE), Literal(1.0, DOUBLE)
SUM = Apply(Primitive.ADD, (Y, ONE))
EACH = pytest.mark.parametrize("number", range(len(labels())), ids=labels())


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


@EACH
def test_emitted_code_does_what_the_machine_does(number: int) -> None:
    machine, of, specification = cases()[number]
    (property_,) = load_plan([of], specification).properties
    for seed in range(3):
        chance, time = random.Random(seed), 0
        emitted, run = property_.monitor(*([0] if property_.timed else [])), Run(machine)
        for _ in range(60):
            time += chance.choice([0, 1, 10**8, 5 * 10**8, 10**9, 10**9 + 1, 3 * 10**9])
            inputs = [value_of(read.type, machine, chance) for read in machine.inputs]
            if property_.timed:
                assert (run.next() or NEVER + 1) == emitted.due + 1
                while emitted.due < time:
                    emitted.expire()
                run.hold(time)
                assert run.verdict is emitted.verdict
            verdict = emitted.step(*([time] if property_.timed else []), *inputs)
            assert (run.step(time, inputs), run.invalid) == (verdict, emitted.invalid)


class ByDefinition:
    """What the monitor says of a run in time, with the atoms of time as their trackers decide them."""

    def __init__(self, of: Compiled) -> None:
        self.of, self.state, self.verdict = of, 0, Verdict.NOT_STARTED
        self.run = TimedRun(trackers_of(of.formula), news_that_counts(of.formula), 0, counts=counts_of(of.formula))

    def take(self, instants: Iterable[Letter]) -> Verdict:
        for instant in instants:
            self.state = self.of.monitor.step(self.state, instant)
            self.verdict = self.of.monitor.verdicts[self.state]
        return self.verdict

    def step(self, time: int, values: Sequence[Any]) -> Verdict:
        """A step or, if it is none, the messages that come with it."""
        specification = self.of.specification
        told = dict(zip(specification.inputs(), values, strict=True))
        letter = evaluation.letter(specification.atoms, told)
        measured = (v for each, value in told.items() for v in (value if isinstance(each, Recent) else (value,)))
        if letter is not None and not any(map(is_nan, measured)):
            return self.take(self.run.step(time, letter))
        news = {IsTrue(each) for each, value in told.items() if isinstance(each, New) and value}
        return self.take(self.run.hear(time, {atom.name for atom in specification.atoms if atom.condition in news}))


@EACH
def test_a_machine_does_what_the_monitor_does_on_a_run_in_time(number: int) -> None:
    machine, of, _ = cases()[number]
    if machine.registers:
        return  # the definition here knows letters, not values at openings
    for seed in range(3):
        chance, time, run, right = random.Random(seed), 0, Run(machine), ByDefinition(of)
        for _ in range(60):
            time += chance.choice([0, 1, 10**8, 2 * 10**8, 10**9, 10**9 + 1, 3 * 10**9])
            run.hold(time)
            assert run.verdict is right.take(right.run.hold(time))
            values = [value_of(read.type, machine, chance) for read in machine.inputs]
            heard = [r.signal for r, value in zip(machine.inputs, values, strict=True) if isinstance(r, News) and value]
            assert run.step(time, values, heard) is right.step(time, values)


def test_an_age_that_a_message_makes_young_opens_a_scope_that_stays_open() -> None:
    declared = "decl g /g Float64.data\ndecl x /x Bool.data\ndecl y /y Bool.data\n"
    (of,), _ = from_text(declared + "after_until age(g) <= 3 ns, y, always x")
    run = Run(of.machine)
    names = [read.signal for read in of.machine.inputs]
    told = [(0, {"x": True, "y": True}), (20, {"g": True, "x": True}), (30, {})]
    verdicts = [run.step(time, [row.get(name, False) for name in names], row.keys() & {"g"}) for time, row in told]
    assert verdicts[-1] is Verdict.VIOLATED


def test_a_value_is_taken_at_a_clock_step_at_which_its_scope_opens_again() -> None:
    machine = next(machine for machine, _, _ in cases() if machine.label == "reopened")
    assert any(outcome.taken for outcome in machine.outcomes)


def test_properties_that_say_the_same_in_other_words_have_equal_machines() -> None:
    declared = "decl x /x Float64.data\ndecl on /on Bool.data\n"
    one, other, third = from_text(
        declared + "always (x > 1 or on)\nnever (x <= 1 and not on)\nalways (x >= 1 or on)\n"
    )[0]
    assert one.machine == other.machine != third.machine


def test_a_machine_has_no_more_than_it_uses() -> None:
    for machine, _, _ in cases():
        targets = [t for _, step, expire in machine.states for t in (step, expire) if t is not None]
        targets += [target for _, low, high in machine.decisions for target in (low, high)]
        assert {*targets} == {*range(len(machine.outcomes)), *(~n for n in range(len(machine.decisions)))}
        assert {question for question, _, _ in machine.decisions} >= {*range(len(machine.atoms))}
        assert {0, *(outcome.state for outcome in machine.outcomes)} == {*range(len(machine.states))}
        assert machine.is_timed or not machine.clocks


@pytest.mark.parametrize("condition", ["u < u", "u > 300", "abs(u) < 0", "not u == u", "len(a) < 0", "not s == s"])
def test_what_was_before_does_not_matter_of_a_condition_that_is_never_true(condition: str) -> None:
    declared = "decl u /u UInt8.data\ndecl v /v Float64.data\ndecl s /s String.data\ndecl a /a LaserScan.ranges\n"
    one, other = from_text(
        f"{declared}always (v > 0 implies previously {condition})\nalways (v > 0 implies {condition})"
    )[0]
    assert one.machine == other.machine
    assert not one.machine.is_timed


def test_what_is_counted_where_it_is_not_above_infinity_is_counted_where_it_is_not_nan() -> None:
    array = Held("a", 0, Type(Scalar.DOUBLE, is_array=True))
    above = Apply(Primitive.LESS, (Literal(math.inf, DOUBLE), Each(array)))
    counted = (Apply(Primitive.NOT, (above,)), Apply(Primitive.MEASURED, (Each(array),)))
    assert len({normal(Count(((array,),), guard, False)) for guard in counted}) == 1
