"""Expressions and conditions of a specification as typed expressions: where types and conversions are decided.

A condition becomes a Boolean expression that is true exactly where it holds, wherever nothing that it compares is NaN:
what can be NaN though no sample is, `undefined_parts` lists, and whoever takes a step tests it first.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import assert_never

from ltlc.program.expressions import (
    Apply,
    Count,
    Each,
    Expression,
    Held,
    Kept,
    Literal,
    News,
    Read,
    Recent,
    Slice,
    Slope,
    is_finite,
    may_be_nan,
)
from ltlc.program.functions import Primitive, primitive_of
from ltlc.program.normal import flattened, settled
from ltlc.program.types import BOOL, DOUBLE, INTEGER, SINGLE, TEXT, kept_as, recent_of, type_of
from ltlc.semantics import ltl
from ltlc.specification import expressions as e
from ltlc.specification.evaluation import evaluate, is_true, number
from ltlc.specification.functions import Function
from ltlc.specification.numbers import can_be_nan, numbers_of
from ltlc.specification.wire import SINGLES, as_double

P = Primitive

_ARITHMETIC = {
    e.Operator.PLUS: P.ADD,
    e.Operator.MINUS: P.SUBTRACT,
    e.Operator.TIMES: P.TIMES,
    e.Operator.OVER: P.OVER,
}

_RELATIONS = {e.Relation.LESS: P.LESS, e.Relation.AT_MOST: P.AT_MOST, e.Relation.EQUAL: P.EQUAL}
_TYPES = {bool: BOOL, str: TEXT, int: INTEGER, float: DOUBLE}


def lowered(expression: e.Expression) -> Expression:
    """The value of `expression`, exactly; what reads no signal is a literal."""
    if is_constant(expression):
        return _literal(evaluate(expression, {}))
    assert not isinstance(expression, e.Number | e.Boolean | e.String)
    match expression:
        case e.Current() | e.Past() | e.Recent() | e.Slope() | e.New() | e.Opening():
            return read(expression)
        case e.Slice(array, start, stop):
            return Slice(lowered(array), start or None, stop)
        case e.Element(array):
            return Each(lowered(array))
        case e.Count():
            return _count(expression, is_any=False)
        case e.When(formula, conditions):  # of a signal, which has no sample where something in it is NaN
            return settled(predicate(formula, dict(conditions)), True)
        case e.Negative(operand):
            return Apply(P.NEGATE, (_signed(operand),))
        case e.Arithmetic(operator, left, right):
            return Apply(_ARITHMETIC[operator], (double(left), double(right)))
        case e.Call(function, (array,)) if expression.array is not None:
            return _called(function, (lowered(array),))
        case e.Call(Function.NEAREST, (sought, among)):
            return _called(Function.NEAREST, (double(sought), lowered(among)))
        case e.Call(Function.ABS, (operand,)):
            return _called(Function.ABS, (_signed(operand),))
        case e.Call(function, arguments):
            return _called(function, tuple(map(_integer if _is_exact(expression) else double, arguments)))
        case _:
            assert_never(expression)


def _called(function: Function, arguments: tuple[Expression, ...]) -> Expression:
    return Apply(primitive_of(function, tuple(argument.type for argument in arguments)), arguments)


def read(wanted: e.Read) -> Read:
    """What is read of a signal."""
    match wanted:
        case e.Current(signal):
            return Held(signal.name, 0, type_of(signal))
        case e.Past(signal, samples):
            return Held(signal.name, samples, type_of(signal))
        case e.Recent(signal, samples):
            return Recent(signal.name, samples, recent_of(signal))
        case e.Slope(signal):
            return Slope(signal.name)
        case e.New(signal):
            return News(signal.name)
        case e.Opening(signal, scope, label):
            return Kept(signal.name, scope, label, type_of(signal))
        case _:
            assert_never(wanted)


def first_value(signal: e.Signal) -> Literal | None:
    """What a signal is before its first sample, in the type in which it is kept; None if it has no value then."""
    if signal.otherwise is None:
        return None
    value, type_ = signal.otherwise.value, kept_as(signal)
    return Literal(int(value) if type_.scalar.is_integer else value, type_)


def double(expression: e.Expression) -> Expression:
    """The double nearest to the value of `expression`."""
    return _to_double(lowered(expression))


def _is_exact(expression: e.Call) -> bool:
    """Whether it is computed with integers of any size."""
    return expression.function in (Function.MIN, Function.MAX) and numbers_of(expression).is_wide


def _integer(expression: e.Expression) -> Expression:
    found = lowered(expression)
    return Literal(int(found.value), INTEGER) if isinstance(found, Literal) else found


def _signed(expression: e.Expression) -> Expression:
    """What `-` and `abs` are applied to: doubles, binary32 and wide integers, so that no result leaves its type."""
    found = lowered(expression)
    return found if found.type.scalar.is_wide or found.type == SINGLE else _to_double(found)


def _to_double(found: Expression) -> Expression:
    if isinstance(found, Literal):
        assert isinstance(found.value, int | float)
        return Literal(as_double(found.value), DOUBLE)
    return found if found.type == DOUBLE else Apply(P.TO_DOUBLE, (found,))


def _literal(value: object) -> Literal:
    assert isinstance(value, bool | int | float | str)
    return Literal(value, _TYPES[type(value)])


def condition(what: e.Condition) -> Expression:
    """That a condition holds; what reads no signal holds always or never."""
    if all(map(is_constant, e.operands(what))):
        return Literal(is_true(what, {}), BOOL)
    match what:
        case e.IsTrue(operand):
            return lowered(operand)
        case e.Same(operand, e.Boolean(value)) | e.Same(e.Boolean(value), operand):
            return lowered(operand) if value else negation(lowered(operand))
        case e.Same(left, right) if left == right:
            return Literal(True, BOOL)
        case e.Same(left, right):
            return Apply(P.SAME, (lowered(left), lowered(right)))
        case e.Comparison(e.Count() as count, e.Relation.AT_LEAST, e.Number(1.0), 0.0):
            return _count(count, is_any=True)
        case e.Comparison(e.Count() as count, e.Relation.LESS, e.Number(1.0), 0.0):
            return negation(_count(count, is_any=True))
        case e.Comparison(left, e.Relation.EQUAL, right, margin) if margin != 0:
            return _close(double(left), double(right), margin)
        case e.Comparison(left, relation, right, margin) if margin != 0:
            return compared(double(left), relation, _shifted(right, margin))
        case e.Comparison(left, relation, right):
            return compared(lowered(left), relation, lowered(right))
        case _:
            assert_never(what)


def sides(what: e.Condition) -> tuple[Expression, ...]:
    """What a condition compares, margins of orderings included.

    A boolean alone is not compared, nor is whether there is an element, or a point in a zone.
    """
    match what:
        case e.IsTrue() | e.Comparison(e.Call(Function.INSIDE)):
            return ()
        case e.Comparison(e.Count(), e.Relation.AT_LEAST | e.Relation.LESS, e.Number(1.0), 0.0):
            return ()
        case e.Comparison(left, relation, right, margin) if margin != 0 and relation is not e.Relation.EQUAL:
            return double(left), _shifted(right, margin)
        case _:
            return tuple(map(lowered, e.operands(what)))


def _shifted(right: e.Expression, margin: float) -> Expression:
    if is_constant(right):
        return Literal(number(right, {}) + margin, DOUBLE)
    return Apply(P.ADD if margin > 0 else P.SUBTRACT, (double(right), Literal(abs(margin), DOUBLE)))


def _close(left: Expression, right: Expression, margin: float) -> Expression:
    """The sides differ by at most `margin`, or are the same, be it infinite."""
    for zero, other in ((left, right), (right, left)):
        if isinstance(zero, Literal) and zero.value == 0:
            least, most = Literal(-margin, DOUBLE), Literal(margin, DOUBLE)
            return Apply(P.AND, (Apply(P.AT_MOST, (least, other)), Apply(P.AT_MOST, (other, most))))
    difference = Apply(P.ABS, (Apply(P.SUBTRACT, (left, right)),))
    close = Apply(P.AT_MOST, (difference, Literal(margin, DOUBLE)))
    if is_finite(left) or is_finite(right):
        return close
    return Apply(P.OR, (Apply(P.EQUAL, (left, right)), close))


def compared(left: Expression, relation: e.Relation, right: Expression) -> Expression:
    """`left relation right`, exactly, in a type that has both sides or by a primitive that takes both."""
    if relation not in _RELATIONS:
        left, relation, right = right, relation.flipped, left
    primitive = _RELATIONS[relation]
    for literal, other in ((left, right), (right, left)):
        if isinstance(literal, Literal):
            return _with_literal(primitive, literal, other, is_left=literal is left)
    if left == right and left.type.scalar.is_integer:
        return Literal(primitive is not P.LESS, BOOL)
    return Apply(primitive, _alike(left, right))


def _with_literal(primitive: Primitive, literal: Literal, other: Expression, is_left: bool) -> Expression:
    """A comparison with a constant, which is made one of the other side's type; decided if it has none like it."""
    assert isinstance(literal.value, int | float)
    numbers, value = other.type.scalar.integers, literal.value
    if numbers is None:
        return _in_order(primitive, _fitting(value, other), other, is_left)
    if primitive is not P.EQUAL and value == (numbers.least if (primitive is P.LESS) != is_left else numbers.most):
        return Literal(primitive is P.AT_MOST, BOOL)  # of which C compilers warn
    if numbers.has(value):
        return _in_order(primitive, Literal(int(value), other.type), other, is_left)
    if primitive is P.EQUAL or math.isnan(value):
        return Literal(False, BOOL)
    if value < numbers.least or value > numbers.most:
        return Literal((value < numbers.least) == is_left, BOOL)
    return _in_order(P.AT_MOST, Literal((math.ceil if is_left else math.floor)(value), other.type), other, is_left)


