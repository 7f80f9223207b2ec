"""What it means that a clock is past a bound, in words."""

from __future__ import annotations

from ltlc.semantics.durations import Nanoseconds, duration_text
from ltlc.semantics.intervals import start_of
from ltlc.semantics.ltl import TRUE, And, Atom, Formula, Not, Or, Truth
from ltlc.semantics.timed_atoms import (
    AfterOpened,
    Clock,
    EpisodeOpened,
    FirstOpen,
    Historically,
    LastTrigger,
    UntilScope,
)
from ltlc.specification.specification import THIS_ONE


def lateness(clock: Clock, bound: Nanoseconds) -> str:
    """That more than `bound` has passed on `clock`; of an interval, since the scope around it began."""
    match clock:
        case AfterOpened(outer, Historically(lasting=int(start)) as event) if event == start_of(outer, start):
            return lateness(outer, start + bound)
        case _:
            return f"more than {duration_text(bound)} since {_moment(clock)}"


def _moment(clock: Clock) -> str:
    """When a clock starts."""
    match clock:
        case AfterOpened(outer, Historically(lasting=int(start)) as event) if event == start_of(outer, start):
            return f"{duration_text(start)} after {_moment(outer)}"
        case AfterOpened(_, Atom(name)) if name.endswith(THIS_ONE):
            return f'this "{name.removesuffix(THIS_ONE)}"'
        case AfterOpened(outer, event):
            return f"the first {_quoted(event)}{_inside(outer)}"
        case UntilScope(outer):
            return _moment(outer)
        case EpisodeOpened(outer, opening):
            return f"{_quoted(opening)} opened the scope{_inside(outer)}"
        case FirstOpen(outer, trigger, goal):
            first = "moment" if trigger == TRUE else _quoted(trigger)
            return f"the first {first} without {_quoted(goal)}{_inside(outer)}"
        case LastTrigger(outer, trigger):
            return f"the last {_quoted(trigger)}{_inside(outer)}"
        case _:
            return str(clock)


def _inside(outer: Clock) -> str:
    """The scope that a moment belongs to, unless it is the whole run."""
    found = _moment(outer)
    return "" if found == "the beginning" else f" after {found}"


def _quoted(predicate: Formula) -> str:
    """A state predicate as the language has it, in quotes unless it is a name."""
    found = _predicate(predicate)
    return found if found.isidentifier() else f'"{found}"'


def _predicate(formula: Formula, around: str = "") -> str:
    """A state predicate as the language has it, as an operand of `around`, if that is an operator."""
    match formula:
        case Truth():
            return "true"
        case Not(Truth()):
            return "false"
        case Atom(name):
            return name
        case Not(operand):
            return f"not {_predicate(operand, 'not')}"
        case And(left, right):
            operator = "and"
        case Or(left, right):
            operator = "or"
        case _:
            raise TypeError(f"not a state predicate: {formula}")
    text = f"{_predicate(left, operator)} {operator} {_predicate(right, operator)}"
    return text if around in ("", operator) else f"({text})"
