"""What is known of an expression's value without a run: a distance is not negative, an angle at most π."""

from __future__ import annotations

import math

from ltlc.dataclass import dataclass
from ltlc.specification.expressions import (
    Arithmetic,
    Call,
    Count,
    Current,
    Expression,
    Field,
    Negative,
    Number,
    Opening,
    Operator,
    Past,
    Signal,
)
from ltlc.specification.functions import Function
from ltlc.specification.wire import as_double


@dataclass(frozen=True, slots=True)
class Interval:
    """The numbers from `low` to `high`, both included; infinite where nothing is known."""

    low: float = -math.inf
    high: float = math.inf

    def meet(self, other: Interval) -> Interval:
        """The numbers in both."""
        return Interval(max(self.low, other.low), min(self.high, other.high))


ANYTHING = Interval()

_RANGES = {
    Function.ABS: Interval(low=0.0),
    Function.SQRT: Interval(low=0.0),
    Function.NORM: Interval(low=0.0),
    Function.INSIDE: Interval(0.0, 1.0),
    Function.DISTANCE: Interval(low=0.0),
    Function.SIGN: Interval(-1.0, 1.0),
    Function.EXP: Interval(low=0.0),
    Function.SIN: Interval(-1.0, 1.0),
    Function.COS: Interval(-1.0, 1.0),
    Function.ASIN: Interval(-math.pi / 2, math.pi / 2),
    Function.ACOS: Interval(0.0, math.pi),
    Function.ATAN2: Interval(-math.pi, math.pi),
    Function.ANGLE_BETWEEN: Interval(0.0, math.pi),
    Function.ROLL: Interval(-math.pi, math.pi),
    Function.PITCH: Interval(-math.pi / 2, math.pi / 2),
    Function.YAW: Interval(-math.pi, math.pi),
    Function.ANGLE: Interval(0.0, math.pi),
    Function.LEN: Interval(low=0.0),
}


def bounds(expression: Expression) -> Interval:
    """An interval that holds every value of `expression`, which is a number."""
    match expression:
        case Number(value):
            return Interval(value, value)
        case Current(signal) | Past(signal, _) | Opening(signal):
            return signal_bounds(signal)
        case Negative(operand):
            inner = bounds(operand)
            return Interval(-inner.high, -inner.low)
        case Arithmetic(Operator.PLUS, left, right):
            one, other = bounds(left), bounds(right)
            return Interval(one.low + other.low, one.high + other.high)
        case Arithmetic(Operator.MINUS, left, right):
            one, other = bounds(left), bounds(right)
            return Interval(one.low - other.high, one.high - other.low)
        case Count():
            return Interval(low=0.0)
        case Call(function, _):
            return _RANGES.get(function, ANYTHING)
        case _:
            return ANYTHING


def signal_bounds(signal: Signal) -> Interval:
    """An interval that holds every value of `signal`, which is a number."""
    if not isinstance(signal.definition, Field):
        return bounds(signal.definition)
    return Interval(as_double(signal.numbers.least), as_double(signal.numbers.most))
