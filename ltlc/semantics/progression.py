"""Progression: what remains to be satisfied after a letter (Bacchus and Kabanza 1998; a formula's derivative).

The definition, for one formula and one letter. `automata/progression.py` and `assurance/residuals.py` take all letters
at once, each in the normal form that it needs; tests hold both against this.
"""

from __future__ import annotations

from typing import assert_never

from ltlc.semantics.ltl import FALSE, TRUE, And, Atom, Formula, Next, Not, Or, Truth, Until
from ltlc.semantics.words import Letter

NON_EMPTY = Until(TRUE, TRUE)
"""Holds on every word but the empty one."""


def progress(formula: Formula, letter: Letter) -> Formula:
    """The formula that a word w satisfies exactly if the word `letter` followed by w satisfies `formula`.

    For finite w, the empty one included, and for infinite w. Coq: `progress`, with the theorems
    `progress_holds` and `progress_sat` in `proofs/Ltl.v`.
    """
    match formula:
        case Truth():
            return formula
        case Atom(name):
            return TRUE if name in letter else FALSE
        case Not(operand):
            return Not(progress(operand, letter))
        case And(left, right):
            return And(progress(left, letter), progress(right, letter))
        case Or(left, right):
            return Or(progress(left, letter), progress(right, letter))
        case Next(operand):
            return And(NON_EMPTY, operand)
        case Until(left, right):
            return Or(progress(right, letter), And(progress(left, letter), formula))
        case _:
            assert_never(formula)
