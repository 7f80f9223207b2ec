"""The reset machine with the order of its clocks: which words of letters are runs in time, for any number of clocks.

The reset machine lets clocks that run side by side pass their bounds in any order. Here a state also has a *zone*, what
the clocks can read there relative to one another (Dill, *Timing assumptions*, 1989): a clock of 5 s is over before one
of 15 s that began with it. States are many where clocks are, so monitors and certificates do without; questions about
several properties, whose clocks are different, need it. Zones are widened where they are many: the machine has all
words of runs in time, and may have more.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import permutations
from math import inf
from typing import Any, Generic, NamedTuple

from ltlc.semantics.ltl import Formula
from ltlc.semantics.reset_machine import Clocks, Letters, Move, Narrowed, ResetMachine
from ltlc.semantics.timed_atoms import Age
from ltlc.semantics.trackers import Case, Phase

Zone = tuple[tuple[float, ...], ...]
"""`zone[i][j]` is the most by which clock i can be ahead of clock j; clock 0 always reads 0."""


MOST_ZONES = 16
"""With more zones for one state of the reset machine, the order of the clocks is left open there."""


def _is_inside(zone: Zone, other: Zone) -> bool:
    rows = zip(zone, other, strict=True)
    return all(most <= limit for row, limits in rows for most, limit in zip(row, limits, strict=True))


class Timed(NamedTuple):
    """A state of the machine: that of the reset machine, and what the clocks that run there can read."""

    clocks: Clocks
    zone: Zone


@dataclass(frozen=True, slots=True)
class TimedMove(Generic[Letters]):
    """As `Move` of the reset machine."""

    letters: Letters
    target: Timed
    fair: frozenset[int]


class OrderedMachine:
    """The ordered machine of the timed atoms in `formula`; to be used as `ResetMachine` is."""

    def __init__(self, formula: Formula) -> None:
        self._machine = ResetMachine(formula)
        self._moves: dict[Clocks, list[Move[Any]]] = {}
        self._zones: dict[Clocks, list[Zone]] = {}
        self.trackers = self._machine.trackers
        self.sets = self._machine.sets
        self.initial = Timed(self._machine.initial, ((0,),))

    def moves(self, state: Timed, letters: Letters, narrowed: Narrowed[Letters]) -> Iterator[TimedMove[Letters]]:
        """What may come after `state` among `letters`, which are the same at each call."""
        if state.clocks not in self._moves:
            self._moves[state.clocks] = list(self._machine.moves(state.clocks, letters, narrowed))
        for move in self._moves[state.clocks]:
            zone = self._after(state, move.cases)
            if zone is not None:
                yield TimedMove(move.letters, Timed(move.target, self._known(move.target, zone)), move.fair)

    def _known(self, clocks: Clocks, zone: Zone) -> Zone:
        """`zone`, or one around it that has been seen; where they are many, that of all readings."""
        zones = self._zones.setdefault(clocks, [])
        found = next((each for each in zones if _is_inside(zone, each)), None)
        if found is None:
            found = zone if len(zones) < MOST_ZONES else self._everything(clocks)
            zones.append(found)
        return found

    def _everything(self, clocks: Clocks) -> Zone:
        running = [(self.trackers[k - 1], clocks.states[k - 1]) for k in self._running(clocks)]
        most = [0, *(tracker.bounds[state.passed] + 1 for tracker, state in running)]
        return tuple(tuple(0 if i in (0, j) else most[i] for j in range(len(most))) for i in range(len(most)))

    def _after(self, state: Timed, cases: tuple[Case, ...]) -> Zone | None:
        """The zone after an instant at which the trackers do `cases`; None if no times fit."""
        running = self._running(state.clocks)
        distances = _Distances(len(self.trackers) + 1)
        for i, of_i in zip((0, *running), state.zone, strict=True):
            for j, most in zip((0, *running), of_i, strict=True):
                distances.at_most(i, j, most)
        distances.close()
        if state.clocks.is_first:
            self._from_the_session(distances)
        else:
            distances.elapse()
        distances.start()
        for k, case in enumerate(cases):
            self._constrain(distances, k, state.clocks, case)
        if not distances.close():
            return None
        for k, case in enumerate(cases):
            if case.starts:
                distances.reset(k + 1)
        return distances.among((0, *self._running(Clocks(False, tuple(case.state for case in cases)))))

    def _running(self, clocks: Clocks) -> tuple[int, ...]:
        """The clocks that have a bound yet to pass, counted from 1."""
        return tuple(k + 1 for k, t in enumerate(self.trackers) if t.is_running(clocks.states[k]))

    def _from_the_session(self, distances: _Distances) -> None:
        """All ages count from one instant, which may be long ago."""
        ages = [k + 1 for k, tracker in enumerate(self.trackers) if isinstance(tracker.subject, Age)]
        for one, other in permutations(ages, 2):
            distances.at_most(one, other, 0)

    def _constrain(self, distances: _Distances, k: int, clocks: Clocks, case: Case) -> None:
        """No clock is past a bound that it has yet to pass, but for the nanosecond at which it does."""
        tracker, before, clock = self.trackers[k], clocks.states[k], k + 1
        if before.phase is Phase.HELD:  # counted from this instant, or from the nanosecond before
            distances.at_most(clock, 0, 1)
        elif tracker.is_running(before):
            distances.at_most(clock, 0, tracker.bounds[before.passed] + 1)
        if case.passed is None:
            return
        if case.passed > 0:
            distances.at_most(0, clock, -(tracker.bounds[case.passed - 1] + 1))
        if case.passed < len(tracker.bounds):
            distances.at_most(clock, 0, tracker.bounds[case.passed])


class _Distances:
    """Bounds on the differences of what clocks read, as matrices (Dill 1989); at first, clocks read anything."""

    def __init__(self, count: int) -> None:
        self._most = [[0 if i == j else inf for j in range(count)] for i in range(count)]

    def at_most(self, i: int, j: int, most: float) -> None:
        self._most[i][j] = min(self._most[i][j], most)

    def elapse(self) -> None:
        """Time passes: differences stay as they are."""
        for row in self._most[1:]:
            row[0] = inf

    def start(self) -> None:
        """No clock reads less than 0."""
        for clock in range(1, len(self._most)):
            self.at_most(0, clock, 0)

    def reset(self, clock: int) -> None:
        for other in range(len(self._most)):
            self._most[clock][other] = self._most[0][other]
            self._most[other][clock] = self._most[other][0]
        self._most[clock][clock] = 0

    def close(self) -> bool:
        """Draw all conclusions; whether there are such readings."""
        for via, through in enumerate(self._most):
            for row in self._most:
                to_via = row[via]
                if to_via < inf:
                    for j, further in enumerate(through):
                        row[j] = min(row[j], to_via + further)
        return all(row[i] >= 0 for i, row in enumerate(self._most))

    def among(self, clocks: tuple[int, ...]) -> Zone:
        return tuple(tuple(self._most[i][j] for j in clocks) for i in clocks)
