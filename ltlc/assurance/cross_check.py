"""The cross-check: a monitor against the reference interpreter of the language, on runs.

The reference is the denotation of the property (`docs/language.md`), not its formula, so the encoding is under test as
well. Permanent verdicts are tried on infinite continuations too, with the formula as judge.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain, islice, pairwise

from ltlc.assurance import random_runs
from ltlc.assurance.runs import (
    Agreement,
    Mismatch,
    exhaustive_length,
    judging_letters,
    residual_runs,
    short_runs,
    transition_runs,
)
from ltlc.assurance.timed_check import timed_check
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.semantics.denotation import READINGS, Reading, satisfies
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import timed_atoms
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso, Letter, Word

MOST_PLANNED_RUNS = 1500
LOOPS_TRIED = 12


def cross_check(compiled: Compiled) -> Agreement | Mismatch:
    """Compare the monitor of `compiled` with the reference; the same input gives the same runs."""
    if timed_atoms(compiled.formula):
        return timed_check(compiled)
    judge = _Judge(
        compiled.monitor,
        compiled.specification.property,
        READINGS[compiled.encoding.name],
        compiled.formula,
        judging_letters(compiled),
    )
    transitions = islice(transition_runs(compiled.monitor, judge.letters), MOST_PLANNED_RUNS)
    pairs = islice(residual_runs(compiled.monitor, compiled.formula, judge.letters), MOST_PLANNED_RUNS)
    planned = sorted(dict.fromkeys(chain(short_runs(judge.letters), transitions, pairs)), key=len)
    wrong = (mismatch for run in planned if (mismatch := judge.mismatch(run)))
    if mismatch := next(wrong, None) or random_runs.mismatch(judge.letters, judge.mismatch):
        return mismatch
    longest = max(len(planned[-1]), random_runs.LONGEST)
    return Agreement(len(planned) + random_runs.COUNT, longest, exhaustive_length(judge.letters))


@dataclass(frozen=True, slots=True)
class _Judge:
    """What decides on one run whether a monitor's verdict is right."""

    monitor: Monitor
    property: Property
    reading: Reading
    formula: Formula
    letters: Sequence[Letter]

    def mismatch(self, run: Word) -> Mismatch | None:
        """What is wrong with the monitor's verdict after the whole of `run`, if anything."""
        verdicts = self.monitor.run(run)
        verdict = verdicts[-1] if verdicts else self.monitor.verdicts[0]
        if any(earlier.is_permanent and earlier is not verdict for earlier in verdicts):
            return Mismatch(run, verdict, "a permanent verdict was given before and cannot change")
        if verdict is Verdict.NOT_STARTED:
            return Mismatch(run, verdict, "the run has started")
        holds = satisfies(run, self.property, self.reading)
        # On the empty word a permanent verdict may differ: `always p and never p` has no infinite run, and holds on it.
        if verdict.holds != holds and (run or not verdict.is_permanent):
            return Mismatch(run, verdict, "satisfied as a finite run" if holds else "not satisfied as a finite run")
        first_permanent = verdict.is_permanent and not any(earlier.is_permanent for earlier in verdicts[:-1])
        if first_permanent and (loop := self._refuting_loop(run, verdict)):
            return Mismatch(run, verdict, f"not permanent: it changes if the run continues with {loop} forever")
        return None

    def _refuting_loop(self, run: Word, verdict: Verdict) -> str | None:
        """An infinite continuation on which a permanent `verdict` is wrong, if one of those tried is one."""
        for loop in islice(_loops(self.letters), LOOPS_TRIED):
            if holds_on_lasso(self.formula, Lasso(run, loop)) != verdict.holds:
                return " ; ".join("{" + ", ".join(sorted(letter)) + "}" for letter in loop)
        return None


def _loops(letters: Sequence[Letter]) -> Iterator[Word]:
    """One letter forever, then two in turn, then all of them."""
    yield from ((letter,) for letter in letters)
    yield from pairwise(letters)
    yield tuple(letters)
