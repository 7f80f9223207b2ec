"""Core LTL as trees and as text; Spot reads the text as we do."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from strategies import ABC, HARD_NAMES, formulas, lassos, words

from ltlc.automata.engine import spot
from ltlc.automata.machine import letters_of
from ltlc.automata.spot_translation import Session
from ltlc.semantics import ltl
from ltlc.semantics.alphabet import Alphabet
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
    atoms,
    eventually,
    globally,
    implies,
    release,
    strong_release,
    to_text,
    weak_next,
    weak_until,
)
from ltlc.semantics.words import Lasso, Letter, Word

A, B, C = Atom("a"), Atom("b"), Atom("c")


@pytest.mark.parametrize(
    ("formula", "text"),
    [
        (TRUE, "1"),
        (FALSE, "0"),
        (And(A, Or(B, C)), "a & (b | c)"),
        (Or(And(A, B), C), "a & b | c"),
        (Not(And(A, B)), "!(a & b)"),
        (implies(A, B), "a -> b"),
        (Next(A), "X[!] a"),
        (weak_next(A), "X a"),
        (eventually(A), "F a"),
        (globally(A), "G a"),
        (globally(And(A, B)), "G(a & b)"),
        (Until(A, B), "a U b"),
        (weak_until(A, B), "a W b"),
        (release(A, B), "a R b"),
        (strong_release(A, B), "a M b"),
        (globally(implies(A, eventually(B))), "G(a -> F b)"),
        (Until(Until(A, B), C), "(a U b) U c"),
        (Atom("GPS_ok"), '"GPS_ok"'),
        (Atom('say "a"'), '"say \\"a\\""'),
    ],
)
def test_text_is_what_a_person_would_write(formula: Formula, text: str) -> None:
    assert to_text(formula) == text


@settings(max_examples=150)
@given(formulas(max_leaves=8), lassos())
def test_spot_reads_the_text_with_the_same_meaning_on_infinite_words(formula: Formula, lasso: Lasso) -> None:
    automaton = spot.formula(to_text(formula)).translate(dict=spot.make_bdd_dict())
    word = spot.parse_word(f"{written(lasso.stem)}cycle{{{written(lasso.loop)[:-1]}}}", automaton.get_dict())
    assert automaton.intersects(word.as_automaton()) == holds_on_lasso(formula, lasso)


def written(word: Word) -> str:
    """A word in Spot's syntax, a semicolon after each letter."""
    return "".join(f"{letter_text(letter)};" for letter in word)


def letter_text(letter: Letter) -> str:
    return "&".join(atom if atom in letter else f"!{atom}" for atom in ABC)


@settings(max_examples=150)
@given(formulas(max_leaves=8), words(max_size=4).filter(bool))
def test_spot_reads_the_text_with_the_same_meaning_on_finite_words(formula: Formula, word: Word) -> None:
    as_infinite = spot.from_ltlf(spot.formula(to_text(formula)))
    automaton = as_infinite.translate(dict=spot.make_bdd_dict())
    ended = "".join(f"{letter_text(letter)}&alive;" for letter in word) + "cycle{!alive}"
    parsed = spot.parse_word(ended, automaton.get_dict())
    assert automaton.intersects(parsed.as_automaton()) == holds(formula, word)


@settings(max_examples=100)
@given(formulas(max_leaves=8))
def test_text_and_tree_are_the_same_formula_to_spot(formula: Formula) -> None:
    session = Session(letters_of(formula, Alphabet(ABC)))
    renamed = rename(formula, {name: f"p{k}" for k, name in enumerate(session.letters.atoms)})
    assert spot.are_equivalent(spot.formula(to_text(renamed)), session.to_spot(formula, finite=False))


def rename(formula: Formula, names: dict[str, str]) -> Formula:
    match formula:
        case Atom(name):
            return Atom(names[name])
        case _:
            return type(formula)(*(rename(child, names) for child in ltl.children(formula)))


@pytest.mark.parametrize("name", [name for name in HARD_NAMES if name])
def test_spot_reads_any_name_of_an_atom_back(name: str) -> None:
    parsed = spot.formula(to_text(And(Atom(name), Next(Atom("x")))))
    [atom] = [p for p in spot.atomic_prop_collect(parsed) if p.ap_name() != "x"]
    assert str(atom) in (name, to_text(Atom(name)))


def test_atoms_come_once_in_the_order_of_first_use() -> None:
    assert atoms(And(Until(C, A), Or(A, Next(B)))) == ("c", "a", "b")


def test_size_counts_every_occurrence() -> None:
    assert ltl.size(And(Not(A), Not(A))) == 5


def test_deep_formulas_are_walked_without_recursion() -> None:
    formula: Formula = A
    for _ in range(100_000):
        formula = Next(formula)
    assert (atoms(formula), ltl.size(formula)) == (("a",), 100_001)
    assert not ltl.is_propositional(formula)


@pytest.mark.parametrize(
    ("formula", "propositional", "next_free"),
    [
        (And(A, Not(B)), True, True),
        (Until(A, B), False, True),
        (Or(A, Next(B)), False, False),
        (TRUE, True, True),
    ],
)
def test_kinds_of_formulas_are_told_apart(formula: Formula, propositional: bool, next_free: bool) -> None:
    assert (ltl.is_propositional(formula), ltl.is_next_free(formula)) == (propositional, next_free)


def test_conjunction_and_disjunction_of_nothing_are_true_and_false() -> None:
    assert (ltl.conjunction([]), ltl.disjunction([])) == (TRUE, FALSE)
    assert ltl.conjunction([A, B, C]) == And(And(A, B), C)
