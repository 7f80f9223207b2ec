"""Times as terms: an instant and so many nanoseconds, of which it is known only whether a clock is late."""

from __future__ import annotations

from ltlc.assurance.reading.language import NEVER, Apply, Constant, Moment, NotUnderstoodError, Term
from ltlc.assurance.reading.text import text

TIME = Moment("time")
"""The time of the instant."""

HELD = Moment("time", -1)
"""The last nanosecond before a clock step, in which the letter before it was held, and at which it was due."""

DUE = Moment("due")
"""When the next clock step is due, before a step: the least of the due times, or the time of the instant before."""


def late(due: Term) -> Term:
    """That the time of the instant is past a due time."""
    return Apply("late", (due,))


def of_times(function: str, values: tuple[Term, ...]) -> Term:
    """A function of times; of an order that is not known, only whether a clock is late can be asked."""
    match function, values:
        case "+", (Moment(base, offset), Constant(int(more))) if base != NEVER.base:
            return Moment(base, offset + more)
        case "-", (Moment(base, offset), Constant(int(less))) if base != NEVER.base:
            return Moment(base, offset - less)
        case "min", _ if all(isinstance(each, Moment) or is_least(each) for each in values):
            return least(values)
        case ">", (left, right):
            return _later(left, right)
        case "<", (left, right):
            return _later(right, left)
        case "<=", (left, right):
            return Apply("not", (_later(left, right),))
        case ">=", (left, right):
            return Apply("not", (_later(right, left),))
        case _:
            raise NotUnderstoodError(f"`{text(Apply(function, values))}` is nothing to do with times")


def _later(left: Term, right: Term) -> Term:
    """That `left` is later than `right`."""
    match left, right:
        case Moment("time", _), Moment("never", 0):
            return Constant(False)
        case Moment(base, one), Moment(other, two) if base == other and base != NEVER.base:
            return Constant(one > two)
        case Moment("time", 0), Moment(_, 0):
            return late(right)
        case _:
            raise NotUnderstoodError(f"`{text(Apply('>', (left, right)))}` is nothing to ask of times")


def least(times: tuple[Term, ...]) -> Term:
    """The earliest of times: one of them, or all that it may be."""
    found: set[Term] = set()
    for each in times:
        found |= set(each.arguments) if isinstance(each, Apply) else {each}
    found = found - {NEVER} or {NEVER}
    return found.pop() if len(found) == 1 else Apply("min", tuple(sorted(found, key=text)))


def is_least(term: Term) -> bool:
    """Whether it is the earliest of several times."""
    return isinstance(term, Apply) and term.function == "min"
