"""What the conditions of a specification say, in the language of step functions: what their text is compared with.

Written from the reference for values (`ltlc.specification.evaluation`), not from the code generator.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from typing import assert_never

from ltlc.assurance.lowered.language import NONE, Apply, Constant, Term
from ltlc.semantics import ltl
from ltlc.specification.evaluation import evaluate, is_true, number
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
    IsTrue,
    Negative,
    New,
    Number,
    Opening,
    Past,
    Read,
    Relation,
    Same,
    Slice,
    Slope,
    String,
    ValueType,
    inputs,
    operands,
)
from ltlc.specification.functions import Function
from ltlc.specification.numbers import numbers_of
from ltlc.specification.wire import Kind, as_double


@dataclass(frozen=True, slots=True)
class Given(Term):
    """What is read of a signal."""

    read: Read

    @property
    def is_number(self) -> bool:
        """Whether it is a number, which may be NaN."""
        return not isinstance(self.read, New) and self.read.signal.type is ValueType.NUMBER

    @property
    def is_wide(self) -> bool:
        """Whether it is, or consists of, integers that may be no doubles."""
        return not isinstance(self.read, New) and self.read.signal.numbers.is_wide


@dataclass(frozen=True, slots=True)
class ElementOf(Term):
    """An element of an array: in `Counted`, each one after the other."""

    array: Term


@dataclass(frozen=True, slots=True)
class Counted(Term):
    """At how many indexes of `arrays`, up to the end of the shortest, `guard` is true of the elements."""

    arrays: frozenset[Term]
    guard: Term


_FUNCTIONS = {
    Function.ABS: "abs",
    Function.MIN: "least",
    Function.MAX: "greatest",
    Function.SQRT: "square_root",
    Function.GAP: "gap",
    Function.NORM: "norm",
    Function.ROLL: "roll",
    Function.PITCH: "pitch",
    Function.YAW: "yaw",
    Function.ANGLE: "angle",
}
_OF_AN_ARRAY = {
    Function.MIN: "smallest",
    Function.MAX: "largest",
    Function.SUM: "sum_of",
    Function.MEDIAN: "median_of",
    Function.LEN: "length_of",
}


def value(expression: Expression) -> Term:
    """The value of an expression, as `evaluate` has it; what reads no signal is a literal."""
    if _is_constant(expression):
        found = evaluate(expression, {})
        if isinstance(found, tuple):
            raise TypeError(f"an array that is constant: {expression}")
        return Constant(found)
    assert not isinstance(expression, Number | Boolean | String)
    match expression:
        case Current() | Past() | Slope() | New() | Opening():
            return Given(expression)
        case Element(array):
            return ElementOf(value(array))
        case Slice(array, start, stop):
            return Apply("slice", (value(array), *(NONE if end is None else Constant(end) for end in (start, stop))))
        case Count():
            return _counted(expression)
        case Negative(operand):
            return Apply("negative", (value(operand),))
        case Arithmetic(operator, left, right):
            return Apply(operator.value, (double(left), double(right)))
        case Call(function, (array,)) if expression.array is not None:
            return Apply(_OF_AN_ARRAY[function], (value(array),))
        case Call(function, arguments):
            is_exact = function is Function.ABS or numbers_of(expression).kind is Kind.INTEGER
            return Apply(_FUNCTIONS[function], tuple(map(value if is_exact else double, arguments)))
        case _:
            assert_never(expression)


def double(expression: Expression) -> Term:
    """The double nearest to the value of an expression."""
    found = value(expression)
    if isinstance(found, Constant) and isinstance(found.value, int | float):
        return Constant(as_double(found.value))
    return Apply("double", (found,))


def truth(condition: Condition) -> Term:
    """That `condition` holds, as `is_true` has it; what reads no signal holds always or never."""
    if all(map(_is_constant, operands(condition))):
        return Constant(is_true(condition, {}))
    match condition:
        case IsTrue(operand):
            return value(operand)
        case Same(left, right):
            return _same(value(left), value(right))
        case Comparison(left, relation, right, margin) if margin == 0:
            return Apply(relation.value, (value(left), value(right)))
        case Comparison(left, Relation.EQUAL, right, margin):
            return _close(double(left), double(right), margin)
        case Comparison(left, relation, right, margin) if _is_constant(right):
            return Apply(relation.value, (double(left), Constant(number(right, {}) + margin)))
        case Comparison(left, relation, right, margin):
            return Apply(relation.value, (double(left), Apply("+", (double(right), Constant(margin)))))


def _same(left: Term, right: Term) -> Term:
    """Of two booleans, one of which is a literal, the other one or its negation."""
    for literal, other in ((left, right), (right, left)):
        if isinstance(literal, Constant) and isinstance(literal.value, bool):
            return other if literal.value else Apply("not", (other,))
    return Apply("==", (left, right))


def _close(left: Term, right: Term, margin: float) -> Term:
    """That the two differ by at most `margin`, or are the same; of 0, the other lies between `-margin` and `margin`."""
    for zero, other in ((left, right), (right, left)):
        if isinstance(zero, Constant) and zero.value == 0:
            least, most = Constant(-margin), Constant(margin)
            return Apply("and", (Apply("<=", (least, other)), Apply("<=", (other, most))))
    close = Apply("<=", (Apply("abs", (Apply("-", (left, right)),)), Constant(margin)))
    if any(
        isinstance(side, Constant) and isinstance(side.value, float) and isfinite(side.value) for side in (left, right)
    ):
        return close
    return Apply("or", (Apply("==", (left, right)), close))


def _counted(count: Count) -> Counted:
    """An element counts if nothing that is compared there is NaN, and the predicate holds."""
    conditions = dict(count.conditions)
    sides = dict.fromkeys(s for c in conditions.values() if isinstance(c, Comparison) for s in operands(c))
    measured = [Apply("measured", (value(side),)) for side in sides]
    holds = predicate(count.predicate, {name: truth(each) for name, each in conditions.items()})
    return Counted(frozenset(value(element.array) for element in count.elements), Apply("and", (*measured, holds)))


def predicate(formula: ltl.Formula, atoms: Mapping[str, Term]) -> Term:
    """That a state predicate over `atoms` holds."""
    match formula:
        case ltl.Truth():
            return Constant(True)
        case ltl.Atom(name):
            return atoms[name]
        case ltl.Not(operand):
            return Apply("not", (predicate(operand, atoms),))
        case ltl.And(left, right):
            return Apply("and", (predicate(left, atoms), predicate(right, atoms)))
        case ltl.Or(left, right):
            return Apply("or", (predicate(left, atoms), predicate(right, atoms)))
        case _:
            raise TypeError(f"not a state predicate: {formula!r}")


def _is_constant(expression: Expression) -> bool:
    return not any(True for _ in inputs(expression))
