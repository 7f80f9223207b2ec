"""Intervals, `within [A, B], P`, said by scopes and bounds: monitors and certificates know nothing else.

That A has passed in a scope is a state predicate: that the scope is open has held for A. So P is judged after that, up
to B − A later. `within` counts from where its scope opens, at an *anchor*: under `always`, `never` and `eventually` an
interval stays.
"""

from __future__ import annotations

from typing import assert_never

from ltlc.semantics import ltl
from ltlc.semantics.denotation import satisfies
from ltlc.semantics.durations import Nanoseconds, duration_text
from ltlc.semantics.ltl import TRUE, Formula
from ltlc.semantics.properties import (
    After,
    AfterUntil,
    Always,
    And,
    Eventually,
    Implies,
    Never,
    Not,
    Now,
    Or,
    Property,
    Throughout,
    Until,
    Within,
    children,
)
from ltlc.semantics.timed_atoms import (
    BEGINNING,
    AfterOpened,
    Clock,
    EpisodeOpened,
    Historically,
    Since,
    UntilScope,
)


def without_intervals(property_: Property, clock: Clock = BEGINNING) -> Property:
    """`property_` without intervals at anchors, with the same meaning on every word of instants.

    `clock` is that of the scope around.
    """
    if not _has_interval(property_):
        return property_
    match property_:
        case Within(duration, body, start) if start:
            return _after(start_of(clock, start), Within(duration - start, body), clock)
        case Within(duration, body):
            return Within(duration, without_intervals(body, clock))
        case Not(operand):
            return Not(without_intervals(operand, clock))
        case And(left, right) | Or(left, right) | Implies(left, right):
            return type(property_)(without_intervals(left, clock), without_intervals(right, clock))
        case After(event, body):
            return After(event, without_intervals(body, AfterOpened(clock, event)))
        case Until(event, body):
            return Until(event, without_intervals(body, UntilScope(clock, event)))
        case AfterUntil(opening, closing, body):
            return AfterUntil(opening, closing, without_intervals(body, EpisodeOpened(clock, opening, closing)))
        case Always() | Never() | Eventually() | Now() | Throughout():
            return property_
        case _:
            assert_never(property_)


def _has_interval(property_: Property) -> bool:
    return (isinstance(property_, Within) and property_.start > 0) or any(map(_has_interval, children(property_)))


def _after(start: Formula, body: Property, clock: Clock) -> Property:
    """`body` from `start` on, of no instants where that does not come."""
    inside = without_intervals(body, AfterOpened(clock, start))
    return After(start, inside) if satisfies((), body) else Not(After(start, Not(inside)))


def start_of(clock: Clock, start: Nanoseconds) -> Formula:
    """The state predicate that the scope which `clock` measures has been open for `start`."""
    return Historically(f"{duration_text(start)} since {clock}", _is_open(clock), start)


def _is_open(clock: Clock) -> Formula:
    """That the scope that `clock` measures is open, or was where that of an `until` ended."""
    match clock:
        case AfterOpened(outer, event):
            return _since(clock, _is_open(outer), event)
        case EpisodeOpened(outer, opening, closing):
            return _since(clock, _both(_is_open(outer), ltl.Not(closing)), opening)
        case UntilScope(outer):
            return _is_open(outer)
        case _:
            return TRUE


def _since(clock: Clock, kept: Formula, opening: Formula) -> Formula:
    """That `kept` has held since an `opening`."""
    return Since(f"open {clock}", kept, _both(kept, opening))


def _both(left: Formula, right: Formula) -> Formula:
    return right if left == TRUE else ltl.And(left, right)
