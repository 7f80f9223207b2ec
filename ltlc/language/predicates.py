"""State predicates: comparisons and boolean signals become atoms, margins are applied, constants are computed."""

from __future__ import annotations

import math

from ltlc.diagnostics import Label
from ltlc.language.built import Built, Context, apply, equivalence, implication, truth
from ltlc.language.evaluate import constant, value
from ltlc.language.names import Checker, Kind
from ltlc.language.references import kind, property_named
from ltlc.language.values import Array, Scalar, Text, Truth, Value, Vector, arithmetic, call, difference
from ltlc.semantics import ltl
from ltlc.specification.atoms import Comparison, IsTrue, Relation, Same
from ltlc.specification.cells import holds
from ltlc.specification.expressions import Boolean, Expression, Function, Number, Operator, String
from ltlc.specification.text import number_text, text
from ltlc.syntax import tree as syntax


def predicate(checker: Checker, node: syntax.Node, context: Context, default_margin: float) -> Built | None:
    """The state predicate that `node` is; None if an error was reported."""
    return _Predicates(checker, default_margin).of(node, context)


class _Predicates:
    """The state predicates of a file, whose `_margin_` is `default_margin`."""

    def __init__(self, checker: Checker, default_margin: float) -> None:
        self.checker = checker
        self.default_margin = default_margin

    def of(self, node: syntax.Node, context: Context) -> Built | None:
        """The state predicate that `node` is."""
        match node:
            case syntax.Negation(span, operand):
                inner = self.of(operand, context.negated())
                return inner and apply(ltl.Not, context.at(span), inner)
            case syntax.Connective():
                return self._connective(node, context)
            case syntax.Comparison():
                return self._comparison(node, context)
            case syntax.BooleanLiteral(span, holds):
                return truth(holds, context.at(span))
        if named := property_named(self.checker, node):
            return self.of(named.node, context.inside(node.span)) if named.sound else None
        return self._boolean(node, context)

    def _connective(self, node: syntax.Connective, context: Context) -> Built | None:
        implies = node.operator.text == "implies"
        left = self.of(node.left, context.negated() if implies else context)
        right = self.of(node.right, context)
        if left is None or right is None:
            return None
        if implies:
            return implication(context.at(node.span), left, right)
        return apply(ltl.And if node.operator.text == "and" else ltl.Or, context.at(node.span), left, right)

    def _boolean(self, node: syntax.Node, context: Context) -> Built | None:
        """A value in the place of a predicate: a boolean."""
        found = value(self.checker, node)
        if found is None:
            return None
        if isinstance(found, Truth):
            return self._is_true(found.expression, context, node)
        help = (
            "compare it with something"
            if not isinstance(found, Array)
            else "compare one of its elements, or `min` of it"
        )
        message = f"`{self.checker.written(node)}` is {found.noun}, where a property is needed"
        self.checker.report("LTL206", node.span, message, help=help)
        return None

    def _is_true(self, expression: Expression, context: Context, node: syntax.Node) -> Built:
        if isinstance(expression, Boolean):
            return truth(expression.value, context.at(node.span))
        return context.atom(text(expression), IsTrue(expression), context.at(node.span))

    def _comparison(self, node: syntax.Comparison, context: Context) -> Built | None:
        """`left operator{margin} right`, by the types of its sides."""
        if {kind(self.checker, node.left), kind(self.checker, node.right)} != {Kind.VALUE}:
            return self._equivalence(node, context)
        left, right = value(self.checker, node.left), value(self.checker, node.right)
        if left is None or right is None:
            return None
        margin = self._margin(node, left, right)
        if margin is None:
            return None
        equality = node.operator.text in ("==", "!=")
        match left, right:
            case Scalar(a), Scalar(b) if equality:
                return self._equality(node, context, a, b, margin)
            case Scalar(a), Scalar(b):
                return self._ordering(node, context, a, b, margin)
            case Vector(), Vector() if equality:
                return self._same_place(node, context, left, right, margin)
            case Text(a), Text(b) if equality:
                return self._same_text(node, context, a, b)
            case Truth(a), Truth(b) if equality:
                both = self._is_true(a, context, node.left), self._is_true(b, context, node.right)
                return self._signed(node, context, equivalence(context.at(node.span), *both))
        self._mismatch(node, left, right)
        return None

    def _equivalence(self, node: syntax.Comparison, context: Context) -> Built | None:
        """`p == q` on predicates; what stands in them is on both sides of a negation."""
        sides = node.left, node.right
        if node.operator.text not in ("==", "!=") or any(kind(self.checker, s) == Kind.TEMPORAL for s in sides):
            wrong = next((s for s in sides if kind(self.checker, s) == Kind.TEMPORAL), sides[0])
            message = f"`{self.checker.written(wrong)}` is a property, which `{node.operator.text}` cannot compare"
            self.checker.report("LTL206", wrong.span, message)
            return None
        if node.margin is not None:
            self.checker.report("LTL305", node.margin.span, "predicates are compared without a margin")
            return None
        left, right = (self.of(side, context.unfavoured()) for side in sides)
        if left is None or right is None:
            return None
        return self._signed(node, context, equivalence(context.at(node.span), left, right))

    def _margin(self, node: syntax.Comparison, left: Value, right: Value) -> float | None:
        """The margin of a comparison, by default that of the file for equality of numbers and vectors, else 0."""
        numeric = isinstance(left, Scalar | Vector) and isinstance(right, Scalar | Vector)
        if node.margin is None:
            return self.default_margin if numeric and node.operator.text in ("==", "!=") else 0.0
        if not numeric:
            noun = left.noun if not isinstance(left, Scalar | Vector) else right.noun
            self.checker.report("LTL305", node.margin.span, f"{noun} is compared without a margin")
            return None
        margin = constant(self.checker, node.margin)
        if margin is None or 0 <= margin < math.inf:
            return margin
        written = self.checker.written(node.margin)
        message = f"a margin of {written}: it has to be a finite number, not negative"
        self.checker.report("LTL303", node.margin.span, message)
        return None

    def _equality(
        self, node: syntax.Comparison, context: Context, left: Expression, right: Expression, margin: float
    ) -> Built:
        if isinstance(left, Number):
            left, right = right, left
        comparison = Comparison(left, Relation.EQUAL, right, margin)
        return self._signed(node, context, self._atom(node, context, comparison, text(left), text(right)))

    def _ordering(
        self, node: syntax.Comparison, context: Context, left: Expression, right: Expression, margin: float
    ) -> Built | None:
        """An ordering, relaxed by its margin in favour of the property."""
        relation = Relation(node.operator.text)
        if margin and context.polarity == 0:
            self._no_side(node, context)
            return None
        upward = 1 if relation in (Relation.LESS, Relation.AT_MOST) else -1
        shift = margin * upward * context.polarity
        if isinstance(right, Number):
            right, shift = Number(right.value + shift), 0.0
        elif isinstance(left, Number) and not shift:
            left, relation, right = right, relation.flipped, left
        shifted = text(right) if not shift else text(arithmetic_text(right, shift))
        return self._atom(node, context, Comparison(left, relation, right, shift), text(left), shifted)

    def _no_side(self, node: syntax.Comparison, context: Context) -> None:
        assert node.margin is not None
        message = f"the margin of `{node.operator.text}` has no favourable side here"
        help = "the second event of `after_until` both closes an episode and ends an obligation: write the bound itself"
        place = context.at(node.margin.span)
        self.checker.report("LTL304", place, message, *context.inner(node.margin.span), help=help)

    def _same_place(
        self, node: syntax.Comparison, context: Context, left: Vector, right: Vector, margin: float
    ) -> Built:
        """The Euclidean distance of two vectors is at most `margin`."""
        apart = call(Function.NORM, difference(left.components, right.components))
        comparison = Comparison(apart, Relation.EQUAL, Number(0.0), margin)
        return self._signed(node, context, self._atom(node, context, comparison, left.text, right.text))

    def _same_text(self, node: syntax.Comparison, context: Context, left: Expression, right: Expression) -> Built:
        if isinstance(left, String) and isinstance(right, String):
            return self._signed(node, context, truth(left == right, context.at(node.span)))
        if isinstance(left, String):
            left, right = right, left
        atom = context.atom(f"{text(left)} == {text(right)}", Same(left, right), context.at(node.span))
        return self._signed(node, context, atom)

    def _atom(self, node: syntax.Comparison, context: Context, comparison: Comparison, left: str, right: str) -> Built:
        """The atom of a comparison of numbers, or what it is if both sides are constant."""
        span = context.at(node.span)
        if isinstance(comparison.left, Number) and isinstance(comparison.right, Number):
            return truth(holds(comparison, comparison.left.value, comparison.right.value), span)
        relation = comparison.relation.value
        if comparison.relation is Relation.EQUAL and comparison.margin:
            relation += f"{{{number_text(comparison.margin)}}}"
        return context.atom(f"{left} {relation} {right}", comparison, span)

    def _signed(self, node: syntax.Comparison, context: Context, equal: Built) -> Built:
        """`equal` or, for `!=`, its negation."""
        return equal if node.operator.text == "==" else apply(ltl.Not, context.at(node.span), equal)

    def _mismatch(self, node: syntax.Comparison, left: Value, right: Value) -> None:
        places = Label(node.left.span, left.noun), Label(node.right.span, right.noun)
        operator = node.operator.text
        message = f"`{operator}` cannot compare {left.noun} and {right.noun}"
        help = ""
        if left.noun == right.noun:
            message = f"`{operator}` cannot compare {left.noun} with another"
            help = "of its elements, `min` and `max`" if isinstance(left, Array) else "they compare with `==` and `!=`"
        self.checker.report("LTL205", node.operator.span, message, *places, help=help)


def arithmetic_text(right: Expression, shift: float) -> Expression:
    """`right + shift` as it is shown in the name of an atom."""
    operator = Operator.PLUS if shift > 0 else Operator.MINUS
    return arithmetic(operator, right, Number(abs(shift)))
