"""Conditions agree with the formulas they come from, and comparing them is right and bounded."""

from __future__ import annotations

import random

from hypothesis import given
from hypothesis import strategies as st
from strategies import ABC, formulas, letters, predicates, words

from ltlc.semantics import finite, ltl
from ltlc.semantics.conditions import FALSE_CONDITION, TRUE_CONDITION, Condition, Conditions, Memory
from ltlc.semantics.ltl import And, Atom, Formula, Next, Not, Or, Until
from ltlc.semantics.progression import progress
from ltlc.semantics.words import Letter, Word, all_letters

ENOUGH = 1_000_000
DEPTH = 200


def at_letter(conditions: Conditions, condition: Condition, letter: frozenset[str]) -> Condition:
    """The condition where the atoms of the current step are known."""
    for atom in ABC:
        condition = conditions.assign(conditions.fact_of_atom(atom), atom in letter, condition)
    return condition


@given(formulas(max_leaves=6, max_temporal=4), letters())
def test_what_unfolding_leaves_after_a_letter_is_what_progression_leaves(formula: Formula, letter: Letter) -> None:
    conditions = Conditions()
    left = at_letter(conditions, conditions.unfold(formula), letter)
    assert conditions.equivalent(DEPTH, left, conditions.later(progress(formula, letter)), Memory(ENOUGH))


@given(formulas(max_leaves=5), formulas(max_leaves=5), st.lists(words(), min_size=5, max_size=5))
def test_formulas_that_are_found_equivalent_hold_on_the_same_words(
    one: Formula, other: Formula, several: list[Word]
) -> None:
    conditions = Conditions()
    if conditions.equivalent(DEPTH, conditions.later(one), conditions.later(other), Memory(ENOUGH)):
        assert [finite.holds(one, word) for word in several] == [finite.holds(other, word) for word in several]


@given(predicates(), predicates())
def test_predicates_are_found_equivalent_exactly_if_they_hold_in_the_same_letters(one: Formula, other: Formula) -> None:
    conditions = Conditions()
    same = all(finite.holds(one, (letter,)) == finite.holds(other, (letter,)) for letter in all_letters(ABC))
    assert conditions.equivalent(DEPTH, conditions.unfold(one), conditions.unfold(other), Memory(ENOUGH)) == same


@given(predicates(), predicates())
def test_a_predicate_follows_from_another_exactly_if_it_holds_in_all_its_letters(one: Formula, other: Formula) -> None:
    conditions = Conditions()
    implied = all(finite.holds(Or(Not(one), other), (letter,)) for letter in all_letters(ABC))
    assert conditions.follows(DEPTH, conditions.unfold(one), conditions.unfold(other), Memory(ENOUGH)) == implied


@given(formulas(max_leaves=8))
def test_the_value_of_a_formula_can_be_folded_from_its_parts(formula: Formula) -> None:
    assert Conditions().fold(formula, lambda _, parts: 1 + sum(parts)) == ltl.size(formula)


def test_equal_formulas_have_one_number_and_one_condition() -> None:
    conditions = Conditions()
    one, other = Until(Atom("a"), Next(Atom("b"))), Until(Atom("a"), Next(Atom("b")))
    assert conditions.number(one) == conditions.number(other)
    assert conditions.unfold(one) == conditions.unfold(other)


def test_constants_and_double_negations_disappear() -> None:
    conditions = Conditions()
    a = conditions.at_step("a")
    assert conditions.unfold(And(ltl.TRUE, Not(Not(Atom("a"))))) == a
    assert conditions.unfold(Or(ltl.FALSE, And(Atom("a"), ltl.FALSE))) == FALSE_CONDITION
    assert conditions.unfold(Or(Atom("a"), ltl.TRUE)) == TRUE_CONDITION


def test_a_formula_thousands_deep_is_no_problem() -> None:
    formula: Formula = Atom("a")
    for _ in range(4_000):
        formula = Next(formula)
    conditions = Conditions()
    assert conditions.node(conditions.unfold(formula)).weight == 3


def parity(atoms: list[str]) -> Formula:
    odd: Formula = Atom(atoms[0])
    for other in map(Atom, atoms[1:]):
        odd = Or(And(odd, Not(other)), And(Not(odd), other))
    return odd


def test_a_comparison_that_is_too_much_work_is_given_up() -> None:
    atoms = [f"a{number}" for number in range(12)]
    conditions = Conditions()
    one, other = conditions.unfold(parity(atoms)), conditions.unfold(parity(atoms[::-1]))
    memory = Memory(20_000)
    assert not conditions.equivalent(DEPTH, one, other, memory)
    assert memory.budget >= 0


def test_a_comparison_that_is_too_deep_is_given_up() -> None:
    conditions = Conditions()
    one, other = (conditions.unfold(parity(list(atoms))) for atoms in ("abc", "cba"))
    assert conditions.equivalent(3, one, other, Memory(ENOUGH))
    assert not conditions.equivalent(1, one, other, Memory(ENOUGH))


def test_a_hard_comparison_ends_when_its_work_is_done() -> None:
    chance = random.Random(5)
    obligations = [ltl.eventually(Atom(f"a{number}")) for number in range(40)]
    clauses = [ltl.disjunction(chance.choice([f, Not(f)]) for f in chance.sample(obligations, 3)) for _ in range(180)]
    conditions = Conditions()
    assert not conditions.follows(DEPTH, conditions.later(ltl.conjunction(clauses)), FALSE_CONDITION, Memory(200_000))
