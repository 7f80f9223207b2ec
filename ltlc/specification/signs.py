"""What is known of the sign of an expression wherever it has a value, in IEEE doubles: -0.0 is not 0.0.

√-0.0 is -0.0 and 1 / -0.0 is -∞: that a value is not below 0 does not give the sign of a quotient by it.
"""

from __future__ import annotations

import math
from enum import IntEnum

from ltlc.specification.expressions import (
    Arithmetic,
    Call,
    Count,
    Current,
    Expression,
    Number,
    Operator,
    Past,
)
from ltlc.specification.functions import Function


class Sign(IntEnum):
    """Each implies those before it. NaN is not a value, so each holds of it."""

    UNKNOWN = 0
    NOT_BELOW_ZERO = 1
    """At least 0, perhaps -0.0."""
    UNSIGNED = 2
    """At least 0, and not -0.0."""
    POSITIVE = 3
    """Greater than 0."""


def never_negative(expression: Expression) -> bool:
    """Whether `expression` is at least 0 wherever it has a value, as far as `sign` knows."""
    return sign(expression) is not Sign.UNKNOWN


def sign(expression: Expression) -> Sign:
    """What is known of the sign of `expression` by its operations, and by the types of fields.

    Lemma: its value by the reference is as the answer says, or NaN. By induction; each case below has its reason.
    """
    match expression:
        case Number(value):
            return _sign_of(value)
        case Count() | Call(Function.LEN):
            return Sign.UNSIGNED
        case Call(function, arguments):
            return _sign_of_call(function, [sign(argument) for argument in arguments])
        case Arithmetic(operator, left, right):
            return _sign_of_arithmetic(operator, sign(left), sign(right))
        case Current(signal) | Past(signal, _) if isinstance(signal.definition, Expression):
            # A recording may give the signal itself: below 0 is refused (`recordings.run`), -0.0 is not.
            return min(sign(signal.definition), Sign.NOT_BELOW_ZERO)
        case Current(signal) | Past(signal, _) if signal.numbers.least == 0:
            # An integer has no sign where it is 0.
            return Sign.UNSIGNED
    return Sign.UNKNOWN


def _sign_of(value: float) -> Sign:
    if value == 0:
        return Sign.UNSIGNED if math.copysign(1.0, value) > 0 else Sign.NOT_BELOW_ZERO
    return Sign.POSITIVE if value > 0 else Sign.UNKNOWN


def _sign_of_call(function: Function, arguments: list[Sign]) -> Sign:
    match function:
        case (
            Function.ABS
            | Function.NORM
            | Function.ANGLE
            | Function.ANGLE_BETWEEN
            | Function.EXP
            | Function.ACOS
            | Function.INSIDE
            | Function.DISTANCE
        ):
            # They clear the sign: |-0.0| and the norm of (-0.0, -0.0) are 0.0; an angle is atan2 of two norms.
            return Sign.UNSIGNED
        case Function.FLOOR | Function.CEIL | Function.SIGN:
            # They are never -0.0, and what is not below 0 stays so.
            return Sign.UNSIGNED if arguments[0] else Sign.UNKNOWN
        case Function.SQRT:
            # √-0.0 is -0.0. The root of the smallest double is still a double above 0.
            return max(arguments[0], Sign.NOT_BELOW_ZERO)
        case Function.MIN:
            # It is one of the arguments, whichever of 0.0 and -0.0 counts as smaller.
            return min(arguments)
        case Function.MAX:
            # It is not less than any argument; but of 0.0 and -0.0, which are equal, it may be either.
            surest = max(arguments)
            return Sign.NOT_BELOW_ZERO if surest is Sign.UNSIGNED and min(arguments) < surest else surest
        case _:
            return Sign.UNKNOWN


def _sign_of_arithmetic(operator: Operator, left: Sign, right: Sign) -> Sign:
    if Sign.UNKNOWN in (left, right):
        return Sign.UNKNOWN
    match operator:
        case Operator.PLUS:
            # A sum is not less than either side; -0.0 + 0.0 is 0.0, and -0.0 only if both sides are.
            return max(left, right)
        case Operator.TIMES:
            # The signs multiply; two numbers above 0 may have a product that is rounded to 0.0. 0 * inf is NaN.
            return min(left, right, Sign.UNSIGNED)
        case Operator.OVER if right >= Sign.UNSIGNED:
            # As a product. What -0.0 divides is -inf, which is why the divisor must not be that; 0 / 0 is NaN.
            return min(left, Sign.UNSIGNED)
    return Sign.UNKNOWN
