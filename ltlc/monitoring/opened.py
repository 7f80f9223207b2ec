"""Scopes at whose openings values are taken: which are open at each line of evidence, and from which step on."""

from __future__ import annotations

from ltlc.assurance.evidence.conditions import numbered_scopes
from ltlc.assurance.evidence.document import StatedScope
from ltlc.assurance.evidence.parts import Opened as Since
from ltlc.assurance.evidence.parts import Part, open_part
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.instants import Instant
from ltlc.semantics.ltl import TRUE, And, Formula
from ltlc.semantics.timed_atoms import Clock, clock_operands, counts_of, news_that_counts
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import trackers_of
from ltlc.specification.specification import PropertySpecification

MOST_SPANS = 200
"""So often may the scopes of a property open in one recording."""


class Opened:
    """The scopes of one property along one run, by the definition of what opens and closes them."""

    def __init__(self, of: PropertySpecification) -> None:
        self._names = [atom.name for atom in of.atoms]
        self._scopes = numbered_scopes(of)
        events: Formula = TRUE
        for part in (part for clock in self._scopes for part in clock_operands(clock)):
            events = And(events, part)
        self._run = TimedRun(trackers_of(events), news_that_counts(events), counts=counts_of(events))
        self._since: tuple[Since, ...] | None = None
        self._bits = 0
        self._turns: list[list[tuple[Nanoseconds, int]]] = [[] for _ in self._scopes]
        self._moved: Nanoseconds | None = None

    @property
    def bits(self) -> int:
        """Which are open, as bits of a letter behind those of the atoms."""
        return self._bits << len(self._names)

    def bit(self, scope: Clock) -> int:
        """That of a scope."""
        return 1 << len(self._names) + [*self._scopes].index(scope)

    def step(self, time: Nanoseconds, letter: int, number: int) -> None:
        """A step with another letter than was held, or at the time of the last; what comes between opens no scope."""
        names = frozenset(name for place, name in enumerate(self._names) if letter >> place & 1)
        *between, now = self._run.step(time, names)
        self._hold(between)
        before, self._bits = self._bits, self._open_at(now)
        for place, turns in enumerate(self._turns):
            if (before ^ self._bits) >> place & 1:
                turns.append((time, number))

    def _hold(self, instants: list[Instant]) -> None:
        """Take clock steps, at which no scope is to open or to close."""
        for instant in instants:
            if self._open_at(instant) != self._bits and self._moved is None:
                self._moved = instant.time

    def _open_at(self, instant: Instant) -> int:
        """Which scopes are open at an instant, as bits."""
        part = Part(instant, instant.time, instant.time)
        before = self._since or ((),) * len(self._scopes)
        pairs = zip(self._scopes, before, strict=True)
        self._since = tuple(open_part(scope, part, self._since is None, since)[0] for scope, since in pairs)
        return sum((since[0] is not None) << number for number, since in enumerate(self._since))

    def moves_by(self, until: Nanoseconds) -> bool:
        """Whether time opens or closes a scope between two steps, in a run that ends at `until`."""
        self._hold(list(self._run.hold(until)))
        return self._moved is not None and self._moved <= until

    def stated(self, until: Nanoseconds) -> tuple[StatedScope, ...] | str:
        """From which steps up to which the scopes are open in a run that ends at `until`; or why that is not said."""
        if self.moves_by(until):
            return "time opens or closes a scope, at whose opening it reads a value, between two steps"
        spans = [_spans([step for time, step in turns if time <= until]) for turns in self._turns]
        if sum(map(len, spans)) > MOST_SPANS:
            return f"scopes, at whose openings it reads values, open more than {MOST_SPANS} times"
        return tuple(StatedScope(*pair) for pair in zip(self._scopes.values(), spans, strict=True))


def _spans(turns: list[int]) -> tuple[tuple[int, int | None], ...]:
    """From which to which step; the last one perhaps to the end."""
    ends: list[int | None] = [*turns[1::2], *([None] if len(turns) % 2 else [])]
    return tuple(zip(turns[::2], ends, strict=True))
