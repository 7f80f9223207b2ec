"""The meaning of a specification's conditions as typed expressions, to be compared with those of its machine.

Written from the reference for values (`ltlc.specification.evaluation`), not from the lowering, and in no normal form:
what is the same though it is written otherwise, `lowered.truths` says.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import assert_never

from ltlc.program import expressions as x
from ltlc.program.functions import Primitive, primitive_of
from ltlc.program.types import BOOL, DOUBLE, INTEGER, TEXT, Scalar, recent_of, type_of
from ltlc.semantics import ltl
from ltlc.specification import expressions as e
from ltlc.specification.evaluation import evaluate, is_true
from ltlc.specification.functions import Function
from ltlc.specification.numbers import numbers_of
from ltlc.specification.wire import as_double

P = Primitive

_OPERATORS = {e.Operator.PLUS: P.ADD, e.Operator.MINUS: P.SUBTRACT, e.Operator.TIMES: P.TIMES, e.Operator.OVER: P.OVER}
_RELATIONS = {e.Relation.LESS: P.LESS, e.Relation.AT_MOST: P.AT_MOST, e.Relation.EQUAL: P.EQUAL}
_TYPES = {bool: BOOL, str: TEXT, int: INTEGER, float: DOUBLE}


def said(wanted: e.Read) -> x.Read:
    """What is read of a signal, as machines have it."""
    signal = wanted.signal
    match wanted:
        case e.Current():
            return x.Held(signal.name, 0, type_of(signal))
        case e.Past(_, samples):
            return x.Held(signal.name, samples, type_of(signal))
        case e.Recent(_, samples):
            return x.Recent(signal.name, samples, recent_of(signal))
        case e.Slope():
            return x.Slope(signal.name)
        case e.New():
            return x.News(signal.name)
        case e.Opening(_, scope, label):
            return x.Kept(signal.name, scope, label, type_of(signal))
        case _:
            assert_never(wanted)


def value(expression: e.Expression) -> x.Expression:
    """The value of an expression, as `evaluate` has it; what reads no signal is a literal."""
    if _is_constant(expression):
        found = evaluate(expression, {})
        assert not isinstance(found, tuple)
        return x.Literal(found, _TYPES[type(found)])
    assert not isinstance(expression, e.Number | e.Boolean | e.String)
    match expression:
        case e.Current() | e.Past() | e.Recent() | e.Slope() | e.New() | e.Opening():
            return said(expression)
        case e.Element(array):
            return x.Each(value(array))
        case e.Slice(array, start, stop):
            return x.Slice(value(array), start or None, stop)
        case e.Count():
            return _counted(expression)
        case e.When(formula, conditions):
            return _predicate(formula, dict(conditions))
        case e.Negative(operand):
            return x.Apply(P.NEGATE, (_exact(operand),))
        case e.Arithmetic(operator, left, right):
            return x.Apply(_OPERATORS[operator], (_double(left), _double(right)))
        case e.Call(function, (array,)) if expression.array is not None:
            return _called(function, value(array))
        case e.Call(Function.NEAREST, (sought, among)):
            return _called(Function.NEAREST, _double(sought), value(among))
        case e.Call(function, arguments):
            is_exact = numbers_of(expression).is_wide
            return _called(function, *map(_exact if is_exact else _double, arguments))
        case _:
            assert_never(expression)


def _called(function: Function, *arguments: x.Expression) -> x.Expression:
    return x.Apply(primitive_of(function, tuple(argument.type for argument in arguments)), arguments)


def _double(expression: e.Expression) -> x.Expression:
    """The double nearest to the value of an expression."""
    found = value(expression)
    if isinstance(found, x.Literal):
        assert not isinstance(found.value, str)
        return x.Literal(as_double(found.value), DOUBLE)
    return found if found.type == DOUBLE else x.Apply(P.TO_DOUBLE, (found,))


def _exact(expression: e.Expression) -> x.Expression:
    """The value of an expression that is a number: as a double, unless it may be an integer that no double equals."""
    found = value(expression)
    return found if found.type.scalar.is_wide else _double(expression)


def truth(condition: e.Condition) -> x.Expression:
    """That `condition` holds, as `is_true` has it; what reads no signal holds always or never."""
    if all(map(_is_constant, e.operands(condition))):
        return x.Literal(is_true(condition, {}), BOOL)
    match condition:
        case e.IsTrue(operand):
            return value(operand)
        case e.Same(left, right):
            return x.Apply(P.SAME, (value(left), value(right)))
        case e.Comparison(left, relation, right, margin) if margin == 0:
            return _compared(_exact(left), relation, _exact(right))
        case e.Comparison(left, e.Relation.EQUAL, right, margin):
            return _close(_double(left), _double(right), margin)
        case e.Comparison(left, relation, right, margin):
            shifted = e.Arithmetic(e.Operator.PLUS, right, e.Number(margin))
            return _compared(_double(left), relation, value(shifted))
        case _:
            assert_never(condition)


def _compared(left: x.Expression, relation: e.Relation, right: x.Expression) -> x.Expression:
    if relation not in _RELATIONS:
        left, relation, right = right, relation.flipped, left
    return x.Apply(_RELATIONS[relation], (left, right))


def _close(left: x.Expression, right: x.Expression, margin: float) -> x.Expression:
    """That the two differ by at most `margin`, or are the same; of 0, the other lies between `-margin` and `margin`."""
    for zero, other in ((left, right), (right, left)):
        if isinstance(zero, x.Literal) and zero.value == 0:
            least, most = x.Literal(-margin, DOUBLE), x.Literal(margin, DOUBLE)
            return x.Apply(P.AND, (x.Apply(P.AT_MOST, (least, other)), x.Apply(P.AT_MOST, (other, most))))
    apart = x.Apply(P.ABS, (x.Apply(P.SUBTRACT, (left, right)),))
    close = x.Apply(P.AT_MOST, (apart, x.Literal(margin, DOUBLE)))
    if x.is_finite(left) or x.is_finite(right):
        return close
    return x.Apply(P.OR, (x.Apply(P.EQUAL, (left, right)), close))


def compared(condition: e.Condition) -> Iterator[x.Expression]:
    """What must not be NaN where `condition` is asked: what it compares and, where that is counted, is no element.

    And among samples as an array.
    """
    for side in e.operands(condition):
        counts = (part for part in e.subexpressions(side) if isinstance(part, e.Count))
        yield from map(value, (side, *(single for count in counts for single in count.singles)))
        recent = (said(part) for part in e.subexpressions(side) if isinstance(part, e.Recent))
        measured = (part for part in recent if part.type.scalar in (Scalar.SINGLE, Scalar.DOUBLE))
        yield from (x.Apply(P.COMPLETE, (part,)) for part in measured)


def _counted(count: e.Count) -> x.Count:
    """An element counts if nothing that is compared there is NaN, and the predicate holds."""
    conditions = dict(count.conditions)
    sides = dict.fromkeys(s for c in conditions.values() if isinstance(c, e.Comparison) for s in e.operands(c))
    measured = [x.Apply(P.MEASURED, (value(side),)) for side in sides]
    guard = x.Apply(P.AND, (*measured, _predicate(count.predicate, conditions)))
    lists = tuple(tuple(value(element.array) for element in elements) for elements in count.lists)
    return x.Count(lists, guard, is_any=False)


def _predicate(formula: ltl.Formula, conditions: Mapping[str, e.Condition]) -> x.Expression:
    """That a state predicate over `conditions` holds."""
    match formula:
        case ltl.Truth():
            return x.Literal(True, BOOL)
        case ltl.Atom(name):
            return truth(conditions[name])
        case ltl.Not(operand):
            return x.Apply(P.NOT, (_predicate(operand, conditions),))
        case ltl.And(left, right):
            return x.Apply(P.AND, (_predicate(left, conditions), _predicate(right, conditions)))
        case ltl.Or(left, right):
            return x.Apply(P.OR, (_predicate(left, conditions), _predicate(right, conditions)))
        case _:
            raise TypeError(f"not a state predicate: {formula!r}")


def _is_constant(expression: e.Expression) -> bool:
    return not any(True for _ in e.inputs(expression))
