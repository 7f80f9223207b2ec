"""Conditions on the elements of arrays: `any`, `all` and `count` become the count of those that satisfy something."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import chain

from ltlc.base.diagnostics import Fix, Help
from ltlc.base.fixes import around
from ltlc.base.source import Span
from ltlc.frontend.language.built import Built, Context
from ltlc.frontend.language.names import Checker
from ltlc.frontend.language.values import Array, Scalar, Value
from ltlc.frontend.syntax import tree as syntax
from ltlc.semantics import ltl
from ltlc.semantics.ltl import Formula
from ltlc.semantics.timed_atoms import News
from ltlc.specification.expressions import (
    Comparison,
    Condition,
    Count,
    Element,
    Field,
    Input,
    Number,
    Recent,
    Relation,
    When,
    children,
    inputs,
    openings,
    operands,
    subexpressions,
)
from ltlc.specification.text import ordering_text, over_text, predicate_text
from ltlc.specification.text import text as expression_text

Conditions = dict[str, Condition]
"""Conditions by the names of their atoms."""


def quantified(checker: Checker, node: syntax.Quantified, context: Context) -> Built | None:
    """`any`: at least one element satisfies the condition; `all`: none fails to. None if an error was reported."""
    is_any = node.quantifier.text == "any"
    count = counted(checker, node, context, holds=is_any)
    if count is None:
        return None
    said, _ = simplified(count.predicate, dict(count.conditions), holds=is_any)
    relation = Relation.AT_LEAST if is_any else Relation.LESS
    name = f"{node.quantifier.text}({predicate_text(said)}{over_text(count)})"
    return context.atom(name, Comparison(count, relation, Number(1.0)), context.at(node.span))


def counted(checker: Checker, node: syntax.Quantified, around: Context, holds: bool = True) -> Count | None:
    """The count of the elements that satisfy the condition of `node` or, with `holds` false, of those that do not.

    None if an error was reported.
    """
    from ltlc.frontend.language.predicates import predicate  # values and predicates are made of one another

    context = Context(polarity=around.polarity, triggers=around.triggers, overlapping=around.overlapping)
    found = predicate(replace(checker, elementwise=True), node.condition, context)
    if found is None:
        return None
    conditions: Conditions = {name: atom.condition for name, atom in context.atoms.items()}
    if any(name not in conditions or type(part) is not ltl.Atom for part, name in _atoms(found.formula)):
        help = f"put it around `{node.quantifier.text}(…)`"
        checker.report("LTL230", node.span, "a condition on elements cannot look back or wait for messages", help=help)
        return None
    lists = _lists(checker, node)
    if lists is None:
        return None
    predicate_, used = simplified(found.formula, conditions, holds)
    count = Count(predicate_, tuple(used.items()), lists)
    return count if _is_sound(checker, node, count) else None


def _lists(checker: Checker, node: syntax.Quantified) -> tuple[tuple[Element, ...], ...] | None:
    """The lists of arrays whose elements are combined; None if an error was reported."""
    lists = [[_element(checker, array) for array in arrays] for arrays in node.over]
    if any(element is None for elements in lists for element in elements):
        return None
    found = tuple(tuple(element for element in elements if element is not None) for elements in lists)
    seen: set[Element] = set()
    for element, array in zip(chain(*found), chain(*node.over), strict=True):
        if element in seen:
            message = f"`{checker.written(array)}` is listed twice: an array cannot be combined with itself"
            checker.report("LTL230", array.span, message, help="list each array once")
            return None
        seen.add(element)
    return found


def _element(checker: Checker, node: syntax.Node) -> Element | None:
    """An element of the array `node`; None if an error was reported."""
    from ltlc.frontend.language.evaluate import value  # counts are values

    found = value(replace(checker, elementwise=True), node)
    expression = getattr(found, "expression", None)
    if found is not None and not isinstance(expression, Element):
        message = f"`over` lists arrays, but `{checker.written(node)}` is {found.noun}"
        checker.report("LTL230", node.span, message, help="omit single values from the list")
        return None
    return expression


def holding(checker: Checker, node: syntax.Node) -> When | None:
    """That the state predicate `node` holds, by what is read at a step; None if an error was reported."""
    from ltlc.frontend.language.predicates import predicate  # values and predicates are made of one another

    context = Context(polarity=0)
    found = predicate(replace(checker, elementwise=False), node, context)
    if found is None:
        return None
    conditions = {name: atom.condition for name, atom in context.atoms.items()}
    looks_back = any(
        name not in conditions or type(part) not in (ltl.Atom, News) for part, name in _atoms(found.formula)
    )
    if looks_back or any(True for each in conditions.values() for side in operands(each) for _ in openings(side)):
        message = f"`{checker.written(node)}` looks back, but this must be a condition on a single step"
        checker.report("LTL231", node.span, message, help="write a condition on that step itself")
        return None
    return When(found.formula, tuple(conditions.items()))


def _atoms(formula: Formula) -> Iterable[tuple[Formula, str]]:
    return ((part, part.name) for part in ltl.subformulas(formula) if isinstance(part, ltl.Atom))


def simplified(formula: Formula, conditions: Conditions, holds: bool) -> tuple[Formula, Conditions]:
    """`formula`, or its negation if not `holds`, negating only equalities, and the conditions of its atoms.

    Of measurements, which are not NaN, an ordering that does not hold is the opposite one: so `all(scan >= 0.3)` and
    `any(scan < 0.3)` count the same.
    """
    match formula:
        case ltl.Not(operand):
            return simplified(operand, conditions, not holds)
        case ltl.And(left, right) | ltl.Or(left, right):
            one, first = simplified(left, conditions, holds)
            other, second = simplified(right, conditions, holds)
            joined = ltl.And if isinstance(formula, ltl.And) == holds else ltl.Or
            return joined(one, other), first | second
        case ltl.Atom(name):
            return _literal(name, conditions[name], holds)
        case _:
            return (formula if holds else ltl.Not(formula)), {}


def _literal(name: str, condition: Condition, holds: bool) -> tuple[Formula, Conditions]:
    if holds:
        return ltl.Atom(name), {name: condition}
    if isinstance(condition, Comparison) and (opposite := condition.relation.opposite):
        return _literal(ordering_text(flipped := replace(condition, relation=opposite)), flipped, holds=True)
    return ltl.Not(ltl.Atom(name)), {name: condition}


def _is_sound(checker: Checker, node: syntax.Quantified, count: Count) -> bool:
    """Whether it is known which elements go side by side, and which are combined; else that is reported."""
    word, listed = node.quantifier.text, tuple(chain(*count.over))
    if any(isinstance(part, Count) for side in children(count) for part in subexpressions(side)):
        message = f"a condition on each element inside `{word}` cannot be about all elements"
        checker.report("LTL230", node.span, message, help="write it outside: `count(…) > 5 and any(…)`")
    elif not count.elements:
        message = f"`{word}` needs an array, but `{checker.written(node.condition)}` contains none"
        checker.report("LTL230", node.condition.span, message, help="declare an array, such as `LaserScan.ranges`")
    elif count.over and (missing := [each for each in count.elements if each not in listed]):
        message = f"`{expression_text(missing[0].array)}` is missing from the lists of `over`"
        checker.report("LTL230", node.span, message, help="list every array that the condition uses")
    elif unread := [each for each in listed if each not in count.elements]:
        message = f"`over` lists `{expression_text(unread[0].array)}`, which the condition does not use"
        checker.report("LTL230", node.span, message, help="omit it, or use its elements")
    else:
        return all(_belong_together(checker, node, elements) for elements in count.lists)
    return False


def _belong_together(checker: Checker, node: syntax.Quantified, elements: Sequence[Element]) -> bool:
    """Whether it is known which elements go side by side; else that is reported."""
    fields = {expression_text(read): read for element in elements for read in [next(inputs(element))]}
    first, *others = fields.values()
    if all(_is_beside(first, other) for other in others):
        return True
    named = " and ".join(f"`{name}`" for name in fields)
    message = f"{named} are not side by side in one message: it is not known which elements belong together"
    apart = ", ".join(f"({name})" for name in fields)
    help = f"compare single values with the elements of one array; or, to combine all elements, write `… over {apart}`"
    checker.report("LTL230", node.condition.span, message, help=help)
    return False


def _is_beside(one: Input, other: Input) -> bool:
    """Whether the elements of two arrays with the same index belong together."""
    first, second = one.signal.definition, other.signal.definition
    if isinstance(one, Recent) or isinstance(other, Recent) or not isinstance(first, Field):
        return one == other
    return isinstance(second, Field) and first.is_beside(second)


def of_elements(checker: Checker, node: syntax.Comparison, left: Value, right: Value) -> Help:
    """Conditions on elements, to write instead of a comparison with an array."""
    said, relation = checker.written(node), Relation(node.operator.text.replace("!=", "=="))
    help = f"say which elements: `any({said})` or `all({said})`"
    fixes = said_of("any", checker, node), said_of("all", checker, node)
    if relation is Relation.EQUAL or not isinstance(left, Scalar | Array) or not isinstance(right, Scalar):
        return Help(help, fixes)
    fold = "min" if relation in (Relation.LESS, Relation.AT_MOST) else "max"
    rest = checker.written(replace(node, span=Span(node.operator.span.start, node.span.end)))
    return Help(f"{help}; the first is `{fold}({checker.written(node.left)}) {rest}`", fixes)


def said_of(quantifier: str, checker: Checker, node: syntax.Node) -> Fix:
    """The fix that demands `node` of `any`, or of `all`, elements."""
    return around(f"write `{quantifier}({checker.written(node)})`", node.span, f"{quantifier}(", ")")
