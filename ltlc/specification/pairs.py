"""What can hold together of comparisons of two numbers a and b, such as `a < b + 1`, `a == b` and `abs(a - b) <= 2`.

Computed in doubles these are not comparisons of the real difference: b + 1 and a - b are rounded. Let t be b + m as it
is rounded, and d be a - b as it is rounded. Since rounding is to the nearest double and monotone,

    a > t  implies  d >= m,          a < t  implies  d <= m,          t grows with m,

and for m = 0 both directions hold, without equality: different doubles differ by a double other than 0, however small.
An infinite sum or difference keeps to the rules: t is infinite on the side to which b + m leaves the line, or where b
is. Only if a and b are the same infinity, then t is a, and d is NaN: they are equal, whatever the margin. That is all
that is used here: what these rules allow is a valuation.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import assert_never

from ltlc.dataclass import dataclass
from ltlc.semantics.words import Letter
from ltlc.specification.expressions import Comparison, Relation


@dataclass(frozen=True, slots=True)
class _Place:
    """Where a and d are on the line.

    a lies above the rounded b + m for the first `below` of the margins, is equal to it for those up to `upto`, and lies
    below it for the others. `cell` is 2i + 1 if d is the i-th of the bounds, 2i if it is between that and the one
    before; None if d is NaN, as that of two equal infinities is.
    """

    below: int
    upto: int
    cell: int | None


def pair_valuations(compared: Mapping[str, Comparison]) -> tuple[Letter, ...]:
    """The sets of the comparisons, by their names, that can hold for some two doubles that are not NaN."""
    margins = sorted({0.0} | {c.margin for c in compared.values() if _is_ordering(c)})
    tolerances = {c.margin for c in compared.values() if not _is_ordering(c)}
    bounds = sorted({*margins, *tolerances, *(-t for t in tolerances)})
    letters = (
        frozenset(name for name, comparison in compared.items() if _holds(comparison, place, margins, bounds))
        for place in _places(margins, bounds)
    )
    return tuple(dict.fromkeys(letters))


def _is_ordering(comparison: Comparison) -> bool:
    return comparison.relation is not Relation.EQUAL


def _places(margins: list[float], bounds: list[float]) -> Iterator[_Place]:
    """Every place that the rules allow, from a far below b to far above."""
    yield _Place(0, len(margins), None)
    at = {margin: 2 * bounds.index(margin) + 1 for margin in margins}
    for cell in range(2 * len(bounds) + 1):
        for below in range(len(margins) + 1):
            for upto in range(below, len(margins) + 1):
                if _agrees(cell, below, upto, [at[m] for m in margins], margins.index(0.0)):
                    yield _Place(below, upto, cell)


def _agrees(cell: int, below: int, upto: int, at: list[int], zero: int) -> bool:
    """Whether d in `cell` agrees with the place of a; `at` are the cells of the margins, `zero` is that of 0."""
    if (below > zero) != (cell > at[zero]) or (upto <= zero) != (cell < at[zero]):
        return False
    return all(cell >= at[i] for i in range(below)) and all(cell <= at[i] for i in range(upto, len(at)))


def _holds(comparison: Comparison, place: _Place, margins: list[float], bounds: list[float]) -> bool:
    """Whether `comparison` holds at `place`."""
    if comparison.relation is Relation.EQUAL and comparison.margin:
        low, high = 2 * bounds.index(-comparison.margin) + 1, 2 * bounds.index(comparison.margin) + 1
        return place.cell is None or low <= place.cell <= high
    index = margins.index(comparison.margin)
    above, equal = index < place.below, place.below <= index < place.upto
    match comparison.relation:
        case Relation.LESS:
            return not above and not equal
        case Relation.AT_MOST:
            return not above
        case Relation.EQUAL:
            return equal
        case Relation.AT_LEAST:
            return above or equal
        case Relation.GREATER:
            return above
        case _:
            assert_never(comparison.relation)
