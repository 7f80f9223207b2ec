"""How two formulas relate: decided by automata, shown by shortest runs, judged and confirmed by the interpreters."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from ltlc.analysis.comparison.reference import Contradiction, Trials, check_separation, confirm, trial_letters
from ltlc.analysis.comparison.results import Candidate, Question, Related, Relation, SeparatingRun
from ltlc.analysis.comparison.shortest import TooManyLoopsError, shortest_lasso, shortest_word
from ltlc.analysis.comparison.timed import TimedTrials, lasso_in_time, told, words_in_time
from ltlc.analysis.examples import telling
from ltlc.automata.queries import buchi, is_satisfiable, some_lasso, words_of
from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.ltl import And, Formula, Not
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.timed_atoms import atoms_within
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
        """The letters that a run can have, as far as either formula reads them, and time does not decide them."""
        read = {atom.name for atom in atoms_within(And(self.left.formula, self.right.formula))}
        return self.question.possible.restricted_to(a for a in self.question.possible.atoms if a in read)


def relate_on_infinite_runs(pair: Pair) -> Related:
    """How the infinite runs of both formulas relate. Raises Contradiction, and NotDecidedError of runs in time."""
    lasso = lasso_in_time if pair.question.timed else distinguishing_lasso
    left, right = pair.left.formula, pair.right.formula
    left_only, left_is_shortest = lasso(And(left, Not(right)), pair.alphabet)
    right_only, right_is_shortest = lasso(And(right, Not(left)), pair.alphabet)
    return _related(pair, left_only, right_only, True, (left_is_shortest, right_is_shortest))


def distinguishing_lasso(formula: Formula, alphabet: Alphabet) -> tuple[Lasso | None, bool]:
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
    words = words_in_time if pair.question.timed else distinguishing_words
    left_only, right_only = words([pair.left.formula, pair.right.formula], pair.alphabet)
    return _related(pair, left_only, right_only, False, (True, True))


def distinguishing_words(formulas: Sequence[Formula], alphabet: Alphabet) -> tuple[Word | None, Word | None]:
    """A shortest word that satisfies only the first of two formulas, and one that satisfies only the second."""
    machines = tuple(words_of(formulas, alphabet))
    left_only = shortest_word(machines, lambda left, right: left and not right)
    return left_only, shortest_word(machines, lambda left, right: right and not left)


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
    formulas = pair.left.formula, pair.right.formula
    letters, all_letters = trial_letters(pair.alphabet, formulas)
    make = partial(TimedTrials, formula=And(*formulas)) if pair.question.timed else Trials
    confirmation = confirm(pair.left, pair.right, relation, make(letters, all_letters, infinite))
    return Related(relation, _shown(pair, left_only, shortest[0]), _shown(pair, right_only, shortest[1]), confirmation)


def _shown(pair: Pair, run: Word | Lasso | None, is_shortest: bool) -> SeparatingRun | None:
    """`run` with the monitors' verdicts after each step; of clock steps, only those that change a verdict."""
    if run is None:
        return None
    letters, loop = (run.stem + run.loop, len(run.stem)) if isinstance(run, Lasso) else (run, None)
    verdicts = list(zip(pair.left_monitor.run(letters), pair.right_monitor.run(letters), strict=True))
    shown = telling(letters, verdicts, loop)
    left_verdicts, right_verdicts = zip(*(verdicts[n] for n in shown), strict=True)
    return SeparatingRun(
        tuple(told(letters[n], pair.question.atoms) for n in shown),
        None if loop is None else sum(n < loop for n in shown),
        left_verdicts,
        right_verdicts,
        is_shortest,
    )
