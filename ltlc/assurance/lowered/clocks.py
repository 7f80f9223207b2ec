"""What an instant does to the clocks of a formula, by definition."""

from __future__ import annotations

from ltlc.assurance.lowered.language import NEVER, DiffersError, Moment, Term
from ltlc.assurance.lowered.times import HELD, TIME
from ltlc.semantics.timed_atoms import Age, Previously
from ltlc.semantics.trackers import ALWAYS, Case, Phase, State, Tracker


def is_age(tracker: Tracker) -> bool:
    """Whether its clock is renewed by messages: instants do not set it."""
    return isinstance(tracker.subject, Age)


def counts(tracker: Tracker, state: State) -> bool:
    """Whether the clock of `tracker` has a bound yet to pass, and is one that instants set."""
    return not is_age(tracker) and tracker.is_running(state)


def due_after(tracker: Tracker, before: State, case: Case, due: Term, by_time: bool) -> Term:
    """When the clock is due after an instant, before which it was in the state `before`, and due at `due`."""
    if is_age(tracker):
        return due
    if not counts(tracker, case.state):
        return NEVER
    bounds, passed = tracker.bounds, case.state.passed
    if case.starts:
        return _later(TIME, bounds[passed])
    if before.phase is Phase.HELD:
        return _later(HELD if by_time else TIME, bounds[passed])
    if not counts(tracker, before):
        raise DiffersError("a clock counts that has not been started")
    return _later(due, bounds[passed] - bounds[before.passed])


def _later(moment: Term, duration: int) -> Moment:
    if not isinstance(moment, Moment) or moment.base == NEVER.base:
        raise DiffersError("a clock counts that is never due")
    return Moment(moment.base, moment.offset + duration)


def is_behind(tracker: Tracker, case: Case) -> bool:
    """Whether it says of `previously p` what a nanosecond later is no more so."""
    return isinstance(tracker.subject, Previously) and bool(case.holding) != (case.state == ALWAYS)
