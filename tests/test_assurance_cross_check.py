"""The cross-check accepts what is right and notices what is not."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, assume, example, given, settings
from hypothesis import strategies as st
from mutants import differ, formula_mutants, monitor_mutants
from strategies import ABC, alphabets, properties
from support import compiled

from ltlc.assurance.cross_check import cross_check
from ltlc.assurance.runs import (
    Agreement,
    Mismatch,
    access_words,
    distinguishing_words,
    judging_letters,
    residual_runs,
    state_after,
)
from ltlc.automata import translate
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.encodings import DWYER, ENCODINGS, EPISODE, POINTWISE, Encoding
from ltlc.semantics.ltl import TRUE, And, Atom, disjunction
from ltlc.semantics.ltl import Not as Negation
from ltlc.semantics.ltl import Or as Either
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import After, AfterUntil, Always, Eventually, Now, Or, Property, Throughout, Until
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter, all_letters

FEW = settings(max_examples=25, suppress_health_check=[HealthCheck.nested_given, HealthCheck.too_slow])
"""The cross-check uses hypothesis itself."""

NEAR, FAR, STOPPED = Atom("near"), Atom("far"), Atom("stopped")
STOP_SIGN = AfterUntil(NEAR, FAR, Eventually(Now(STOPPED)))
SCOPES = [
    After(NEAR, Eventually(Now(STOPPED))),
    Until(FAR, Eventually(Now(STOPPED))),
    STOP_SIGN,
]


@FEW
@given(properties(depth=2), st.sampled_from(list(ENCODINGS.values())), alphabets())
def test_every_monitor_that_translation_makes_agrees_with_the_reference(
    property_: Property, encoding: Encoding, alphabet: Alphabet
) -> None:
    assert isinstance(cross_check(compiled(property_, encoding, alphabet)), Agreement)


A, B, C = map(Atom, ABC)


@FEW
@given(properties(depth=2), st.randoms(use_true_random=False))
@example(
    Until(
        Either(And(A, Negation(TRUE)), And(B, C)),
        Or(Now(Either(C, And(Negation(TRUE), Negation(A)))), Throughout(Negation(A))),
    ),
    None,
)
def test_a_monitor_that_gives_one_other_finite_verdict_is_caught(
    property_: Property, chance: random.Random | None
) -> None:
    right = compiled(property_)
    letters = all_letters(ABC)
    mutants = [m for m in monitor_mutants(right.monitor) if _differ_as_finite_words(right.monitor, m, letters)]
    assume(mutants)
    for mutant in [chance.choice(mutants)] if chance else mutants:
        assert isinstance(cross_check(replace(right, monitor=mutant)), Mismatch)


def _differ_as_finite_words(one: Monitor, other: Monitor, letters: Sequence[Letter]) -> bool:
    return differ(_as_finite(one), _as_finite(other), letters)


def _as_finite(monitor: Monitor) -> Monitor:
    presumable = (Verdict.PRESUMABLY_VIOLATED, Verdict.PRESUMABLY_SATISFIED)
    return replace(monitor, verdicts=tuple(presumable[v.holds] for v in monitor.verdicts))


@pytest.mark.parametrize("encoding", ENCODINGS.values(), ids=lambda e: e.name)
@pytest.mark.parametrize("property_", SCOPES, ids=lambda p: type(p).__name__)
def test_every_wrong_equation_of_an_encoding_is_caught(property_: Property, encoding: Encoding) -> None:
    right = compiled(property_, encoding)
    alphabet = right.specification.alphabet
    missed = []
    for formula in formula_mutants(right.formula):
        monitor = translate(formula, alphabet)
        if not differ(right.monitor, monitor, all_letters(alphabet.atoms)):
            continue
        if isinstance(cross_check(replace(right, formula=formula, monitor=monitor)), Agreement):
            missed.append(str(formula))
    assert missed == []


def test_a_mismatch_shows_a_shortest_run() -> None:
    wrong = replace(compiled(STOP_SIGN, POINTWISE), encoding=EPISODE)
    mismatch = cross_check(wrong)
    assert isinstance(mismatch, Mismatch)
    assert len(mismatch.run) == 2


def test_the_reading_of_another_encoding_is_told_from_the_language() -> None:
    assert isinstance(cross_check(replace(compiled(STOP_SIGN, DWYER), encoding=EPISODE)), Mismatch)
    assert isinstance(cross_check(compiled(STOP_SIGN, DWYER)), Agreement)


def test_a_property_with_thirty_atoms_is_judged_on_few_letters() -> None:
    names = [f"p{n}" for n in range(30)]
    right = compiled(Always(Now(disjunction(map(Atom, names)))))
    letters = judging_letters(right)
    assert frozenset() in letters
    assert len(letters) < 200
    assert isinstance(cross_check(right), Agreement)


def test_letters_that_do_not_exist_are_not_tried() -> None:
    names = tuple(f"p{n}" for n in range(12))
    alphabet = Alphabet(names).restricted_to(names)
    right = compiled(Always(Now(disjunction(map(Atom, names)))), alphabet=alphabet)
    assert all(alphabet.allows(letter) for letter in judging_letters(right))


def test_the_same_property_is_judged_on_the_same_runs() -> None:
    assert cross_check(compiled(STOP_SIGN)) == cross_check(compiled(STOP_SIGN))


@FEW
@given(properties(depth=2))
def test_distinguishing_words_tell_all_states_of_a_minimal_monitor_apart(property_: Property) -> None:
    monitor = compiled(property_).monitor
    letters = all_letters(monitor.atoms)
    words = distinguishing_words(monitor, letters)
    outputs = {
        tuple(monitor.verdicts[state_after(monitor, word, state)] for word in words)
        for state in range(len(monitor.verdicts))
    }
    assert len(outputs) == len(monitor.verdicts)
    assert sorted(access_words(monitor, letters)) == list(range(len(monitor.verdicts)))


@FEW
@given(properties(depth=2), st.randoms(use_true_random=False))
def test_residual_runs_lead_to_every_state_of_any_monitor_with_each_outcome_that_a_run_can_have(
    property_: Property, chance: random.Random
) -> None:
    right = compiled(property_)
    letters = all_letters(ABC)
    other = chance.choice([right.monitor, *monitor_mutants(right.monitor)])
    reached = {
        (state_after(other, w), state_after(right.monitor, w)) for w in residual_runs(other, right.formula, letters)
    }
    assert reached == set(_pairs(other, right.monitor, letters))


def _pairs(one: Monitor, other: Monitor, letters: Sequence[Letter]) -> list[tuple[int, int]]:
    """The pairs of states that some run leads to."""
    pairs = [(0, 0)]
    for a, b in pairs:
        steps = ((one.step(a, letter), other.step(b, letter)) for letter in letters)
        pairs += [pair for pair in dict.fromkeys(steps) if pair not in pairs]
    return pairs


def test_a_permanent_verdict_that_can_change_is_caught() -> None:
    right = compiled(Eventually(Now(NEAR)))
    wrong = replace(right, monitor=Monitor(("near",), (Verdict.VIOLATED,), (0,), ()))
    assert isinstance(cross_check(wrong), Mismatch)