def _fitting(value: float, other: Expression) -> Literal:
    """A constant beside what is no field of integers: as exact as that."""
    if other.type == INTEGER:
        return _literal(value)
    is_single = other.type == SINGLE and math.isfinite(value) and SINGLES.nearest(value) == value
    return Literal(as_double(value), SINGLE if is_single else DOUBLE)


def _in_order(primitive: Primitive, literal: Literal, other: Expression, is_left: bool) -> Expression:
    if other.type == SINGLE and literal.type == DOUBLE:
        other = _to_double(other)
    return Apply(primitive, (literal, other) if is_left else (other, literal))


def _alike(left: Expression, right: Expression) -> tuple[Expression, Expression]:
    """Both sides in one type; a wide integer beside another number as it is, the other one as far as it goes."""
    types = (left.type, right.type)
    if not any(t.scalar.is_wide for t in types):
        is_exact = left.type == right.type and left.type in (SINGLE, DOUBLE)
        return (left, right) if is_exact else (_to_double(left), _to_double(right))
    if INTEGER in types:
        return left, right
    is_unsigned = all(t.scalar.is_unsigned for t in types)
    return _widened(left, is_unsigned), _widened(right, is_unsigned)


def _widened(side: Expression, is_unsigned: bool) -> Expression:
    if side.type.scalar.is_wide:
        return side
    if not side.type.scalar.is_integer:
        return _to_double(side)
    return Apply(P.TO_UNSIGNED if is_unsigned else P.TO_SIGNED, (side,))


