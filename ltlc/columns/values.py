"""Expressions and conditions at all steps at once: the same doubles, to the bit, as at one step after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ltlc.columns.arrays import Held, Views, changes, folded, pieces, sums
from ltlc.columns.bits import Mask
from ltlc.columns.series import Given, Steps, UnsupportedError
from ltlc.recordings.blocks import Array
from ltlc.runtime import functions, sampling
from ltlc.semantics import ltl
from ltlc.specification import expressions as e
from ltlc.specification.atoms import Comparison, Condition, Count, IsTrue, Relation, Same, operands
from ltlc.specification.evaluation import evaluate
from ltlc.specification.wire import EXACT

Column = Array | float | bool | str
"""A value for each step, or one for all."""

_SCALAR: dict[e.Function, Callable[..., float]] = {
    e.Function.NORM: functions.norm,
    e.Function.ROLL: functions.roll,
    e.Function.PITCH: functions.pitch,
    e.Function.YAW: functions.yaw,
    e.Function.ANGLE: functions.angle,
}
"""What numpy would round differently: computed number by number."""

_RELATIONS = {
    Relation.LESS: np.less,
    Relation.AT_MOST: np.less_equal,
    Relation.EQUAL: np.equal,
    Relation.AT_LEAST: np.greater_equal,
    Relation.GREATER: np.greater,
}


def wanted_of(read: e.Input) -> sampling.Wanted:
    """What is read of a signal, as the runtime calls it."""
    match read:
        case e.Current(signal):
            return sampling.Input(signal.name)
        case e.Past(signal, samples):
            return sampling.Input(signal.name, samples)
        case e.Slope(signal):
            return sampling.Slope(signal.name)
        case e.New(signal):
            return sampling.New(signal.name)


def value(expression: e.Expression, steps: Steps) -> Column:
    """`expression` at `steps`. Raises UnsupportedError."""
    if expression not in steps.known:
        with np.errstate(all="ignore"):
            steps.known[expression] = _value(expression, steps)
    found: Column = steps.known[expression]
    return found


def _value(expression: e.Expression, steps: Steps) -> Column:
    match expression:
        case e.Number() | e.Boolean() | e.String():
            return _constant(expression)
        case e.Current() | e.Past() | e.Slope() | e.New():
            return _as_doubles(steps.column(wanted_of(expression)))
        case e.Negative(operand):
            return -_number(operand, steps)
        case e.Arithmetic(operator, left, right):
            return _calculated(operator, _number(left, steps), _number(right, steps))
        case e.Call(function, _) if expression.array is not None:
            return _folded(function, expression.array, steps)
        case e.Call(function, arguments):
            return _applied(function, [_number(argument, steps) for argument in arguments])
        case Count():
            return _counted(expression, steps)
    raise UnsupportedError(type(expression).__name__.lower())


def _constant(expression: e.Expression) -> Column:
    constant = evaluate(expression, {})
    if isinstance(constant, tuple) or type(constant) is int:
        raise UnsupportedError("an integer that is no double")
    return constant


def _as_doubles(column: Array) -> Array:
    """Integers as doubles, which compare as they do, unless they are large."""
    if column.dtype.kind not in "iu":
        return column
    if len(column) and (column.max() > EXACT or column.min() < -EXACT):
        raise UnsupportedError("integers that are no doubles")
    return column.astype(np.float64)


def _number(expression: e.Expression, steps: Steps) -> NDArray[np.float64] | np.float64:
    found = value(expression, steps)
    return found if isinstance(found, np.ndarray) else np.float64(found)


def _calculated(operator: e.Operator, left: Array | np.float64, right: Array | np.float64) -> Column:
    match operator:
        case e.Operator.PLUS:
            return left + right
        case e.Operator.MINUS:
            return left - right
        case e.Operator.TIMES:
            return left * right
        case e.Operator.OVER:
            return np.true_divide(left, right)


def _applied(function: e.Function, arguments: list[Array | np.float64]) -> Column:
    match function:
        case e.Function.ABS:
            return np.abs(arguments[0])
        case e.Function.SQRT:
            return np.sqrt(arguments[0])
        case e.Function.MIN | e.Function.MAX:
            return _extreme(arguments, np.less if function is e.Function.MIN else np.greater)
    apply = _SCALAR[function]
    parts = np.broadcast_arrays(*arguments)
    if not parts[0].ndim:
        return apply(*(float(part) for part in parts))
    return np.fromiter(map(apply, *(part.tolist() for part in parts)), np.float64, len(parts[0]))


def _extreme(arguments: list[Array | np.float64], is_beyond: np.ufunc) -> Column:
    """The first of those that no other is beyond, as Python's own functions choose; NaN where one is."""
    found, *others = arguments
    is_nan = np.isnan(found)
    for other in others:
        found = np.where(is_beyond(other, found), other, found)
        is_nan = is_nan | np.isnan(other)
    return np.where(is_nan, np.nan, found)


def arrays_at(array: e.Expression, steps: Steps) -> Held:
    """An array, or a part of one, at each of `steps`."""
    if array not in steps.known:
        if isinstance(array, e.Slice):
            steps.known[array] = arrays_at(array.array, steps).part(array.start, array.stop)
        else:
            assert isinstance(array, e.Current | e.Past)
            wanted = wanted_of(array)
            assert isinstance(wanted, sampling.Input)
            steps.known[array] = steps.arrays(wanted)
    found: Held = steps.known[array]
    return found


