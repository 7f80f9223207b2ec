"""Core LTL on infinite words that are ultimately periodic: the reference for permanent verdicts."""

from __future__ import annotations

from typing import assert_never

from ltlc.semantics.ltl import And, Atom, Formula, Next, Not, Or, Truth, Until, children, parts_first
from ltlc.semantics.words import Lasso


def holds_on_lasso(formula: Formula, lasso: Lasso) -> bool:
    """Whether the infinite word `lasso` satisfies `formula` (LTL; Pnueli 1977). Coq: `holds_on_lasso`."""
    truth: dict[int, list[bool]] = {}
    for part in parts_first(formula):
        truth[id(part)] = truth_at_positions(part, [truth[id(child)] for child in children(part)], lasso)
    return truth[id(formula)][0]


def truth_at_positions(formula: Formula, parts: list[list[bool]], lasso: Lasso) -> list[bool]:
    """The truth of `formula` at each position of stem and loop, from that of its `parts`, its immediate subformulas.

    After the last position comes the loop's first. Coq: `truth` in `proofs/Lasso.v`.
    """
    letters = lasso.stem + lasso.loop
    match formula:
        case Truth():
            return [True] * len(letters)
        case Atom(name):
            return [name in letter for letter in letters]
        case Not():
            return [not value for value in parts[0]]
        case And():
            return [a and b for a, b in zip(*parts, strict=True)]
        case Or():
            return [a or b for a, b in zip(*parts, strict=True)]
        case Next():
            return [*parts[0][1:], parts[0][len(lasso.stem)]]
        case Until():
            return _until(parts[0], parts[1], len(lasso.stem))
        case _:
            assert_never(formula)


def _until(left: list[bool], right: list[bool], loop_start: int) -> list[bool]:
    """`left U right` at each position: a `right` within the rest and one pass of the loop, `left` up to it."""
    count = len(left)

    def from_here(start: int) -> bool:
        walk = [*range(start, count), *range(loop_start, start)]
        for position in walk:
            if right[position]:
                return True
            if not left[position]:
                return False
        return False

    return [from_here(start) for start in range(count)]
