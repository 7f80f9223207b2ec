"""Expressions and conditions at all steps at once: the same doubles, to the bit, as at one step after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ltlc.columns.bits import Mask
from ltlc.columns.series import Steps, UnsupportedError
from ltlc.recordings.blocks import Array, Ragged
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

_FOLDS: dict[e.Function, Callable[..., float]] = {
    e.Function.MIN: functions.smallest,
    e.Function.MAX: functions.largest,
    e.Function.SUM: functions.sum_of,
}

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
            return _of_arrays(expression.array, steps, partial(_folded, function))
        case e.Call(function, arguments):
            return _applied(function, [_number(argument, steps) for argument in arguments])
        case Count():
            return _counted(expression, steps)
        case e.Opening():
            raise UnsupportedError("a value at an opening")
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


def _of_arrays(array: e.Expression, steps: Steps, of: Callable[[Ragged], Array]) -> Array:
    """What is computed of an array at `steps`: `of` computes it of samples, each once."""
    if not isinstance(array, e.Current | e.Past):
        raise UnsupportedError("a part of an array")
    wanted = wanted_of(array)
    assert isinstance(wanted, sampling.Input)
    parts, numbers = steps.arrays(wanted)
    return np.concatenate([of(_doubled(part)) for part in parts]).take(numbers)


def _doubled(samples: Ragged) -> Ragged:
    if samples.elements.dtype.kind not in "iu":
        return samples
    return Ragged(_as_doubles(samples.elements), samples.lengths)


def _folded(function: e.Function, array: Ragged) -> Array:
    if function is e.Function.LEN:
        return array.lengths.astype(np.float64)
    fold = _FOLDS[function]
    if function is e.Function.SUM or not array.lengths.all():
        return _one_by_one(array, fold)
    if not len(array):
        return np.empty(0)
    starts = np.concatenate(([0], np.cumsum(array.lengths)[:-1]))
    reduce = np.fmin if function is e.Function.MIN else np.fmax
    found: Array = reduce.reduceat(array.elements, starts)
    # Which of 0 and -0 it is depends on their order.
    for number in np.flatnonzero(found == 0).tolist():
        found[number] = fold(array.elements[starts[number] :][: array.lengths[number]].tolist())
    return found


def _one_by_one(array: Ragged, fold: Callable[..., float]) -> Array:
    ends = np.cumsum(array.lengths).tolist()
    starts, elements = [0, *ends[:-1]], array.elements.tolist()
    parts = (fold(elements[start:end]) for start, end in zip(starts, ends, strict=True))
    return np.fromiter(parts, np.float64, len(ends))


def _counted(count: Count, steps: Steps) -> Column:
    """How many elements of one array satisfy a predicate about numbers and constants."""
    if len(count.elements) != 1:
        raise UnsupportedError("the elements of several arrays")
    singles: dict[e.Expression, Column] = {}
    for single in count.singles:
        singles[single] = value(single, steps)
        if isinstance(singles[single], np.ndarray):
            raise UnsupportedError("elements that are compared with other signals")
    is_invalid = any(isinstance(each, float) and each != each for each in singles.values())

    def of(array: Ragged) -> Array:
        if is_invalid:
            return np.full(len(array), np.nan)
        inner = Steps(steps.columns, steps.base, steps.first, {count.elements[0]: array.elements, **singles})
        holds = {name: np.broadcast_to(truth(c, inner), len(array.elements)) for name, c in count.conditions}
        mask = np.broadcast_to(predicate(count.predicate, holds), len(array.elements))
        undefined = not_numbers((side for _, c in count.conditions for side in operands(c)), inner)
        if undefined is not None:
            mask = mask & ~undefined
        before = np.concatenate(([0], np.cumsum(mask)))
        ends = np.cumsum(array.lengths)
        counts: Array = before[ends] - before[ends - array.lengths]
        return counts.astype(np.float64)

    return _of_arrays(count.elements[0].array, steps, of)


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
        found = np.abs(left - right) <= margin
    else:
        found = _RELATIONS[relation](left, right + margin)
    return found
