"""Values at openings where several openings could be meant: which, and how to write each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ltlc.base.diagnostics import Fix, Help
from ltlc.base.fixes import with_fixes
from ltlc.base.source import Span
from ltlc.frontend.language.bounds import is_parenthesised
from ltlc.frontend.language.built import Context
from ltlc.frontend.language.names import Checker, Sort
from ltlc.frontend.language.references import kind, property_named
from ltlc.frontend.syntax import tree as syntax


def has_one_opening(checker: Checker, node: syntax.Node, context: Context, value: str) -> bool:
    """Whether there is one opening at which `value`, which `node` reads, can be taken; if not, it is reported."""
    if not (context.triggers or context.overlapping):
        return True
    place, inner = context.at(node.span), context.inner(node.span)
    if context.overlapping:
        message = f"`{value}` has no single opening"
        label = "under `always`, `never` or `eventually` the scope may be open several times at once"
        help = "put the scope outside: its episodes do not overlap, and each has one opening"
        checker.report("LTL312", place, message, *inner, label=label, help=help)
        return False
    scope = "the scope around opened" if context.scope else "the run began"
    trigger = checker.written(context.triggers[-1].left)
    message = f"`{value}` behind `implies`: the value when {scope}, or when `{trigger}` began to hold?"
    either = _either(checker, scope, context.triggers)
    if not context.scope and (each := _from_each_message(checker, context.triggers)):
        either = replace(either, text=f"{either.text}; for the value at each message, write `{each}`")
    checker.report("LTL312", place, message, *inner, help=either)
    return False


def _from_each_message(checker: Checker, triggers: Sequence[syntax.Connective]) -> str:
    """The property that begins at each message, if the only one of `triggers` is a message that comes."""
    left, right = triggers[0].left, triggers[0].right
    if len(triggers) > 1 or not isinstance(left, syntax.News):
        return ""
    if isinstance(right, syntax.Temporal | syntax.Within):
        return f"each {checker.written(left)}: {checker.written(right)}"
    if kind(checker, right) == Sort.TEMPORAL:
        return ""
    return f"each {checker.written(left)}: initially {checker.written(right)}"


def _either(checker: Checker, scope: str, triggers: Sequence[syntax.Connective]) -> Help:
    """How to write either value: `or` opens nothing, and a scope does. A bound has no clock behind `or`."""
    began = "for the value when P began to hold, write `after_until P, END, …` instead of `always`"
    if any(_is_bounded(checker, trigger.right) for trigger in triggers):
        return Help(began)
    whole, text = triggers[0].span, checker.source.text
    edits = tuple(edit for trigger in triggers for edit in _alternatives(checker, trigger))
    if not all(whole.start <= span.start and span.end <= whole.end for span, _ in edits):
        return Help(f"write `not (P) or …` for the value when {scope}; {began}")
    written = with_fixes(text, [Fix("", edits)])[whole.start : whole.end - len(text) or None]
    fix = Fix(f"write `{' '.join(written.split())}`", edits)
    return Help(f"{fix.title} for the value when {scope}; {began}", (fix,))


def _alternatives(checker: Checker, node: syntax.Connective) -> Iterator[tuple[Span, str]]:
    """What makes `not (P) or (Q)` of `P implies Q`."""
    left, right = node.left, node.right
    opened, closed = zip(*(_parentheses(checker, side) for side in (left, right)), strict=True)
    yield Span(left.span.start, left.span.start), f"not {opened[0]}"
    yield Span(left.span.end, right.span.start), f"{closed[0]} or {opened[1]}"
    yield Span(right.span.end, right.span.end), closed[1]


def _parentheses(checker: Checker, node: syntax.Node) -> tuple[str, str]:
    """Those that `node` needs under `not` and `or`."""
    return ("", "") if isinstance(node, syntax.Reference) or is_parenthesised(checker, node) else ("(", ")")


def _is_bounded(checker: Checker, node: syntax.Node) -> bool:
    """Whether a bound stands in the property `node`."""
    if named := property_named(checker, node):
        return _is_bounded(checker, named.node)
    if isinstance(node, syntax.Within) or (isinstance(node, syntax.Temporal) and node.bound is not None):
        return True
    return any(_is_bounded(checker, part) for part in syntax.children(node))
