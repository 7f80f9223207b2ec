"""How formulas relate: known answers, and answers on random formulas judged by other means."""

from dataclasses import replace
from functools import reduce

import pytest
from hypothesis import given, settings
from strategies import alphabets, formulas

from ltlc.analysis.comparison import relate
from ltlc.analysis.comparison.answer import answer
from ltlc.analysis.comparison.measure import earliest, monitorability
from ltlc.analysis.comparison.questions import KNOWN, question_of_formulas
from ltlc.analysis.comparison.reference import Contradiction, Trials, check_separation, confirm
from ltlc.analysis.comparison.relate import Pair, relate_on_finite_runs, relate_on_infinite_runs
from ltlc.analysis.comparison.results import (
    Candidate,
    Comparison,
    Monitorability,
    Monitored,
    Question,
    Related,
    Relation,
    Runs,
)
from ltlc.automata import Budget, Exceeded, translate
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.encodings import encode
from ltlc.semantics.finite import holds
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import And, Atom, Formula, Not, Or, eventually, globally, implies
from ltlc.semantics.properties import AfterUntil, Eventually, Now
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso, Word, all_letters

A, B = Atom("a"), Atom("b")
NEAR, FAR, STOP = Atom("near"), Atom("far"), Atom("stop")
STOP_AT_SIGN = AfterUntil(NEAR, FAR, Eventually(Now(STOP)))
ZONES = Alphabet(
    ("near", "far", "stop"), (Group(("near", "far"), (frozenset(), frozenset({"near"}), frozenset({"far"}))),)
)
LETTERS = all_letters(("a", "b"))


def pair(left: Formula, right: Formula, alphabet: Alphabet) -> Pair:
    one, other = Candidate("left", left), Candidate("right", right)
    question = Question("test", None, "", alphabet, alphabet, (one, other))
    return Pair(question, one, other, translate(left, alphabet), translate(right, alphabet))


def holds_on(word: Word | Lasso, formula: Formula) -> bool:
    return holds_on_lasso(formula, word) if isinstance(word, Lasso) else holds(formula, word)


@settings(max_examples=30)
@given(formulas(("a", "b"), max_leaves=4), formulas(("a", "b"), max_leaves=4), alphabets(("a", "b")))
def test_separating_runs_separate_and_turn_round_with_the_formulas(
    left: Formula, right: Formula, alphabet: Alphabet
) -> None:
    there, back = pair(left, right, alphabet), pair(right, left, alphabet)
    for how in (relate_on_infinite_runs, relate_on_finite_runs):
        related, turned = how(there), how(back)
        assert Relation.of(turned.right_only is not None, turned.left_only is not None) is related.relation
        for run, accepted, refused in ((related.left_only, left, right), (related.right_only, right, left)):
            if run is None:
                continue
            assert holds_on(run.word, accepted)
            assert not holds_on(run.word, refused)


@settings(max_examples=40)
@given(formulas(("a", "b"), max_leaves=5))
def test_a_formula_is_equivalent_to_itself_written_in_another_way(formula: Formula) -> None:
    other = Or(Not(Not(formula)), formula)
    for how in (relate_on_infinite_runs, relate_on_finite_runs):
        assert how(pair(formula, other, Alphabet(("a", "b")))).relation is Relation.EQUIVALENT


def relations(names: tuple[str, ...], kind: Runs) -> dict[tuple[str, str], Relation]:
    candidates = tuple(Candidate(name, encode(STOP_AT_SIGN, KNOWN[name])) for name in names)
    [found] = answer([Question("stop", 1, "", ZONES, ZONES, candidates)], Budget(), [kind])
    related = {(c.left, c.right): c.related[kind] for c in found.comparisons}
    return {names: part.relation for names, part in related.items() if isinstance(part, Related)}


@pytest.mark.parametrize("kind", list(Runs))
def test_the_encodings_of_the_stop_sign_relate_as_published(kind: Runs) -> None:
    found = relations(("episode", "pointwise", "pointwise-strong", "dwyer", "dwyer-1", "dwyer-2"), kind)
    assert found["episode", "dwyer"] is Relation.WEAKER
    assert found["pointwise", "pointwise-strong"] is Relation.WEAKER
    assert found["episode", "pointwise"] is Relation.INCOMPARABLE
    assert found["dwyer", "dwyer-2"] is Relation.EQUIVALENT
    assert found["dwyer-1", "dwyer-2"] is Relation.WEAKER  # near and far exclude each other here


