"""State predicates: comparisons and boolean signals become atoms, margins are applied, constants are computed."""

from __future__ import annotations

import math
from collections.abc import Callable

from ltlc.diagnostics import Label
from ltlc.language import bounds
from ltlc.language.built import Built, Context, apply, equivalence, implication, truth
from ltlc.language.evaluate import constant, value
from ltlc.language.names import Checker, Kind
from ltlc.language.references import kind, property_named
from ltlc.language.values import (
    AgeOf,
    Array,
    Duration,
    Scalar,
    Text,
    Truth,
    Value,
    Vector,
    arithmetic,
    call,
    difference,
)
from ltlc.semantics import ltl
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import Formula
from ltlc.specification import timed
from ltlc.specification.atoms import Comparison, IsTrue, Relation, Same
from ltlc.specification.cells import holds
from ltlc.specification.expressions import Boolean, Expression, Function, New, Number, Operator, Signal, String
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
            case syntax.Past():
                return self._past(node, context)
            case syntax.StrayBound():
                bounds.stray(self.checker, node)
                return None
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

    def _past(self, node: syntax.Past, context: Context) -> Built | None:
        """A timed atom: what it looks back at is no part of it in the sense of `Built`, but has a say in it."""
        keyword = node.keyword.text
        sound, duration = bounds.of_keyword(self.checker, node)
        operands = [self._operand(keyword, operand, context) for operand in node.arguments]
        formulas = [operand.formula for operand in operands if operand is not None]
        if not sound or len(formulas) < len(operands):
            return None
        arguments = formulas if keyword == "previously" else [*formulas, duration]
        return Built(_PAST[keyword](*arguments), context.at(node.span))

    def _operand(self, keyword: str, node: syntax.Node, context: Context) -> Built | None:
        if kind(self.checker, node) != Kind.TEMPORAL:
            return self.of(node, context)
        message = f"what `{keyword}` looks back at has to be a state predicate"
        help = "`always`, `eventually` and the scopes look ahead"
        self.checker.report("LTL301", context.at(node.span), message, *context.inner(node.span), help=help)
        return None

    def _boolean(self, node: syntax.Node, context: Context) -> Built | None:
        """A value in the place of a predicate: a boolean."""
        found = value(self.checker, node)
        if found is None:
            return None
        if isinstance(found, Truth):
            return self._is_true(found.expression, context, node)
        message = f"`{self.checker.written(node)}` is {found.noun}, where a property is needed"
        self.checker.report("LTL206", node.span, message, help=_to_predicate(found, self.checker.written(node)))
        return None

    def _is_true(self, expression: Expression, context: Context, node: syntax.Node) -> Built:
        if isinstance(expression, Boolean):
            return truth(expression.value, context.at(node.span))
        if isinstance(expression, New):
            return context.news(expression, context.at(node.span))
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
            case AgeOf(signal), Duration(duration) if not equality:
                return self._age(node, context, signal, Relation(node.operator.text), duration)
            case Duration(duration), AgeOf(signal) if not equality:
                return self._age(node, context, signal, Relation(node.operator.text).flipped, duration)
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

    def _age(
        self, node: syntax.Comparison, context: Context, signal: Signal, relation: Relation, duration: Nanoseconds
    ) -> Built | None:
        """`age(s) <= D` or `age(s) < D`, of which the other orderings are negations."""
        if duration == 0:
            message = f"an age is compared with 0: it is 0 when a message on the topic of `{signal.name}` arrives"
            self.checker.report("LTL217", node.span, message, help=f"write `{text(New(signal))}` for that")
            return None
        strictly = relation in (Relation.LESS, Relation.AT_LEAST)
        span = context.at(node.span)
        context.news(New(signal), span)
        young = Built(timed.age(signal, duration, strictly=strictly), span)
        return young if relation in (Relation.LESS, Relation.AT_MOST) else apply(ltl.Not, span, young)

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
        if isinstance(left, AgeOf) or isinstance(right, AgeOf):
            self._bad_age(node, left, right)
            return
        places = Label(node.left.span, left.noun), Label(node.right.span, right.noun)
        operator = node.operator.text
        message = f"`{operator}` cannot compare {left.noun} and {right.noun}"
        help = ""
        if left.noun == right.noun:
            message = f"`{operator}` cannot compare {left.noun} with another"
            help = "of its elements, `min` and `max`" if isinstance(left, Array) else "they compare with `==` and `!=`"
        self.checker.report("LTL205", node.operator.span, message, *places, help=help)

    def _bad_age(self, node: syntax.Comparison, left: Value, right: Value) -> None:
        other, side = (node.right, right) if isinstance(left, AgeOf) else (node.left, left)
        message = f"`{node.operator.text}` cannot compare an age: it has an ordering with a duration, no equality"
        help = f"write `{self.checker.written(node.left)} <= {self.checker.written(node.right)}`"
        if not isinstance(side, Duration):
            message = f"an age is compared with a duration, not with {side.noun}"
            is_number = isinstance(other, syntax.NumberLiteral)
            help = f"write the unit: `{self.checker.written(other)} s`" if is_number else ""
        self.checker.report("LTL218", node.span, message, help=help)


def _to_predicate(found: Value, written: str) -> str:
    """How a value could be made a predicate."""
    match found:
        case Array():
            return "compare one of its elements, or `min` of it"
        case AgeOf():
            return f"compare it with a duration: `{written} <= 200 ms`"
        case Duration():
            return f"`within {written}, …` bounds what is to come; `historically true for {written}` holds from then on"
    return "compare it with something"


def arithmetic_text(right: Expression, shift: float) -> Expression:
    """`right + shift` as it is shown in the name of an atom."""
    operator = Operator.PLUS if shift > 0 else Operator.MINUS
    return arithmetic(operator, right, Number(abs(shift)))


_PAST: dict[str, Callable[..., Formula]] = {
    "previously": timed.previously,
    "once": timed.once,
    "historically": timed.historically,
    "since": timed.since,
}