def _folded(function: e.Function, array: e.Expression, steps: Steps) -> Array:
    """A function of an array, computed once of each."""
    held = arrays_at(array, steps)
    elements = _as_doubles(held.arrays.packed())
    return folded(function, elements, held.arrays.lengths).take(held.numbers)


def _counted(count: Count, steps: Steps) -> Column:
    """How many elements of arrays satisfy a predicate, computed once where all that it reads stays the same."""
    arrays = [arrays_at(element.array, steps) for element in count.elements]
    singles = {single: value(single, steps) for single in count.singles}
    if any(isinstance(each, float) and each != each for each in singles.values()):
        return np.nan
    columns = [each for each in singles.values() if isinstance(each, np.ndarray)]
    if len(arrays) == 1 and not columns:
        return _counts(count, [arrays[0].arrays], singles, steps).take(arrays[0].numbers)
    is_new = np.logical_or.reduce([changes(each) for each in (*(held.numbers for held in arrays), *columns)])
    at = np.flatnonzero(is_new)
    views = [held.arrays.taken(held.numbers[at]) for held in arrays]
    here = {single: each[at] if isinstance(each, np.ndarray) else each for single, each in singles.items()}
    counts: Array = _counts(count, views, here, steps).take(is_new.cumsum() - 1)
    for column in columns:
        if column.dtype == np.float64:
            counts[np.isnan(column)] = np.nan
    return counts


def _counts(count: Count, arrays: Sequence[Views], singles: Mapping[e.Expression, Column], steps: Steps) -> Array:
    """The same of `arrays` that belong together, one after the other; columns of `singles` have a value for each."""
    lengths = np.minimum.reduce([each.lengths for each in arrays])

    def of(part: slice) -> Array:
        known: dict[e.Expression, Column] = {
            element: _as_doubles(Views(each.elements, lengths[part], each.starts[part]).packed())
            for element, each in zip(count.elements, arrays, strict=True)
        }
        for single, each in singles.items():
            known[single] = each[part].repeat(lengths[part]) if isinstance(each, np.ndarray) else each
        given = Given(steps.columns, steps.base, steps.first, known, int(lengths[part].sum()))
        return sums(_satisfied(count, given), lengths[part])

    counts: Array = np.concatenate([np.empty(0), *map(of, pieces(lengths))])
    return counts


def _satisfied(count: Count, elements: Given) -> Mask:
    """Which of the `elements` satisfy the predicate of `count`."""
    size = len(elements)
    holds = {name: np.broadcast_to(truth(condition, elements), size) for name, condition in count.conditions}
    mask = np.broadcast_to(predicate(count.predicate, holds), size)
    undefined = not_numbers((side for _, condition in count.conditions for side in operands(condition)), elements)
    return mask if undefined is None else mask & ~undefined


def predicate(formula: ltl.Formula, holds: dict[str, Mask]) -> Mask | np.bool_:
    """A state predicate where its atoms hold at these places."""
    match formula:
        case ltl.Truth():
            return np.True_
        case ltl.Atom(name):
            return holds[name]
        case ltl.Not(operand):
            return ~predicate(operand, holds)
        case ltl.And(left, right):
            return predicate(left, holds) & predicate(right, holds)
        case ltl.Or(left, right):
            return predicate(left, holds) | predicate(right, holds)
    raise TypeError(f"not a state predicate: {formula}")


def not_numbers(sides: Iterable[e.Expression], steps: Steps) -> Mask | None:
    """Where one of `sides` is NaN; None where none is."""
    masks = [mask for side in sides if (mask := _not_a_number(side, steps)) is not None]
    return np.logical_or.reduce(masks) if masks else None


def _not_a_number(side: e.Expression, steps: Steps) -> Mask | None:
    if isinstance(side, e.Number):
        constant = _constant(side)
        return np.ones(len(steps), np.bool_) if constant != constant else None
    key = "NaN", side
    if key not in steps.known:
        found = value(side, steps)
        is_double = isinstance(found, np.ndarray) and found.dtype == np.float64 and found.size
        if not is_double:
            has = isinstance(found, float) and found != found
            steps.known[key] = np.ones(len(steps), np.bool_) if has else None
        else:
            steps.known[key] = np.isnan(found) if np.isnan(np.max(found)) else None
    mask: Mask | None = steps.known[key]
    return mask


def truth(condition: Condition, steps: Steps) -> Mask | np.bool_:
    """Where `condition` holds; what it says where something that it compares is NaN is no matter."""
    match condition:
        case IsTrue(operand):
            return np.asarray(value(operand, steps), np.bool_)
        case Same(left, right):
            return np.asarray(value(left, steps) == value(right, steps), np.bool_)
        case Comparison(left, relation, right, margin):
            with np.errstate(all="ignore"):
                return _compared(_number(left, steps), relation, _number(right, steps), margin)


def _compared(
    left: Array | np.float64, relation: Relation, right: Array | np.float64, margin: float
) -> Mask | np.bool_:
    if margin == 0:
        found: Mask = _RELATIONS[relation](left, right)
    elif relation is Relation.EQUAL:
        found = (np.abs(left - right) <= margin) | (left == right)
    else:
        found = _RELATIONS[relation](left, right + margin)
    return found
