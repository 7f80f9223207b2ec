"""The reset machine with the order of its clocks: which words of letters are runs in time, for any number of clocks.

The reset machine lets clocks that run side by side pass their bounds in any order. Here a state also has a *zone*, what
the clocks can read there relative to one another (Dill, *Timing assumptions*, 1989): a clock of 5 s is over before one
of 15 s that began with it. States are many where clocks are, so monitors and certificates do without; questions about
several properties, whose clocks are different, need it. Zones are widened where they are many: the machine has all
words of runs in time, and may have more.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from itertools import permutations
from math import inf
from typing import Any, Generic, NamedTuple

from ltlc.dataclass import dataclass
from ltlc.semantics.reset_machine import Clocks, Letters, Move, Narrowed, ResetMachine
from ltlc.semantics.timed_atoms import Age
from ltlc.semantics.trackers import Case, Phase

Zone = tuple[tuple[float, ...], ...]
"""`zone[i][j]` is the most by which clock i can be ahead of clock j; clock 0 always reads 0."""


MOST_ZONES = 16
"""With more zones for one state of the reset machine, the order of the clocks is left open there."""


def is_inside(zone: Zone, other: Zone) -> bool:
    """Whether `other` has all readings that `zone` has."""
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
    cases: tuple[Case, ...]


class OrderedMachine:
    """`machine` with the order of its clocks; to be used as that is."""

    def __init__(self, machine: ResetMachine) -> None:
        self._machine = machine
        self._moves: dict[Clocks, list[Move[Any]]] = {}
        self._zones: dict[Clocks, list[Zone]] = {}
        self.trackers = machine.trackers
        self._timed = [k for k, tracker in enumerate(self.trackers) if tracker.bounds]
        self.sets = machine.sets
        self.initial = Timed(machine.initial, ((0,),))

    def moves(self, state: Timed, letters: Letters, narrowed: Narrowed[Letters]) -> Iterator[TimedMove[Letters]]:
        """What may come after `state` among `letters`, which are the same at each call."""
        if state.clocks not in self._moves:
            self._moves[state.clocks] = list(self._machine.moves(state.clocks, letters, narrowed))
        for move in self._moves[state.clocks]:
            zone = self._after(state, move.cases)
            if zone is not None:
                target = Timed(move.target, self._known(move.target, zone))
                yield TimedMove(move.letters, target, move.fair, move.cases)

    def _known(self, clocks: Clocks, zone: Zone) -> Zone:
        """A zone around `zone` that has been seen, or itself; where they are many, that of all readings."""
        zones = self._zones.setdefault(clocks, [])
        found = next((each for each in zones if is_inside(zone, each)), None)
        if found is None:
            found = zone if len(zones) < MOST_ZONES else self._everything(clocks)
            zones.append(found)
        return found

    def _everything(self, clocks: Clocks) -> Zone:
        running = [(self.trackers[k], clocks.states[k]) for k in self._running(clocks)]
        most = [0, *(tracker.bounds[state.passed] + 1 for tracker, state in running)]
        return tuple(tuple(0 if i in (0, j) else most[i] for j in range(len(most))) for i in range(len(most)))

    def _after(self, state: Timed, cases: tuple[Case, ...]) -> Zone | None:
        """The zone after an instant at which the trackers do `cases`; None if no times fit."""
        clocks = (self._clock(k, state.clocks, cases[k]) for k in self._timed)
        return _zone_after(state.zone, tuple(clocks))

    def _running(self, clocks: Clocks) -> list[int]:
        """The clocks that have a bound yet to pass."""
        return [k for k in self._timed if self.trackers[k].is_running(clocks.states[k])]

    def _clock(self, k: int, clocks: Clocks, case: Case) -> _Clock:
        """What clock `k` does at an instant: it is not past a bound that it has yet to pass, but for a nanosecond."""
        tracker, before = self.trackers[k], clocks.states[k]
        runs, least, most = tracker.is_running(before), 0, inf
        if before.phase is Phase.HELD:  # counted from this instant, or from the nanosecond before
            most = 1
        elif runs:
            most = tracker.bounds[before.passed] + 1
        if case.passed is not None and case.passed > 0:
            least = tracker.bounds[case.passed - 1] + 1
        if case.passed is not None and case.passed < len(tracker.bounds):
            most = min(most, tracker.bounds[case.passed])
        from_session = clocks.is_first and isinstance(tracker.subject, Age)
        return _Clock(runs, from_session, least, most, case.starts, tracker.is_running(case.state))


class _Clock(NamedTuple):
    """A clock at an instant: whether it ran before, what it can read, whether it is reset then and runs afterwards.

    `from_session`: it counts from the beginning of the session, which may be long before the first instant.
    """

    runs: bool
    from_session: bool
    least: float
    most: float
    starts: bool
    goes_on: bool


@lru_cache(maxsize=10_000)
def _zone_after(zone: Zone, clocks: tuple[_Clock, ...]) -> Zone | None:
    """The zone after an instant at which `clocks` are as they are, `zone` that before it; None if no times fit."""
    numbered = list(enumerate(clocks, 1))
    distances = Distances(len(clocks) + 1)
    before = (0, *(k for k, clock in numbered if clock.runs))
    for i, of_i in zip(before, zone, strict=True):
        for j, most in zip(before, of_i, strict=True):
            distances.at_most(i, j, most)
    distances.elapse()
    for one, other in permutations([k for k, clock in numbered if clock.from_session], 2):
        distances.at_most(one, other, 0)
    for k, clock in numbered:
        distances.at_most(k, 0, clock.most)
        distances.at_most(0, k, -clock.least)
    if not distances.close():
        return None
    for k, clock in numbered:
        if clock.starts:
            distances.reset(k)
    return distances.among((0, *(k for k, clock in numbered if clock.goes_on)))


class Distances:
    """Bounds on the differences of what clocks read, as matrices (Dill 1989); at first, clocks read anything."""

    def __init__(self, count: int) -> None:
        self._most = [[0 if i == j else inf for j in range(count)] for i in range(count)]

    def at_most(self, i: int, j: int, most: float) -> None:
        """Clock i is ahead of clock j by at most that."""
        self._most[i][j] = min(self._most[i][j], most)

    def elapse(self) -> None:
        """Time passes: differences stay as they are."""
        for row in self._most[1:]:
            row[0] = inf

    def most(self, i: int, j: int) -> float:
        """By how much clock i can be ahead of clock j."""
        return self._most[i][j]

    def reset(self, clock: int) -> None:
        """The clock reads 0."""
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
        """The bounds on the differences of these clocks only."""
        return tuple(tuple(self._most[i][j] for j in clocks) for i in clocks)
