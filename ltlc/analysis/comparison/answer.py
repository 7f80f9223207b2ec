"""Answers questions: each translation and each relation in a child process of its own, under a budget."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import combinations, islice
from typing import Any

from ltlc.analysis.comparison.measure import monitored
from ltlc.analysis.comparison.relate import Pair, relate_on_finite_runs, relate_on_infinite_runs
from ltlc.analysis.comparison.results import Answer, Candidate, Comparison, Measured, Monitored, Question, Related, Runs
from ltlc.automata import queries
from ltlc.base.limits import Budget, Exceeded, Watch, run_all
from ltlc.semantics.ltl import size

RELATE: dict[Runs, Callable[[Pair], Related]] = {
    Runs.INFINITE: relate_on_infinite_runs,
    Runs.FINITE: relate_on_finite_runs,
}


def answer(
    questions: Sequence[Question],
    budget: Budget,
    kinds: Sequence[Runs] = tuple(Runs),
    watch: Watch | None = None,
) -> list[Answer]:
    """The answer to each of `questions`, on the `kinds` of runs asked for; each step of it may use `budget`.

    `watch` gets the progress: first with what each candidate costs, then with each pair of them. Raises
    Contradiction and SpotMissing.
    """
    measured = _measure(questions, budget, watch)
    comparisons = _compare(questions, measured, budget, kinds, watch)
    return [Answer(*parts) for parts in zip(questions, measured, comparisons, strict=True)]


def _measure(questions: Sequence[Question], budget: Budget, watch: Watch | None) -> list[tuple[Measured, ...]]:
    """What each candidate of each question costs and allows."""
    jobs = [
        job
        for question in questions
        for candidate in question.candidates
        for job in (
            partial(queries.temporal_class, candidate.formula, question.alphabet),
            partial(monitored, candidate.formula, question.alphabet),
            partial(queries.nondeterministic_size, candidate.formula),
            partial(queries.deterministic_size, candidate.formula),
        )
    ]
    outcomes: Iterator[Any] = iter(run_all(jobs, budget, watch=watch))
    return [
        tuple(Measured(c.name, c.formula, size(c.formula), *islice(outcomes, 4)) for c in question.candidates)
        for question in questions
    ]


def _compare(
    questions: Sequence[Question],
    measured: Sequence[tuple[Measured, ...]],
    budget: Budget,
    kinds: Sequence[Runs],
    watch: Watch | None,
) -> list[tuple[Comparison, ...]]:
    """How the candidates of each question relate, pair by pair."""
    pairs = [
        list(combinations(zip(question.candidates, of_question, strict=True), 2))
        for question, of_question in zip(questions, measured, strict=True)
    ]
    jobs = [
        _relation(question, *left, *right, kind)
        for question, of_question in zip(questions, pairs, strict=True)
        for left, right in of_question
        for kind in kinds
    ]
    outcomes = iter(run_all(jobs, budget, watch=watch))
    return [
        tuple(
            Comparison(left.name, right.name, dict(zip(kinds, islice(outcomes, len(kinds)), strict=True)))
            for (left, _), (right, _) in of_question
        )
        for of_question in pairs
    ]


def _relation(
    question: Question, left: Candidate, left_measured: Measured, right: Candidate, right_measured: Measured, kind: Runs
) -> Callable[[], Any]:
    """The job that finds how two candidates relate; what keeps a monitor from being made, keeps that from it too."""
    match left_measured.monitored, right_measured.monitored:
        case (Monitored(left_monitor), Monitored(right_monitor)):
            return partial(RELATE[kind], Pair(question, left, right, left_monitor, right_monitor))
        case (Exceeded() as exceeded, _) | (_, Exceeded() as exceeded):
            return partial(_identity, exceeded)
        case _:
            raise TypeError(f"neither a monitor nor a limit: {left_measured}, {right_measured}")


def _identity(exceeded: Exceeded) -> Exceeded:
    return exceeded
