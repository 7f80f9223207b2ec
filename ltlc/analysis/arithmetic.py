"""Conditions as z3 understands them: real numbers for doubles, and what is known of norms, angles and roots.

Numbers are those that the author wrote, `0.1` being a tenth. What has no exact counterpart, such as a yaw, is a
variable of its own within its bounds: then more letters seem possible than are, never fewer.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from itertools import pairwise
from typing import Any

import z3  # noqa: TID251

from ltlc.analysis.bounds import bounds
from ltlc.analysis.elements import Elements, are_plain
from ltlc.analysis.groups import definition_inputs, key, source
from ltlc.analysis.zones import OF_ZONES, zone_facts
from ltlc.specification.evaluation import Single, Value
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
    Field,
    IsTrue,
    Negative,
    New,
    Number,
    Opening,
    Operator,
    Past,
    Read,
    Recent,
    Relation,
    Same,
    Signal,
    Slice,
    Slope,
    String,
    ValueType,
    inputs,
    value_type,
)
from ltlc.specification.functions import Function
from ltlc.specification.numbers import numbers_of
from ltlc.specification.wire import Kind

Term = Any
"""A term of z3's."""

ENDS = (Function.MIN, Function.MAX)
"""The functions that give an element of an array."""

ORDERED = (Function.MIN, Function.MEDIAN, Function.MAX)
"""The functions that have no value of an array without elements that are measured."""

_SORTS: dict[ValueType, Callable[[str], Term]] = {
    ValueType.NUMBER: z3.Real,
    ValueType.BOOLEAN: z3.Bool,
    ValueType.STRING: z3.Int,
}
"""The terms for single values; arrays are treated by their elements."""


Taken = Mapping[tuple[Opening, int], int]
"""At which step the value at an opening was taken that is read at a step."""


