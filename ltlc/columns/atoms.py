"""The atoms of all properties that step together, over the columns of a block."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ltlc.columns.bits import Bits, pack
from ltlc.columns.series import Steps, UnsupportedError
from ltlc.columns.thresholds import Threshold, compared
from ltlc.columns.values import truth, value
from ltlc.specification.atoms import Atom, Comparison, Condition, Relation, operands
from ltlc.specification.evaluation import evaluate, exact_number, number
from ltlc.specification.expressions import Expression, inputs

Compared = tuple[str, Expression, Threshold]
"""The name of an atom that compares with a constant, what it compares, and how."""


def comparisons(atoms: Iterable[Atom]) -> tuple[Compared, ...]:
    """Those of `atoms` that compare with constants."""
    found = ((atom.name, _threshold(atom.condition)) for atom in atoms)
    return tuple((name, *each) for name, each in found if each is not None)


def _threshold(condition: Condition) -> tuple[Expression, Threshold] | None:
    if not isinstance(condition, Comparison) or (condition.relation is Relation.EQUAL and condition.margin):
        return None
    left, right, margin = condition.left, condition.right, condition.margin
    if any(inputs(left)) and not any(inputs(right)):
        return _of(left, condition.relation, number(right, {}) + margin if margin else exact_number(right, {}))
    if any(inputs(right)) and not any(inputs(left)) and not margin:
        return _of(right, condition.relation.flipped, exact_number(left, {}))
    return None


def _of(side: Expression, relation: Relation, constant: float) -> tuple[Expression, Threshold] | None:
    return (side, (relation, constant)) if isinstance(constant, float) and constant == constant else None


def prepare(compare: Iterable[Compared], steps: Steps) -> None:
    """Compute what is wanted, one column after the other."""
    by_side: dict[Expression, dict[str, Threshold]] = {}
    for name, side, threshold in compare:
        if name not in steps.known:
            by_side.setdefault(side, {})[name] = threshold
    for side, wanted in by_side.items():
        try:
            column = value(side, steps)
        except UnsupportedError:
            continue
        if isinstance(column, np.ndarray) and column.size:
            bits, has_nan = compared(column, list(wanted.values()))
            steps.known.update(zip(wanted, bits, strict=True))
            if not has_nan:
                steps.known["NaN", side] = None


def bits_of(atom: Atom, steps: Steps) -> Bits:
    """Where `atom` holds. Raises UnsupportedError."""
    if atom.name not in steps.known:
        steps.known[atom.name] = pack(np.broadcast_to(truth(atom.condition, steps), len(steps)))
    found: Bits = steps.known[atom.name]
    return found


def sides(atoms: Iterable[Atom]) -> tuple[Expression, ...]:
    """What `atoms` compare and may be NaN, each once."""
    found = dict.fromkeys(side for atom in atoms for side in operands(atom.condition))
    return tuple(side for side in found if any(inputs(side)) or _is_nan(side))


def _is_nan(constant: Expression) -> bool:
    value = evaluate(constant, {})
    return value != value
