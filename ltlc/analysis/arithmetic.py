"""Conditions as z3 understands them: real numbers for doubles, and what is known of norms, angles and roots.

Numbers are those that the author wrote, `0.1` being a tenth. What has no exact counterpart, such as a yaw, is a
variable of its own within its bounds: then more letters seem possible than are, never fewer.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterator, Sequence
from fractions import Fraction
from typing import Any

import z3  # noqa: TID251

from ltlc.analysis.bounds import bounds
from ltlc.analysis.groups import definition_inputs, key, type_of
from ltlc.specification.atoms import Comparison, Condition, IsTrue, Relation, Same
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import (
    Arithmetic,
    Boolean,
    Call,
    Current,
    Expression,
    Field,
    Function,
    Input,
    Negative,
    New,
    Number,
    Operator,
    Past,
    Signal,
    Slope,
    String,
    ValueType,
)

Term = Any
"""A term of z3's."""

_SORTS: dict[ValueType, Callable[[str], Term]] = {
    ValueType.NUMBER: z3.Real,
    ValueType.BOOLEAN: z3.Bool,
    ValueType.STRING: z3.Int,
}


class Translator:
    """Conditions at the step with the number `step` as terms; `facts` hold of their variables whatever the run.

    If `linked`, every step is a sample of every signal: `@{x, -1}` is x at the step before.
    """

    def __init__(
        self, related: frozenset[Hashable] = frozenset(), linked: bool = False, exact_norms: bool = False
    ) -> None:
        """`related` are the values whose connection with a signal that is computed from them matters.

        Unless `exact_norms`, of a norm only the linear bounds are known: between the largest component and their sum.
        """
        self.facts: list[Term] = []
        self.step = 0
        self._related = related
        self._linked = linked
        self._exact_norms = exact_norms
        self._exact_norms = exact_norms
        self._variables: dict[Hashable, Term] = {}
        self._strings: dict[str, int] = {}

    def condition(self, condition: Condition) -> Term:
        """The term that is true where `condition` holds."""
        match condition:
            case IsTrue(operand):
                return self._plain(operand)
            case Same(left, right):
                return self._plain(left) == self._plain(right)
            case Comparison(left, relation, right, margin):
                return _compare(self.number(left), relation, self.number(right), margin)

    def value(self, model: Any, wanted: Input) -> Value:
        """The value of `wanted` in a model of the terms."""
        if type_of(wanted) is ValueType.NUMBERS:
            folds = (self._variables.get((function, self._name(wanted))) for function in (Function.MIN, Function.MAX))
            ends = [to_float(model, fold) for fold in folds if fold is not None]
            return tuple(ends or [0.0])
        variable = self._input(wanted)
        if type_of(wanted) is ValueType.BOOLEAN:
            return bool(z3.is_true(model.eval(variable, model_completion=True)))
        if type_of(wanted) is ValueType.STRING:
            number = model.eval(variable, model_completion=True).as_long()
            return next((text for text, code in self._strings.items() if code == number), "other")
        return to_float(model, variable)

    @property
    def numbers(self) -> list[Term]:
        """The variables that are numbers."""
        return [variable for variable in self._variables.values() if z3.is_real(variable)]

    def number(self, expression: Expression) -> Term:
        """The term of an expression that is a number."""
        match expression:
            case Number(value) if math.isfinite(value):
                return real(value)
            case Current() | Past() | Slope() | New():
                return self._input(expression)
            case Negative(operand):
                return -self.number(operand)
            case Arithmetic(operator, left, right):
                return self._arithmetic(operator, self.number(left), self.number(right))
            case Call(Function.MIN | Function.MAX as function, (Current() | Past() as array,)):
                return self._fold(function, array)
            case Call(function, arguments):
                return self._call(expression, function, [self.number(argument) for argument in arguments])
        return self._fresh(expression)

    def _plain(self, expression: Expression) -> Term:
        """The term of a boolean or a string; strings are numbered."""
        match expression:
            case Boolean(value):
                return z3.BoolVal(value)
            case String(value):
                return z3.IntVal(self._strings.setdefault(value, len(self._strings)))
            case Current() | Past() | Slope() | New():
                return self._input(expression)
        raise TypeError(f"not a boolean or a string: {expression!r}")

    def _name(self, value: Input) -> Hashable:
        """Which variable `value` is; values with the same name are the same number."""
        if not self._linked or isinstance(value, Slope | New):
            return key(value), self.step
        samples = value.samples if isinstance(value, Past) else 0
        return value.signal.definition, self.step - samples

    def _input(self, value: Input) -> Term:
        name = self._name(value)
        if name not in self._variables:
            self._variables[name] = _SORTS[type_of(value)](f"v{len(self._variables)}")
            if type_of(value) is ValueType.NUMBER:
                self._bound(self._variables[name], value)
                if isinstance(value, Current):
                    self._define(self._variables[name], value.signal)
        return self._variables[name]

    def _define(self, variable: Term, signal: Signal) -> None:
        """State what `signal` is computed from, if that is spoken of as well."""
        if isinstance(signal.definition, Field):
            return
        if any(key(part) in self._related for part in definition_inputs(signal)):
            self.facts.append(variable == self.number(signal.definition))

    def _bound(self, variable: Term, expression: Expression) -> None:
        interval = bounds(expression)
        if math.isfinite(interval.low):
            self.facts.append(variable >= real(interval.low))
        if math.isfinite(interval.high):
            self.facts.append(variable <= real(interval.high))

    def _fresh(self, expression: Expression, name: Hashable = None) -> Term:
        """The variable of an expression of which only the bounds are known."""
        name = name or (expression, self.step)
        if name not in self._variables:
            self._variables[name] = z3.Real(f"v{len(self._variables)}")
            self._bound(self._variables[name], expression)
        return self._variables[name]

    def _fold(self, function: Function, array: Current | Past) -> Term:
        """The smallest or largest element of an array."""
        smallest = self._fresh(array, (Function.MIN, self._name(array)))
        if function is Function.MIN:
            return smallest
        largest = self._fresh(array, (Function.MAX, self._name(array)))
        self.facts.append(smallest <= largest)
        return largest

    def _arithmetic(self, operator: Operator, left: Term, right: Term) -> Term:
        match operator:
            case Operator.PLUS:
                return left + right
            case Operator.MINUS:
                return left - right
            case Operator.TIMES:
                return left * right
            case Operator.OVER:
                return left / right

    def _call(self, expression: Expression, function: Function, arguments: list[Term]) -> Term:
        match function:
            case Function.ABS:
                return _absolute(arguments[0])
            case Function.MIN:
                return _fold_terms(lambda a, b: z3.If(a <= b, a, b), arguments)
            case Function.MAX:
                return _fold_terms(lambda a, b: z3.If(a >= b, a, b), arguments)
        result = self._fresh(expression)
        if function is Function.SQRT:
            # A negative argument makes no step for this property, but does for others.
            self.facts.append(z3.Implies(arguments[0] >= 0, result * result == arguments[0]))
        if function is Function.NORM:
            self.facts.extend(self._norm(result, arguments))
        return result

    def _norm(self, norm: Term, components: Sequence[Term]) -> Iterator[Term]:
        """What is known of a norm."""
        if self._exact_norms:
            yield norm * norm == z3.Sum([component * component for component in components])
        for component in components:
            yield norm >= _absolute(component)
        yield norm <= z3.Sum([_absolute(component) for component in components])


def _absolute(term: Term) -> Term:
    return z3.If(term >= 0, term, -term)


def real(value: float) -> Term:
    """The number that `value` is written as."""
    return z3.RealVal(repr(value))


def _compare(left: Term, relation: Relation, right: Term, margin: float) -> Term:
    match relation:
        case Relation.EQUAL if margin == 0:
            return left == right
        case Relation.EQUAL:
            return z3.And(left - right <= real(margin), right - left <= real(margin))
        case Relation.LESS:
            return left < right + real(margin)
        case Relation.AT_MOST:
            return left <= right + real(margin)
        case Relation.GREATER:
            return left > right + real(margin)
        case Relation.AT_LEAST:
            return left >= right + real(margin)


def _fold_terms(function: Callable[[Term, Term], Term], terms: Sequence[Term]) -> Term:
    result = terms[0]
    for term in terms[1:]:
        result = function(result, term)
    return result


def to_float(model: Any, term: Term) -> float:
    """The value of `term` in `model` as a double."""
    value = model.eval(term, model_completion=True)
    if z3.is_algebraic_value(value):
        value = value.approx(20)
    return float(Fraction(value.numerator_as_long(), value.denominator_as_long()))
