"""Conditions as decision diagrams, those of a specification and those of a machine alike: equal ones are one number.

The machine need not say them as the specification does. These are all the rewritings under which the two are the same:

- `a > b` is `b < a`. Of numbers, `a <= b` is `not b < a`; and, or, not, and equality of booleans as in logic.
- A comparison holds of no NaN. No number is more than infinity, or less than -infinity; each is equal to itself.
- A result is NaN where an operand is and, for some primitives, by itself: the table of functions says for which.
- Conversions that change no number are omitted: every number is a double, unless it may be an integer that no double
  equals.
- `x - c` is `x + (-c)` for a constant c, and `least(least(a, b), c)` is `least(a, b, c)`.
- Where what is read is an integer of so many bits by its type, `q < 2.5` is `q <= 2`, and what is true of all these
  integers, or of none, is a constant.

Nothing else is the same: numbers and texts bit for bit, operands and their order as they stand.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable
from dataclasses import replace

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
    makes_nan,
    parts,
)
from ltlc.program.functions import Primitive
from ltlc.program.types import DOUBLE, INTEGER, Scalar
from ltlc.semantics.diagrams import Diagram, Diagrams
from ltlc.specification.wire import Numbers, double_or_integer

P = Primitive


class DiffersError(Exception):
    """A machine does something else than it should; the message says what."""


class Truths:
    """Diagrams whose levels are what can be true or false of the values at a step.

    Levels are made until `close` is called; then a condition that asks anything else raises DiffersError.
    """

    def __init__(self, diagrams: Diagrams) -> None:
        self.diagrams = diagrams
        self.levels: dict[Hashable, int] = {}
        self._is_closed = False

    def close(self) -> None:
        """From now on nothing new is asked."""
        self._is_closed = True

    def asked(self, fact: Hashable) -> Diagram:
        """True where `fact` is."""
        if fact not in self.levels:
            if self._is_closed:
                raise DiffersError("that is not a condition of the property")
            self.levels[fact] = len(self.levels)
        return self.diagrams.variable(self.levels[fact])

    def some(self, diagrams: Iterable[Diagram]) -> Diagram:
        """True where at least one is."""
        found = self.diagrams.false
        for diagram in diagrams:
            found = self.diagrams.disjunction(found, diagram)
        return found

    def every(self, diagrams: Iterable[Diagram]) -> Diagram:
        """True where all are."""
        return self.diagrams.negation(self.some(map(self.diagrams.negation, diagrams)))

    def holds(self, expression: Expression) -> Diagram:
        """Where a Boolean expression is true."""
        return self._truth(self._plain(expression), within=False)

    def is_nan(self, expression: Expression) -> Diagram:
        """Where an expression is NaN. A number of elements is so nowhere: that is for the step to check."""
        return self._undefined(self._plain(expression), within=False)

    def _plain(self, expression: Expression) -> Expression:
        """The one form of what is the same; the guard of what is counted is a diagram."""
        match expression:
            case Literal(bool() | str()):
                return expression
            case Literal(value):
                exact = double_or_integer(value) if isinstance(value, int) else value
                return Literal(exact, DOUBLE if isinstance(exact, float) else INTEGER)
            case Held() | Recent() | Slope() | News() | Kept():
                return _number(expression)
            case Each(array):
                return _number(Each(self._plain(array)))
            case Slice(array):
                return replace(expression, array=self._plain(array))
            case Count(lists, guard, is_any):
                holds = Literal(self._truth(self._plain(guard), within=True), INTEGER)
                of_lists = (tuple(sorted({self._plain(array) for array in arrays}, key=repr)) for arrays in lists)
                found = Count(tuple(sorted(of_lists, key=repr)), holds, is_any=False)
                return Apply(P.AT_MOST, (Literal(1.0, DOUBLE), found)) if is_any else found
            case Apply(P.TO_SIGNED | P.TO_UNSIGNED, (integer,)):
                return self._plain(integer)
            case Apply(P.TO_DOUBLE, (number,)):
                plain = self._plain(number)
                return plain if plain.type == DOUBLE else Apply(P.TO_DOUBLE, (plain,))
            case Apply(primitive, arguments):
                return _applied(primitive, tuple(map(self._plain, arguments)))

    def _truth(self, plain: Expression, within: bool) -> Diagram:
        """Where it is true; `within` is the guard of what is counted."""
        diagrams = self.diagrams
        match plain:
            case Literal(bool(value)):
                return diagrams.terminal(value)
            case Apply(P.NOT, (operand,)):
                return diagrams.negation(self._truth(operand, within))
            case Apply(P.AND, operands):
                return self.every(self._truth(operand, within) for operand in operands)
            case Apply(P.OR, operands):
                return self.some(self._truth(operand, within) for operand in operands)
            case Apply(P.MEASURED, (operand,)):
                return diagrams.negation(self._undefined(operand, within))
            case Apply(P.SAME, (left, right)) if left.type.scalar is Scalar.BOOL:
                one, other = self._truth(left, within), self._truth(right, within)
                return diagrams.choose(one, other, diagrams.negation(other))
            case Apply(P.SAME, (left, right)):
                return self._equal(left, right)
            case Apply(P.LESS | P.AT_MOST | P.EQUAL as primitive, (left, right)):
                are_numbers = diagrams.negation(self.some(self._undefined(side, within) for side in (left, right)))
                if are_numbers == diagrams.false:
                    return are_numbers
                return diagrams.conjunction(are_numbers, self._compared(primitive, left, right))
            case _:
                return self.asked(("holds", plain))

    def _compared(self, primitive: Primitive, left: Expression, right: Expression) -> Diagram:
        """Of two that are not NaN."""
        if primitive is P.AT_MOST:
            return self.diagrams.negation(self._compared(P.LESS, right, left))
        for integer, constant in ((left, right), (right, left)):
            numbers = _integers(integer)
            if numbers is not None and isinstance(constant, Literal) and isinstance(constant.value, int | float):
                return self._bounded(primitive, integer, numbers, constant.value, is_above=integer is right)
        if primitive is P.EQUAL:
            return self._equal(left, right)
        if left == right or left == Literal(math.inf, DOUBLE) or right == Literal(-math.inf, DOUBLE):
            return self.diagrams.false
        return self.asked(("less", left, right))

    def _equal(self, left: Expression, right: Expression) -> Diagram:
        return self.diagrams.true if left == right else self.asked(("equal", frozenset({left, right})))

    def _bounded(
        self, primitive: Primitive, integer: Expression, numbers: Numbers, value: float, is_above: bool
    ) -> Diagram:
        """An integer is `value`, below it, or `is_above` it."""
        diagrams = self.diagrams
        if primitive is P.EQUAL:
            return self.asked(("is", integer, int(value))) if numbers.has(value) else diagrams.false
        if math.isinf(value):
            return diagrams.terminal((value > 0) != is_above)
        last = math.floor(value) if is_above else math.ceil(value) - 1
        if numbers.least <= last < numbers.most:
            at_most = self.asked(("at most", integer, last))
        else:
            at_most = diagrams.terminal(last >= numbers.most)
        return diagrams.negation(at_most) if is_above else at_most

    def _undefined(self, plain: Expression, within: bool) -> Diagram:
        """Where it is NaN. Within what is counted, what speaks of no element is not: that is checked before."""
        if within and not any(isinstance(part, Each) for part in parts(plain)):
            return self.diagrams.false
        match plain:
            case Literal(value):
                return self.diagrams.terminal(isinstance(value, float) and math.isnan(value))
            case Kept(signal, _, _, type_):
                return self._undefined(Held(signal, 0, type_), within)
            case Held() | Slope() | Each() if plain.type.is_number:
                return self.asked(("nan", plain))
            case Apply(_, arguments):
                found = self.some(self._undefined(part, within) for part in arguments if not part.type.is_array)
                return self.diagrams.disjunction(found, self.asked(("undefined", plain))) if makes_nan(plain) else found
            case _:
                return self.diagrams.false


def _number(read: Expression) -> Expression:
    """What is read: a number as a double, unless it may be an integer that no double equals."""
    is_double = not read.type.is_number or read.type == DOUBLE or read.type.scalar.is_wide
    return read if is_double else Apply(P.TO_DOUBLE, (read,))


def _applied(primitive: Primitive, arguments: tuple[Expression, ...]) -> Expression:
    match primitive, arguments:
        case P.SUBTRACT, (left, Literal(float(value))):
            return Apply(P.ADD, (left, Literal(-value, DOUBLE)))
        case ((P.LEAST | P.GREATEST), (Apply(inner, first), *rest)) if inner is primitive:
            return Apply(primitive, (*first, *rest))
        case _:
            return Apply(primitive, arguments)


def _integers(plain: Expression) -> Numbers | None:
    """Which integers it can be by the type of what is read; None if it may be something else."""
    match plain:
        case Apply(P.TO_DOUBLE, (number,)) if not number.type.scalar.is_wide:
            return _integers(number)
        case Held() | Kept() | Each() if not plain.type.is_array:
            return plain.type.scalar.integers
        case _:
            return None
