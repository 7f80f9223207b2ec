"""The margins of conditions at all steps at once, as `specification/margins.py` defines them."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain

import numpy as np

from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.monitoring.columns.series import Given, Steps
from ltlc.monitoring.columns.values import over_elements, singles, value
from ltlc.program.lowering import condition, double, lowered
from ltlc.semantics import ltl
from ltlc.semantics.ltl import Formula
from ltlc.semantics.robustness import FALSE, TRUE
from ltlc.specification import expressions as e
from ltlc.specification.margins import difference, some_element


def margins_of(of: e.Condition, steps: Steps) -> Array:
    """By how much the condition holds at each of `steps`. Raises UnsupportedError."""
    if (elements := some_element(of)) is None:
        found = _of_one(of, steps)
    else:
        count, is_sought = elements
        found = _largest(count, steps) if is_sought else -_largest(count, steps)
    return np.broadcast_to(found, len(steps))


def _of_one(of: e.Condition, steps: Steps) -> Array:
    apart = difference(of)
    if apart is None:
        return np.where(np.asarray(value(condition(of), steps), np.bool_), TRUE, FALSE)
    return np.asarray(value(double(apart), steps), np.float64)


def combined(predicate: Formula, margins: Mapping[str, Array]) -> Array:
    """By how much a state predicate holds where its atoms have these `margins`, everywhere at once."""
    match predicate:
        case ltl.Truth():
            return np.array(TRUE)
        case ltl.Atom(name):
            return margins[name]
        case ltl.Not(operand):
            return -combined(operand, margins)
        case ltl.And(left, right):
            return np.minimum(combined(left, margins), combined(right, margins))
        case ltl.Or(left, right):
            return np.maximum(combined(left, margins), combined(right, margins))
        case _:
            raise TypeError(f"not a state predicate: {predicate}")


def _largest(count: e.Count, steps: Steps) -> Array:
    """The largest margin of one of the elements that are measured."""
    lists = [tuple(dict.fromkeys(lowered(each.array) for each in of_list)) for of_list in count.lists]
    conditions = dict(count.conditions)
    compared = [lowered(side) for each in conditions.values() for side in e.operands(each)]
    asked = [*compared, *(double(apart) for each in conditions.values() if (apart := difference(each)) is not None)]

    def of(elements: Given, sizes: Places) -> Array:
        margins = {name: _of_one(each, elements) for name, each in conditions.items()}
        found = np.array(np.broadcast_to(combined(count.predicate, margins), len(elements)))
        for side in compared:
            if side.type.is_number:
                found[np.broadcast_to(np.isnan(np.asarray(value(side, elements), np.float64)), len(elements))] = FALSE
        return _greatest(found, sizes)

    return over_elements(lists, chain.from_iterable(map(singles, asked)), steps, of)


def _greatest(margins: Array, sizes: Places) -> Array:
    """The greatest of each of pieces with these `sizes`, one after the other."""
    found, some = np.full(len(sizes), FALSE), np.flatnonzero(sizes)
    if len(some):
        found[some] = np.maximum.reduceat(margins, (sizes.cumsum() - sizes)[some])
    return found
