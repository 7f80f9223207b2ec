"""Ways to make a monitor, tried on a corpus: `ltlc compare --corpus`."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

from ltlc.analysis.comparison import trials
from ltlc.analysis.comparison.bounded import within
from ltlc.analysis.comparison.constructors import Trial, measure
from ltlc.analysis.comparison.formula_files import formulas_of_file
from ltlc.analysis.comparison.tables import Block
from ltlc.automata.corpora import CORPORA, corpus
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.errors import UnusableInput
from ltlc.base.limits import Budget, Exceeded
from ltlc.base.nearest import did_you_mean
from ltlc.dataclass import dataclass
from ltlc.frontend.language import read_source
from ltlc.interfaces.api.tables import Display
from ltlc.semantics.ltl import Formula


@dataclass(frozen=True)
class Measurement(Display):
    """What the ways to make a monitor took and gave, on each formula of `corpus`."""

    corpus: str
    trials: tuple[Trial, ...]

    def blocks(self) -> Iterator[Block]:
        """A line for each way, and the formulas that were too much for it."""
        return trials.blocks_of(self.corpus, self.trials)

    def document(self) -> dict[str, Any]:
        """A summary for each way, and every result."""
        return trials.document(self.corpus, self.trials)

    def rows(self) -> list[dict[str, Any]]:
        """A row for each formula and way."""
        return trials.rows_of(self.trials)

    @property
    def agrees(self) -> bool:
        """Whether all ways gave the same, as far as they gave anything."""
        return all(agrees for trial in self.trials for agrees in trial.agrees.values())

    @property
    def is_complete(self) -> bool:
        """Whether no limit was met."""
        return not any(isinstance(outcome, Exceeded) for trial in self.trials for outcome in trial.outcomes.values())


def measure_corpus(name: str, seed: int = 0, count: int = 100, budget: Budget | None = None) -> Measurement:
    """Try every way to make a monitor on the corpus called `name`, or on the formulas in the file of that name.

    `seed` and `count` are for the corpus `random`; `budget` is for each formula and way. Raises UnusableInput and
    SpotMissing.
    """
    budget = budget or Budget()
    formulas = corpus(name, seed, count) if name in CORPORA else _formulas_in(name, budget)
    return Measurement(name, tuple(measure(formulas, budget)))


def _formulas_in(name: str, budget: Budget) -> list[tuple[str, Formula]]:
    if not Path(name).exists():
        hint = did_you_mean(name, CORPORA) or f"the corpora are {', '.join(CORPORA)}"
        raise UnusableInput((), f"`{name}` is neither a corpus nor a file: {hint}")
    source = read_source(Path(name))
    if isinstance(source, Diagnostic):
        raise UnusableInput([source])
    formulas, problems = within(budget, partial(formulas_of_file, source), f"to read {name}")
    if problems:
        raise UnusableInput(problems)
    return formulas
