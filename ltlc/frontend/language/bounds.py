"""Bounds on time: what each keyword can be given, and the readings of what it cannot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ltlc.base.diagnostics import Fix, Help, Label
from ltlc.base.fixes import around, put, write, writing
from ltlc.base.source import Span
from ltlc.frontend.language.evaluate import value
from ltlc.frontend.language.names import Checker
from ltlc.frontend.language.values import Duration, Scalar
from ltlc.frontend.syntax import tree as syntax
from ltlc.semantics.durations import UNITS, Nanoseconds
from ltlc.specification.expressions import Number

TAKES = {
    "eventually": "within",
    "never": "within",
    "always": "for",
    "once": "within",
    "since": "within",
    "historically": "for",
}
"""The keywords that can have a bound after their argument, and the word that it begins with."""

READINGS = {
    "within": ("eventually {} within {}", "once {} within {}"),
    "for": ("always {} for {}", "historically {} for {}"),
}
"""What a bound without a keyword can mean: what is to come, and what has been."""

INSTEAD = {
    "eventually": ("eventually {} within {}", "eventually historically {} for {}"),
    "never": ("never {} within {}", "never historically {} for {}"),
    "always": ("always {} for {}", "always eventually {} within {}"),
    "once": ("once {} within {}", "historically {} for {}"),
    "historically": ("historically {} for {}", "once {} within {}"),
    "previously": ("once {} within {}", "historically {} for {}"),
}
"""What may have been meant by a keyword with a bound that it does not take."""


class Period(NamedTuple):
    """The time of a bound: from `start` to `end` after the instant at which its scope begins, `start` before `end`."""

    start: Nanoseconds
    end: Nanoseconds


def period(checker: Checker, node: syntax.Node) -> Period | None:
    """The duration or interval of a bound; None if an error was reported."""
    if isinstance(node, syntax.Interval):
        return _interval(checker, node)
    end = _duration(checker, node)
    if end == 0:
        message = "a bound of 0 leaves no time for anything to happen"
        checker.report("LTL217", node.span, message, help="omit the bound: what must hold immediately needs none")
    return Period(0, end) if end else None


def _interval(checker: Checker, node: syntax.Interval) -> Period | None:
    start, end = (_duration(checker, each) for each in (node.start, node.end))
    if start is None or end is None:
        return None
    if start < end:
        return Period(start, end)
    first, last = (checker.written(each) for each in (node.start, node.end))
    help: Help | str = (
        "an interval must end later than it begins; one that lasts a nanosecond is `[2 s, 2000000001 ns]`"
    )
    if start > end:
        help = write(writing(node.span, f"[{last}, {first}]"))
    message = f"the interval from {first} to {last} is empty"
    checker.report("LTL217", node.span, message, help=help)
    return None


def _duration(checker: Checker, node: syntax.Node) -> Nanoseconds | None:
    """The duration that `node` is; None if an error was reported."""
    found = value(checker, node)
    match found:
        case None:
            return None
        case Duration(duration):
            return duration
        case Scalar(Number()):
            written = checker.written(node)
            fixes = tuple(
                Fix(f"write `{written} {unit}`", put(node.span.end, f" {unit}").edits) for unit in ("s", "ms")
            )
            help = Help(f"write `{written} s`, `{written} ms` or another of the units {_units()}", fixes)
            checker.report("LTL216", node.span, f"the bound `{written}` has no unit", help=help)
            return None
        case _:
            pass
    message = f"`{checker.written(node)}` is {found.noun}, but a duration is needed here"
    checker.report("LTL216", node.span, message, help=f"a duration is a number with one of the units {_units()}")
    return None


def _units() -> str:
    return " ".join(f"`{unit}`" for unit in UNITS)


def of_keyword(checker: Checker, node: syntax.Temporal | syntax.Past) -> tuple[bool, Period | None]:
    """Whether the bound after the arguments of `node` is valid, and its time; None without a bound."""
    if node.bound is None:
        return True, None
    if TAKES.get(node.keyword.text) == node.bound.keyword.text:
        if nearer := _nearer(checker, node.arguments[-1], node.bound.keyword.text):
            _two_readings(checker, node.keyword.text, node.arguments[-1], nearer, node.bound)
            return False, None
        if isinstance(node, syntax.Past) and isinstance(node.bound.duration, syntax.Interval):
            _unbounded_memory(checker, node.keyword.text, node.bound, node.bound.duration)
            return False, None
        found = period(checker, node.bound.duration)
        return found is not None, found
    wrong(checker, node.keyword.text, node.arguments, node.bound, node.keyword.span.start)
    return False, None


def _unbounded_memory(checker: Checker, keyword: str, bound: syntax.Bound, interval: syntax.Interval) -> None:
    """Report an interval in the past: each moment of it would have to be kept until it is as long ago as the end."""
    message = f"`{keyword}` takes no interval: a monitor would have to store everything that happened in the last "
    message += f"{checker.written(interval.end)}, without limit"
    to_now = f"{bound.keyword.text} {_raw(checker, interval.end)}"
    help = write(Fix(f"write `{to_now}`, which looks back from now on", ((bound.span, to_now),)))
    checker.report("LTL308", bound.span, message, help=help)


def _nearer(checker: Checker, node: syntax.Node, preposition: str) -> syntax.Past | None:
    """A keyword in `node`, not in parentheses, that is nearer to a bound after it and could be taken for its own."""
    if is_parenthesised(checker, node):
        return None
    if isinstance(node, syntax.Past) and node.bound is None and TAKES.get(node.keyword.text) == preposition:
        return node
    return next((found for part in syntax.children(node) if (found := _nearer(checker, part, preposition))), None)


def is_parenthesised(checker: Checker, node: syntax.Node) -> bool:
    """Whether parentheses stand around all of `node`."""
    inside = syntax.children(node)
    return checker.source.text[node.span.start] == "(" and (not inside or inside[0].span.start > node.span.start)


def _two_readings(checker: Checker, keyword: str, body: syntax.Node, nearer: syntax.Past, bound: syntax.Bound) -> None:
    """Report a bound after an argument in which another keyword stands, whose own argument ends before the bound."""
    far, near, written = checker.written(body), checker.written(nearer), checker.written(bound)
    message = f"`{written}` could be the bound of `{nearer.keyword.text}` or of `{keyword}`"
    text = f"write `{keyword} ({far}) {written}`, or replace `{near}` by `({near} {written})`"
    outer = around(f"write `{keyword} ({far}) {written}`", body.span, "(", ")")
    inner = around(f"write `({near} {written})`", nearer.span, "(", f" {written})")
    moved = Fix(inner.title, (*inner.edits, (Span(body.span.end, bound.span.end), "")))
    help = Help(text, (outer, moved))
    place = Label(nearer.keyword.span, "this is nearer, but its operand ends before the bound")
    checker.report("LTL309", bound.span, message, place, help=help)


def wrong(checker: Checker, keyword: str, arguments: Sequence[syntax.Node], bound: syntax.Bound, start: int) -> None:
    """Report a bound that `keyword`, which stands at `start`, does not take, and what may have been meant."""
    given, takes, body = bound.keyword.text, TAKES.get(keyword), arguments[-1]
    message = f"`{keyword}` takes a bound with `{takes}`, not with `{given}`"
    if takes is None:
        message = f"`{keyword}` takes no bound"
    forms: Sequence[str] = INSTEAD.get(keyword, READINGS[given])
    if keyword not in INSTEAD:
        start = body.span.start
    if keyword == "since":
        start, forms = arguments[0].span.start, (f"{_in_form(checker, arguments[0])} since {{}} within {{}}",)
    if keyword == "always" and (rule := _rule(body)):
        forms = [f"always ({_in_form(checker, rule.left)} implies {form})" for form in READINGS[given]]
        body = rule.right
    checker.report("LTL308", bound.span, message, help=_either(checker, forms, body, bound, start))


def stray(checker: Checker, node: syntax.StrayBound) -> None:
    """Report a bound that no keyword stands before, with what it can mean."""
    forms: Sequence[str] = READINGS[node.bound.keyword.text]
    body = node.body
    if rule := _rule(body):
        forms, body = [f"{_in_form(checker, rule.left)} implies {form}" for form in forms], rule.right
    message = f"the bound `{checker.written(node.bound)}` belongs to no keyword: does it look ahead or back?"
    checker.report(
        "LTL016", node.bound.span, message, help=_either(checker, forms, body, node.bound, node.body.span.start)
    )


def _rule(node: syntax.Node) -> syntax.Connective | None:
    """`node`, if it is an implication, after whose right side a bound is probably meant for that."""
    return node if isinstance(node, syntax.Connective) and node.operator.text == "implies" else None


def _raw(checker: Checker, node: syntax.Node) -> str:
    return checker.source.text[node.span.start : node.span.end]


def _in_form(checker: Checker, node: syntax.Node) -> str:
    """The text of `node` as a part of a form, in which braces are twice."""
    return _raw(checker, node).replace("{", "{{").replace("}", "}}")


def _either(checker: Checker, forms: Sequence[str], body: syntax.Node, bound: syntax.Bound, start: int) -> Help:
    """`forms` with the text of `body` and of the duration put in, for what stands from `start` to the bound's end."""
    written, duration = _raw(checker, body), _raw(checker, bound.duration)
    if isinstance(body, syntax.Connective | syntax.Past | syntax.Temporal | syntax.Within) and written[0] != "(":
        written = f"({written})"
    place = Span(start, bound.span.end)
    return write(*(writing(place, form.format(written, duration)) for form in forms))
