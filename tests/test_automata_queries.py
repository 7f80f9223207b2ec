"""Spot's answers, against examples from the literature and all short lassos."""

import pytest
from hypothesis import given, settings
from strategies import formulas

from ltlc.automata.queries import (
    TemporalClass,
    deterministic_size,
    implies,
    is_satisfiable,
    nondeterministic_size,
    some_lasso,
    temporal_class,
)
from ltlc.semantics import properties as p
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import FALSE, TRUE, And, Atom, Formula, Not, Or, eventually, globally, weak_until
from ltlc.semantics.ltl import implies as then
from ltlc.semantics.timed_atoms import Historically, Once
from ltlc.semantics.words import Lasso, all_letters, all_words

A, B = Atom("a"), Atom("b")
FREE = Alphabet(("a", "b"))
NEVER_BOTH = Alphabet(("a", "b"), (Group(("a", "b"), (frozenset(), frozenset("a"), frozenset("b"))),))


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        (TRUE, TemporalClass.SAFETY_AND_GUARANTEE),
        (A, TemporalClass.SAFETY_AND_GUARANTEE),
        (globally(A), TemporalClass.SAFETY),
        (weak_until(A, B), TemporalClass.SAFETY),
        (eventually(A), TemporalClass.GUARANTEE),
        (Or(globally(A), eventually(B)), TemporalClass.OBLIGATION),
        (globally(then(A, eventually(B))), TemporalClass.RECURRENCE),
        (eventually(globally(A)), TemporalClass.PERSISTENCE),
        (Or(globally(eventually(A)), eventually(globally(B))), TemporalClass.REACTIVITY),
    ],
)
def test_a_formula_has_the_class_of_manna_and_pnueli(formula: Formula, expected: TemporalClass) -> None:
    assert temporal_class(formula, FREE) is expected


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        (globally(Or(Not(And(A, B)), eventually(A))), TemporalClass.SAFETY_AND_GUARANTEE),
        (Or(eventually(A), eventually(globally(And(A, B)))), TemporalClass.GUARANTEE),
        (And(globally(A), Not(And(eventually(B), A))), TemporalClass.SAFETY),
    ],
)
def test_the_class_is_that_among_the_letters_that_exist(formula: Formula, expected: TemporalClass) -> None:
    assert temporal_class(formula, NEVER_BOTH) is expected


def _within(body: p.Property) -> p.Property:
    return p.Within(10**9, body)


@pytest.mark.parametrize(
    ("property_", "expected"),
    [
        (p.Always(p.Implies(p.Now(A), _within(p.Eventually(p.Now(B))))), TemporalClass.SAFETY),
        (p.Always(_within(p.Eventually(p.Now(A)))), TemporalClass.SAFETY),
        (_within(p.Eventually(p.Always(p.Now(A)))), TemporalClass.SAFETY_AND_GUARANTEE),
        (p.Until(A, _within(p.Eventually(p.Now(B)))), TemporalClass.GUARANTEE),
        (p.AfterUntil(A, B, p.Eventually(p.Now(Historically("h", A, 10**9)))), TemporalClass.RECURRENCE),
        (p.Eventually(p.Now(Once("o", A, 10**9))), TemporalClass.GUARANTEE),
    ],
)
def test_a_deadline_that_passes_some_time_makes_violations_show(property_: p.Property, expected: TemporalClass) -> None:
    assert temporal_class(encode(property_, EPISODE), FREE) is expected


def test_letters_that_do_not_exist_satisfy_nothing() -> None:
    assert is_satisfiable(And(A, B), FREE)
    assert not is_satisfiable(eventually(And(A, B)), NEVER_BOTH)
    assert implies(eventually(A), eventually(And(A, Not(B))), NEVER_BOTH)
    assert not implies(eventually(A), eventually(And(A, Not(B))), FREE)


@settings(max_examples=150)
@given(formulas(("a", "b"), max_leaves=4), formulas(("a", "b"), max_leaves=4))
def test_an_implication_holds_on_every_short_lasso(left: Formula, right: Formula) -> None:
    if not implies(left, right, FREE):
        return
    for lasso in _lassos(3):
        assert not holds_on_lasso(left, lasso) or holds_on_lasso(right, lasso)


@settings(max_examples=100)
@given(formulas(("a", "b"), max_leaves=4))
def test_a_lasso_is_found_where_one_is_and_satisfies_the_formula(formula: Formula) -> None:
    found = some_lasso(formula, NEVER_BOTH)
    assert (found is not None) == is_satisfiable(formula, NEVER_BOTH)
    if found:
        assert holds_on_lasso(formula, found)
        assert {"a", "b"} not in (*found.stem, *found.loop)


def _lassos(longest: int) -> list[Lasso]:
    words = [w for n in range(1, longest + 1) for w in all_words(all_letters(("a", "b")), n)]
    return [Lasso(word[:k], word[k:]) for word in words for k in range(len(word))]


def test_sizes_are_those_of_the_textbook_automata() -> None:
    response = globally(then(A, eventually(B)))
    assert nondeterministic_size(response).states == 2
    assert deterministic_size(eventually(globally(A))).states == 1  # acceptance on edges
    assert nondeterministic_size(FALSE).states == 1
