"""Properties: temporal keywords, events, and how a state predicate is read where it stands."""

from __future__ import annotations

from functools import partial

from ltlc.base.diagnostics import Fix, Help
from ltlc.base.fixes import around, write, writing
from ltlc.base.source import Span
from ltlc.frontend.language import bounds
from ltlc.frontend.language.built import Built, Context, apply
from ltlc.frontend.language.misread import note_inside
from ltlc.frontend.language.names import Checker, Sort
from ltlc.frontend.language.predicates import predicate
from ltlc.frontend.language.references import kind, property_named
from ltlc.frontend.syntax import tree as syntax
from ltlc.semantics import properties
from ltlc.semantics.denotation import satisfies
from ltlc.semantics.ltl import TRUE
from ltlc.semantics.properties import Property


class Scopes:
    """The properties of a file."""

    def __init__(self, checker: Checker) -> None:
        self.checker = checker

    def property(self, node: syntax.Node, context: Context, in_scope: bool) -> Built | None:
        """The property that `node` is; `in_scope` if it stands in scope position. None if an error was reported."""
        if kind(self.checker, node) != Sort.TEMPORAL:
            return self._state(node, context, in_scope)
        if named := property_named(self.checker, node):
            return self.property(named.node, context.inside(node.span), in_scope) if named.sound else None
        match node:
            case syntax.Temporal():
                return self._temporal(node, context)
            case syntax.Within():
                return self._within(node, context)
            case syntax.Negation(span, operand):
                if in_scope and self._is_mixture(node, context):
                    return None
                inner = self.property(operand, context.negated(), in_scope)
                return inner and apply(properties.Not, context.at(span), inner)
            case syntax.Connective():
                return self._connective(node, context, in_scope)
            case _:
                raise TypeError(f"not a property: {node!r}")

    def _state(self, node: syntax.Node, context: Context, in_scope: bool) -> Built | None:
        """A state predicate: in scope position it means `always` it, else it is read at the current step."""
        found = predicate(self.checker, node, context)
        if found is None:
            return None
        wrapped = properties.Throughout(found.formula) if in_scope else properties.Now(found.formula)
        return Built(wrapped, found.span, found.parts)

    def _temporal(self, node: syntax.Temporal, context: Context) -> Built | None:
        keyword, arguments = node.keyword.text, node.arguments
        sound, bound = bounds.of_keyword(self.checker, node)
        if not sound:
            return None
        if keyword == "initially":
            return self._initially(node, context)
        if keyword in ("always", "eventually", "never"):
            note_inside(self.checker, node)
            inside = (context.negated() if keyword == "never" else context).each_step()
            inner = self.property(arguments[0], inside, in_scope=False)
            span = node.keyword.span.to(arguments[0].span) if node.bound else node.span
            found = inner and apply(_CONSTRUCTORS[keyword], context.at(span), inner)
            return found and (found if bound is None else _bounded(bound, context.at(node.span), found))
        inside = context.maybe_empty() if keyword == "until" else context.opened()
        contexts = {
            "after": (context.negated(),),
            "until": (context,),
            "after_until": (context.negated(), inside.unfavoured()),
        }[keyword]
        events = [self._event(keyword, e, c) for e, c in zip(arguments[:-1], contexts, strict=True)]
        body = self.property(arguments[-1], inside, in_scope=True)
        built = [part for part in (*events, body) if part is not None]
        if len(built) < len(arguments):
            return None
        return apply(_CONSTRUCTORS[keyword], context.at(node.span), *built)

    def _initially(self, node: syntax.Temporal, context: Context) -> Built | None:
        """What holds at the first step, in any scope; false if there is no step."""
        (argument,) = node.arguments
        if kind(self.checker, argument) != Sort.TEMPORAL:
            found = self._state(argument, context, in_scope=False)
            if found is None or not context.may_be_empty or not satisfies((), found.property):
                return found
            some = Built(properties.SOME_STEP, found.span, (Built(properties.Now(TRUE), found.span),))
            return apply(properties.And, found.span, some, found)
        message = "`initially` is about the first step: it needs a state predicate"
        self.checker.report("LTL301", context.at(argument.span), message, *context.inner(argument.span))
        return None

    def _within(self, node: syntax.Within, context: Context) -> Built | None:
        """`within D, P`; a state predicate would be taken for `eventually` it by some, for `always` it by others."""
        period = bounds.period(self.checker, node.duration)
        if node.bound is not None:
            bounds.wrong(self.checker, "within", (node.body,), node.bound, node.span.start)
            return None
        if kind(self.checker, node.body) == Sort.TEMPORAL:
            inside = context.maybe_empty() if period and period.start else context
            body = self.property(node.body, inside, in_scope=True)
            return None if body is None or period is None else _bounded(period, context.at(node.span), body)
        predicate(self.checker, node.body, context)
        start, body_ = self.checker.written(node.duration), self.checker.written(node.body)
        message = f"`{body_}` under a bound: at some step in that time, or at every step?"
        place = Span(node.body.span.start, node.body.span.start)
        help = write(
            *(
                Fix(f"write `within {start}, {word} {body_}`", ((place, f"{word} "),))
                for word in ("eventually", "always")
            )
        )
        self.checker.report("LTL309", context.at(node.body.span), message, *context.inner(node.body.span), help=help)
        return None

    def _event(self, keyword: str, node: syntax.Node, context: Context) -> Built | None:
        if kind(self.checker, node) != Sort.TEMPORAL:
            return predicate(self.checker, node, context)
        message = f"an event of `{keyword}` must be a state predicate: it happens at one step"
        help = "nest the properties the other way round, or use a comparison for the event"
        self.checker.report("LTL301", context.at(node.span), message, *context.inner(node.span), help=help)
        return None

    def _connective(self, node: syntax.Connective, context: Context, in_scope: bool) -> Built | None:
        operator = node.operator.text
        if in_scope and operator != "and" and self._is_mixture(node, context):
            return None
        implies = operator == "implies"
        left = self.property(node.left, context.negated() if implies else context, in_scope)
        right = self.property(node.right, context.implied(node) if implies else context, in_scope)
        if left is None or right is None:
            return None
        return apply(_CONSTRUCTORS[operator], context.at(node.span), left, right)

    def _is_mixture(self, node: syntax.Node, context: Context) -> bool:
        """Whether state predicates stand beside temporal properties in `node`, which is reported."""
        states = list(self._states(node))
        if not states:
            return False
        written = self.checker.written(node)
        each, start = written, node.span.start
        states_are_here = all(start <= state.span.start and state.span.end <= node.span.end for state in states)
        if states_are_here:
            each = self._with_always(node, states)
        message = f"`{self.checker.written(states[0])}` beside a temporal property is ambiguous"
        label = "meant once for all steps, or anew at each step?"
        one, other = writing(node.span, each), around(f"write `always ({written})`", node.span, "always (", ")")
        text = f"{one.title}, or {other.title.removeprefix('write ')}"
        help = Help(text, (one, other) if states_are_here else (other,))
        place, inner = context.at(states[0].span), context.inner(states[0].span)
        self.checker.report("LTL302", place, message, *inner, label=label, help=help)
        for state in states:
            predicate(self.checker, state, context)
        return True

    def _states(self, node: syntax.Node) -> list[syntax.Node]:
        """The largest state predicates that connectives join with temporal properties in `node`."""
        if kind(self.checker, node) != Sort.TEMPORAL:
            return [node]
        if named := property_named(self.checker, node):
            return [node] if self._states(named.node) else []
        if isinstance(node, syntax.Temporal | syntax.Within):
            return []
        return [state for child in syntax.children(node) for state in self._states(child)]

    def _with_always(self, node: syntax.Node, states: list[syntax.Node]) -> str:
        """The text of `node` with `always` before each of `states`."""
        text, start = self.checker.source.text[node.span.start : node.span.end], node.span.start
        for state in reversed(states):
            first, last = state.span.start - start, state.span.end - start
            inner = text[first:last]
            wrapped = f"(always {inner})"
            text = text[:first] + wrapped + text[last:]
        return text


def _bounded(bound: bounds.Period, span: Span, body: Built) -> Built:
    return apply(partial(properties.Within, bound.end, start=bound.start), span, body)


_CONSTRUCTORS: dict[str, type[Property]] = {
    "always": properties.Always,
    "never": properties.Never,
    "eventually": properties.Eventually,
    "after": properties.After,
    "until": properties.Until,
    "after_until": properties.AfterUntil,
    "and": properties.And,
    "or": properties.Or,
    "implies": properties.Implies,
}