class Translator:
    """Conditions at the step with the number `step` as terms; `facts` hold of their variables whatever the run.

    If `linked`, every step is a sample of every signal: `@{x, -1}` is x at the step before. `taken` says at which step
    the value at an opening that is read at a step was taken; where it does not, that is any value.
    """

    def __init__(
        self,
        related: frozenset[Hashable] = frozenset(),
        linked: bool = False,
        exact_norms: bool = False,
        taken: Taken | None = None,
        knows_zones: bool = False,
    ) -> None:
        """`related` are the values whose connection with a signal that is computed from them matters.

        Unless `exact_norms`, of a norm only the linear bounds are known: between the largest component and their sum;
        of a distance from a zone, only where it is 0. Unless it `knows_zones`, neither that nor where a point is.
        """
        self._facts: list[Term] = []
        self.step = 0
        self._related = related
        self._linked = linked
        self._exact_norms = exact_norms
        self._knows_zones = knows_zones
        self._taken = taken or {}
        self._folds: dict[Hashable, dict[Function, Term]] = {}
        self._elements: dict[Hashable, Elements] = {}
        self._lengths: dict[Hashable, int] = {}
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
                compared = _compare(self.number(left), relation, self.number(right), margin)
                if isinstance(left, Call) and left.array and left.function in ENDS and isinstance(right, Number):
                    elements = self._side_by_side((Element(left.array),))
                    elements.compare(left.function, relation, right, margin, compared)
                return compared

    def facts(self) -> list[Term]:
        """What holds of the variables of the conditions so far, whatever the run."""
        of_elements = [fact for found in self._elements.values() for fact in found.facts()]
        return [*self._facts, *of_elements, *self._of_ends(), *self._of_lengths()]

    def value(self, model: Any, wanted: Read) -> Value:
        """The value of `wanted` in a model of the terms."""
        if isinstance(wanted, Current | Past | Recent | Opening) and value_type(wanted).element is not None:
            return self._array_value(model, wanted)
        variable = self._input(wanted)
        if value_type(wanted) is ValueType.BOOLEAN:
            return bool(z3.is_true(model.eval(variable, model_completion=True)))
        if value_type(wanted) is ValueType.STRING:
            number = model.eval(variable, model_completion=True).as_long()
            return next((text for text, code in self._strings.items() if code == number), "other")
        return numbers_of(wanted).nearest(to_float(model, variable))

    @property
    def numbers(self) -> list[Term]:
        """The variables that are numbers."""
        return [variable for variable in self._variables.values() if z3.is_real(variable)]

    def number(self, expression: Expression) -> Term:
        """The term of an expression that is a number."""
        match expression:
            case Number(value) if math.isfinite(value):
                return real(value)
            case Current() | Past() | Recent() | Slope() | New() | Opening():
                return self._input(expression)
            case Negative(operand):
                return -self.number(operand)
            case Arithmetic(sign, left, right):
                return _CALCULATED[sign](self.number(left), self.number(right))
            case Count():
                alone = None if are_plain(expression) else expression
                return self._side_by_side(expression.elements, alone).count(expression)
            case Call(function, (array,)) if expression.array is not None:
                return self._fold(function, array)
            case Call(Function.NEAREST):
                return self._fresh(expression)
            case Call(function, arguments):
                return self._call(expression, function, [self.number(argument) for argument in arguments])
            case _:
                return self._fresh(expression)

    def _plain(self, expression: Expression) -> Term:
        """The term of a boolean or a string; strings are numbered."""
        match expression:
            case Boolean(value):
                return z3.BoolVal(value)
            case String(value):
                return z3.IntVal(self._strings.setdefault(value, len(self._strings)))
            case Current() | Past() | Recent() | Slope() | New() | Opening():
                return self._input(expression)
            case _:
                raise TypeError(f"not a boolean or a string: {expression!r}")

    def _name(self, value: Read) -> Hashable:
        """Which variable `value` is; values with the same name are the same number."""
        if isinstance(value, Opening) and (value, self.step) in self._taken:
            return self._named(Current(value.signal), self._taken[value, self.step])
        return self._named(value, self.step)

    def _named(self, value: Read, step: int) -> Hashable:
        if not self._linked or isinstance(value, Recent | Slope | New | Opening):
            return key(value), step
        samples = value.samples if isinstance(value, Past) else 0
        return source(value.signal), step - samples

    def _input(self, value: Read) -> Term:
        name = self._name(value)
        if name not in self._variables:
            self._variables[name] = _SORTS[value_type(value)](f"v{len(self._variables)}")
            if value_type(value) is ValueType.NUMBER:
                self._bound(self._variables[name], value)
                if numbers_of(value).kind is Kind.INTEGER:
                    self._facts.append(z3.IsInt(self._variables[name]))
                if isinstance(value, Current):
                    self._define(self._variables[name], value.signal)
        return self._variables[name]

    def _define(self, variable: Term, signal: Signal) -> None:
        """State what `signal`, a number, is computed from, if that has a term, too."""
        if isinstance(signal.definition, Field) or signal.is_taken:
            return
        if any(key(part) in self._related for part in definition_inputs(signal)):
            self._facts.append(variable == self.number(signal.definition))

    def _bound(self, variable: Term, expression: Expression) -> None:
        interval = bounds(expression)
        if math.isfinite(interval.low):
            self._facts.append(variable >= real(interval.low))
        if math.isfinite(interval.high):
            self._facts.append(variable <= real(interval.high))

    def _fresh(self, expression: Expression, name: Hashable = None) -> Term:
        """The variable of an expression of which only the bounds are known."""
        name = name or (expression, self.step)
        if name not in self._variables:
            self._variables[name] = z3.Real(f"v{len(self._variables)}")
            self._bound(self._variables[name], expression)
        return self._variables[name]

    def _fold(self, function: Function, array: Expression) -> Term:
        """What a function of an array gives."""
        name = self._array(array)
        folded = self._fresh(Call(function, (array,)), (function, name))
        if function is Function.LEN:
            self._facts.append(z3.IsInt(folded))
        self._folds.setdefault(name, {})[function] = folded
        return folded

    def _array(self, array: Expression) -> Hashable:
        """Which array `array` is."""
        match array:
            case Slice(whole, start, stop):
                return self._array(whole), start, stop
            case Current() | Past() | Opening():
                return self._name(array)
            case Recent(_, samples):
                name = self._name(array)
                self._lengths[name] = samples + 1
                return name
            case _:
                raise TypeError(f"not an array: {array!r}")

    def _side_by_side(self, elements: tuple[Element, ...], alone: Count | None = None) -> Elements:
        """What is asked, at this step, of elements of these arrays side by side; or `alone`, by one count."""
        names = tuple(self._array(element.array) for element in elements)
        are_combined = alone is not None and len(alone.lists) > 1
        asked = Elements(elements, names, f"e{len(self._elements)}", are_combined)
        return self._elements.setdefault((names, alone), asked)

    def _of_ends(self) -> Iterator[Term]:
        """How functions of one array are related; where it has no elements but NaN, its ends mean nothing."""
        for name, folds in self._folds.items():
            found = self._elements.get(((name,), None))
            total = None if found is None else found.total
            length = folds.get(Function.LEN)
            for low, high in pairwise(folds[f] for f in ORDERED if f in folds):
                yield low <= high if total is None else z3.Implies(total >= 1, low <= high)
            if found is not None and length is not None and total is not None:
                is_numeric = value_type(next(inputs(found.elements[0]))) is ValueType.NUMBERS
                yield total <= length if is_numeric else total == length

    def _of_lengths(self) -> Iterator[Term]:
        """Each of so many samples is a number; otherwise there is no step."""
        for name, length in self._lengths.items():
            folded = self._folds.get(name, {}).get(Function.LEN)
            found = self._elements.get(((name,), None))
            counted = [] if found is None or found.total is None else [found.total]
            yield from (term == length for term in (*counted, *([] if folded is None else [folded])))

    def measured(self) -> Iterator[Term]:
        """What holds, beside `facts`, where all conditions have a value: arrays asked for an element have one."""
        for name, folds in self._folds.items():
            found = self._elements.get(((name,), None))
            if found is not None and found.total is not None and not folds.keys().isdisjoint((*ORDERED, Function.MEAN)):
                yield found.total >= 1

    def _array_value(self, model: Any, wanted: Current | Past | Recent | Opening) -> Value:
        """An array of as many elements of each kind as the model has; else of its smallest and its largest."""
        name = self._array(wanted)
        folds = {function: to_float(model, term) for function, term in self._folds.get(name, {}).items()}
        length = int(folds.pop(Function.LEN, self._lengths.get(name, 0)))
        folds.pop(Function.SUM, None)
        folds.pop(Function.MEAN, None)
        values: tuple[Single, ...] = tuple(folds.values()) or (0.0,) * (length > 0)
        asked = [found for found in self._elements.values() if name in found.arrays]
        for found in asked:
            if found.counts:
                values = found.values(model, found.elements[found.arrays.index(name)]) or ()
        filling = (math.nan,) if asked else values[:1]
        return (values + filling * length)[: max(length, len(values))]

    def _call(self, expression: Expression, function: Function, arguments: list[Term]) -> Term:
        if function in _CALLED:
            return _CALLED[function](*arguments)
        result = self._fresh(expression)
        if function is Function.SQRT:
            # A negative argument makes no step for this property, but does for others.
            self._facts.append(z3.Implies(arguments[0] >= 0, result * result == arguments[0]))
        if function is Function.NORM:
            self._facts.extend(self._norm(result, arguments))
        if function in OF_ZONES and self._knows_zones:
            self._facts.extend(zone_facts(function, result, arguments, self._exact_norms))
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