def test_a_robot_that_stops_and_drives_on_is_the_shortest_run_that_only_episode_accepts() -> None:
    candidates = tuple(Candidate(name, encode(STOP_AT_SIGN, KNOWN[name])) for name in ("episode", "dwyer"))
    [found] = answer([Question("stop", 1, "", ZONES, ZONES, candidates)], Budget())
    related = found.comparisons[0].related[Runs.FINITE]
    assert isinstance(related, Related)
    assert related.left_only is not None
    assert related.left_only.letters == (frozenset({"near", "stop"}), frozenset({"near"}))
    assert related.left_only.left_verdicts[-1] is Verdict.PRESUMABLY_SATISFIED
    assert related.left_only.right_verdicts[-1] is Verdict.PRESUMABLY_VIOLATED
    assert related.confirmation.length >= 3


def test_a_run_that_does_not_separate_is_not_let_through() -> None:
    with pytest.raises(Contradiction):
        check_separation(Candidate("left", eventually(A)), Candidate("right", A), (frozenset("a"),))


def test_a_wrong_claim_of_equivalence_is_refuted_by_a_short_run() -> None:
    left, right = Candidate("left", eventually(A)), Candidate("right", A)
    with pytest.raises(Contradiction, match="imply"):
        confirm(left, right, Relation.EQUIVALENT, Trials(LETTERS, all_letters=True, infinite=False))
    with pytest.raises(Contradiction, match="imply"):
        confirm(left, right, Relation.STRONGER, Trials(LETTERS, all_letters=True, infinite=True))
    assert confirm(left, right, Relation.WEAKER, Trials(LETTERS, all_letters=True, infinite=True)).length >= 2


def test_a_formula_that_is_not_its_reading_is_found() -> None:
    right = replace(Candidate("right", A), satisfied_by=lambda word: True)
    with pytest.raises(Contradiction, match="reading"):
        confirm(Candidate("left", A), right, Relation.EQUIVALENT, Trials(LETTERS, all_letters=True, infinite=False))


def test_a_wrong_answer_of_the_automata_does_not_get_through(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = pair(eventually(A), A, Alphabet(("a", "b")))
    monkeypatch.setattr(relate, "is_satisfiable", lambda formula, alphabet: False)
    monkeypatch.setattr(relate, "shortest_word", lambda machines, wanted: None)
    with pytest.raises(Contradiction):
        relate_on_infinite_runs(asked)
    with pytest.raises(Contradiction):
        relate_on_finite_runs(asked)


@pytest.mark.parametrize(
    ("formula", "expected", "steps"),
    [
        (globally(A), Monitorability.ALWAYS, 1),
        (globally(implies(A, eventually(B))), Monitorability.NEVER, None),
        (Or(globally(eventually(A)), B), Monitorability.SOMETIMES, None),
        (eventually(A), Monitorability.ALWAYS, None),
        (Not(Or(A, eventually(B))), Monitorability.ALWAYS, 1),
    ],
)
def test_a_formula_can_be_decided_as_long_as_a_permanent_verdict_can_come(
    formula: Formula, expected: Monitorability, steps: int | None
) -> None:
    alphabet = Alphabet(("a", "b"))
    monitor = translate(formula, alphabet)
    assert monitorability(monitor) is expected
    run = earliest(monitor, Verdict.VIOLATED, formula, alphabet)
    assert (None if run is None else len(run)) == steps


def test_a_limit_is_an_answer() -> None:
    responses = [globally(implies(Atom(f"p{n}"), eventually(Atom(f"q{n}")))) for n in range(10)]
    question = question_of_formulas("hard", None, {"hard": reduce(And, responses), "a": A})
    [found] = answer([question], Budget(seconds=0.05))
    assert not isinstance(found.measured[0].monitored, Monitored)
    assert isinstance(found.comparisons[0], Comparison)
    assert all(isinstance(part, Exceeded) for part in found.comparisons[0].related.values())
