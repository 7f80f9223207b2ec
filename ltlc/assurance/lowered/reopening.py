"""When the values at openings have to be taken at a clock step, by definition."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from ltlc.semantics.timed_atoms import Clock
from ltlc.semantics.trackers import Case, Phase, State, Tracker, clocks_around

Scopes = frozenset[Clock]


class Reopening:
    """The `scopes` at whose opening values are taken, as their trackers go from states by cases.

    A scope is *stale* if it has closed, and at its opening no value has been taken since.
    """

    def __init__(self, trackers: Sequence[Tracker], scopes: Collection[Clock]) -> None:
        self._numbers = {k: t.subject for k, t in enumerate(trackers) if isinstance(t.subject, Clock)}
        self._numbers = {k: scope for k, scope in self._numbers.items() if scope in scopes}

    def open(self, states: Sequence[State]) -> Scopes:
        """Those that are open."""
        return frozenset(scope for k, scope in self._numbers.items() if states[k].phase is Phase.RUNNING)

    def _after(self, cases: Sequence[Case]) -> Scopes:
        return self.open([case.state for case in cases])

    def to_take(self, stale: Scopes, states: Sequence[State], cases: Sequence[Case]) -> Scopes:
        """Those whose values are to be taken before a clock step: that are stale and open, outer ones first."""
        found = stale & (self._after(cases) - self.open(states))
        return frozenset(scope for scope in found if found.isdisjoint(list(clocks_around(scope))[1:]))

    def stale_after(self, stale: Scopes, states: Sequence[State], cases: Sequence[Case], by_time: bool) -> Scopes:
        """Those that are stale after an instant: at a step, all that are not open before it take their values."""
        before, after = self.open(states), self._after(cases)
        return (stale if by_time else frozenset()) - after | (before - after)
