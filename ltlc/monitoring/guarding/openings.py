"""The values that a property takes at openings, along a run that can be forked; by the definition of its scopes."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ltlc.assurance.evidence.parts import Opened, Part, open_part
from ltlc.monitoring.guarding.arrangement import Asked, Nan
from ltlc.runtime.sampling import Value
from ltlc.semantics.instants import Instant
from ltlc.semantics.timed_atoms import Clock
from ltlc.semantics.trackers import outer_clock
from ltlc.semantics.words import Letter
from ltlc.specification.evaluation import truth
from ltlc.specification.expressions import Current, Opening, Read


class Openings:
    """Which scopes of a property are open, and the values taken where they opened; `asked` are the atoms with such.

    `clocks` are those of the scopes. A value is taken at each step before which its scope is not open, and at a clock
    step at which that opens (`docs/language.md`, History).
    """

    def __init__(self, asked: Mapping[str, Asked], clocks: Mapping[Opening, Clock]) -> None:
        self.asked, self._clocks = asked, clocks
        self._outer_first = sorted(dict.fromkeys(clocks.values()), key=_depth)
        self._since: dict[Clock, Opened] = {}
        self._values: Mapping[Read, Value] = {}

    def fork(self) -> Openings:
        """The same, to go on by itself."""
        other = object.__new__(Openings)
        vars(other).update(vars(self))
        other._since = {**self._since}
        return other

    def answers(self, known: list[Value]) -> dict[str, bool | Nan | None]:
        """What the atoms are at a next step with what is `known`."""
        kept = self._kept()
        return {name: asked.answer(known, kept) for name, asked in self.asked.items()}

    def step(self, known: list[Value]) -> None:
        """There is a step with what is `known`."""
        read: dict[Read, Value] = {}
        for asked in self.asked.values():
            read |= asked.values(known)
        self._values = {**read, **self._kept()}

    def note(self, instant: Instant) -> None:
        """The run goes on with `instant`."""
        self._since = {clock: self._after(clock, instant) for clock in self._outer_first}

    def clock_step(self, instant: Instant, judged: Callable[[Letter], Instant]) -> Instant:
        """What a clock step is, as `Retake` of the reference: if a scope opens, what is held is taken.

        What compares with it is asked anew; then what is inside the scope may open in turn.
        """
        for clock in self._outer_first:
            if not self._is_open(clock) and self._after(clock, instant)[0] is not None:
                taken: dict[Read, Value] = {
                    o: self._values[Current(o.signal)] for o, c in self._clocks.items() if c == clock
                }
                self._values = {**self._values, **taken}
                about = {name: a.atom for name, a in self.asked.items() if not taken.keys().isdisjoint(a.wanted)}
                holding = {name for name, atom in about.items() if truth(atom.condition, self._values) is True}
                instant = judged(instant.difference(about).union(holding))
        return instant

    def _kept(self) -> dict[Read, Value]:
        """The values taken in scopes that are open."""
        open_ = (opening for opening, clock in self._clocks.items() if self._is_open(clock))
        return {opening: self._values[opening] for opening in open_}

    def _is_open(self, clock: Clock) -> bool:
        return clock in self._since and self._since[clock][0] is not None

    def _after(self, clock: Clock, instant: Instant) -> Opened:
        part = Part(instant, instant.time, instant.time, single=True)
        return open_part(clock, part, not self._since, self._since.get(clock, ()))[0]


def _depth(clock: Clock) -> int:
    outer = outer_clock(clock)
    return 0 if outer is None else 1 + _depth(outer)
