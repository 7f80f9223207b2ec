"""Python and Coq mean the same: evaluators extracted from Coq made the table, those in Python must agree with it."""

from __future__ import annotations

import pytest
from cases import ATOMS, LASSOS, RUNS, TABLE, digits, read_formula, read_property
from effort import some_of

from ltlc.automata import translate
from ltlc.semantics import finite
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.denotation import satisfies
from ltlc.semantics.encodings import ENCODINGS, Encoding, encode
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import Formula
from ltlc.semantics.progression import progress
from ltlc.semantics.words import Word

LINES = [line.split(" ; ") for line in TABLE.read_text(encoding="utf-8").splitlines()]
NUMBERS = ("line ", "singles ", "integers ")
PROPERTIES = [(text, values.split()) for text, values in LINES if not text.startswith(("formula ", *NUMBERS))]
FORMULAS = [(text.removeprefix("formula "), values.split()) for text, values in LINES if text.startswith("formula ")]


def test_the_table_holds_tens_of_thousands_of_cases() -> None:
    assert len(PROPERTIES) * len(ENCODINGS) * (len(RUNS) + len(LASSOS)) > 100_000
    assert len(FORMULAS) * (len(RUNS) + len(LASSOS)) > 30_000


def test_the_denotation_is_that_of_coq() -> None:
    for text, (episode, *_) in PROPERTIES:
        property_ = read_property(iter(text.split()))
        assert digits(satisfies(run, property_) for run in RUNS) == episode, text


@pytest.mark.parametrize(("column", "encoding"), list(enumerate(ENCODINGS.values())), ids=list(ENCODINGS))
def test_the_encodings_are_those_of_coq(column: int, encoding: Encoding) -> None:
    for text, values in some_of(PROPERTIES, column):
        formula = encode(read_property(iter(text.split())), encoding)
        assert digits(finite.holds(formula, run) for run in RUNS) == values[column], text
        assert digits(holds_on_lasso(formula, lasso) for lasso in LASSOS) == values[4 + column], text


def test_the_interpreters_of_core_ltl_are_those_of_coq() -> None:
    for text, (on_runs, on_lassos) in FORMULAS:
        formula = read_formula(iter(text.split()))
        assert digits(finite.holds(formula, run) for run in RUNS) == on_runs, text
        assert digits(holds_on_lasso(formula, lasso) for lasso in LASSOS) == on_lassos, text


def progressed(formula: Formula, run: Word) -> Formula:
    for letter in run:
        formula = progress(formula, letter)
    return formula


def test_what_progression_leaves_of_a_formula_holds_on_the_empty_word_where_coq_says_the_run_satisfies_it() -> None:
    for text, (on_runs, _) in FORMULAS:
        formula = read_formula(iter(text.split()))
        assert digits(finite.holds(progressed(formula, run), ()) for run in RUNS) == on_runs, text


def test_monitors_give_the_finite_verdicts_of_coq_where_none_is_permanent() -> None:
    for text, (episode, *_) in PROPERTIES[:120]:
        formula = encode(read_property(iter(text.split())), ENCODINGS["episode"])
        monitor = translate(formula, Alphabet(ATOMS))
        # Without `next` a permanent verdict agrees with the finite run, except before the first step.
        found = digits(monitor.run(run)[-1].holds if run else finite.holds(formula, ()) for run in RUNS)
        assert found == episode, text
