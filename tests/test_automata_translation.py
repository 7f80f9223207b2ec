"""Monitors against the definition of the four verdicts."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from itertools import combinations, product
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import HARD_NAMES, alphabets, formulas, lassos, letters, properties, words
from tableau import Tableau

from ltlc.analysis.comparison import mona
from ltlc.automata import translate, translate_by_progression
from ltlc.semantics import finite
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.encodings import ENCODINGS, Encoding, encode
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
    conjunction,
    disjunction,
    eventually,
    globally,
    implies,
    weak_until,
)
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import Property
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso, Letter, Word, all_letters, all_words

A, B, C = Atom("a"), Atom("b"), Atom("c")
AB = ("a", "b")

SHORT = {
    "V": Verdict.VIOLATED,
    "v": Verdict.PRESUMABLY_VIOLATED,
    "s": Verdict.PRESUMABLY_SATISFIED,
    "S": Verdict.SATISFIED,
}


def free(formula: Formula) -> Alphabet:
    return Alphabet(atoms(formula))


def steps(*letters_: str) -> Word:
    return tuple(frozenset(letter.split()) for letter in letters_)


def verdicts(monitor: Monitor, word: Word) -> list[Verdict]:
    """The verdict on the empty word, and the one after each letter."""
    return [monitor.verdicts[0], *monitor.run(word)]


def short_words(letters_: list[Letter], longest: int) -> list[Word]:
    return [word for length in range(longest + 1) for word in all_words(letters_, length)]


@pytest.mark.parametrize(
    ("formula", "word", "expected"),
    [
        (TRUE, ("", "a"), "SSS"),
        (FALSE, ("", "a"), "VVV"),
        (A, ("a", ""), "vSS"),
        (Not(A), ("a", ""), "sVV"),
        (Next(A), ("", "a"), "vvS"),
        (Next(A), ("a", ""), "vvV"),
        (Not(Next(A)), ("a", "a"), "ssV"),
        (eventually(A), ("", "", "a", ""), "vvvSS"),
        (globally(A), ("a", "a", "", "a"), "sssVV"),
        (globally(eventually(A)), ("", "a", ""), "svsv"),
        (eventually(globally(A)), ("", "a", ""), "vvsv"),
        (globally(implies(A, eventually(B))), ("", "a", "", "b", "a b"), "ssvvss"),
        (Until(A, B), ("a", "a", "b"), "vvvS"),
        (Until(A, B), ("a", "", "b"), "vvVV"),
        (weak_until(A, B), ("a", "a", ""), "sssV"),
    ],
)
def test_verdicts_are_those_of_the_definition(formula: Formula, word: tuple[str, ...], expected: str) -> None:
    monitor = translate(formula, free(formula))
    assert verdicts(monitor, steps(*word)) == [SHORT[letter] for letter in expected]


@pytest.mark.parametrize(
    ("formula", "states"),
    [
        (TRUE, 1),
        (eventually(A), 2),
        (globally(eventually(A)), 2),
        (globally(implies(A, eventually(B))), 2),
        (And(eventually(A), eventually(Not(A))), 4),
    ],
)
def test_monitors_are_as_small_as_they_can_be(formula: Formula, states: int) -> None:
    assert len(translate(formula, free(formula)).verdicts) == states


@pytest.mark.parametrize(
    "formula",
    [
        # Spot's own `monitor` translation does not notice the bad prefix.
        And(eventually(B), Next(Next(And(globally(Not(B)), globally(eventually(C)))))),
        And(eventually(A), Next(Next(globally(Not(A))))),
        And(eventually(A), And(Next(globally(Not(A))), globally(eventually(B)))),
        And(globally(eventually(A)), eventually(globally(Not(A)))),
        Or(globally(eventually(A)), eventually(globally(Not(A)))),
        Until(A, globally(And(Not(A), eventually(B)))),
    ],
)
def test_formulas_that_break_naive_constructions_are_exact(formula: Formula) -> None:
    for construction in (translate, translate_by_progression):
        assert_exact(construction(formula, free(formula)), formula, all_letters(atoms(formula)), longest=3)


def assert_exact(monitor: Monitor, formula: Formula, letters_: list[Letter], longest: int) -> None:
    oracle = Tableau(formula, letters_)
    for word in short_words(letters_, longest):
        assert verdicts(monitor, word)[-1] is oracle.verdict(word), word


def test_a_bad_prefix_that_spots_own_translation_survives_is_violated() -> None:
    formula = And(eventually(B), Next(Next(And(globally(Not(B)), globally(eventually(C))))))
    assert translate(formula, free(formula)).run(steps("", ""))[-1] is Verdict.VIOLATED


@settings(max_examples=120)
@given(formulas(AB, max_temporal=4), alphabets(AB))
def test_verdicts_of_random_formulas_are_exact(formula: Formula, alphabet: Alphabet) -> None:
    assert_exact(translate(formula, alphabet), formula, list(alphabet.letters()), longest=3)


@settings(max_examples=100)
@given(formulas(), words(), lassos())
def test_verdicts_agree_with_finite_words_and_do_not_contradict_infinite_ones(
    formula: Formula, word: Word, rest: Lasso
) -> None:
    verdict = verdicts(translate(formula, free(formula)), word)[-1]
    satisfied = holds_on_lasso(formula, Lasso(word + rest.stem, rest.loop))
    assert not (verdict is Verdict.VIOLATED and satisfied)
    assert not (verdict is Verdict.SATISFIED and not satisfied)
    assert verdict.is_permanent or verdict.holds == finite.holds(formula, word)


@settings(max_examples=200)
@given(formulas(), alphabets())
def test_two_constructions_give_the_same_monitor(formula: Formula, alphabet: Alphabet) -> None:
    assert translate(formula, alphabet) == translate_by_progression(formula, alphabet)


@settings(max_examples=60)
@given(properties(depth=3), st.sampled_from(list(ENCODINGS.values())))
def test_two_constructions_give_the_same_monitor_of_properties(property_: Property, encoding: Encoding) -> None:
    formula = encode(property_, encoding)
    assert translate(formula, free(formula)) == translate_by_progression(formula, free(formula))


@settings(max_examples=100)
@given(formulas(AB, max_leaves=12), formulas(AB, max_leaves=8))
def test_equivalent_formulas_have_equal_monitors(left: Formula, right: Formula) -> None:
    alphabet = Alphabet(AB)
    padding = Or(TRUE, And(A, B))
    once = And(padding, Not(And(Not(left), Not(right))))
    again = And(padding, Or(right, And(left, Or(A, Not(A)))))
    assert translate(once, alphabet) == translate(again, alphabet)


@settings(max_examples=100)
@given(formulas(AB, max_leaves=12), alphabets(AB))
def test_monitors_are_minimal_and_numbered_from_the_smallest_letter_on(formula: Formula, alphabet: Alphabet) -> None:
    monitor = translate(formula, alphabet)
    smallest_first = [
        frozenset(a for a, holds in zip(monitor.atoms, bits, strict=True) if holds)
        for bits in product((False, True), repeat=len(monitor.atoms))
    ]
    existing = alphabet.restricted_to(monitor.atoms)
    letters_ = [letter for letter in smallest_first if existing.allows(letter)]
    assert breadth_first(monitor, letters_) == list(range(len(monitor.verdicts)))
    assert all(distinguishable(monitor, p, q, letters_) for p, q in combinations(range(len(monitor.verdicts)), 2))


def breadth_first(monitor: Monitor, letters_: list[Letter]) -> list[int]:
    found = [0]
    for state in found:
        for letter in letters_:
            if (successor := monitor.step(state, letter)) not in found:
                found.append(successor)
    return found


def distinguishable(monitor: Monitor, p: int, q: int, letters_: list[Letter]) -> bool:
    """Whether some word of existing letters gives different verdicts from p and from q."""
    pairs = [(p, q)]
    for left, right in pairs:
        if monitor.verdicts[left] is not monitor.verdicts[right]:
            return True
        successors = ((monitor.step(left, letter), monitor.step(right, letter)) for letter in letters_)
        pairs += [pair for pair in dict.fromkeys(successors) if pair not in pairs]
    return False


@settings(max_examples=60)
@given(formulas(AB, max_leaves=12), alphabets(AB))
def test_decisions_ask_in_order_and_only_what_matters(formula: Formula, alphabet: Alphabet) -> None:
    monitor = translate(formula, alphabet)
    for number, (atom, low, high) in enumerate(monitor.decisions):
        assert low != high
        assert all(t >= 0 or monitor.decisions[~t].atom > atom for t in (low, high)), number
    assert len(set(monitor.decisions)) == len(monitor.decisions)


@pytest.mark.parametrize("name", HARD_NAMES)
def test_names_of_atoms_are_only_names(name: str) -> None:
    formula = globally(implies(Atom(name), Next(eventually(Atom("b")))))
    plain = globally(implies(A, Next(eventually(B))))
    monitor = translate(formula, free(formula))
    expected = translate(plain, free(plain))
    assert (monitor.verdicts, monitor.edges, monitor.decisions) == (
        expected.verdicts,
        expected.edges,
        expected.decisions,
    )
    assert monitor.atoms == (name, "b")


THIRTY = tuple(f"x{number}" for number in range(30))
THRESHOLDS = Alphabet(THIRTY, (Group(THIRTY, tuple(frozenset(THIRTY[:k]) for k in range(31))),))
"""x0 is v > 0, x1 is v > 1, …: what holds is x0 up to some x."""


@pytest.mark.parametrize("construction", [translate, translate_by_progression])
@pytest.mark.parametrize("alphabet", [Alphabet(THIRTY), THRESHOLDS])
def test_thirty_atoms_are_not_enumerated(
    construction: Callable[[Formula, Alphabet], Monitor], alphabet: Alphabet
) -> None:
    some, every = disjunction(map(Atom, THIRTY)), conjunction(map(Atom, THIRTY))
    monitor = construction(Until(some, every), alphabet)
    assert verdicts(monitor, (frozenset(THIRTY[:3]), frozenset(THIRTY))) == [SHORT[x] for x in "vvS"]
    assert len(monitor.decisions) < 100


def test_thresholds_on_one_signal_ask_no_more_than_they_must() -> None:
    some = disjunction(map(Atom, THIRTY))
    assert len(translate(globally(some), THRESHOLDS).decisions) == 1


def test_letters_that_do_not_exist_cannot_save_a_property() -> None:
    exclusive = Alphabet(AB, (Group(AB, (frozenset(), frozenset("a"), frozenset("b"))),))
    both_at_last = eventually(And(A, B))
    assert translate(both_at_last, exclusive).verdicts == (Verdict.VIOLATED,)
    assert translate(both_at_last, Alphabet(AB)).verdicts[0] is Verdict.PRESUMABLY_VIOLATED


def test_atoms_keep_the_order_of_the_alphabet_and_those_not_in_the_formula_are_left_out() -> None:
    assert translate(And(B, A), Alphabet(("c", "a", "b"))).atoms == ("a", "b")


def test_an_atom_that_is_not_in_the_alphabet_is_refused() -> None:
    with pytest.raises(ValueError, match="not in the alphabet: b"):
        translate(And(A, B), Alphabet(("a",)))


def test_an_alphabet_without_letters_is_refused() -> None:
    with pytest.raises(ValueError, match="no letter"):
        translate(A, Alphabet(("a",), (Group(("a",), ()),)))


@pytest.mark.skipif(shutil.which("mona") is None, reason="mona is not installed")
@settings(max_examples=60)
@given(formulas(max_leaves=7).filter(atoms), st.lists(words(letters()), min_size=10, max_size=20))
def test_presumable_verdicts_agree_with_mona(
    tmp_path_factory: pytest.TempPathFactory, formula: Formula, samples: list[Word]
) -> None:
    oracle = mona.automaton(formula, tmp_path_factory.getbasetemp())
    monitor = translate(formula, free(formula))
    for word in samples:
        verdict = verdicts(monitor, word)[-1]
        if word and not verdict.is_permanent:
            assert verdict.holds == oracle.accepts(word)


@pytest.mark.skipif(shutil.which("mona") is None, reason="mona is not installed")
def test_mona_knows_strong_next_and_until(tmp_path: Path) -> None:
    automaton = mona.automaton(Next(Until(A, B)), tmp_path)
    assert automaton.accepts(steps("", "a", "b"))
    assert not automaton.accepts(steps("b"))
    assert not automaton.accepts(steps("", "a"))
