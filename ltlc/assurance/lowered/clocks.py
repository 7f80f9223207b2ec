"""What an instant does to the clocks of a formula, by definition."""

from __future__ import annotations

from typing import NamedTuple

from ltlc.semantics.timed_atoms import Age, Previously
from ltlc.semantics.trackers import ALWAYS, Case, Phase, State, Tracker


class Moment(NamedTuple):
    """`offset` nanoseconds after `base`, of which it is known only whether a clock that is due then is late."""

    base: str
    offset: int = 0

    def __str__(self) -> str:
        """As it is called in messages."""
        return f"{self.base} {'+' if self.offset > 0 else '-'} {abs(self.offset)}" if self.offset else self.base

    def after(self, duration: int) -> Moment:
        """So many nanoseconds later."""
        assert self != NEVER
        return Moment(self.base, self.offset + duration)


TIME = Moment("time")
"""The time of the instant."""

HELD = Moment("time", -1)
"""The last nanosecond before a clock step, in which the letter before it was held, and at which it was due."""

NEVER = Moment("never")
"""Later than any time."""


def is_age(tracker: Tracker) -> bool:
    """Whether its clock is renewed by messages: instants do not set it."""
    return isinstance(tracker.subject, Age)


def counts(tracker: Tracker, state: State) -> bool:
    """Whether the clock of `tracker` has a bound yet to pass, and is one that instants set."""
    return not is_age(tracker) and tracker.is_running(state)


def due_after(tracker: Tracker, before: State, case: Case, due: Moment, by_time: bool) -> Moment:
    """When the clock is due after an instant, before which it was in the state `before`, and due at `due`."""
    if is_age(tracker):
        return due
    if not counts(tracker, case.state):
        return NEVER
    bounds, passed = tracker.bounds, case.state.passed
    if case.starts:
        return TIME.after(bounds[passed])
    if before.phase is Phase.HELD:
        return (HELD if by_time else TIME).after(bounds[passed])
    assert counts(tracker, before)
    return due.after(bounds[passed] - bounds[before.passed])


def is_behind(tracker: Tracker, case: Case) -> bool:
    """Whether it is an answer of `previously p` that changes a nanosecond later."""
    return isinstance(tracker.subject, Previously) and bool(case.holding) != (case.state == ALWAYS)
