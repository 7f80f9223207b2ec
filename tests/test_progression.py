"""What remains after a letter: the definition is the oracle of the two that take all letters at once.

`automata` has residuals in normal form all through; `assurance` keeps obligations as they stand in the formula, since
the certificate checker compares those. Neither knows of the other.
"""

from __future__ import annotations

from functools import partial

from hypothesis import given
from hypothesis import strategies as st
from strategies import ABC, formulas

from ltlc.assurance.residuals import Residuals
from ltlc.automata import progression
from ltlc.automata.machine import Letters, runs_in_time
from ltlc.semantics.diagrams import Diagrams
from ltlc.semantics.ltl import TRUE, Formula
from ltlc.semantics.progression import progress
from ltlc.semantics.words import Letter

LETTERS = st.frozensets(st.sampled_from(ABC))


def holds(letter: Letter, level: int) -> bool:
    return ABC[level] in letter


@given(formulas(max_leaves=8, max_temporal=6), st.lists(LETTERS, max_size=4))
def test_residuals_for_certificates_are_what_progression_leaves(formula: Formula, word: list[Letter]) -> None:
    residuals = Residuals(ABC, TRUE)
    diagram = residuals.of(formula)
    for letter in word:
        diagram = residuals.progress(diagram)
        while not residuals.diagrams.is_terminal(diagram) and residuals.diagrams.split(diagram)[0] < len(ABC):
            level, low, high = residuals.diagrams.split(diagram)
            diagram = high if holds(letter, level) else low
        formula = progress(formula, letter)
    assert diagram == residuals.of(formula)


@given(formulas(max_leaves=8, max_temporal=6), st.lists(LETTERS, max_size=4))
def test_residuals_for_monitors_are_what_progression_leaves(formula: Formula, word: list[Letter]) -> None:
    diagrams = Diagrams()
    residuals = progression.Residuals(Letters(ABC, diagrams, diagrams.true, runs_in_time(TRUE, ABC, diagrams)))
    residual = residuals.of(formula)
    for letter in word:
        residual = diagrams.evaluate(residuals.step(residual), partial(holds, letter))
        formula = progress(formula, letter)
    assert residual == residuals.of(formula)
