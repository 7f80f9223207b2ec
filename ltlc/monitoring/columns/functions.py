"""The table of functions in numpy: each primitive at all steps at once, the same values to the bit.

Numbers are doubles here: `values.py` refuses integers that are not doubles. So every comparison is exact, and
conversions leave a column as it is. What numpy has not, or rounds differently, is what Python has; a property with a
primitive that has no row goes row by row.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping
from functools import reduce
from typing import Any

import numpy as np

from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.monitoring.columns.arrays import sums
from ltlc.program.functions import ROWS as TABLE
from ltlc.program.functions import Function, Primitive
from ltlc.program.types import DOUBLE, Scalar, Type
from ltlc.runtime import functions

Apply = Callable[..., Any]
"""Makes a column of columns; of arrays, of the elements of all, one array after the other, and of their lengths."""


def _one_by_one(function: Callable[..., float]) -> Apply:
    """What numpy would round differently."""

    def apply(*columns: Any) -> Array:
        parts = np.broadcast_arrays(*columns)
        return np.fromiter(map(function, *(part.tolist() for part in parts)), np.float64, len(parts[0]))

    return apply


def _extreme(is_beyond: np.ufunc) -> Apply:
    """The first of those that no other is beyond, as Python's own functions choose; NaN where one is."""

    def apply(found: Any, *others: Any) -> Array:
        is_nan = np.isnan(found)
        for other in others:
            found = np.where(is_beyond(other, found), other, found)
            is_nan = is_nan | np.isnan(other)
        return np.where(is_nan, np.nan, found)

    return apply


def _nearest(sought: Any, elements: Array, lengths: Places) -> Array:
    """Of each array, for the number beside it."""
    ends = lengths.cumsum()
    asked = zip(np.broadcast_to(sought, len(lengths)).tolist(), (ends - lengths).tolist(), ends.tolist(), strict=True)
    found = (functions.nearest_of(number, elements[start:end].tolist()) for number, start, end in asked)
    return np.fromiter(found, np.float64, len(lengths))


def _of_points(function: Callable[..., float]) -> Apply:
    """What asks for points and a zone, whose corners are the same at all steps."""

    def apply(x: Any, y: Any, *corners: Any) -> Array:
        zone = [float(coordinate) for coordinate in corners]
        xs, ys = np.broadcast_arrays(x, y)
        found = (function(*point, *zone) for point in zip(xs.tolist(), ys.tolist(), strict=True))
        return np.fromiter(found, np.float64, len(xs))

    return apply


def _folded(function: Apply) -> Apply:
    """A function of two of all columns, from left to right."""
    return lambda *columns: reduce(function, columns)


def _extreme_element(function: np.ufunc, of_one: Callable[[list[float]], float]) -> Apply:
    """Of those that are not NaN; which of 0 and -0 it is depends on their order."""

    def apply(elements: Array, lengths: Places) -> Array:
        found, starts = np.full(len(lengths), np.nan), lengths.cumsum() - lengths
        some = np.flatnonzero(lengths)
        if len(some):
            found[some] = function.reduceat(elements, starts[some])
        for number in np.flatnonzero(found == 0).tolist():
            found[number] = of_one(elements[starts[number] :][: lengths[number]].tolist())
        return found

    return apply


def _array_by_array(function: Callable[[list[float]], float]) -> Apply:
    """What numpy would round differently, or has not for arrays of many lengths."""

    def apply(elements: Array, lengths: Places) -> Array:
        ends = lengths.cumsum()
        pairs = zip((ends - lengths).tolist(), ends.tolist(), strict=True)
        found = (function(elements[start:end].tolist()) for start, end in pairs)
        return np.fromiter(found, np.float64, len(lengths))

    return apply


def _as_in_python() -> Iterator[tuple[Primitive, Apply]]:
    """What Python has a function of its own for, called for one step after the other."""
    array = Type(Scalar.DOUBLE, is_array=True)
    for primitive, row in TABLE.items():
        is_of_array = row.typed((array,)) is not None
        spelling = row.python((array if is_of_array else DOUBLE,))
        function = getattr(functions, spelling.name, None) if isinstance(spelling, Function) else None
        if function is not None:
            yield primitive, (_array_by_array if is_of_array else _one_by_one)(function)


P = Primitive

ROWS: Mapping[Primitive, Apply] = {
    **dict(_as_in_python()),
    P.NEGATE: np.negative,
    P.ABS: np.abs,
    P.ADD: np.add,
    P.SUBTRACT: np.subtract,
    P.TIMES: np.multiply,
    P.OVER: np.true_divide,
    P.NEAREST: _nearest,
    P.INSIDE: _of_points(functions.inside_of),
    P.DISTANCE: _of_points(functions.distance_of),
    P.LEAST: _extreme(np.less),
    P.GREATEST: _extreme(np.greater),
    P.SQRT: np.sqrt,
    P.FLOOR: lambda column: np.floor(column) + 0.0,
    P.CEIL: lambda column: np.ceil(column) + 0.0,
    P.SIGN: lambda column: np.sign(column) + 0.0,
    P.GAP: lambda left, right: np.where(np.equal(left, right), 0.0, np.subtract(left, right)),
    P.SMALLEST: _extreme_element(np.fmin, functions.smallest),
    P.LARGEST: _extreme_element(np.fmax, functions.largest),
    P.COMPLETE: lambda elements, lengths: np.where(sums(np.isnan(elements), lengths) > 0, np.nan, lengths),
    P.LENGTH: lambda elements, lengths: lengths.astype(np.float64),
    P.TO_DOUBLE: np.asarray,
    P.TO_SIGNED: np.asarray,
    P.TO_UNSIGNED: np.asarray,
    P.LESS: np.less,
    P.AT_MOST: np.less_equal,
    P.EQUAL: np.equal,
    P.SAME: operator.eq,
    P.NOT: np.logical_not,
    P.AND: _folded(np.logical_and),
    P.OR: _folded(np.logical_or),
    P.MEASURED: lambda column: ~np.isnan(column),
}
