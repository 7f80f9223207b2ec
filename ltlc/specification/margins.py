"""By how much a condition holds: its margin, in the unit of what it compares. The reference.

`a < b` holds by b - a, and so does `a <= b`; `a == b` by -|a - b|, so never by more than 0, and with a margin m by
m - |a - b|. `any` of elements holds by the largest margin of one that is measured. What compares no numbers holds by
infinity, or not: booleans, strings, news, places in a zone.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import chain, product

from ltlc.semantics.robustness import FALSE, TRUE, margin
from ltlc.specification.evaluation import Known, Value, Values, array, evaluate, holding, is_nan, is_true, number
from ltlc.specification.expressions import (
    Arithmetic,
    Call,
    Comparison,
    Condition,
    Count,
    Expression,
    Negative,
    Number,
    Operator,
    Relation,
)
from ltlc.specification.functions import Function


def some_element(condition: Condition) -> tuple[Count, bool] | None:
    """The elements of `any`, of which one has to be found, or, of `all`, none (False); None of other conditions."""
    match condition:
        case Comparison(Count() as count, Relation.AT_LEAST | Relation.LESS as relation, Number(1.0), 0.0):
            return count, relation is Relation.AT_LEAST
        case _:
            return None


def difference(condition: Condition) -> Expression | None:
    """The number by which `condition` holds; None where it compares no numbers, or asks for elements."""
    match condition:
        case Comparison(Call(Function.INSIDE)):
            return None
        case Comparison(left, Relation.EQUAL, right, most):
            apart = Call(Function.ABS, (_minus(left, right),))
            return Arithmetic(Operator.MINUS, Number(most), apart) if most else Negative(apart)
        case Comparison(left, relation, right, moved):
            shifted = Arithmetic(Operator.PLUS, right, Number(moved)) if moved else right
            return _minus(shifted, left) if relation in (Relation.LESS, Relation.AT_MOST) else _minus(left, shifted)
        case _:
            return None


def _minus(left: Expression, right: Expression) -> Expression:
    """The difference, which is 0 of equal infinities."""
    is_finite = any(isinstance(side, Number) and math.isfinite(side.value) for side in (left, right))
    return Arithmetic(Operator.MINUS, left, right) if is_finite else Call(Function.GAP, (left, right))


def by_how_much(condition: Condition, values: Values[Known]) -> float:
    """The margin of `condition` where the inputs have these `values`; NaN where something that it compares is."""
    if (elements := some_element(condition)) is not None:
        count, is_sought = elements
        found = _largest(count, values)
        return found if is_sought else -found
    apart = difference(condition)
    if apart is None:
        return TRUE if is_true(condition, values) else FALSE
    return number(apart, values)


def _largest(count: Count, values: Values[Known]) -> float:
    if any(is_nan(evaluate(single, values)) for single in count.singles):
        return math.nan
    found, elements = FALSE, tuple(chain(*count.lists))
    rows = (zip(*(array(element.array, values) for element in of_list), strict=False) for of_list in count.lists)
    for combination in product(*rows):
        here: Mapping[Expression, Value] = {**values, **dict(zip(elements, chain(*combination), strict=True))}  # type: ignore[dict-item]
        if holding(count.conditions, here) is not None:  # what is not measured does not count
            margins = {name: by_how_much(each, here) for name, each in count.conditions}
            found = max(found, margin(count.predicate, margins))
    return found
