"""Which numbers an expression can be, as far as its form and the types of its fields determine them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ltlc.specification.expressions import (
    Call,
    Count,
    Current,
    Element,
    Expression,
    Field,
    Negative,
    Number,
    Opening,
    Past,
    Recent,
    Signal,
    Slice,
    ValueType,
)
from ltlc.specification.functions import Function
from ltlc.specification.signs import never_negative
from ltlc.specification.wire import DOUBLES, EXACT, Kind, Numbers, as_double

_EXTREMES = {Function.MIN: min, Function.MAX: max}


def numbers_of(expression: Expression) -> Numbers:
    """The numbers among which `expression` is wherever it has a value; of an array, each of its elements.

    A field, `min`, `max`, `abs` and `-` of such are as exact as the field; all else is computed in doubles.
    """
    match expression:
        case Current(signal) | Past(signal, _) | Recent(signal, _) | Opening(signal) if (
            isinstance(signal.definition, Field) or signal.is_taken
        ):
            return signal.numbers
        case Count() | Call(Function.LEN):
            return Numbers(Kind.INTEGER, 0, EXACT)
        case Element(array) | Slice(array):
            return numbers_of(array)
        case Negative(operand):
            inner = numbers_of(operand)
            return inner.between(-inner.most, -inner.least)
        case Call(Function.ABS, (operand,)):
            return _absolute(numbers_of(operand))
        case Call(Function.MIN | Function.MAX as function, arguments):
            return _extreme(function, arguments)
        case _:
            return DOUBLES.between(0.0 if never_negative(expression) else -math.inf, math.inf)


def can_be_nan(signal: Signal) -> bool:
    """Whether a sample of `signal`, or an element of one, can be NaN."""
    return (signal.type.element or signal.type) is ValueType.NUMBER and signal.numbers.kind is not Kind.INTEGER


def _absolute(inner: Numbers) -> Numbers:
    most = max(-inner.least, inner.most)
    return inner.between(max(inner.least, -inner.most, 0), most)


def _extreme(function: Function, arguments: Sequence[Expression]) -> Numbers:
    """Of one of several numbers: of their kind if they have one, constants being of any that has them."""
    choose = _EXTREMES[function]
    parts = [numbers_of(argument) for argument in arguments if not isinstance(argument, Number)]
    constants = [argument.value for argument in arguments if isinstance(argument, Number)]
    kinds = {part.kind for part in parts}
    kind = kinds.pop() if len(kinds) == 1 else Kind.DOUBLE
    if not all(Numbers(kind).has(constant) for constant in constants):
        kind = Kind.DOUBLE
    least = choose([*(part.least for part in parts), *constants])
    most = choose([*(part.most for part in parts), *constants])
    return Numbers(kind, least, most) if kind is not Kind.DOUBLE else DOUBLES.between(as_double(least), as_double(most))
