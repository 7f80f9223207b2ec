"""Typed values: what an expression of the language stands for, with vectors and orientations as their components."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import replace

from ltlc.base.source import Span
from ltlc.dataclass import dataclass
from ltlc.semantics import ltl
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.evaluation import apply, calculate
from ltlc.specification.expressions import (
    Arithmetic,
    Call,
    Current,
    Element,
    Expression,
    Negative,
    Number,
    Operator,
    Signal,
    ValueType,
    When,
    reads,
)
from ltlc.specification.functions import Function
from ltlc.specification.numbers import can_be_nan, numbers_of
from ltlc.specification.text import text
from ltlc.specification.wire import SINGLES, Kind, as_double


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
    """An array, of numbers unless its `elements` are something else."""

    expression: Expression
    elements: ValueType = ValueType.NUMBER

    @property
    def noun(self) -> str:  # type: ignore[override]
        """What it is called."""
        return "an array" if self.elements is ValueType.NUMBER else f"an array of {self.elements.value}s"

    @property
    def element(self) -> Value:
        """Each of its elements."""
        makes = {ValueType.NUMBER: Scalar, ValueType.BOOLEAN: Truth, ValueType.STRING: Text}
        return makes[self.elements](Element(self.expression))


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


@dataclass(frozen=True, slots=True)
class Message(Value):
    """The messages of a topic, of which no field is named where their type is `declared`: `signal` says they came."""

    signal: Signal
    declared: Span
    noun = "a message"


@dataclass(frozen=True, slots=True)
class Duration(Value):
    """A duration."""

    nanoseconds: Nanoseconds
    noun = "a duration"


@dataclass(frozen=True, slots=True)
class AgeOf(Value):
    """The time since the last message on the topic of `signal`."""

    signal: Signal
    noun = "an age"


@dataclass(frozen=True, slots=True)
class Zone(Value):
    """A simple polygon in the plane, called `name`, by its corners."""

    name: str
    corners: tuple[tuple[float, float], ...]
    noun = "a zone"


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
        case Message(signal, _):
            return (Current(signal),)
        case Duration() | AgeOf() | Zone():
            return ()
        case _:
            raise TypeError(f"not a value: {value!r}")


SignalOf = Callable[[Value, Expression], Signal | None]
"""The signal that has the samples of a part of a value."""


def sampled(value: Value, sample: Callable[[Signal], Expression], which: str, signal_of: SignalOf) -> Value | None:
    """The `sample` of `value` that is wanted, in words: `which`; None if a part of it has no samples by `signal_of`."""
    value = alone(value)
    signals = [signal_of(value, part) for part in expressions(value)]
    found = [sample(signal) for signal in signals if signal is not None]
    if not found or len(found) < len(signals):
        return None
    if isinstance(value, Vector):
        return Vector((found[0], found[1], found[2]), f"@{{{value.text}, {which}}}")
    return replace(value, expression=found[0])  # type: ignore[type-var]


def signal_alone(_: Value, part: Expression) -> Signal | None:
    """The signal that a part of a value is, if it is one, with samples only."""
    return part.signal if isinstance(part, Current) and part.signal.otherwise is None else None


def signal_or_computed(value: Value, part: Expression) -> Signal | None:
    """Likewise, or a signal of the values of an expression over present values, if that is not an array.

    Whether a state predicate holds has no sample where something that it compares is NaN.
    """
    if isinstance(part, Current) or not isinstance(value, Scalar | Vector | Truth):
        return signal_alone(value, part)
    if {type(read) for read in reads(part)} != {Current} or any(read.signal.otherwise for read in reads(part)):
        return None
    if isinstance(part, When):
        measured = When(ltl.TRUE, part.conditions) if any(can_be_nan(read.signal) for read in reads(part)) else None
        return Signal(text(part), ValueType.BOOLEAN, part, measured)
    return Signal(text(part), ValueType.NUMBER, part)


def arithmetic(operator: Operator, left: Expression, right: Expression) -> Expression:
    """`left operator right`, computed if both are constants."""
    if isinstance(left, Number) and isinstance(right, Number):
        return Number(calculate(operator, as_double(left.value), as_double(right.value)))
    return Arithmetic(operator, left, right)


def beside(expression: Expression, other: Expression) -> Expression:
    """`expression` where it meets `other`: a constant is the nearest binary32 beside one, exact beside an integer."""
    if not isinstance(expression, Number) or isinstance(other, Number):
        return expression
    match numbers_of(other).kind:
        case Kind.SINGLE:
            return Number(SINGLES.nearest(expression.value), single=True)
        case Kind.DOUBLE:
            return replace(expression, value=as_double(expression.value))
        case _:
            return expression


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


def gap(left: Expression, right: Expression) -> Expression:
    """The difference of two components, 0 of equal infinities; no finite constant is one."""
    has_finite = any(isinstance(side, Number) and math.isfinite(side.value) for side in (left, right))
    return arithmetic(Operator.MINUS, left, right) if has_finite else call(Function.GAP, (left, right))


def difference(left: Iterable[Expression], right: Iterable[Expression]) -> tuple[Expression, ...]:
    """The differences of the components of two vectors."""
    return tuple(arithmetic(Operator.MINUS, a, b) for a, b in zip(left, right, strict=True))
