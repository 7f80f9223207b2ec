"""Counts: `once p N times`, which counts at how many steps p occurred, and `rate(s) >= f Hz over D`."""

from __future__ import annotations

from fractions import Fraction

from ltlc.frontend.language import bounds
from ltlc.frontend.language.built import Built, Context, apply
from ltlc.frontend.language.evaluate import MAX_HISTORY, heard_of
from ltlc.frontend.language.names import Checker
from ltlc.frontend.syntax import tree as syntax
from ltlc.semantics import ltl
from ltlc.semantics.durations import UNITS, Nanoseconds, duration_text
from ltlc.semantics.ltl import Atom, Formula, subformulas
from ltlc.semantics.timed_atoms import News
from ltlc.specification import timed
from ltlc.specification.expressions import openings, operands


def counted(
    checker: Checker, node: syntax.Past, times: syntax.NumberLiteral, operand: Built | None, context: Context
) -> Built | None:
    """`once p N times`, of what p is; None if an error was reported."""
    sound, bound = bounds.of_keyword(checker, node)
    within = bound and bound.end
    number = _whole(checker, node, times)
    if operand is None or not sound or number is None or not _can_be_counted(checker, node, operand.formula, context):
        return None
    span = context.at(node.span)
    found = timed.count(operand.formula, number, within)
    built = Built(found, span, (operand,))
    return built if within is not None else Built(timed.once(found, None), span, (built,))


def _whole(checker: Checker, node: syntax.Past, times: syntax.NumberLiteral) -> int | None:
    if node.keyword.text != "once":
        message = f"`{node.keyword.text}` does not count"
        checker.report("LTL232", times.span, message, help=f"`once … {times.text} times` counts past occurrences")
    elif not times.text.isdigit() or not 0 < int(times.text[:9]) <= MAX_HISTORY:
        message = f"`{times.text} times`: a count must be a whole number from 1 to {MAX_HISTORY}"
        checker.report("LTL232", times.span, message)
    else:
        return int(times.text)
    return None


def _can_be_counted(checker: Checker, node: syntax.Past, operand: Formula, context: Context) -> bool:
    """Whether `operand` is decided by what a step brings, and does not change where news is over."""
    written, help = checker.written(node.arguments[0]), "count something that holds at a single step"
    atoms = [part for part in subformulas(operand) if isinstance(part, Atom)]
    taken = (
        side for part in atoms if part.name in context.atoms for side in operands(context.atoms[part.name].condition)
    )
    if any(type(part) not in (Atom, News) for part in atoms) or any(True for side in taken for _ in openings(side)):
        message = f"`{written}` looks back, but a count needs a condition on single steps"
    elif timed.has_news_apart(operand):
        message = f"`{written}` can hold both with and without a new message: it is unclear what to count"
        help = "count a condition on messages, `new s and …`, or one that does not depend on whether a message arrives"
    else:
        return True
    checker.report("LTL232", context.at(node.span), message, *context.inner(node.span), help=help)
    return False


def of_rate(checker: Checker, node: syntax.Rate, context: Context) -> Built | None:
    """`rate(s) >= f Hz over D`, or its negation: as many messages in the last D, or no more than D so far."""
    signal, bound = heard_of(checker, node.signal, "rate"), bounds.period(checker, node.duration)
    duration = bound and bound.end
    if signal is None or duration is None or not _is_rate(checker, node, duration):
        return None
    span = context.at(node.span)
    news = context.news(context.heard(signal), span)
    assert isinstance(news.node, News)
    count = timed.rate(news.node, node.hertz.text, int(_messages(node, duration)), duration)
    found = Built(count, span, (news,))
    return found if node.operator.text == ">=" else apply(ltl.Not, span, found)


def _messages(node: syntax.Rate, duration: Nanoseconds) -> Fraction:
    """How many messages come in a duration at the rate."""
    return Fraction(node.hertz.text) * duration / UNITS["s"]


def _is_rate(checker: Checker, node: syntax.Rate, duration: Nanoseconds) -> bool:
    count, help = _messages(node, duration), ""
    if checker.rate is not None:
        place, message = node.span, "with `_rate_` the steps are ticks, and messages between them are not counted"
        help = "omit `_rate_`, or use the age of the last message: `age(s)`"
    elif node.operator.text not in (">=", "<"):
        place, message = node.operator.span, "a rate is compared with `>=` or `<`"
        upper = f"never once new {checker.written(node.signal)} {count // 1 + 1} times within {duration_text(duration)}"
        help = f"for a lower limit, write `>= {node.hertz.text} Hz`; for an upper limit, `{upper}`"
    elif count.denominator > 1 or not 0 < count <= MAX_HISTORY:
        place = node.hertz.span
        message = f"{node.hertz.text} Hz over {duration_text(duration)} are {float(count):g} messages"
        help = f"it must be a whole number from 1 to {MAX_HISTORY}"
    else:
        return True
    checker.report("LTL232", place, message, help=help)
    return False
