"""State predicates: comparisons and boolean signals become atoms, margins are applied, constants are computed."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial, reduce

from ltlc.base.diagnostics import Fix, Help, Label
from ltlc.base.fixes import put, write, writing
from ltlc.frontend.language import bounds
from ltlc.frontend.language.built import Built, Context, apply, equivalence, implication, truth
from ltlc.frontend.language.counts import counted, of_rate
from ltlc.frontend.language.elements import of_elements, quantified, said_of
from ltlc.frontend.language.evaluate import compared, constant, of_zone, value
from ltlc.frontend.language.names import Checker, Sort
from ltlc.frontend.language.openings import has_one_opening
from ltlc.frontend.language.references import is_unknown, kind, property_named, unknown
from ltlc.frontend.language.values import (
    AgeOf,
    Array,
    Duration,
    Scalar,
    Text,
    Truth,
    Value,
    Vector,
    beside,
    call,
    expressions,
    gap,
)
from ltlc.frontend.syntax import tree as syntax
from ltlc.semantics import ltl
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import Formula
from ltlc.specification import timed
from ltlc.specification.cells import holds
from ltlc.specification.expressions import (
    Boolean,
    Comparison,
    Expression,
    IsTrue,
    New,
    Number,
    Relation,
    Same,
    Signal,
    String,
    openings,
)
from ltlc.specification.functions import INSIDE, Function
from ltlc.specification.text import number_text, ordering_text, text


def predicate(checker: Checker, node: syntax.Node, context: Context) -> Built | None:
    """The state predicate that `node` is; None if an error was reported."""
    return _Predicates(checker).of(node, context)


class _Predicates:
    """The state predicates of a file."""

    def __init__(self, checker: Checker) -> None:
        self.checker = checker

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
            case syntax.Membership():
                return self._membership(node, context)
            case syntax.Quantified(_, quantifier) if quantifier.text != "count":
                return quantified(self.checker, node, context)
            case syntax.Call(_, function) if function.text == INSIDE:
                return self._inside(node, context)
            case syntax.Past():
                return self._past(node, context)
            case syntax.Rate():
                return of_rate(self.checker, node, context)
            case syntax.StrayBound():
                bounds.stray(self.checker, node)
                return None
            case syntax.BooleanLiteral(span, holds):
                return truth(holds, context.at(span))
            case _:
                pass
        if named := property_named(self.checker, node):
            return self.of(named.node, context.inside(node.span)) if named.sound else None
        return self._boolean(node, context)

    def _inside(self, node: syntax.Call, context: Context) -> Built | None:
        found = of_zone(self.checker, node, Function.INSIDE)
        if found is None or not self._has_one_opening(node, context, Scalar(found)):
            return None
        condition = Comparison(found, Relation.AT_LEAST, Number(1.0))
        return context.atom(ordering_text(condition), condition, context.at(node.span))

    def _connective(self, node: syntax.Connective, context: Context) -> Built | None:
        implies = node.operator.text == "implies"
        left = self.of(node.left, context.negated() if implies else context)
        right = self.of(node.right, context.implied(node) if implies else context)
        if left is None or right is None:
            return None
        if implies:
            return implication(context.at(node.span), left, right)
        return apply(ltl.And if node.operator.text == "and" else ltl.Or, context.at(node.span), left, right)

    def _membership(self, node: syntax.Membership, context: Context) -> Built | None:
        """The operand equals one of the items, by the margin of the file if they are numbers."""
        found, _ = self._sides(node.operand, node.items[0])
        if found is None:
            return None
        if not isinstance(found, Scalar | Text | Truth):
            message = f"`in` applies to numbers, strings and booleans, but `{self.checker.written(node.operand)}` is "
            help: str | Help = ""
            if isinstance(found, Array):
                any_ = said_of("any", self.checker, node)
                help = Help(f"say which elements: {any_.title.removeprefix('write ')}", (any_,))
            self.checker.report("LTL205", node.operand.span, message + found.noun, help=help)
            return None
        equal = syntax.Word(node.operator.span, "==")
        found_items = [self.of(syntax.Comparison(i.span, node.operand, equal, i), context) for i in node.items]
        items = [item for item in found_items if item is not None]
        if len(items) < len(found_items):
            return None
        return reduce(partial(apply, ltl.Or, context.at(node.span)), items)

    def _past(self, node: syntax.Past, context: Context) -> Built | None:
        """A timed atom, whose parts are what it looks back at."""
        keyword = node.keyword.text
        if node.times is not None:
            return counted(self.checker, node, node.times, self._operand(keyword, node.arguments[0], context), context)
        sound, bound = bounds.of_keyword(self.checker, node)
        found = [self._operand(keyword, operand, context) for operand in node.arguments]
        operands = tuple(operand for operand in found if operand is not None)
        if not sound or len(operands) < len(found):
            return None
        formulas = [operand.formula for operand in operands]
        arguments = formulas if keyword == "previously" else [*formulas, bound and bound.end]
        return Built(_PAST[keyword](*arguments), context.at(node.span), operands)

    def _operand(self, keyword: str, node: syntax.Node, context: Context) -> Built | None:
        if kind(self.checker, node) != Sort.TEMPORAL:
            return self.of(node, context)
        message = f"the operand of `{keyword}` must be a state predicate"
        help = "`always`, `eventually` and the scopes look ahead"
        self.checker.report("LTL301", context.at(node.span), message, *context.inner(node.span), help=help)
        return None

    def _boolean(self, node: syntax.Node, context: Context) -> Built | None:
        """A value in place of a predicate: a boolean."""
        found = value(self.checker, node)
        if found is None:
            return None
        if isinstance(found, Truth) and self._has_one_opening(node, context, found):
            return self._is_true(found.expression, context, node)
        if isinstance(found, Truth):
            return None
        message = f"`{self.checker.written(node)}` is {found.noun}, but a property is needed here"
        self.checker.report("LTL206", node.span, message, help=_to_predicate(found, self.checker.written(node)))
        return None

    def _is_true(self, expression: Expression, context: Context, node: syntax.Node) -> Built:
        if isinstance(expression, Boolean):
            return truth(expression.value, context.at(node.span))
        if isinstance(expression, New):
            return context.news(context.heard(expression.signal), context.at(node.span))
        return context.atom(text(expression), IsTrue(expression), context.at(node.span))

    def _comparison(self, node: syntax.Comparison, context: Context) -> Built | None:
        """`left operator{margin} right`, by the types of its sides."""
        if {kind(self.checker, node.left), kind(self.checker, node.right)} != {Sort.VALUE}:
            return self._equivalence(node, context)
        left, right = self._sides(node.left, node.right)
        if left is None or right is None or not self._has_one_opening(node, context, left, right):
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

    def _has_one_opening(self, node: syntax.Node, context: Context, *values: Value) -> bool:
        """Whether at most one opening can be meant where values at an opening are read; if not, it is reported."""
        found = next((o for each in values for part in expressions(each) for o in openings(part)), None)
        return found is None or has_one_opening(self.checker, node, context, text(found))

    def _sides(self, left: syntax.Node, right: syntax.Node) -> tuple[Value | None, Value | None]:
        """The values of both sides; a word that is nothing may be meant as a value of what stands beside it."""
        lost = [side for side in (left, right) if isinstance(side, syntax.Reference) and is_unknown(self.checker, side)]
        if not lost:
            return compared(self.checker, left, right)
        other = None if len(lost) > 1 else value(self.checker, right if lost[0] is left else left)
        for side in lost:
            unknown(self.checker, side, other)
        return None, None

    def _equivalence(self, node: syntax.Comparison, context: Context) -> Built | None:
        """`p == q` on predicates; what stands in them is on both sides of a negation."""
        sides = node.left, node.right
        if node.operator.text not in ("==", "!=") or any(kind(self.checker, s) == Sort.TEMPORAL for s in sides):
            wrong = next((s for s in sides if kind(self.checker, s) == Sort.TEMPORAL), sides[0])
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
            return self.checker.margin if numeric and node.operator.text in ("==", "!=") else 0.0
        if not numeric:
            noun = left.noun if not isinstance(left, Scalar | Vector) else right.noun
            self.checker.report("LTL305", node.margin.span, f"{noun} is compared without a margin")
            return None
        margin = constant(self.checker, node.margin)
        if margin is None or 0 <= margin < math.inf:
            return margin
        written = self.checker.written(node.margin)
        message = f"a margin of {written}: it must be a finite number and not negative"
        self.checker.report("LTL303", node.margin.span, message)
        return None

    def _equality(
        self, node: syntax.Comparison, context: Context, left: Expression, right: Expression, margin: float
    ) -> Built:
        if isinstance(left, Number):
            left, right = right, left
        right = beside(right, left)
        comparison = Comparison(left, Relation.EQUAL, right, margin)
        name = _equality_text(text(left), margin, text(right))
        return self._signed(node, context, self._atom(node, context, comparison, name))

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
        left, right = beside(left, right), beside(right, left)
        if isinstance(right, Number):
            right, shift = Number(right.value + shift) if shift else right, 0.0
        elif isinstance(left, Number) and not shift:
            left, relation, right = right, relation.flipped, left
        comparison = Comparison(left, relation, right, shift)
        return self._atom(node, context, comparison, ordering_text(comparison))

    def _no_side(self, node: syntax.Comparison, context: Context) -> None:
        assert node.margin is not None
        message = f"the margin of `{node.operator.text}` has no favourable side here"
        help = "the closing event of `after_until` also ends an obligation: write the bound without a margin"
        if self.checker.elementwise:
            help = "a higher count may be good or bad: write the bound without a margin"
        place = context.at(node.margin.span)
        self.checker.report("LTL304", place, message, *context.inner(node.margin.span), help=help)

    def _same_place(
        self, node: syntax.Comparison, context: Context, left: Vector, right: Vector, margin: float
    ) -> Built:
        """The Euclidean distance of two vectors is at most `margin`."""
        apart = call(Function.NORM, map(gap, left.components, right.components))
        comparison = Comparison(apart, Relation.EQUAL, Number(0.0), margin)
        name = _equality_text(left.text, margin, right.text)
        return self._signed(node, context, self._atom(node, context, comparison, name))

    def _age(
        self, node: syntax.Comparison, context: Context, signal: Signal, relation: Relation, duration: Nanoseconds
    ) -> Built | None:
        """`age(s) <= D` or `age(s) < D`, of which the other orderings are negations."""
        if duration == 0:
            message = f"an age is compared with 0: it is 0 when a message on the topic of `{signal.name}` arrives"
            self.checker.report("LTL217", node.span, message, help=f"write `{text(New(signal))}` instead")
            return None
        strictly = relation in (Relation.LESS, Relation.AT_LEAST)
        span = context.at(node.span)
        young = context.age(context.heard(signal), duration, span, strictly=strictly)
        return young if relation in (Relation.LESS, Relation.AT_MOST) else apply(ltl.Not, span, young)

    def _same_text(self, node: syntax.Comparison, context: Context, left: Expression, right: Expression) -> Built:
        if isinstance(left, String) and isinstance(right, String):
            return self._signed(node, context, truth(left == right, context.at(node.span)))
        if isinstance(left, String):
            left, right = right, left
        atom = context.atom(f"{text(left)} == {text(right)}", Same(left, right), context.at(node.span))
        return self._signed(node, context, atom)

    def _atom(self, node: syntax.Comparison, context: Context, comparison: Comparison, name: str) -> Built:
        """The atom of a comparison of numbers, or what it is if both sides are constant."""
        span = context.at(node.span)
        if isinstance(comparison.left, Number) and isinstance(comparison.right, Number):
            return truth(holds(comparison, comparison.left.value, comparison.right.value), span)
        return context.atom(name, comparison, span)

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
        help: str | Help = ""
        if left.noun == right.noun:
            message = f"`{operator}` cannot compare {left.noun} with another"
            help = "use `==` or `!=`"
        if {type(left), type(right)} == {Scalar, Text}:
            help = self._as_string(node, left)
        if {type(left), type(right)} == {Scalar, Truth} and operator in ("==", "!="):
            help = self._as_boolean(node, left) or "a boolean is used by itself: `p`, `not p`"
        if isinstance(left, Array) or isinstance(right, Array):
            help = of_elements(self.checker, node, left, right)
        self.checker.report("LTL205", node.operator.span, message, *places, help=help)

    def _as_boolean(self, node: syntax.Comparison, left: Value) -> Help | None:
        """A boolean that is compared with 0 or 1, by itself."""
        number, truth_ = (node.right, node.left) if isinstance(left, Truth) else (node.left, node.right)
        written = self.checker.written(number)
        if written not in ("0", "1") or node.margin is not None:
            return None
        is_negated = (written == "1") != (node.operator.text == "==")
        return write(writing(node.span, f"{'not ' if is_negated else ''}{self.checker.written(truth_)}"))

    def _as_string(self, node: syntax.Comparison, left: Value) -> Help | str:
        """A number beside a string may be meant as one."""
        number = node.left if isinstance(left, Scalar) else node.right
        if not isinstance(number, syntax.NumberLiteral):
            return ""
        return write(writing(number.span, f'"{self.checker.written(number)}"'))

    def _bad_age(self, node: syntax.Comparison, left: Value, right: Value) -> None:
        other, side = (node.right, right) if isinstance(left, AgeOf) else (node.left, left)
        message = f"`{node.operator.text}` cannot compare an age: use `< <= > >=` with a duration"
        title = f"write `{self.checker.written(node.left)} <= {self.checker.written(node.right)}`"
        is_fixed = isinstance(left, AgeOf) and node.margin is None
        help = Help(title, (Fix(title, ((node.operator.span, "<="),)),) if is_fixed else ())
        if not isinstance(side, Duration):
            message = f"an age is compared with a duration, not with {side.noun}"
            is_number = isinstance(other, syntax.NumberLiteral)
            unit = Fix(f"write `{self.checker.written(other)} s`", put(other.span.end, " s").edits)
            help = Help(f"write the unit: `{self.checker.written(other)} s`", (unit,)) if is_number else Help("")
        self.checker.report("LTL218", node.span, message, help=help)


def _to_predicate(found: Value, written: str) -> str:
    """How a value could be made a predicate."""
    match found:
        case Array():
            return f"compare its elements, as in `any({written} …)`, or `min({written})`"
        case AgeOf():
            return f"compare it with a duration: `{written} <= 200 ms`"
        case Duration():
            return f"`within {written}, …` bounds the future; `historically true for {written}` holds from then on"
        case _:
            return "compare it with a value"


def _equality_text(left: str, margin: float, right: str) -> str:
    """The name of an equality."""
    return f"{left} =={f'{{{number_text(margin)}}}' if margin else ''} {right}"


_PAST: dict[str, Callable[..., Formula]] = {
    "previously": timed.previously,
    "once": timed.once,
    "historically": timed.historically,
    "since": timed.since,
}