def _count(count: e.Count, is_any: bool) -> Expression:
    """The guard says what must not be NaN: each comparison that does not itself make it false there."""
    conditions = dict(count.conditions)
    compared_sides = (s for c in conditions.values() if isinstance(c, e.Comparison) for s in e.operands(c))
    asked = (
        s
        for s in dict.fromkeys(compared_sides)
        if s not in count.singles and not excludes_nan(count.predicate, conditions, s)
    )
    measured = [Apply(P.MEASURED, (lowered(side),)) for side in asked]
    guard = joined(P.AND, [*reversed(measured), predicate(count.predicate, conditions)])
    lists = (dict.fromkeys(lowered(element.array) for element in elements) for elements in count.lists)
    return Count(tuple(map(tuple, lists)), guard, is_any)


def has_sample(signal: e.Signal) -> Expression:
    """That a computed signal has a sample where a part of it has: always, if that does not depend on a predicate.

    In it, orderings are not negated: of what is not NaN, the opposite one holds.
    """
    assert not isinstance(signal.definition, e.Field)
    if signal.when is None:
        return Literal(True, BOOL)
    conditions = dict(signal.when.conditions)
    compared_parts = dict.fromkeys(part for each in conditions.values() for part in measured_parts(each))
    asked = [
        part
        for part in compared_parts
        if not is_constant(part) and not excludes_nan(signal.when.predicate, conditions, part)
    ]
    measured = [Apply(P.MEASURED, (found,)) for found in map(lowered, (signal.definition, *asked)) if _has_nan(found)]
    holds = [] if signal.when.predicate == ltl.TRUE else [predicate(signal.when.predicate, conditions)]
    return settled(joined(P.AND, [*measured, *holds]), True) if measured or holds else Literal(True, BOOL)


