"""Typed expressions: what a program computes from samples, with every conversion and every test for NaN explicit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from typing import assert_never

from ltlc.dataclass import dataclass
from ltlc.program.functions import ROWS, Nan, Primitive
from ltlc.program.types import BOOL, DOUBLE, Type


@dataclass(frozen=True, slots=True, eq=False)
class Literal:
    """A constant of a type; equal ones have one type and are bit for bit the same: 0.0 and -0.0 differ."""

    value: bool | int | float | str
    type: Type

    def _exact(self) -> tuple[object, ...]:
        return self.type, type(self.value), repr(self.value)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Literal) and self._exact() == other._exact()

    def __hash__(self) -> int:
        return hash(self._exact())


@dataclass(frozen=True, slots=True)
class Held:
    """The sample of a signal from `ago` samples of it ago."""

    signal: str
    ago: int
    type: Type


@dataclass(frozen=True, slots=True)
class Recent:
    """The samples of a signal from `ago` samples of it ago to the latest, oldest first; `type` is that of the array."""

    signal: str
    ago: int
    type: Type


@dataclass(frozen=True, slots=True)
class Slope:
    """The difference quotient of the last two samples of a signal, per second; NaN if they have the same time."""

    signal: str

    @property
    def type(self) -> Type:
        """A double."""
        return DOUBLE


@dataclass(frozen=True, slots=True)
class News:
    """Whether a message arrives at this very instant on a topic that the signal is read from."""

    signal: str

    @property
    def type(self) -> Type:
        """A boolean."""
        return BOOL


@dataclass(frozen=True, slots=True)
class Kept:
    """The value of a register: that of the signal when the scope with that number, of that property, opened."""

    signal: str
    scope: int
    label: str
    type: Type


@dataclass(frozen=True, slots=True)
class Slice:
    """The elements of `array` from `start`, None for the first, up to, not including, `stop`, as in Python."""

    array: Expression
    start: int | None
    stop: int | None

    @property
    def type(self) -> Type:
        """That of the array."""
        return self.array.type


@dataclass(frozen=True, slots=True)
class Each:
    """In the guard of a `Count`: the elements of an array one after the other."""

    array: Expression

    @property
    def type(self) -> Type:
        """That of the elements."""
        return self.array.type.element


@dataclass(frozen=True, slots=True)
class Count:
    """For how many combinations of an index into each of `lists` `guard` holds; with `is_any`, whether for one.

    A list has arrays, and indexes up to the end of the shortest. The guard itself says what must not be NaN
    (`Primitive.MEASURED`).
    """

    lists: tuple[tuple[Expression, ...], ...]
    guard: Expression
    is_any: bool

    @property
    def arrays(self) -> tuple[Expression, ...]:
        """Those of all lists."""
        return tuple(array for arrays in self.lists for array in arrays)

    @property
    def type(self) -> Type:
        """A double, or a boolean."""
        return BOOL if self.is_any else DOUBLE


@dataclass(frozen=True, slots=True)
class Apply:
    """A primitive of arguments. Raises TypeError where the table has no type for it."""

    primitive: Primitive
    arguments: tuple[Expression, ...]
    type: Type = field(init=False, compare=False)

    def __post_init__(self) -> None:
        found = ROWS[self.primitive].typed(tuple(argument.type for argument in self.arguments))
        if found is None:
            raise TypeError(f"{self.primitive.value} of {[argument.type for argument in self.arguments]}")
        object.__setattr__(self, "type", found)


Read = Held | Recent | Slope | News | Kept
Expression = Literal | Held | Recent | Slope | News | Kept | Slice | Each | Count | Apply


def children(expression: Expression) -> tuple[Expression, ...]:
    """The immediate parts of an expression."""
    match expression:
        case Slice(array) | Each(array):
            return (array,)
        case Count(_, guard):
            return (*expression.arrays, guard)
        case Apply(_, arguments):
            return arguments
        case Literal() | Held() | Recent() | Slope() | News() | Kept():
            return ()
        case _:
            assert_never(expression)


def parts(expression: Expression) -> Iterator[Expression]:
    """An expression and all that is inside it, outermost and leftmost first, with repetitions."""
    yield expression
    for child in children(expression):
        yield from parts(child)


def replaced(expression: Expression, instead: Mapping[Read, Read]) -> Expression:
    """An expression with other things read, of the same types, `instead` of some."""
    match expression:
        case Literal():
            return expression
        case Held() | Recent() | Slope() | News() | Kept():
            return instead.get(expression, expression)
        case Slice(array) | Each(array):
            return replace(expression, array=replaced(array, instead))
        case Count(lists, guard):
            others = tuple(tuple(replaced(array, instead) for array in arrays) for arrays in lists)
            return replace(expression, lists=others, guard=replaced(guard, instead))
        case Apply(primitive, arguments):
            return Apply(primitive, tuple(replaced(argument, instead) for argument in arguments))
        case _:
            assert_never(expression)


def reads_of(expression: Expression) -> Iterator[Read]:
    """What an expression reads of signals, left to right, with repetitions."""
    return (part for part in parts(expression) if isinstance(part, Read))


def may_be_nan(expression: Expression) -> bool:
    """Whether `expression` can be NaN where no sample that it reads is."""
    match expression:
        case Literal(value):
            return isinstance(value, float) and math.isnan(value)
        case Held() | Recent() | Slope() | News() | Kept() | Slice() | Each() | Count():
            return False
        case Apply(primitive, arguments):
            passes = ROWS[primitive].nan in (Nan.STRICT, Nan.PARTIAL)
            return makes_nan(expression) or (passes and any(map(may_be_nan, arguments)))
        case _:
            assert_never(expression)


def makes_nan(applied: Apply) -> bool:
    """Whether a primitive can be NaN of arguments that are not."""
    match ROWS[applied.primitive].nan:
        case Nan.SKIPS:
            return True
        case Nan.PARTIAL:
            return not _is_total(applied.primitive, applied.arguments)
        case _:
            return False


def _is_total(primitive: Primitive, arguments: tuple[Expression, ...]) -> bool:
    """Whether a constant among the arguments excludes what makes NaN of numbers."""
    match primitive, arguments:
        case ((Primitive.ADD | Primitive.SUBTRACT), sides):
            return any(map(is_finite, sides))
        case Primitive.TIMES, sides:
            return any(is_finite(side) and is_nonzero(side) for side in sides)
        case Primitive.OVER, (_, divisor):
            return is_finite(divisor) and is_nonzero(divisor)
        case _:
            return False


def is_finite(expression: Expression) -> bool:
    """Whether `expression` is a constant, and a finite double."""
    return isinstance(expression, Literal) and isinstance(expression.value, float) and math.isfinite(expression.value)


def is_nonzero(expression: Expression) -> bool:
    """Whether `expression` is a constant, and not 0."""
    return isinstance(expression, Literal) and expression.value != 0
