"""Typed values: what an expression of the language stands for, with vectors and orientations as their components."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

from ltlc.language.expressions import (
    Arithmetic,
    Boolean,
    Call,
    Current,
    Expression,
    Function,
    Negative,
    Number,
    Operator,
    Past,
    Slope,
    String,
)
from ltlc.semantics.values import apply, calculate


class Value:
    """The value of an expression of the language."""

    __slots__ = ()
    noun = "a value"


@dataclass(frozen=True, slots=True)
class Scalar(Value):
    """A number."""

    expression: Expression
    noun = "a number"


@dataclass(frozen=True, slots=True)
class Truth(Value):
    """A boolean: a signal, `true` or `false`."""

    expression: Expression
    noun = "a boolean"


@dataclass(frozen=True, slots=True)
class Text(Value):
    """A string."""

    expression: Expression
    noun = "a string"


@dataclass(frozen=True, slots=True)
class Array(Value):
    """An array of numbers."""

    expression: Expression
    noun = "an array"


@dataclass(frozen=True, slots=True)
class Vector(Value):
    """Three numbers; `text` is how the vector is written in the language."""

    components: tuple[Expression, Expression, Expression]
    text: str
    noun = "a vector"


@dataclass(frozen=True, slots=True)
class Orientation(Value):
    """A unit quaternion x, y, z, w; used alone it is its `yaw`. `name` is the signal's, if it is one."""

    components: tuple[Expression, Expression, Expression, Expression]
    yaw: Expression
    angles: tuple[tuple[str, Expression], ...]
    noun = "an orientation"


def alone(value: Value) -> Value:
    """What a value is where it stands by itself: of an orientation, the yaw."""
    return Scalar(value.yaw) if isinstance(value, Orientation) else value


def expressions(value: Value) -> tuple[Expression, ...]:
    """The expressions that `value` consists of."""
    match value:
        case Scalar(e) | Truth(e) | Text(e) | Array(e):
            return (e,)
        case Vector(components, _) | Orientation(components, _, _):
            return components
    raise TypeError(f"not a value: {value!r}")


def in_the_past(value: Value, samples: int) -> Value | None:
    """`value`, `samples` samples ago; None if it is not a signal."""
    value = alone(value)
    if not all(isinstance(e, Current) for e in expressions(value)):
        return None
    if samples == 0:
        return value
    past = tuple(Past(e.signal, samples) for e in expressions(value) if isinstance(e, Current))
    if isinstance(value, Vector):
        return Vector((past[0], past[1], past[2]), f"@{{{value.text}, -{samples}}}")
    return replace(value, expression=past[0])  # type: ignore[type-var]


def arithmetic(operator: Operator, left: Expression, right: Expression) -> Expression:
    """`left operator right`, computed if both are constants."""
    if isinstance(left, Number) and isinstance(right, Number):
        return Number(calculate(operator, left.value, right.value))
    return Arithmetic(operator, left, right)


def negative(operand: Expression) -> Expression:
    """`-operand`, computed if it is a constant."""
    return Number(-operand.value) if isinstance(operand, Number) else Negative(operand)


def call(function: Function, arguments: Iterable[Expression]) -> Expression:
    """`function` of `arguments`, computed if all are constants."""
    parts = tuple(arguments)
    numbers = [part.value for part in parts if isinstance(part, Number)]
    if len(numbers) == len(parts):
        return Number(apply(function, numbers))
    return Call(function, parts)


def difference(left: Iterable[Expression], right: Iterable[Expression]) -> tuple[Expression, ...]:
    """The differences of the components of two vectors."""
    return tuple(arithmetic(Operator.MINUS, a, b) for a, b in zip(left, right, strict=True))


def number_text(value: float) -> str:
    """A number as it is written in the language; the shortest text that reads as the same double."""
    if math.isinf(value):
        return "1e999" if value > 0 else "-1e999"
    return repr(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)


_SUM, _PRODUCT, _FACTOR, _VALUE = range(4)
_STRENGTH = {Operator.PLUS: _SUM, Operator.MINUS: _SUM, Operator.TIMES: _PRODUCT, Operator.OVER: _PRODUCT}


def text(expression: Expression) -> str:
    """`expression` as it is written in the language."""
    return _text(expression, _SUM)


def _text(expression: Expression, context: int) -> str:
    written, strength = _written(expression)
    return f"({written})" if strength < context else written


def _written(expression: Expression) -> tuple[str, int]:
    """The text of `expression` and how tightly it binds."""
    match expression:
        case Number(value):
            return number_text(value), _FACTOR if value < 0 else _VALUE
        case Boolean(value):
            return str(value).lower(), _VALUE
        case String(value):
            return quoted(value), _VALUE
        case Current(signal):
            return signal.name, _VALUE
        case Past(signal, samples):
            return f"@{{{signal.name}, -{samples}}}", _VALUE
        case Slope(signal):
            return f"slope({signal.name})", _VALUE
        case Negative(operand):
            return f"-{_text(operand, _FACTOR)}", _FACTOR
        case Arithmetic(operator, left, right):
            strength = _STRENGTH[operator]
            return f"{_text(left, strength)} {operator.value} {_text(right, strength + 1)}", strength
        case Call(function, arguments):
            return f"{function.value}({', '.join(text(a) for a in arguments)})", _VALUE
    raise TypeError(f"not an expression: {expression!r}")


def quoted(value: str) -> str:
    """A string as it is written in the language."""
    escaped = value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\t", "\\t")
    return f'"{escaped}"'
