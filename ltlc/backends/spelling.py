"""Typed expressions as code, by the table of functions; a language's `Target` has what the table does not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol, assert_never

from ltlc.backends.statements import conjunction, disjunction
from ltlc.backends.trees import Call, Chain, Code, Infix, Prefix, Text
from ltlc.dataclass import dataclass
from ltlc.program import functions as f
from ltlc.program.expressions import (
    Apply,
    Count,
    Each,
    Expression,
    Held,
    Kept,
    Literal,
    News,
    Recent,
    Slice,
    Slope,
    children,
    is_nonzero,
    may_be_nan,
)
from ltlc.program.functions import Primitive
from ltlc.program.normal import may_be_nan_when_taken
from ltlc.program.types import INTEGER, Scalar


class NotInTargetError(Exception):
    """The target has no spelling for something; the text says what, and `instead` what to write."""

    def __init__(self, what: str, instead: str = "") -> None:
        super().__init__(what)
        self.instead = instead


class Target(Protocol):
    """How a language writes expressions, beyond the table of functions."""

    def spelling(self, primitive: Primitive, types: f.Types) -> f.Spelling | None:
        """How a primitive of such arguments is written; None if it cannot be."""
        ...

    def literal(self, speller: Speller, literal: Literal) -> Code:
        """A constant."""
        ...

    def slice(self, speller: Speller, slice_: Slice) -> Code:
        """A part of an array."""
        ...

    def count(self, speller: Speller, count: Count) -> Code:
        """What counts elements, or says whether there is one."""
        ...

    def at_most_infinite(self, speller: Speller, argument: Expression) -> Code:
        """That a number is not NaN."""
        ...

    def of_array(self, function: str, array: Expression) -> str:
        """The name of a function of such arrays: one for all, unless the language has one for each type."""
        return function

    def components(self, arguments: Sequence[Code]) -> tuple[Code, ...]:
        """Doubles as what a function takes that takes them together: as they are, unless it takes an array."""
        return tuple(arguments)

    def member(self, name: str, array: Code) -> Code:
        """A member of an array, as a double, where the language has no function for it."""
        raise TypeError(name)


@dataclass
class Speller:
    """Writes expressions over what is called as in `names`."""

    names: Mapping[Expression, str]
    target: Target

    def code(self, expression: Expression, holds: bool = True) -> Code:
        """Code for the value of `expression`; with `holds` false, of a Boolean, for its negation.

        Nothing that has a name is NaN there. Raises NotInTargetError.
        """
        if expression in self.names:
            return _unless(holds, Text(self.names[expression]))
        match expression:
            case Literal(bool(value)):
                return self.target.literal(self, Literal(value == holds, expression.type))
            case Literal():
                return self.target.literal(self, expression)
            case Held() | Recent() | Slope() | News() | Kept() | Each():
                raise KeyError(expression)
            case Slice():
                return self.target.slice(self, expression)
            case Count():
                return _unless(holds, self.target.count(self, expression))
            case Apply(Primitive.NOT, (operand,)):
                return self.code(operand, not holds)
            case Apply(Primitive.AND | Primitive.OR as primitive, operands):
                return self._joined(primitive, operands, holds)
            case Apply(Primitive.TO_DOUBLE, (Apply() as inner,)) if inner not in self.names:
                spelling = self._spelling(inner)
                if isinstance(spelling, f.OfDoubles):
                    return self._spelled(spelling.spelling, tuple(map(_rounded, inner.arguments)))
                return self._applied(expression)
            case Apply():
                return self._applied(expression, holds)
            case _:
                assert_never(expression)

    def asked(self, atom: Expression, holds: bool) -> Code:
        """That an atom of a machine holds, or does not; where a part of it is NaN, no comparison of that holds."""
        if holds or not may_be_nan_when_taken(atom):
            return self.code(atom, holds)
        return Prefix("not ", self.code(atom))

    def _spelling(self, applied: Apply) -> f.Spelling | None:
        return self.target.spelling(applied.primitive, tuple(a.type for a in applied.arguments))

    def _applied(self, applied: Apply, holds: bool = True) -> Code:
        spelling = self._spelling(applied)
        if spelling is None or isinstance(spelling, f.OfDoubles):
            raise NotInTargetError(_refusal(applied))
        return self._spelled(spelling, applied.arguments, holds)

    def _joined(self, primitive: Primitive, operands: Sequence[Expression], holds: bool) -> Code:
        if within := _within(primitive, operands):
            return _unless(holds, Chain(tuple(map(self.code, within)), ("<=", "<=")))
        sides = [self.code(operand, holds) for operand in operands]
        return conjunction(sides) if (primitive is Primitive.AND) == holds else disjunction(sides)

    def _spelled(self, spelling: f.Spelling, arguments: tuple[Expression, ...], holds: bool = True) -> Code:
        match spelling:
            case f.Infix(operator, ""):
                return self._calculated(operator, arguments)
            case f.Infix(operator, opposite):
                if not holds and self._are_numbers(arguments):
                    return self._compared(opposite, *arguments)
                return _unless(holds, self._compared(operator, *arguments))
            case f.Order(function, operator, opposite, is_mirrored):
                order = Call(function, tuple(map(self.code, reversed(arguments) if is_mirrored else arguments)))
                if not holds and self._are_numbers(arguments):
                    return Chain((order, Text("0.0")), (opposite,))
                return _unless(holds, Chain((order, Text("0.0")), (operator,)))
            case f.Quotient(function):
                if is_nonzero(arguments[1]):
                    return self._calculated("/", arguments)
                return Call(function, tuple(map(self.code, arguments)))
            case f.Prefix(operator):
                return Prefix(operator, self.code(arguments[0]))
            case f.Silent():
                return self.code(arguments[0], holds)
            case f.Function(function):
                return _unless(holds, Call(function, tuple(map(self.code, arguments))))
            case f.Folded(function):
                found, *rest = map(self.code, arguments)
                for other in rest:
                    found = Call(function, (found, other))
                return found
            case f.OfArray(function):
                return Call(self.target.of_array(function, arguments[-1]), tuple(map(self.code, arguments)))
            case f.Components(function, counted):
                count = [Text(str(len(arguments)))] if counted else []
                return Call(function, (*self.target.components([self.code(a) for a in arguments]), *count))
            case f.Member(name):
                return self.target.member(name, self.code(arguments[0]))
            case f.AtMostInfinite():
                return _unless(holds, self.target.at_most_infinite(self, arguments[0]))
            case f.OfDoubles():
                raise TypeError("one inside another")
            case _:
                assert_never(spelling)

    def _compared(self, operator: str, left: Expression, right: Expression) -> Code:
        """What is read stands on the left, what is constant on the right."""
        if self._precedence(right) < self._precedence(left):
            left, operator, right = right, f.MIRRORED[operator], left
        return Chain((self.code(left), self.code(right)), (operator,))

    def _precedence(self, side: Expression) -> int:
        match side:
            case Literal():
                return 2
            case Apply(Primitive.TO_DOUBLE | Primitive.TO_SIGNED | Primitive.TO_UNSIGNED, (inner,)):
                return self._precedence(inner)
            case _:
                return 0 if side in self.names or not children(side) else 1

    def _are_numbers(self, arguments: Sequence[Expression]) -> bool:
        """Whether none is NaN: of what has a name, whoever gave it has seen to that."""
        return not any(argument not in self.names and may_be_nan(argument) for argument in arguments)

    def _calculated(self, operator: str, operands: Sequence[Expression]) -> Code:
        """What groups to the left already becomes one tree."""
        left, *rest = map(self.code, operands)
        if isinstance(left, Infix) and left.operator == operator:
            return Infix(operator, (*left.operands, *rest))
        return Infix(operator, (left, *rest))


def _within(primitive: Primitive, operands: Sequence[Expression]) -> tuple[Expression, ...] | None:
    """The three parts of `low <= value and value <= high`."""
    match primitive, operands:
        case (
            Primitive.AND,
            (
                Apply(Primitive.AT_MOST, (Literal() as low, value)),
                Apply(Primitive.AT_MOST, (same, Literal() as high)),
            ),
        ) if value == same:
            return low, value, high
    return None


def _refusal(applied: Apply) -> str:
    if INTEGER in (applied.type, *(argument.type for argument in applied.arguments)):
        return "a comparison with `-`, `abs`, `min` or `max` of 64-bit integers, which is exact"
    return f"the {applied.primitive.value}"


def _rounded(argument: Expression) -> Expression:
    is_double = argument.type.is_array or argument.type.scalar is Scalar.DOUBLE
    return argument if is_double else Apply(Primitive.TO_DOUBLE, (argument,))


def _unless(holds: bool, code: Code) -> Code:
    return code if holds else Prefix("not ", code)