def _has_nan(expression: Expression) -> bool:
    """Whether there is a NaN among the values of its type."""
    return expression.type.is_number and not expression.type.scalar.is_integer


def excludes_nan(formula: ltl.Formula, conditions: Mapping[str, e.Condition], side: e.Expression) -> bool:
    """Whether `formula` is false where `side` is NaN: no comparison holds of NaN, but its negation does."""
    match formula:
        case ltl.Atom(name):
            return side in e.operands(conditions[name])
        case ltl.And(left, right):
            return any(excludes_nan(part, conditions, side) for part in (left, right))
        case ltl.Or(left, right):
            return all(excludes_nan(part, conditions, side) for part in (left, right))
        case _:
            return False


def predicate(formula: ltl.Formula, conditions: Mapping[str, e.Condition]) -> Expression:
    """That the state predicate `formula` holds, whose atoms stand for `conditions`."""
    match formula:
        case ltl.Truth():
            return Literal(True, BOOL)
        case ltl.Atom(name):
            return condition(conditions[name])
        case ltl.Not(operand):
            return negation(predicate(operand, conditions))
        case ltl.And(left, right):
            return joined(P.AND, [predicate(left, conditions), predicate(right, conditions)])
        case ltl.Or(left, right):
            return joined(P.OR, [predicate(left, conditions), predicate(right, conditions)])
        case _:
            raise TypeError(f"not a state predicate: {formula}")


def negation(found: Expression) -> Expression:
    """That a Boolean expression is false."""
    match found:
        case Apply(Primitive.NOT, (inner,)):
            return inner
        case Literal(bool(value), _):
            return Literal(not value, BOOL)
        case _:
            return Apply(P.NOT, (found,))


def joined(primitive: Primitive, operands: Sequence[Expression]) -> Expression:
    """The conjunction or disjunction, flat."""
    flat = tuple(flattened(primitive, operands))
    return flat[0] if len(flat) == 1 else Apply(primitive, flat)


def is_constant(expression: e.Expression) -> bool:
    """Whether `expression` reads no signal."""
    return not any(True for _ in e.inputs(expression))


def undefined_parts(what: e.Condition) -> Iterator[e.Expression]:
    """What can be NaN where no sample is, and makes a step invalid that asks for the condition."""
    return (part for part in measured_parts(what) if may_be_nan(lowered(part)))


def measured_parts(what: e.Condition) -> Iterator[e.Expression]:
    """What must not be NaN at a step that asks for the condition: all that it compares; of a count, what is single.

    And of samples as an array, each.
    """
    for operand in e.operands(what):
        recent = (part for part in e.subexpressions(operand) if isinstance(part, e.Recent))
        yield from (e.Call(Function.COMPLETE, (part,)) for part in recent if can_be_nan(part.signal))
        counts = (part for part in e.subexpressions(operand) if isinstance(part, e.Count))
        yield from (single for count in counts for single in count.singles)
        if not isinstance(operand, e.Count):
            yield operand
