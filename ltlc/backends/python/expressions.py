"""Expressions and conditions of a specification as Python code; it agrees with `ltlc.specification.evaluation`."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from ltlc.backends.python.code import Call, Chain, Code, Each, Infix, Prefix, Text, flat, literal
from ltlc.backends.python.names import Names
from ltlc.backends.python.statements import conjunction, disjunction
from ltlc.semantics import ltl
from ltlc.specification import expressions as e
from ltlc.specification.atoms import Comparison, Condition, Count, IsTrue, Relation, Same, operands
from ltlc.specification.evaluation import evaluate, is_true, number
from ltlc.specification.numbers import numbers_of
from ltlc.specification.wire import Kind, as_double

_FUNCTIONS = {
    e.Function.ABS: "abs",
    e.Function.MIN: "least",
    e.Function.MAX: "greatest",
    e.Function.SQRT: "square_root",
    e.Function.NORM: "norm",
    e.Function.ROLL: "roll",
    e.Function.PITCH: "pitch",
    e.Function.YAW: "yaw",
    e.Function.ANGLE: "angle",
}
_DEFINED = (e.Function.ABS, e.Function.NORM, e.Function.MIN, e.Function.MAX)
_FOLDS = {e.Function.MIN: "smallest", e.Function.MAX: "largest", e.Function.SUM: "sum_of", e.Function.LEN: "length_of"}

RUNTIME_FUNCTIONS = frozenset(
    {"number", "divide", "doubles_of", "elements_of", *_FUNCTIONS.values(), *_FOLDS.values()} - {"abs"}
)
"""The functions of `ltlc.runtime.functions` that emitted code may call."""

_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "=="}
_NEGATIONS = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}


@dataclass
class Coder:
    """Writes expressions over inputs and local variables that are called as in `names`.

    `called` collects the functions and modules that the code written so far needs.
    """

    names: Mapping[e.Expression, str]
    called: set[str] = field(default_factory=set)

    def expression(self, expression: e.Expression) -> Code:
        """Code for the value of `expression`."""
        if expression in self.names:
            return Text(self.names[expression])
        if is_constant(expression):
            return self.constant(evaluate(expression, {}))
        match expression:
            case e.Negative(operand):
                return Prefix("-", self.expression(operand))
            case e.Arithmetic(e.Operator.OVER, left, right) if not _is_nonzero(right):
                return self._call("divide", map(self._double, (left, right)))
            case e.Arithmetic(operator, left, right):
                return _infix(operator.value, self._double(left), self._double(right))
            case e.Slice(array, start, stop):
                ends = ("" if end is None else str(end) for end in (start, stop))
                return Text(f"{flat(self.expression(array))}[{':'.join(ends)}]")
            case Count():
                return Call("float", (Call("sum", (self._elements(expression, Text("1")),)),))
            case e.Call(function, (array,)) if expression.array is not None:
                return self._call(_FOLDS[function], (self.expression(array),))
            case e.Call(function, arguments):
                is_exact = function is e.Function.ABS or numbers_of(expression).kind is Kind.INTEGER
                return self._call(_FUNCTIONS[function], map(self.expression if is_exact else self._double, arguments))
        raise TypeError(f"not an expression over the inputs: {expression!r}")

    def _elements(self, count: Count, result: Code) -> Each:
        """`result` for each element that counts."""
        local = Names(frozenset(self.names.values()))
        names: dict[e.Expression, str] = {
            element: local.unique(f"each_{self.names[next(e.inputs(element))]}") for element in count.elements
        }
        inner, conditions = Coder({**self.names, **names}, self.called), dict(count.conditions)
        guard = [inner.predicate(count.predicate, conditions)]
        for side in dict.fromkeys(s for c in conditions.values() if isinstance(c, Comparison) for s in operands(c)):
            if side not in count.singles and not excludes_nan(count.predicate, conditions, side):
                self.called.add("INFINITY")
                guard.insert(0, Chain((inner.expression(side), Text("INFINITY")), ("<=",)))
        arrays = tuple(self.expression(element.array) for element in count.elements)
        items = arrays[0] if len(arrays) == 1 else Call("zip", (*arrays, Text("strict=False")))
        return Each(result, Chain((Text(", ".join(names.values())), items), ("in",)), conjunction(guard))

    def _double(self, expression: e.Expression) -> Code:
        """Code for the double nearest to the value of `expression`."""
        if is_constant(expression):
            value = evaluate(expression, {})
            return self.constant(as_double(value) if isinstance(value, int) else value)
        code = self.expression(expression)
        return Call("float", (code,)) if _may_be_int(expression) else code

    def _call(self, function: str, arguments: Iterable[Code]) -> Code:
        self.called.add(function)
        return Call(function, tuple(arguments))

    def constant(self, value: object) -> Code:
        """Code for a constant; the same double, boolean or string."""
        if isinstance(value, str):
            return Text(literal(value))
        if isinstance(value, float) and not math.isfinite(value):
            self.called.add("math")
            return Text({math.inf: "math.inf", -math.inf: "-math.inf"}.get(value, "math.nan"))
        return Text(repr(value))

    def condition(self, condition: Condition, holds: bool = True) -> Code:
        """Code that is true where `condition` holds, or, with `holds` false, where it does not."""
        match condition:
            case IsTrue(operand):
                return self._truth(operand, holds)
            case Same(operand, e.Boolean(value)) | Same(e.Boolean(value), operand):
                return self._truth(operand, holds == value)
            case Same(left, right):
                return self._compare(self.expression(left), "==", self.expression(right), holds)
            case Comparison(Count() as count, Relation.AT_LEAST | Relation.LESS as relation, e.Number(1.0), 0.0):
                found = Call("any", (self._elements(count, Text("True")),))
                return found if (relation is Relation.AT_LEAST) == holds else Prefix("not ", found)
            case Comparison(left, Relation.EQUAL, right, margin) if margin != 0:
                return self._close(left, right, margin, holds)
            case Comparison(left, relation, right, margin):
                side, bound = self._ordered(left, right, margin)
                if is_constant(left) and margin == 0:
                    return self._compare(bound, _MIRRORED[relation.value], side, holds)
                return self._compare(side, relation.value, bound, holds)

    def _truth(self, operand: e.Expression, holds: bool) -> Code:
        code = self.expression(operand)
        return code if holds else Prefix("not ", code)

    def _compare(self, left: Code, operator: str, right: Code, holds: bool) -> Code:
        return Chain((left, right), (operator if holds else _NEGATIONS[operator],))

    def _ordered(self, left: e.Expression, right: e.Expression, margin: float) -> tuple[Code, Code]:
        """What is compared where `margin` moves the right side: without one, both sides as they are."""
        if margin == 0:
            return self.expression(left), self.expression(right)
        if is_constant(right):
            return self._double(left), self.constant(number(right, {}) + margin)
        shifted = _infix("+" if margin > 0 else "-", self._double(right), Text(repr(abs(margin))))
        return self._double(left), shifted

    def _close(self, left: e.Expression, right: e.Expression, margin: float, holds: bool) -> Code:
        """The sides differ by at most `margin`, or are the same, be it infinite."""
        code: Code
        if is_zero(left) or is_zero(right):
            value = self._double(right if is_zero(left) else left)
            code = Chain((Text(repr(-margin)), value, Text(repr(margin))), ("<=", "<="))
        else:
            self.called.add("abs")
            sides = self._double(left), self._double(right)
            code = Chain((Call("abs", (_infix("-", *sides),)), Text(repr(margin))), ("<=",))
            if not (is_finite(left) or is_finite(right)):
                code = disjunction([Chain(sides, ("==",)), code])
        return code if holds else Prefix("not ", code)

    def sides(self, condition: Condition) -> tuple[Code, ...]:
        """Code for what `condition` compares, margins of orderings included.

        A boolean alone is not compared, nor is whether there is an element.
        """
        match condition:
            case IsTrue() | Comparison(Count(), Relation.AT_LEAST | Relation.LESS, e.Number(1.0), 0.0):
                return ()
            case Comparison(left, relation, right, margin) if relation is not Relation.EQUAL:
                return self._ordered(left, right, margin)
            case _:
                return tuple(map(self.expression, operands(condition)))

    def predicate(self, formula: ltl.Formula, conditions: Mapping[str, Condition], holds: bool = True) -> Code:
        """Code that is true where the state predicate `formula` over atoms with these conditions holds, or does not."""
        match formula:
            case ltl.Truth():
                return Text(str(holds))
            case ltl.Atom(name):
                return self.condition(conditions[name], holds)
            case ltl.Not(operand):
                return self.predicate(operand, conditions, not holds)
            case ltl.And(left, right) | ltl.Or(left, right):
                sides = [self.predicate(side, conditions, holds) for side in (left, right)]
                return conjunction(sides) if isinstance(formula, ltl.And) == holds else disjunction(sides)
        raise TypeError(f"not a state predicate: {formula}")


def excludes_nan(predicate: ltl.Formula, conditions: Mapping[str, Condition], side: e.Expression) -> bool:
    """Whether `predicate` is false where `side` is NaN: no comparison holds of NaN, but its negation does."""
    match predicate:
        case ltl.Atom(name):
            return side in operands(conditions[name])
        case ltl.And(left, right):
            return any(excludes_nan(part, conditions, side) for part in (left, right))
        case ltl.Or(left, right):
            return all(excludes_nan(part, conditions, side) for part in (left, right))
    return False


def _infix(operator: str, left: Code, right: Code) -> Code:
    """`left operator right`; what groups to the left already becomes one tree."""
    if isinstance(left, Infix) and left.operator == operator:
        return Infix(operator, (*left.operands, right))
    return Infix(operator, (left, right))


def constant_truth(condition: Condition) -> bool | None:
    """Whether `condition` holds, if it reads no signal and does not depend on NaN."""
    if not all(map(is_constant, operands(condition))) or any(map(may_be_undefined, operands(condition))):
        return None
    return is_true(condition, {})


def is_constant(expression: e.Expression) -> bool:
    """Whether `expression` reads no signal."""
    return not any(True for _ in e.inputs(expression))


def _is_calculated(expression: e.Expression) -> bool:
    """Whether `expression` is more than an input, an element of one, or the smallest or largest one."""
    match expression:
        case e.Call(e.Function.MIN | e.Function.MAX | e.Function.LEN, (array,)) if expression.array is not None:
            return _is_calculated(array)
        case e.Slice(array) | e.Element(array):
            return _is_calculated(array)
    return bool(expression.children)


def _may_be_int(expression: e.Expression) -> bool:
    """Whether the value of `expression` may be an `int` in Python."""
    is_wide = any(wanted.signal.numbers.is_wide for wanted in e.inputs(expression))
    return is_wide and numbers_of(expression).kind is Kind.INTEGER


def is_zero(expression: e.Expression) -> bool:
    """Whether `expression` is a constant, 0 or -0."""
    return is_constant(expression) and evaluate(expression, {}) == 0.0


def _is_nonzero(expression: e.Expression) -> bool:
    return is_constant(expression) and evaluate(expression, {}) != 0.0


def is_finite(expression: e.Expression) -> bool:
    """Whether `expression` is a constant, and finite."""
    if not is_constant(expression):
        return False
    value = evaluate(expression, {})
    return isinstance(value, float) and math.isfinite(value)


def may_be_undefined(expression: e.Expression) -> bool:
    """Whether `expression` can be NaN where none of its inputs is."""
    if is_constant(expression):
        value = evaluate(expression, {})
        return isinstance(value, float) and math.isnan(value)
    match expression:
        case e.Current() | e.Past() | e.Slope() | e.New() | e.Opening() | Count():
            return False
        case e.Arithmetic(e.Operator.PLUS | e.Operator.MINUS, left, right):
            defined = is_finite(left) or is_finite(right)
        case e.Arithmetic(e.Operator.TIMES, left, right):
            defined = any(is_finite(side) and _is_nonzero(side) for side in (left, right))
        case e.Arithmetic(e.Operator.OVER, _, right):
            defined = is_finite(right) and _is_nonzero(right)
        case e.Call(function) if expression.array is not None:
            defined = function is e.Function.LEN
        case e.Call(function):
            defined = function in _DEFINED
        case _:
            defined = True
    return not defined or any(may_be_undefined(child) for child in expression.children)


def undefined_parts(condition: Condition) -> Iterator[e.Expression]:
    """What can be NaN where no input is, and makes a step invalid that asks for `condition`."""
    for operand in operands(condition):
        counts = (part for part in e.subexpressions(operand) if isinstance(part, Count))
        yield from (single for count in counts for single in count.singles if may_be_undefined(single))
        if may_be_undefined(operand):
            yield operand


def calculated_inputs(conditions: Iterable[Condition]) -> set[e.Input]:
    """The inputs that are calculated with, not only compared: these must be doubles."""
    found: set[e.Input] = set()
    for condition in conditions:
        close = isinstance(condition, Comparison) and condition.relation is Relation.EQUAL and condition.margin != 0
        for operand in operands(condition):
            if isinstance(operand, Count):
                found |= calculated_inputs(condition for _, condition in operand.conditions)
            elif _is_calculated(operand) or (close and not any(map(is_zero, operands(condition)))):
                found.update(e.inputs(operand))
        if isinstance(condition, Comparison) and condition.margin != 0 and not close:
            found.update(e.inputs(condition.right))
    return found
