"""How two formulas relate: decided by automata, shown by shortest runs, judged and confirmed by the interpreters."""

from __future__ import annotations

from dataclasses import dataclass

from ltlc.automata.machine import read_by
from ltlc.automata.queries import buchi, is_satisfiable, some_lasso, words_of
from ltlc.comparison.reference import Contradiction, check_separation, confirm, trial_letters
from ltlc.comparison.results import Candidate, Question, Related, Relation, SeparatingRun
from ltlc.comparison.shortest import TooManyLoopsError, shortest_lasso, shortest_word
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.ltl import And, Formula, Not
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.words import Lasso, Word


@dataclass(frozen=True)
class Pair:
    """Two formulas of a question, with their monitors."""

    question: Question
    left: Candidate
    right: Candidate
    left_monitor: Monitor
    right_monitor: Monitor

    @property
    def alphabet(self) -> Alphabet:
        """The letters that a run can have, as far as either formula reads them."""
        return read_by(And(self.left.formula, self.right.formula), self.question.possible)


def relate_on_infinite_runs(pair: Pair) -> Related:
    """How the infinite runs of both formulas relate. Raises Contradiction."""
    left, right = pair.left.formula, pair.right.formula
    left_only, left_is_shortest = _lasso(And(left, Not(right)), pair.alphabet)
    right_only, right_is_shortest = _lasso(And(right, Not(left)), pair.alphabet)
    return _related(pair, left_only, right_only, True, (left_is_shortest, right_is_shortest))


def _lasso(formula: Formula, alphabet: Alphabet) -> tuple[Lasso | None, bool]:
    """A lasso that satisfies `formula`, if there is one, and whether it is as short as any."""
    if not is_satisfiable(formula, alphabet):
        return None, True
    try:
        found = shortest_lasso(buchi(formula, alphabet))
    except TooManyLoopsError:
        return some_lasso(formula, alphabet), False
    if found is None:
        raise Contradiction(f"some run should satisfy {formula}, but none is found")
    return found, True


def relate_on_finite_runs(pair: Pair) -> Related:
    """How the finite runs, of one step at least, of both formulas relate. Raises Contradiction."""
    machines = tuple(words_of([pair.left.formula, pair.right.formula], pair.alphabet))
    left_only = shortest_word(machines, lambda left, right: left and not right)
    right_only = shortest_word(machines, lambda left, right: right and not left)
    return _related(pair, left_only, right_only, False, (True, True))


def _related(
    pair: Pair,
    left_only: Word | Lasso | None,
    right_only: Word | Lasso | None,
    infinite: bool,
    shortest: tuple[bool, bool],
) -> Related:
    """The relation that the runs show, once the reference interpreters have agreed to it."""
    relation = Relation.of(left_only is not None, right_only is not None)
    if left_only is not None:
        check_separation(pair.left, pair.right, left_only)
    if right_only is not None:
        check_separation(pair.right, pair.left, right_only)
    letters, all_letters = trial_letters(pair.alphabet, (pair.left.formula, pair.right.formula))
    confirmation = confirm(pair.left, pair.right, relation, infinite, letters, all_letters)
    return Related(relation, _shown(pair, left_only, shortest[0]), _shown(pair, right_only, shortest[1]), confirmation)


def _shown(pair: Pair, run: Word | Lasso | None, is_shortest: bool) -> SeparatingRun | None:
    """`run` with what the monitors say after each step, and values of the signals."""
    if run is None:
        return None
    letters = run.stem + run.loop if isinstance(run, Lasso) else run
    return SeparatingRun(
        letters,
        len(run.stem) if isinstance(run, Lasso) else None,
        tuple(pair.left_monitor.run(letters)),
        tuple(pair.right_monitor.run(letters)),
        is_shortest,
    )
