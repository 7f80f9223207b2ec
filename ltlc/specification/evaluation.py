"""The value of an expression and the truth of a condition at a step: the reference for emitted code.

Slow and obvious, in IEEE doubles throughout.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from ltlc.semantics.words import Letter
from ltlc.specification.atoms import Atom, Comparison, Condition, IsTrue, Relation, Same, operands
from ltlc.specification.expressions import (
    Arithmetic,
    Boolean,
    Call,
    Current,
    Expression,
    Function,
    Input,
    Negative,
    New,
    Number,
    Operator,
    Past,
    Slope,
    String,
)

Value = float | bool | str | tuple[float, ...]


def letter(atoms: tuple[Atom, ...], values: Mapping[Input, Value]) -> Letter | None:
    """The atoms that hold where the inputs have these `values`; None, for no step, where an expression is NaN."""
    conditions = [atom.condition for atom in atoms]
    if any(is_undefined(condition, values) for condition in conditions):
        return None
    return frozenset(atom.name for atom in atoms if is_true(atom.condition, values))


def is_undefined(condition: Condition, values: Mapping[Input, Value]) -> bool:
    """Whether something that `condition` compares is NaN."""
    compared = (evaluate(operand, values) for operand in operands(condition))
    return any(isinstance(value, float) and math.isnan(value) for value in compared)


def is_true(condition: Condition, values: Mapping[Input, Value]) -> bool:
    """Whether `condition` holds."""
    match condition:
        case IsTrue(operand):
            return bool(evaluate(operand, values))
        case Same(left, right):
            return evaluate(left, values) == evaluate(right, values)
        case Comparison(left, relation, right, margin):
            return compare(number(left, values), relation, number(right, values), margin)


def compare(left: float, relation: Relation, right: float, margin: float) -> bool:
    """`left relation right` with its margin, as `Comparison` defines it."""
    match relation:
        case Relation.EQUAL:
            return left == right if margin == 0 else abs(left - right) <= margin
        case Relation.LESS:
            return left < right + margin
        case Relation.AT_MOST:
            return left <= right + margin
        case Relation.GREATER:
            return left > right + margin
        case Relation.AT_LEAST:
            return left >= right + margin


def number(expression: Expression, values: Mapping[Input, Value]) -> float:
    """The value of an expression that the type checker found to be a number."""
    value = evaluate(expression, values)
    if not isinstance(value, float):
        raise TypeError(f"not a number: {expression}")
    return value


def evaluate(expression: Expression, values: Mapping[Input, Value]) -> Value:
    """The value of `expression` where the inputs have these `values`."""
    match expression:
        case Number(value):
            return float(value)
        case Boolean(value) | String(value):
            return value
        case Current() | Past() | Slope() | New():
            return values[expression]
        case Negative(operand):
            return -number(operand, values)
        case Arithmetic(operator, left, right):
            return calculate(operator, number(left, values), number(right, values))
        case Call(function, (array,)) if function in (Function.MIN, Function.MAX):
            return _fold(function, evaluate(array, values))
        case Call(function, arguments):
            return apply(function, [number(argument, values) for argument in arguments])
    raise TypeError(f"not an expression: {expression!r}")


def calculate(operator: Operator, left: float, right: float) -> float:
    """IEEE 754 arithmetic, division by zero included."""
    match operator:
        case Operator.PLUS:
            return left + right
        case Operator.MINUS:
            return left - right
        case Operator.TIMES:
            return left * right
        case Operator.OVER:
            if right != 0:
                return left / right
            if left == 0 or math.isnan(left):
                return math.nan
            return math.copysign(math.inf, left) * math.copysign(1.0, right)


def apply(function: Function, arguments: list[float]) -> float:
    """The value of `function`; see `Function`."""
    if any(math.isnan(argument) for argument in arguments):
        return math.nan
    match function:
        case Function.ABS:
            return abs(arguments[0])
        case Function.MIN:
            return min(arguments)
        case Function.MAX:
            return max(arguments)
        case Function.SQRT:
            return math.sqrt(arguments[0]) if arguments[0] >= 0 else math.nan
        case Function.NORM:
            return math.hypot(*arguments)
        case Function.ROLL | Function.PITCH | Function.YAW:
            return _euler(function, *arguments)
        case Function.ANGLE:
            return _angle(arguments[:4], arguments[4:])


def _fold(function: Function, array: Value) -> float:
    if not isinstance(array, tuple):
        raise TypeError(f"{function.value} of one number: the resolver folds these")
    return apply(function, list(array)) if array else math.nan


def _euler(function: Function, *orientation: float) -> float:
    """Yaw, pitch, roll of a quaternion (REP 103: rotations about z, then y, then x); of length 0: NaN."""
    x, y, z, w = _unit(orientation)
    if math.isnan(x):
        return math.nan
    if function is Function.ROLL:
        return math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    if function is Function.YAW:
        return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x))))


def _angle(one: list[float], other: list[float]) -> float:
    """The angle of the rotation that turns `one` into `other`; q and −q are the same orientation.

    It is twice the angle between the unit quaternions p and q as vectors, or p and −q if that is smaller; the tangent
    of half that angle is |p − q| / |p + q|.
    """
    p, q = _unit(one), _unit(other)
    apart = math.hypot(*(a - b for a, b in zip(p, q, strict=True)))
    together = math.hypot(*(a + b for a, b in zip(p, q, strict=True)))
    return 4 * math.atan2(min(apart, together), max(apart, together))


def _unit(orientation: Sequence[float]) -> list[float]:
    """The quaternion with length 1 that is the same orientation; NaN if its length is 0 or infinite."""
    length = math.hypot(*orientation)
    if length == 0 or math.isinf(length):
        return [math.nan] * 4
    return [component / length for component in orientation]
