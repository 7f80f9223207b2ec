"""The number line of IEEE doubles, cut where comparisons change: exactly as they are computed, rounding included.

Coq: `proofs/Thresholds.v`, with the same names; that nothing is missed or made up is `valuations_exact`.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise

from ltlc.specification.atoms import Comparison, Relation

Condition = Callable[[float], bool]
"""A condition on one double, which changes at most once between two neighbouring pivots (see `samples`).

Coq: `condition_changes_once`.
"""


def holds(comparison: Comparison, left: float, right: float) -> bool:
    """Whether `comparison` holds for the values of its sides, none of them NaN: its definition, in doubles."""
    match comparison.relation:
        case Relation.LESS:
            return left < right + comparison.margin
        case Relation.AT_MOST:
            return left <= right + comparison.margin
        case Relation.AT_LEAST:
            return left >= right + comparison.margin
        case Relation.GREATER:
            return left > right + comparison.margin
        case Relation.EQUAL if comparison.margin:
            return abs(left - right) <= comparison.margin
    return left == right


def rank(value: float) -> int:
    """The place of a double among all doubles: neighbours have neighbouring ranks; 0.0 and -0.0 have rank 0."""
    (bits,) = struct.unpack(">Q", struct.pack(">d", abs(value)))
    return int(bits) if value > 0 else -int(bits)


def at_rank(number: int) -> float:
    """The double of that rank."""
    (value,) = struct.unpack(">d", struct.pack(">Q", abs(number)))
    return float(value) if number >= 0 else -float(value)


def samples(conditions: Sequence[Condition], pivots: Iterable[float], least: float = -math.inf) -> list[float]:
    """Doubles from `least` on, in ascending order, such that every other has the same conditions as one of them.

    Between two neighbouring `pivots` every condition changes at most once, and so does it outside of them all. The
    doubles are where a part of the line begins on which no condition changes.
    """
    ranks = sorted({rank(p) for p in (*pivots, least, math.inf) if p >= least})
    found = set(ranks)
    for low, high in pairwise(ranks):
        found.update(_change(condition, low, high) for condition in conditions)
        found.update(r + 1 for r in (low,) if r < high)
    return [at_rank(r) for r in sorted(found)]


def _change(condition: Condition, low: int, high: int) -> int:
    """The first rank in `low` + 1 … `high` at which `condition` is as at `high`, if it changes at most once there."""
    last = condition(at_rank(high))
    first = low + 1
    while first < high:
        middle = (first + high) // 2
        if condition(at_rank(middle)) == last:
            high = middle
        else:
            first = middle + 1
    return high