def _floor(term: Term) -> Term:
    return z3.ToReal(z3.ToInt(term))


def _sign(term: Term) -> Term:
    return z3.If(term > 0, z3.RealVal(1), z3.If(term < 0, z3.RealVal(-1), z3.RealVal(0)))


def _extreme(is_beyond: Callable[[Term, Term], Term]) -> Callable[..., Term]:
    """The term of which no other is beyond."""
    return lambda *terms: reduce(lambda found, other: z3.If(is_beyond(other, found), other, found), terms)


def _compare(left: Term, relation: Relation, right: Term, margin: float) -> Term:
    if margin == 0:
        return _COMPARED[relation](left, right)
    if relation is Relation.EQUAL:
        return z3.And(left - right <= real(margin), right - left <= real(margin))
    return _COMPARED[relation](left, right + real(margin))


_COMPARED: Mapping[Relation, Callable[[Term, Term], Term]] = {
    Relation.LESS: operator.lt,
    Relation.AT_MOST: operator.le,
    Relation.EQUAL: operator.eq,
    Relation.AT_LEAST: operator.ge,
    Relation.GREATER: operator.gt,
}

_CALCULATED: Mapping[Operator, Callable[[Term, Term], Term]] = {
    Operator.PLUS: operator.add,
    Operator.MINUS: operator.sub,
    Operator.TIMES: operator.mul,
    Operator.OVER: operator.truediv,
}

_CALLED: Mapping[Function, Callable[..., Term]] = {
    Function.ABS: _absolute,
    Function.MIN: _extreme(operator.lt),
    Function.MAX: _extreme(operator.gt),
    Function.GAP: operator.sub,
    Function.FLOOR: _floor,
    Function.CEIL: lambda term: -_floor(-term),
    Function.SIGN: _sign,
}
"""The functions of numbers that z3 has exactly; of the others, it knows their bounds."""


def to_float(model: Any, term: Term) -> float:
    """The value of `term` in `model` as a double."""
    value = model.eval(term, model_completion=True)
    if z3.is_algebraic_value(value):
        value = value.approx(20)
    return float(Fraction(value.numerator_as_long(), value.denominator_as_long()))
