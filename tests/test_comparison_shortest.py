"""Shortest separating runs: against all runs that are no longer."""

from hypothesis import given, settings
from strategies import alphabets, formulas

from ltlc.automata.queries import buchi, is_satisfiable, words_of
from ltlc.comparison.shortest import shortest_lasso, shortest_word
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.finite import holds
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import And, Atom, Formula, Not, atoms, eventually, globally
from ltlc.semantics.words import Lasso, all_words

AB = ("a", "b")
LONGEST = 3


@settings(max_examples=120)
@given(formulas(AB, max_leaves=5), formulas(AB, max_leaves=5), alphabets(AB))
def test_no_shorter_finite_run_tells_two_formulas_apart(left: Formula, right: Formula, alphabet: Alphabet) -> None:
    found = shortest_word(tuple(words_of([left, right], alphabet)), lambda a, b: a and not b)
    longest = LONGEST if found is None else len(found) - 1
    if found is not None:
        used = set(atoms(And(left, right)))
        assert set(found) <= {letter & used for letter in alphabet.letters()}
        assert holds(left, found)
        assert not holds(right, found)
    for length in range(1, min(longest, LONGEST) + 1):
        assert not any(holds(left, w) and not holds(right, w) for w in all_words(alphabet.letters(), length))


@settings(max_examples=120)
@given(formulas(AB, max_leaves=5), alphabets(AB))
def test_no_shorter_lasso_satisfies_a_formula(formula: Formula, alphabet: Alphabet) -> None:
    found = shortest_lasso(buchi(formula, alphabet))
    assert (found is not None) == is_satisfiable(formula, alphabet)
    longest = LONGEST
    if found is not None:
        assert holds_on_lasso(formula, found)
        longest = len(found.stem) + len(found.loop) - 1
    for length in range(1, min(longest, LONGEST) + 1):
        for word in all_words(alphabet.letters(), length):
            assert not any(holds_on_lasso(formula, Lasso(word[:k], word[k:])) for k in range(length))


def test_a_loop_that_has_to_alternate_is_found() -> None:
    a = Atom("a")
    both_for_ever = And(globally(eventually(a)), globally(eventually(Not(a))))
    found = shortest_lasso(buchi(both_for_ever, Alphabet(("a",))))
    assert found is not None
    assert (len(found.stem), len(found.loop)) == (0, 2)


def test_a_letter_that_does_not_exist_separates_nothing() -> None:
    a, b = Atom("a"), Atom("b")
    never_both = Alphabet(AB, (Group(AB, (frozenset(), frozenset("a"), frozenset("b"))),))
    machines = tuple(words_of([eventually(a), eventually(And(a, Not(b)))], never_both))
    assert shortest_word(machines, lambda left, right: left != right) is None
    assert shortest_lasso(buchi(eventually(And(a, b)), never_both)) is None
