"""Simulates again and again, until a property is violated or the budget is spent; then shrinks what was found."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from itertools import islice

from ltlc.dataclass import dataclass
from ltlc.falsification.assignment import Assignment
from ltlc.falsification.parameters import Space
from ltlc.falsification.search import Losses, batches
from ltlc.falsification.shrinking import shrink
from ltlc.falsification.simulation import Outcome, Simulate, Simulated, SimulationError, violated_first
from ltlc.semantics.verdicts import Verdict

MOST_KNOWN = 1000
"""So many points in a row that have all been simulated before end a search: there is hardly anything else."""


@dataclass(frozen=True)
class Falsification:
    """The result of a search in `space`: its simulations, of which the last violates a property if one was `found`.

    `smallest` is what that was shrunk to, in so many simulations more (`shrinking`); None if the same assignment did
    not violate it again, or was not simulated again. The search is `exhaustive` if it looked at all assignments.
    `unmeasured` says of properties that could not guide it why not. Search or shrinking `is_interrupted` if Ctrl-C
    ended it.
    """

    space: Space
    seed: int
    simulations: tuple[Simulated, ...]
    unmeasured: Mapping[str, str]
    exhaustive: bool = False
    smallest: Simulated | None = None
    shrinking: int = 0
    is_interrupted: bool = False

    @property
    def found(self) -> Simulated | None:
        """The simulation that violates a property."""
        last = self.simulations[-1]
        return last if last.violated is not None else None

    @property
    def failed(self) -> tuple[Simulated, ...]:
        """The simulations that failed."""
        return tuple(each for each in self.simulations if each.failure)

    @property
    def exit_code(self) -> int:
        """1 a property is violated; 2 a simulation failed; 3 something is owed or undecided; 0 otherwise."""
        if self.found is not None:
            return 1
        if self.failed:
            return 2
        verdicts = [each.verdicts for each in self.simulations]
        is_owed = any(Verdict.PRESUMABLY_VIOLATED in each.values() for each in verdicts)
        is_idle = any(all(each[label] is Verdict.NOT_STARTED for each in verdicts) for label in verdicts[0])
        return 3 if is_owed or is_idle or self.is_interrupted else 0


Watch = Callable[[Simulated, str], None]
"""Called after each simulation, with what it was for: the label of the property that was pursued, or nothing."""


def falsify(
    simulate: Simulate,
    space: Space,
    count: int,
    seed: int = 0,
    examples: Sequence[Assignment] = (),
    watch: Watch | None = None,
) -> Falsification:
    """Search `space` in at most `count` simulations, and shrink what is found in at most as many more.

    The first is of the defaults, then come `examples`. Everything follows from `seed`, if it does in the simulation,
    and from nothing else: how many simulations run at a time changes nothing. Ctrl-C ends it, and what was found stays.

    Raises SimulationError if the first one fails, and KeyboardInterrupt if that was not finished.
    """
    search = _Search(simulate, space, count, watch)
    is_interrupted = False
    try:
        search.run(seed, examples)
    except KeyboardInterrupt:
        if not search.simulations:
            raise
        is_interrupted = True
    last = len(search.simulations) if search.found is None else search.found.number
    return Falsification(
        space,
        seed,
        tuple(search.simulations[:last]),
        search.unmeasured,
        search.is_exhaustive,
        search.smallest,
        len(search.simulations) - last,
        is_interrupted,
    )


class _Search:
    """Looks for a violation, and shrinks it; what is known is here at any time, whatever comes in between."""

    def __init__(self, simulate: Simulate, space: Space, count: int, watch: Watch | None) -> None:
        self._simulate = simulate
        self._space = space
        self._count = count
        self._watch = watch
        self.is_exhaustive = False
        self.simulations: list[Simulated] = []
        self.unmeasured: dict[str, str] = {}
        self.found: Simulated | None = None
        self.smallest: Simulated | None = None

    def run(self, seed: int, examples: Sequence[Assignment]) -> None:
        """Search and shrink. Raises SimulationError if the first simulation fails."""
        self.found = self._first([self._space.defaults()], _is_violation)
        if self.found is None:
            self.found = self._of_all() if self._space.size <= self._count else self._guided(seed, examples)
        if self.found is not None:
            self._shrink(self.found)

    def _first(
        self, assignments: Iterable[Assignment], ends: Callable[[Simulated], bool], what_for: str = ""
    ) -> Simulated | None:
        """Simulate `assignments` in order, until one ends it, which is given."""
        with closing(self._simulate(assignments)) as simulated:
            for assignment, outcome in simulated:
                found = self._judged(assignment, outcome)
                self.simulations.append(found)
                if self._watch is not None:
                    self._watch(found, what_for)
                if ends(found):
                    return found
        return None

    def _judged(self, assignment: Assignment, outcome: Outcome) -> Simulated:
        number = len(self.simulations) + 1
        if isinstance(outcome, SimulationError):
            if number == 1:
                raise outcome
            return Simulated(number, assignment, str(outcome))
        assert outcome.session is not None
        tracks = {track.property.label: track for track in outcome.session.tracks}
        verdicts = {label: track.verdict for label, track in tracks.items()}
        self.unmeasured |= {label: curve.reason for label, curve in outcome.robustness.items() if curve.reason}
        margins = {
            label: outcome.bands[label].high + 0.0 if label in outcome.bands else math.inf  # 0, not -0
            for label, curve in outcome.robustness.items()
            if not curve.reason
        }
        untriggered = [label for label, track in tracks.items() if track.never_triggered]
        left_out = {label: next(iter(track.invalid_because)) for label, track in tracks.items() if track.invalid}
        kept = None if violated_first(outcome) is None else outcome
        return Simulated(number, assignment, "", verdicts, margins, untriggered, left_out, kept)

    def _of_all(self) -> Simulated | None:
        """Simulate all assignments but the first, until a property is violated."""
        first = self.simulations[0].assignment.key
        found = self._first((each for each in self._space.all() if each.key != first), _is_violation)
        self.is_exhaustive = found is None
        return found

    def _guided(self, seed: int, examples: Sequence[Assignment]) -> Simulated | None:
        """Simulate what the search proposes, until a property is violated, or there have been as many as there may."""
        first = self.simulations[0]
        begin = [self._space.point(each) for each in (first.assignment, *examples)]
        search = batches(begin, self._count, seed)
        known = {first.assignment.key: _losses(first)}
        labels, batch, repeated = known[first.assignment.key], next(search), 0
        while True:
            assignments = [self._space.assignment(point) for point in batch.points]
            others = {each.key: each for each in assignments if each.key not in known}
            repeated = 0 if others else repeated + len(assignments)
            before = len(self.simulations)
            allowed = islice(others.values(), self._count - before)
            if (found := self._first(allowed, _is_violation, batch.pursued or "")) is not None:
                return found
            if len(self.simulations) >= self._count or repeated >= MOST_KNOWN:
                return None
            for each in self.simulations[before:]:
                known[each.assignment.key] = dict.fromkeys(labels, math.inf) | dict(_losses(each))
            batch = search.send([known[each.key] for each in assignments])

    def _shrink(self, found: Simulated) -> None:
        """Simulate what is simpler, up to so many times, if the same violates the property once more."""
        assert found.violated is not None
        label, most = found.violated.property.label, found.number + self._count
        tried = {each.assignment.key for each in self.simulations}

        def failing(assignments: Iterator[Assignment]) -> Simulated | None:
            before = len(self.simulations)
            smaller = self._first(
                islice(assignments, most - before),
                lambda each: each.verdicts.get(label) is Verdict.VIOLATED,
                f"shrinking {label}",
            )
            tried.update(each.assignment.key for each in self.simulations[before:])
            if smaller is not None:
                self.smallest = smaller
            return smaller

        again = failing(iter([found.assignment]))
        if again is not None:
            shrink(again, self._space, failing, tried)


def _is_violation(simulated: Simulated) -> bool:
    return simulated.violated is not None


def _losses(simulated: Simulated) -> Losses:
    """How close each property came to failing: its margin; at least 0, as it was not violated."""
    return {label: max(margin, 0.0) for label, margin in simulated.margins.items()}
