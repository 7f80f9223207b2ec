"""The two readings of core LTL, operator by operator, and progression between them."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from strategies import formulas, lassos, letters, predicates, words

from ltlc.semantics.encodings import relativise
from ltlc.semantics.finite import holds
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import (
    FALSE,
    TRUE,
    And,
    Atom,
    Formula,
    Next,
    Not,
    Or,
    Until,
    eventually,
    globally,
    implies,
    is_next_free,
    release,
    strong_release,
    weak_next,
    weak_until,
)
from ltlc.semantics.progression import NON_EMPTY, progress
from ltlc.semantics.words import Lasso, Letter, Word, all_letters, all_words

A, B = Atom("a"), Atom("b")


def word(text: str) -> Word:
    """`a.ab.-` is three steps: a, both, none; the empty text is the empty word."""
    return tuple(frozenset(step.strip("-")) for step in text.split(".")) if text else ()


FINITE = [
    (TRUE, "", True),
    (TRUE, "-", True),
    (FALSE, "", False),
    (FALSE, "-", False),
    (A, "", False),
    (A, "a", True),
    (A, "-.a", False),
    (Not(A), "", True),
    (Not(A), "a", False),
    (And(A, B), "ab", True),
    (And(A, B), "a.b", False),
    (Or(A, B), "b", True),
    (Or(A, B), "-", False),
    (implies(A, B), "", True),
    (implies(A, B), "a", False),
    (implies(A, B), "ab", True),
    (implies(A, B), "-", True),
    (Next(A), "", False),
    (Next(A), "a", False),
    (Next(A), "-.a", True),
    (Next(A), "a.-", False),
    (Next(TRUE), "a", False),
    (weak_next(A), "", True),
    (weak_next(A), "-", True),
    (weak_next(A), "-.a", True),
    (weak_next(A), "a.-", False),
    (Until(A, B), "", False),
    (Until(A, B), "a", False),
    (Until(A, B), "b", True),
    (Until(A, B), "a.a.b", True),
    (Until(A, B), "a.-.b", False),
    (Until(A, B), "a.a", False),
    (weak_until(A, B), "", True),
    (weak_until(A, B), "a.a", True),
    (weak_until(A, B), "a.b.-", True),
    (weak_until(A, B), "a.-.b", False),
    (release(A, B), "", True),
    (release(A, B), "b.b", True),
    (release(A, B), "b.ab.-", True),
    (release(A, B), "b.a", False),
    (strong_release(A, B), "", False),
    (strong_release(A, B), "b.b", False),
    (strong_release(A, B), "b.ab.-", True),
    (strong_release(A, B), "b.a", False),
    (eventually(A), "", False),
    (eventually(A), "-.a", True),
    (eventually(A), "-.-", False),
    (globally(A), "", True),
    (globally(A), "a.a", True),
    (globally(A), "a.-", False),
    (eventually(globally(A)), "", False),
    (eventually(globally(A)), "-.a", True),
    (eventually(globally(A)), "a.-", False),
    (globally(eventually(A)), "a.-", False),
    (globally(eventually(A)), "-.a", True),
    (NON_EMPTY, "", False),
    (NON_EMPTY, "-", True),
]

INFINITE = [
    (TRUE, "", "-", True),
    (A, "", "a", True),
    (A, "-", "a", False),
    (Not(A), "-", "a", True),
    (And(A, B), "ab", "-", True),
    (Or(A, B), "b", "-", True),
    (Next(A), "", "-.a", True),
    (Next(A), "a", "-", False),
    (Next(A), "", "a", True),
    (weak_next(A), "a", "-", False),
    (Until(A, B), "a.a", "b", True),
    (Until(A, B), "", "a", False),
    (Until(A, B), "a", "a.-.b", False),
    (Until(A, B), "", "b.-", True),
    (weak_until(A, B), "", "a", True),
    (weak_until(A, B), "a", "-", False),
    (release(A, B), "", "b", True),
    (release(A, B), "b", "ab.-", True),
    (strong_release(A, B), "", "b", False),
    (strong_release(A, B), "b", "ab.-", True),
    (eventually(A), "-.-", "-.a", True),
    (eventually(A), "", "-", False),
    (globally(A), "a", "a.a", True),
    (globally(A), "a", "a.-", False),
    (globally(eventually(A)), "", "a.-", True),
    (globally(eventually(A)), "a.a", "-", False),
    (eventually(globally(A)), "-.-", "a", True),
    (eventually(globally(A)), "", "a.-", False),
]


@pytest.mark.parametrize(("formula", "text", "expected"), FINITE)
def test_finite_truth_table(formula: Formula, text: str, expected: bool) -> None:
    assert holds(formula, word(text)) is expected


@pytest.mark.parametrize(("formula", "stem", "loop", "expected"), INFINITE)
def test_infinite_truth_table(formula: Formula, stem: str, loop: str, expected: bool) -> None:
    assert holds_on_lasso(formula, Lasso(word(stem), word(loop))) is expected


@given(formulas(), lassos())
def test_unrolling_the_loop_changes_nothing(formula: Formula, lasso: Lasso) -> None:
    once = Lasso(lasso.stem + lasso.loop, lasso.loop)
    twice = Lasso(lasso.stem, lasso.loop * 2)
    assert holds_on_lasso(formula, lasso) == holds_on_lasso(formula, once) == holds_on_lasso(formula, twice)


def test_a_lasso_without_a_loop_is_refused() -> None:
    with pytest.raises(ValueError, match="loop"):
        Lasso((frozenset(),), ())


@settings(max_examples=300)
@given(formulas(), letters(), words(max_size=4))
def test_progression_is_what_remains_on_finite_words(formula: Formula, letter: Letter, rest: Word) -> None:
    assert holds(progress(formula, letter), rest) == holds(formula, (letter, *rest))


@settings(max_examples=300)
@given(formulas(), letters(), lassos())
def test_progression_is_what_remains_on_infinite_words(formula: Formula, letter: Letter, rest: Lasso) -> None:
    whole = Lasso((letter, *rest.stem), rest.loop)
    assert holds_on_lasso(progress(formula, letter), rest) == holds_on_lasso(formula, whole)


def segment(u: Word, end: Formula) -> Word:
    """`u` before its first step with `end`."""
    return u[: next((k for k in range(len(u)) if holds(end, u[k:])), len(u))]


@settings(max_examples=300)
@given(formulas(), predicates(), words())
def test_relativised_formulas_judge_the_segment_before_the_end(formula: Formula, end: Formula, u: Word) -> None:
    assert holds(relativise(end, formula), u) == holds(formula, segment(u, end))


@settings(max_examples=300)
@given(formulas(), predicates(), lassos())
def test_relativised_formulas_judge_infinite_words_too(formula: Formula, end: Formula, lasso: Lasso) -> None:
    once = lasso.stem + lasso.loop
    cut = segment(once, end)
    expected = holds_on_lasso(formula, lasso) if cut == once else holds(formula, cut)
    assert holds_on_lasso(relativise(end, formula), lasso) == expected


@given(formulas().filter(is_next_free), words(max_size=5).filter(bool))
def test_on_next_free_formulas_the_end_is_as_if_the_last_step_were_repeated(formula: Formula, u: Word) -> None:
    assert holds(formula, u) == holds_on_lasso(formula, Lasso(u[:-1], u[-1:]))


def test_all_letters_and_words_are_there_once() -> None:
    assert len(set(all_letters("abc"))) == len(all_letters("abc")) == 8
    assert len(set(all_words(all_letters("ab"), 3))) == 4**3
    assert list(all_words(all_letters("ab"), 0)) == [()]
