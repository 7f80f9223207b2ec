"""The value of an expression and the truth of a condition at a step: the reference for emitted code.

Slow and obvious. Arithmetic is in IEEE doubles; without it, numbers are compared exactly, as they are in messages.

It computes what emitted code computes by other means, and so does the reference for samples (`assurance/histories.py`,
`assurance/traffic.py`) what the runtime does; the replay compares them with what is emitted. Of constants this says
nothing: the lowering folds what reads no signal by this module itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import chain, product
from typing import TypeVar, assert_never

from ltlc.semantics.finite import holds
from ltlc.semantics.words import Letter
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import (
    Arithmetic,
    Boolean,
    Call,
    Comparison,
    Condition,
    Count,
    Current,
    Element,
    Expression,
    Field,
    IsTrue,
    Negative,
    New,
    Number,
    Opening,
    Operator,
    Past,
    Recent,
    Relation,
    Same,
    Signal,
    Slice,
    Slope,
    String,
    When,
    operands,
)
from ltlc.specification.functions import Function
from ltlc.specification.numbers import numbers_of
from ltlc.specification.wire import Kind, as_double, double_or_integer

Single = float | bool | str
Value = Single | tuple[Single, ...]

Known = TypeVar("Known", bound=Expression)

Values = Mapping[Known, Value]
"""The values of inputs and, in the conditions of a count, of its elements."""


def letter(atoms: tuple[Atom, ...], values: Values[Known]) -> Letter | None:
    """The atoms that hold where the inputs have these `values`; None, for no step, where an expression is NaN."""
    return holding([(atom.name, atom.condition) for atom in atoms], values)


def holding(conditions: Iterable[tuple[str, Condition]], values: Values[Known]) -> Letter | None:
    """The names of those `conditions` that hold; None where something that one of them compares is NaN."""
    found = set()
    for name, condition in conditions:
        holds_here = truth(condition, values)
        if holds_here is None:
            return None
        if holds_here:
            found.add(name)
    return frozenset(found)


def sample(signal: Signal, values: Values[Known]) -> Value | None:
    """The sample of a computed signal where its inputs have these `values`; None if it has none there."""
    assert not isinstance(signal.definition, Field)
    value = evaluate(signal.definition, values)
    if signal.when is None:
        return value
    asked = holding(signal.when.conditions, values)
    if is_nan(value) or asked is None:
        return None
    return value if holds(signal.when.predicate, (asked,)) else None


def _holds(when: When, values: Values[Known]) -> bool:
    """Whether the state predicate holds."""
    return holds(when.predicate, (frozenset(name for name, each in when.conditions if is_true(each, values)),))


def is_nan(value: Value) -> bool:
    """Whether a value is NaN."""
    return isinstance(value, float) and math.isnan(value)


def is_true(condition: Condition, values: Values[Known]) -> bool:
    """Whether `condition` holds; where something that it compares is NaN, it does not."""
    return truth(condition, values) is True


def truth(condition: Condition, values: Values[Known]) -> bool | None:
    """Whether `condition` holds; None where something that it compares is NaN."""
    compared = [evaluate(operand, values) for operand in operands(condition)]
    if any(map(is_nan, compared)):
        return None
    match condition:
        case IsTrue():
            return bool(compared[0])
        case Same():
            return compared[0] == compared[1]
        case Comparison(_, relation, _, margin):
            left, right = map(_as_number, compared)
            return (
                _is_within(as_double(left), relation, as_double(right), margin)
                if margin
                else compare(left, relation, right)
            )


def _is_within(left: float, relation: Relation, right: float, margin: float) -> bool:
    """`left relation{margin} right`."""
    if relation is Relation.EQUAL:
        return left == right or abs(left - right) <= margin
    return compare(left, relation, right + margin)


def compare(left: float, relation: Relation, right: float) -> bool:
    """`left relation right`, exactly."""
    match relation:
        case Relation.EQUAL:
            return left == right
        case Relation.LESS:
            return left < right
        case Relation.AT_MOST:
            return left <= right
        case Relation.GREATER:
            return left > right
        case Relation.AT_LEAST:
            return left >= right


def number(expression: Expression, values: Values[Known]) -> float:
    """The value of an expression that the type checker found to be a number, as a double."""
    return as_double(exact_number(expression, values))


def exact_number(expression: Expression, values: Values[Known]) -> float:
    """The value of an expression that the type checker found to be a number."""
    return _as_number(evaluate(expression, values))


def _as_number(value: Value) -> float:
    if not isinstance(value, float | int) or isinstance(value, bool):
        raise TypeError(f"not a number: {value!r}")
    return value


def array(expression: Expression, values: Values[Known]) -> tuple[Single, ...]:
    """The value of an expression that the type checker found to be an array."""
    value = evaluate(expression, values)
    if not isinstance(value, tuple):
        raise TypeError(f"not an array: {expression}")
    return value


def evaluate(expression: Expression, values: Values[Known]) -> Value:
    """The value of `expression` where the inputs have these `values`."""
    match expression:
        case Number(value):
            return double_or_integer(value) if isinstance(value, int) else value
        case Boolean(value) | String(value):
            return value
        case Current() | Past() | Recent() | Slope() | New() | Element() | Opening():
            return values[expression]  # type: ignore[index]
        case Slice(whole, start, stop):
            return array(whole, values)[start:stop]
        case Count():
            return _count(expression, values)
        case When():
            return _holds(expression, values)
        case Negative(operand):
            return -exact_number(operand, values)
        case Arithmetic(operator, left, right):
            return calculate(operator, number(left, values), number(right, values))
        case Call(function) if expression.array is not None:
            return fold(function, array(expression.array, values))
        case Call(Function.NEAREST, (sought, among)):
            return nearest(number(sought, values), array(among, values))
        case Call(Function.ABS, (operand,)):
            return abs(exact_number(operand, values))
        case Call(Function.MIN | Function.MAX as function, arguments) if numbers_of(expression).kind is Kind.INTEGER:
            return apply(function, [exact_number(argument, values) for argument in arguments])
        case Call(function, arguments):
            return apply(function, [number(argument, values) for argument in arguments])
        case _:
            assert_never(expression)


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


def apply(function: Function, arguments: Sequence[float]) -> float:
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
        case Function.GAP:
            left, right = arguments
            return 0.0 if left == right else left - right
        case Function.NORM:
            return math.hypot(*arguments)
        case Function.ROLL | Function.PITCH | Function.YAW:
            return _euler(function, *arguments)
        case Function.ANGLE:
            return _angle(arguments[:4], arguments[4:])
        case Function.FLOOR | Function.CEIL:
            return _whole(function, arguments[0])
        case Function.SIGN:
            return float((arguments[0] > 0) - (arguments[0] < 0))
        case Function.MOD:
            return _remainder(*arguments)
        case Function.ANGLE_BETWEEN:
            turn = arguments[0] - arguments[1]
            return abs(math.remainder(turn, math.tau)) if math.isfinite(turn) else math.nan
        case Function.INSIDE:
            return float(_is_inside(arguments[:2], corners_of(arguments)))
        case Function.DISTANCE:
            return _distance(arguments[:2], corners_of(arguments))
        case Function.LOG if arguments[0] == 0:
            return -math.inf
        case (
            Function.EXP
            | Function.LOG
            | Function.SIN
            | Function.COS
            | Function.TAN
            | Function.ASIN
            | Function.ACOS
            | Function.ATAN2
        ):
            return _of_the_library(function.value, arguments)
        case Function.SUM | Function.NEAREST | Function.MEAN | Function.MEDIAN | Function.LEN | Function.COMPLETE:
            raise TypeError(f"{function.value} takes an array")


Point = Sequence[float]


def corners_of(arguments: Sequence[float]) -> list[Point]:
    """The corners of a zone, of the arguments of a function of it."""
    return [arguments[at : at + 2] for at in range(2, len(arguments), 2)]


def edges_of(corners: Sequence[Point]) -> list[tuple[Point, Point]]:
    """The edges of a polygon, the last one back to the first corner."""
    return list(zip(corners, [*corners[1:], corners[0]], strict=True))


def _is_inside(point: Point, corners: Sequence[Point]) -> bool:
    """Whether a point lies on an edge, or an odd number of edges is to the right of it, exactly."""
    if not all(map(math.isfinite, point)):
        return False
    x, y = map(Fraction, point)
    is_odd = False
    for one, other in edges_of(corners):
        (low_x, low_y), (high_x, high_y) = sorted(([*map(Fraction, one)], [*map(Fraction, other)]), key=lambda p: p[1])
        if low_y == high_y == y and min(low_x, high_x) <= x <= max(low_x, high_x):
            return True
        if low_y == high_y or not low_y <= y <= high_y:
            continue
        at_height = low_x + (y - low_y) * (high_x - low_x) / (high_y - low_y)
        if at_height == x:
            return True
        is_odd ^= y < high_y and at_height > x
    return is_odd


def _distance(point: Point, corners: Sequence[Point]) -> float:
    """The least distance from an edge, where the point is not inside."""
    if _is_inside(point, corners):
        return 0.0
    return min(_from_edge(point, one, other) for one, other in edges_of(corners))


def _from_edge(point: Point, one: Point, other: Point) -> float:
    """In doubles: beside the edge, the area that it spans with the point by its length; else from the nearer end."""
    along, across = other[0] - one[0], other[1] - one[1]
    x, y = point[0] - one[0], point[1] - one[1]
    if 0 < x * along + y * across < along * along + across * across:
        return abs(along * y - across * x) / math.hypot(along, across)
    return min(math.hypot(x, y), math.hypot(point[0] - other[0], point[1] - other[1]))


def _whole(function: Function, number: float) -> float:
    """The integer next to `number`."""
    if math.isinf(number):
        return number
    return float(math.floor(Fraction(number)) if function is Function.FLOOR else math.ceil(Fraction(number)))


def _remainder(dividend: float, divisor: float) -> float:
    """What is left, with the sign of the divisor, rounded once."""
    if divisor == 0 or math.isinf(dividend):
        return math.nan
    if math.isinf(divisor):
        return divisor if dividend * divisor < 0 else dividend + 0.0
    return float(Fraction(dividend) % Fraction(divisor))


def _of_the_library(name: str, arguments: Sequence[float]) -> float:
    """The platform's mathematical functions; NaN outside their domain."""
    try:
        found: float = getattr(math, name)(*arguments)
    except ValueError:
        return math.nan
    except OverflowError:
        return math.inf
    return found


