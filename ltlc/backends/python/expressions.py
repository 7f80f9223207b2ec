"""Expressions and conditions of a specification as Python code; it agrees with `ltlc.specification.evaluation`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from ltlc.backends.python.code import Call, Chain, Code, Infix, Prefix, Text, literal
from ltlc.backends.python.statements import conjunction, disjunction
from ltlc.semantics import ltl
from ltlc.specification import expressions as e
from ltlc.specification.atoms import Comparison, Condition, IsTrue, Relation, Same, operands
from ltlc.specification.evaluation import evaluate, is_true

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
_FOLDS = {e.Function.MIN: "smallest", e.Function.MAX: "largest"}

RUNTIME_FUNCTIONS = frozenset({"number", "divide", *_FUNCTIONS.values(), *_FOLDS.values()} - {"abs"})
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
                return self._call("divide", left, right)
            case e.Arithmetic(operator, left, right):
                return _infix(operator.value, self.expression(left), self.expression(right))
            case e.Call(function, (array,)) if function in _FOLDS:
                return self._call(_FOLDS[function], array)
            case e.Call(function, arguments):
                return self._call(_FUNCTIONS[function], *arguments)
        raise TypeError(f"not an expression over the inputs: {expression!r}")

    def _call(self, function: str, *arguments: e.Expression) -> Code:
        self.called.add(function)
        return Call(function, tuple(map(self.expression, arguments)))

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
            case Comparison(left, Relation.EQUAL, right, margin) if margin != 0:
                return self._close(left, right, margin, holds)
            case Comparison(left, relation, right, margin):
                bound = self._bound(right, margin)
                if is_constant(left) and margin == 0:
                    return self._compare(bound, _MIRRORED[relation.value], self.expression(left), holds)
                return self._compare(self.expression(left), relation.value, bound, holds)

    def _truth(self, operand: e.Expression, holds: bool) -> Code:
        code = self.expression(operand)
        return code if holds else Prefix("not ", code)

    def _compare(self, left: Code, operator: str, right: Code, holds: bool) -> Code:
        return Chain((left, right), (operator if holds else _NEGATIONS[operator],))

    def _bound(self, right: e.Expression, margin: float) -> Code:
        if is_constant(right):
            value = evaluate(right, {})
            return self.constant(value + margin if isinstance(value, float) else value)
        code = self.expression(right)
        if margin == 0:
            return code
        return _infix("+" if margin > 0 else "-", code, Text(repr(abs(margin))))

    def _close(self, left: e.Expression, right: e.Expression, margin: float, holds: bool) -> Code:
        """The sides differ by at most `margin`; not so where both are infinite."""
        code: Code
        if _is_zero(left) or _is_zero(right):
            value = self.expression(right if _is_zero(left) else left)
            code = Chain((Text(repr(-margin)), value, Text(repr(margin))), ("<=", "<="))
        else:
            self.called.add("abs")
            difference = _infix("-", self.expression(left), self.expression(right))
            code = Chain((Call("abs", (difference,)), Text(repr(margin))), ("<=",))
        return code if holds else Prefix("not ", code)

    def sides(self, condition: Condition) -> tuple[Code, ...]:
        """Code for what `condition` compares, margins of orderings included; a boolean alone is not compared."""
        match condition:
            case IsTrue():
                return ()
            case Comparison(left, relation, right, margin) if relation is not Relation.EQUAL:
                return (self.expression(left), self._bound(right, margin))
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


def _is_zero(expression: e.Expression) -> bool:
    return is_constant(expression) and evaluate(expression, {}) == 0.0


def _is_nonzero(expression: e.Expression) -> bool:
    return is_constant(expression) and evaluate(expression, {}) != 0.0


def _is_finite(expression: e.Expression) -> bool:
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
        case e.Current() | e.Past() | e.Slope() | e.New():
            return False
        case e.Arithmetic(e.Operator.PLUS | e.Operator.MINUS, left, right):
            defined = _is_finite(left) or _is_finite(right)
        case e.Arithmetic(e.Operator.TIMES, left, right):
            defined = any(_is_finite(side) and _is_nonzero(side) for side in (left, right))
        case e.Arithmetic(e.Operator.OVER, _, right):
            defined = _is_finite(right) and _is_nonzero(right)
        case e.Call(function, arguments) if function in _FOLDS:
            defined = len(arguments) > 1
        case e.Call(function):
            defined = function in (e.Function.ABS, e.Function.NORM)
        case _:
            defined = True
    return not defined or any(may_be_undefined(child) for child in e.children(expression))


def calculated_inputs(conditions: list[Condition]) -> set[e.Expression]:
    """The inputs that are calculated with, not only compared: these must be doubles."""
    found: set[e.Expression] = set()
    for condition in conditions:
        close = isinstance(condition, Comparison) and condition.relation is Relation.EQUAL and condition.margin != 0
        for operand in operands(condition):
            if e.children(operand) or (close and not any(map(_is_zero, operands(condition)))):
                found.update(e.inputs(operand))
        if isinstance(condition, Comparison) and condition.margin != 0 and not close:
            found.update(e.inputs(condition.right))
    return found
