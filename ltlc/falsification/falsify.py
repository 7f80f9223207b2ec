"""Simulates again and again, until a property is violated or the budget is spent; then shrinks what was found."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from ltlc.dataclass import dataclass
from ltlc.falsification.assignment import Assignment
from ltlc.falsification.parameters import Space
from ltlc.falsification.search import Losses, proposals
from ltlc.falsification.shrinking import shrink
from ltlc.falsification.simulation import Simulate, Simulated, SimulationError, is_violated
from ltlc.semantics.verdicts import Verdict

MOST_KNOWN = 1000
"""So many proposals in a row that have all been simulated before end a search: there is hardly anything else."""


@dataclass(frozen=True)
class Falsification:
    """The result of a search in `space`: its simulations, of which the last violates a property if one was `found`.

    `smallest` is what that was shrunk to, in so many simulations more (`shrinking`); None if the same assignment did
    not violate it again. The search is `exhaustive` if it looked at all assignments. `unmeasured` says of properties
    that could not guide it why not.
    """

    space: Space
    seed: int
    simulations: tuple[Simulated, ...]
    unmeasured: Mapping[str, str]
    exhaustive: bool = False
    smallest: Simulated | None = None
    shrinking: int = 0

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
        """1 a property is violated; 2 a simulation failed; 3 something is owed, or never started; 0 otherwise."""
        if self.found is not None:
            return 1
        if self.failed:
            return 2
        verdicts = [each.verdicts for each in self.simulations]
        is_owed = any(Verdict.PRESUMABLY_VIOLATED in each.values() for each in verdicts)
        is_idle = any(all(each[label] is Verdict.NOT_STARTED for each in verdicts) for label in verdicts[0])
        return 3 if is_owed or is_idle else 0


Watch = Callable[[Simulated, str], None]
"""Called after each simulation, with what it was for: the label of the property that was pursued, or nothing."""


class _Bench:
    """Simulates, and counts; remembers why properties could not be measured."""

    def __init__(self, simulate: Simulate, watch: Watch | None) -> None:
        self._simulate = simulate
        self._watch = watch
        self.count = 0
        self.unmeasured: dict[str, str] = {}

    def __call__(self, assignment: Assignment, what_for: str = "") -> Simulated:
        self.count += 1
        found = self._outcome(assignment)
        if self._watch is not None:
            self._watch(found, what_for)
        return found

    def _outcome(self, assignment: Assignment) -> Simulated:
        try:
            report = self._simulate(assignment)
        except SimulationError as error:
            return Simulated(self.count, assignment, str(error))
        assert report.session is not None
        verdicts = {track.property.label: track.verdict for track in report.session.tracks}
        self.unmeasured |= {label: curve.reason for label, curve in report.robustness.items() if curve.reason}
        margins = {
            label: report.bands[label].high if label in report.bands else math.inf
            for label, curve in report.robustness.items()
            if not curve.reason
        }
        kept = report if is_violated(report) else None
        return Simulated(self.count, assignment, "", verdicts, margins, kept)


def falsify(
    simulate: Simulate,
    space: Space,
    count: int,
    seed: int = 0,
    examples: Sequence[Assignment] = (),
    watch: Watch | None = None,
) -> Falsification:
    """Search `space` in at most `count` simulations, and shrink what is found in at most as many more.

    The first is of the defaults, then come `examples`. Everything follows from `seed`, if it does in the simulation.
    Raises SimulationError if the first one fails.
    """
    bench = _Bench(simulate, watch)
    first = bench(space.defaults())
    if first.failure:
        raise SimulationError(first.failure)
    simulations, exhaustive = [first], space.size <= count
    if first.violated is None:
        others = space.all() if exhaustive else None
        rest = _all(bench, first, others) if others else _searched(bench, space, first, count, seed, examples)
        simulations += rest
    found = Falsification(space, seed, tuple(simulations), bench.unmeasured, exhaustive and len(simulations) > 1)
    return found if found.found is None else _shrunk(found, bench, count)


def _all(bench: _Bench, first: Simulated, assignments: Iterator[Assignment]) -> Iterator[Simulated]:
    """Simulate all of `assignments` but the first, until a property is violated."""
    for assignment in assignments:
        if assignment.key != first.assignment.key:
            found = bench(assignment)
            yield found
            if found.violated is not None:
                return


def _searched(
    bench: _Bench, space: Space, first: Simulated, count: int, seed: int, examples: Sequence[Assignment]
) -> Iterator[Simulated]:
    """Simulate what the search proposes, up to `count` with the `first`, until a property is violated."""
    begin = [space.point(each) for each in (first.assignment, *examples)]
    search = proposals(begin, count, seed)
    known = {first.assignment.key: _losses(first)}
    labels, proposal, repeated = known[first.assignment.key], next(search), 0
    while bench.count < count and repeated < MOST_KNOWN:
        assignment = space.assignment(proposal.point)
        repeated = repeated + 1 if assignment.key in known else 0
        if not repeated:
            found = bench(assignment, proposal.pursued or "")
            yield found
            if found.violated is not None:
                return
            known[assignment.key] = dict.fromkeys(labels, math.inf) | dict(_losses(found))
        proposal = search.send(known[assignment.key])


def _losses(simulated: Simulated) -> Losses:
    """How close each property came to failing: its margin; at least 0, as it was not violated."""
    return {label: max(margin, 0.0) for label, margin in simulated.margins.items()}


def _shrunk(found: Falsification, bench: _Bench, most: int) -> Falsification:
    """The same with what it was shrunk to, in at most so many simulations."""
    begin = bench.count
    assert found.found is not None
    assert found.found.violated is not None
    label = found.found.violated.property.label

    def fails(assignment: Assignment) -> Simulated | None:
        if bench.count - begin >= most:
            return None
        simulated = bench(assignment, f"shrinking {label}")
        return simulated if simulated.verdicts.get(label) is Verdict.VIOLATED else None

    again = fails(found.found.assignment)
    tried = {each.assignment.key for each in found.simulations}
    smallest = None if again is None else shrink(again, found.space, fails, tried)
    return replace(found, smallest=smallest, shrinking=bench.count - begin)
