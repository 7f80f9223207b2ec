"""The line of the numbers of a type, cut where comparisons change: exactly as they are computed, rounding included.

Coq: `proofs/Thresholds.v`, with the same names; that nothing is missed or made up is `valuations_exact`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from typing import assert_never

from ltlc.specification.expressions import Comparison, Relation
from ltlc.specification.wire import Numbers, as_double

Condition = Callable[[float], bool]
"""A condition on one number, which changes at most once between two neighbouring pivots (see `samples`).

Coq: `condition_changes_once`.
"""


def holds(comparison: Comparison, left: float, right: float) -> bool:
    """Whether `comparison` holds for the values of its sides, none of them NaN: by its definition, and exactly.

    Only what a margin is added to, or a difference is taken of, has to be a double.
    """
    if comparison.margin:
        left, right = as_double(left), as_double(right)
        if comparison.relation is Relation.EQUAL:
            return left == right or abs(left - right) <= comparison.margin
        right += comparison.margin
    match comparison.relation:
        case Relation.LESS:
            return left < right
        case Relation.AT_MOST:
            return left <= right
        case Relation.AT_LEAST:
            return left >= right
        case Relation.GREATER:
            return left > right
        case Relation.EQUAL:
            return left == right
        case _:
            assert_never(comparison.relation)


def samples(conditions: Sequence[Condition], pivots: Iterable[float], numbers: Numbers) -> list[float]:
    """Some of `numbers`, in ascending order, such that every other has the same conditions as one of them.

    Between two neighbouring `pivots` every condition changes at most once, and so does it outside of them all. Those
    that are found are where a part of the line begins on which no condition changes.
    """
    least, most = numbers.rank(numbers.least), numbers.rank(numbers.most)
    within = {numbers.rank(p) for p in pivots if numbers.least <= p <= numbers.most}
    ranks = sorted({least, most, *within})
    found = set(ranks)
    for low, high in pairwise(ranks):
        found.update(_change(condition, low, high, numbers) for condition in conditions)
        found.add(low + 1)
    return [numbers.at(r) for r in sorted(found)]


def _change(condition: Condition, low: int, high: int, numbers: Numbers) -> int:
    """The first rank in `low` + 1 … `high` at which `condition` is as at `high`, if it changes at most once there."""
    last = condition(numbers.at(high))
    first = low + 1
    while first < high:
        middle = (first + high) // 2
        if condition(numbers.at(middle)) == last:
            high = middle
        else:
            first = middle + 1
    return high