def fold(function: Function, elements: Sequence[Single]) -> float:
    """The value of a function of one array; see `Function`."""
    if function is Function.LEN:
        return float(len(elements))
    numbers = [element for element in elements if isinstance(element, float | int)]
    if function is Function.COMPLETE:
        return math.nan if any(map(is_nan, numbers)) else float(len(numbers))
    if function is Function.SUM:
        return _sum(list(map(as_double, numbers)))
    measured = [number for number in numbers if not is_nan(number)]
    if function is Function.MEAN:
        return _sum(list(map(as_double, measured))) / len(measured) if measured else math.nan
    if function is Function.MEDIAN:
        return _median(sorted(map(as_double, measured)))
    return apply(function, measured) if measured else math.nan


def nearest(sought: float, elements: Sequence[Single]) -> float:
    """The first of the elements with the least difference."""
    measured = [as_double(each) for each in elements if isinstance(each, float | int) and not is_nan(each)]
    if math.isnan(sought) or not measured:
        return math.nan
    return min(measured, key=lambda each: abs(apply(Function.GAP, [each, sought])))


def _median(ascending: Sequence[float]) -> float:
    """The mean of the middle two, which are one in an odd number."""
    if not ascending:
        return math.nan
    low, high = ascending[(len(ascending) - 1) // 2], ascending[len(ascending) // 2]
    if math.isfinite(low) and math.isfinite(high):
        return float((Fraction(low) + Fraction(high)) / 2)
    return low + high


def _sum(elements: list[float]) -> float:
    infinite = {element for element in elements if not math.isfinite(element)}
    if infinite:
        return infinite.pop() if len(infinite) == 1 else math.nan
    exact = sum(map(Fraction, elements))
    try:
        return float(exact)
    except OverflowError:
        return math.inf if exact > 0 else -math.inf


def _count(count: Count, values: Values[Known]) -> float:
    """How many elements satisfy a predicate; see `Count`."""
    if any(is_nan(evaluate(single, values)) for single in count.singles):
        return math.nan
    found, elements = 0, tuple(chain(*count.lists))
    rows = (zip(*(array(element.array, values) for element in of_list), strict=False) for of_list in count.lists)
    for combination in product(*rows):
        here: dict[Expression, Value] = dict([*values.items(), *zip(elements, chain(*combination), strict=True)])
        satisfied = holding(count.conditions, here)
        found += satisfied is not None and holds(count.predicate, (satisfied,))
    return float(found)


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


def _angle(one: Sequence[float], other: Sequence[float]) -> float:
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
