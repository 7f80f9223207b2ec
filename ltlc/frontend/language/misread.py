"""What is well formed, but may be read otherwise than it is meant: second properties, nesting, slips in names."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Fix, Help, Label
from ltlc.base.fixes import around
from ltlc.base.nearest import Words, slip, words
from ltlc.base.source import Source, Span
from ltlc.frontend.language.bounds import is_parenthesised
from ltlc.frontend.language.names import Checker, Sort
from ltlc.frontend.language.references import kind
from ltlc.frontend.syntax import tree as syntax

_SAME_APART = {("always", "and", "always"), ("always", "and", "never"), ("eventually", "or", "eventually")}
"""Keywords that mean the same whether the connective stands inside or outside their argument."""


def second_on_line(source: Source, first: syntax.PropertyCommand, second: syntax.PropertyCommand) -> Diagnostic:
    """A property without a label that begins on the line on which another ends: was it meant to be a part of that?"""
    one, other = first.property.span, second.property.span
    message = f"this is read as two properties: `{source.excerpt(one)}`, then `{source.excerpt(other)}`"
    text = f"begin the second on a new line; if it is one property, {_joined(source, first.property, second.property)}"
    help = Help(text, (Fix("begin the second on a new line", ((Span(one.end, other.start), "\n"),)),))
    label = Label(one, "the first ends here")
    return diagnostic("LTL019", source, other, message, secondary=(label,), help=help)


def _joined(source: Source, one: syntax.Node, other: syntax.Node) -> str:
    """How two properties could be written as one."""
    first, second = source.excerpt(one.span), source.excerpt(other.span)
    if isinstance(other, syntax.Temporal) and other.keyword.text == "until":
        return f"`until` and its event come first: `until {source.excerpt(other.arguments[0].span)}, {first}`"
    return f"an operator is needed between them, as in `{first} and {second}`"


def note_inside(checker: Checker, node: syntax.Temporal) -> None:
    """Say that what a connective joins to the argument of a keyword is inside that, where this matters."""
    keyword, argument = node.keyword.text, node.arguments[0]
    if not isinstance(argument, syntax.Connective) or is_parenthesised(checker, argument):
        return
    operator, right = argument.operator.text, argument.right
    if operator == "implies" or kind(checker, right) != Sort.TEMPORAL:
        return
    inner = right.keyword.text if isinstance(right, syntax.Temporal) else ""
    if (keyword, operator, inner) in _SAME_APART:
        return
    first, second = (checker.written(side) for side in (argument.left, right))
    message = f"`{second}` is inside `{keyword}`, which is read as `{keyword} ({first} {operator} {second})`"
    other = f"`({keyword} {first}) {operator} {second}`"
    inside = around(f"write `{keyword} ({first} {operator} {second})`", argument.span, "(", ")")
    outside = around(f"write {other}", Span(node.keyword.span.start, argument.left.span.end), "(", ")")
    help = Help(f"write it that way if you mean it; otherwise {other}", (inside, outside))
    checker.report("LTL311", right.span, message, Label(node.keyword.span, "this keyword extends over it"), help=help)


def report_similar(checker: Checker, tree: syntax.SyntaxTree) -> None:
    """Objects that nothing declares and that are called almost as others: declared ones, used more, or used before."""
    names = checker.names
    declared = {*names.objects, *names.models}
    weights: dict[Words, float] = {words(name): math.inf for name in declared}
    families: dict[Words, list[str]] = {}
    for name, uses in names.undeclared.items():
        family = words(name)
        weights[family] = weights.get(family, 0) + len(uses)
        families.setdefault(family, []).append(name)
    in_sets = {w.text: w.span for c in tree.commands if isinstance(c, syntax.PropertyCommand) for w in c.names.values()}
    likely = sorted(weights, key=lambda family: -weights[family])
    for number, family in enumerate(likely):
        wrong, right = next((found for other in likely[:number] if (found := slip(family, other))), ("", ""))
        for name in families.get(family, ()) if wrong else ():
            if name not in declared and name.isascii():
                place = in_sets.get(name, names.undeclared[name][0])
                written = {place, *names.undeclared[name]}
                _report_slip(checker, place, name, name.replace(wrong, right), sorted(written))


def _report_slip(checker: Checker, place: Span, name: str, meant: str, uses: Sequence[Span]) -> None:
    message = f"nothing declares the object `{name}`: did you mean `{meant}`?"
    edits = tuple((use, meant) for use in uses if checker.source.text[use.start : use.end] == name)
    help = Help(f"if it exists, declare it: `object {name} TOPIC TYPE`", (Fix(f"write `{meant}`", edits),))
    checker.report("LTL110", place, message, help=help)
