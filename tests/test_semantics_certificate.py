"""Certificates are found for monitors that are right, and no certificate is accepted for one that is wrong."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mutants import differ, monitor_mutants
from strategies import ABC, alphabets, formulas, properties
from support import place

from ltlc.assurance.certify import NotCertified, certify
from ltlc.automata import translate
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.certificate import Answer, Certificate, Level, check, possible
from ltlc.semantics.conditions import Bound
from ltlc.semantics.encodings import ENCODINGS, EPISODE, Encoding, encode
from ltlc.semantics.finite import holds
from ltlc.semantics.ltl import (
    TRUE,
    And,
    Atom,
    Formula,
    Next,
    Not,
    Until,
    atoms,
    disjunction,
    eventually,
    globally,
)
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import AfterUntil, Eventually, Now, Property
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso, letters_over

A, B, C = (Atom(name) for name in ABC)
EXACT = Answer(certified=True, exact=True)
FREE = Alphabet(ABC)


def certified(formula: Formula, alphabet: Alphabet = FREE, monitor: Monitor | None = None) -> Certificate:
    found = certify(formula, alphabet, translate(formula, alphabet) if monitor is None else monitor)
    assert isinstance(found, Certificate), found
    return found


@settings(max_examples=150)
@given(properties(), st.sampled_from(list(ENCODINGS.values())), alphabets())
def test_every_monitor_of_a_property_is_certified_exactly(
    property_: Property, encoding: Encoding, alphabet: Alphabet
) -> None:
    assert check(certified(encode(property_, encoding), alphabet)) == EXACT


def test_a_clock_that_is_not_there_does_not_have_to_move_on() -> None:
    """`always a` is not violated from the start because no step is one of a fairness set that does not exist."""
    violated = Monitor((), (Verdict.VIOLATED,), (0,), ())
    dead = Level(7, (place(globally(A)),))
    assert not check(Certificate(globally(A), TRUE, violated, ((),), (dead,), ((),))).certified


@settings(max_examples=150)
@given(formulas(max_leaves=8, max_temporal=6), alphabets())
def test_every_monitor_of_a_formula_with_next_is_certified_exactly(formula: Formula, alphabet: Alphabet) -> None:
    assert check(certified(formula, alphabet)) == EXACT


@settings(max_examples=60)
@given(formulas(max_leaves=6, max_temporal=4), alphabets())
def test_no_monitor_that_differs_in_a_verdict_is_certified(formula: Formula, alphabet: Alphabet) -> None:
    monitor = translate(formula, alphabet)
    letters = list(alphabet.letters())
    right = certified(formula, alphabet, monitor)
    for mutant in monitor_mutants(monitor):
        if differ(monitor, mutant, letters):
            made_for_it = certify(formula, alphabet, mutant)
            assert check(replace(right, monitor=mutant)) != EXACT
            assert isinstance(made_for_it, NotCertified) or check(made_for_it) != EXACT


HARD = {
    "infinitely often and not": And(globally(eventually(A)), globally(eventually(Not(A)))),
    "from some step on, and not": And(eventually(globally(A)), globally(eventually(Not(A)))),
    "never what must come": And(eventually(B), globally(Not(B))),
    "the first step only": Next(TRUE),
    "any step": eventually(TRUE),
    "true": TRUE,
    "false": Not(TRUE),
    "a release of eventualities": Not(Until(Not(eventually(A)), globally(B))),
}


@pytest.mark.parametrize("formula", HARD.values(), ids=HARD)
def test_formulas_whose_verdicts_no_finite_run_explains_are_certified_exactly(formula: Formula) -> None:
    assert check(certified(formula)) == EXACT


def test_a_property_of_thirty_atoms_is_certified() -> None:
    names = [f"a{number}" for number in range(30)]
    near, far, stopped = (disjunction(map(Atom, names[k : k + 10])) for k in (0, 10, 20))
    formula = encode(AfterUntil(near, far, Eventually(Now(stopped))), EPISODE)
    assert check(certified(formula, Alphabet(tuple(names)))) == EXACT


def test_thirty_thresholds_of_one_signal_are_certified_over_their_thirty_one_letters() -> None:
    names = tuple(f"d > {number}" for number in range(30))
    alphabet = Alphabet(names, (Group(names, tuple(frozenset(names[:k]) for k in range(31))),))
    above = [Atom(name) for name in names]
    in_a_band = disjunction(And(above[k], Not(above[k + 1])) for k in range(4, 20, 2))
    formula = encode(AfterUntil(above[25], Not(above[2]), Eventually(Now(in_a_band))), EPISODE)
    assert check(certified(formula, alphabet)) == EXACT


def test_letters_are_assumed_away_only_by_the_stated_assumption() -> None:
    never_both = Alphabet(("a", "b"), (Group(("a", "b"), (frozenset(), frozenset("a"), frozenset("b"))),))
    certificate = certified(globally(Not(And(A, B))), never_both)
    assert certificate.monitor.verdicts == (Verdict.SATISFIED,)
    assert check(certificate) == EXACT
    assert not check(replace(certificate, assumption=TRUE)).certified


def test_a_permanent_verdict_needs_its_levels() -> None:
    certificate = certified(And(eventually(B), globally(Not(B))))
    assert certificate.levels
    assert not check(replace(certificate, levels=())).certified


def test_a_level_whose_eventuality_can_be_met_proves_nothing() -> None:
    formula = eventually(A)
    monitor = Monitor(("a",), (Verdict.VIOLATED,), (0,), ())
    assert isinstance(formula, Until)
    levels = (Level(formula, (place(formula),)),)
    assert not check(Certificate(formula, TRUE, monitor, ((),), levels, ((),))).certified


def test_a_verdict_that_should_be_permanent_is_certified_but_not_as_exact() -> None:
    lazy = Monitor(("a",), (Verdict.PRESUMABLY_SATISFIED,), (0,), ())
    certificate = Certificate(TRUE, TRUE, lazy, ((place(TRUE),),), (), ((Lasso((), (frozenset(),)),),))
    assert check(certificate) == Answer(certified=True, exact=False)


def test_a_witness_must_use_letters_that_exist() -> None:
    certificate = certified(globally(A), Alphabet(("a", "b"), (Group(("a", "b"), (frozenset(), frozenset("ab"))),)))
    assert check(certificate) == EXACT
    only_b = Lasso((), (frozenset("b"),))
    word_for_a = replace(
        certificate, assumption=Atom("a"), witnesses=tuple((*w, only_b) for w in certificate.witnesses)
    )
    assert not check(word_for_a).exact


def test_what_assumes_the_impossible_is_not_certified() -> None:
    nothing = And(A, Not(A))
    monitor = Monitor(("a",), (Verdict.VIOLATED,), (0,), ())
    vacuous = Certificate(globally(A), nothing, monitor, ((),), (Level(None, (place(globally(A)),)),), ((),))
    assert check(vacuous) == Answer(certified=False, exact=False)
    assert check(replace(vacuous, assumption=And(B, Not(A)))) == EXACT


@given(formulas(max_leaves=8, max_temporal=0))
def test_what_is_possible_holds_of_some_letter(assumption: Formula) -> None:
    some = any(holds(assumption, (letter,)) for letter in letters_over(ABC))
    assert some or not possible(assumption)


@given(alphabets())
def test_every_alphabet_is_possible(alphabet: Alphabet) -> None:
    assert possible(alphabet.as_formula())


def test_too_much_work_is_not_certified() -> None:
    certificate = certified(encode(AfterUntil(A, B, Eventually(Now(C))), EPISODE))
    assert check(certificate) == EXACT
    assert check(certificate, work=10) == Answer(certified=False, exact=False, met=Bound.WORK)
    assert check(certificate, depth=1) == Answer(certified=False, exact=False, met=Bound.DEPTH)


def test_a_certificate_that_is_wrong_met_no_bound() -> None:
    certificate = certified(encode(AfterUntil(A, B, Eventually(Now(C))), EPISODE))
    wrong = replace(certificate, formula=Not(certificate.formula))
    assert check(wrong) == Answer(certified=False, exact=False, met=None)


def test_sightings_in_order_are_certified_exactly() -> None:
    """Each further one takes twice as much work."""
    formula = eventually(Atom("a12"))
    for number in range(11, 0, -1):
        formula = eventually(And(Atom(f"a{number}"), formula))
    assert check(certified(formula, Alphabet(atoms(formula)))) == EXACT


@given(formulas(max_leaves=6, max_temporal=4))
def test_a_certificate_does_not_fit_the_negated_formula(formula: Formula) -> None:
    certificate = certified(formula, Alphabet(atoms(formula)))
    assert not check(replace(certificate, formula=Not(formula))).certified
