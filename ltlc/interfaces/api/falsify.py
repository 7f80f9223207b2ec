"""`ltlc.falsify`: a function that simulates, searched as `ltlc falsify` searches a command."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

from ltlc.base.errors import UnusableInput
from ltlc.base.limits import Budget
from ltlc.dataclass import dataclass
from ltlc.falsification import report
from ltlc.falsification.assignment import Assignment
from ltlc.falsification.examples import examples
from ltlc.falsification.falsify import Falsification
from ltlc.falsification.falsify import falsify as search
from ltlc.falsification.parameters import space_of
from ltlc.falsification.simulation import Simulated, SimulationError, is_violated, whole
from ltlc.inputs.recordings import Recording, open_recording
from ltlc.inputs.recordings.reading import ReadOptions
from ltlc.interfaces.api.prepare import Prepared, Text, encoding_of, folders, prepare, read
from ltlc.interfaces.api.results import Run
from ltlc.interfaces.api.run import Recorded, opening, run_of
from ltlc.monitoring.judging.run import Judge, Open, RunReport
from ltlc.specification.expressions import Signal

Simulate = Callable[[dict[str, Any]], Recorded]
"""Gets the values of parameters by name, of an input a list of times, in s, and values; gives the run."""


@dataclass(frozen=True)
class Falsified:
    """The result of `ltlc.falsify`; as text, what the command prints."""

    _made: Falsification
    _prepared: Prepared
    _runs: Mapping[str, Run]

    @property
    def violated(self) -> str | None:
        """The label of the property that is violated; None if none was in any simulation."""
        track = None if self._made.found is None else self._made.found.violated
        return None if track is None else track.property.label

    @property
    def parameters(self) -> dict[str, Any] | None:
        """What the function was given when it was violated, shrunk; None if nothing was found."""
        return None if self._shown is None else self._shown.assignment.document()

    @property
    def run(self) -> Run | None:
        """The run in which it is violated."""
        return None if self._shown is None else self._runs[self._shown.assignment.key]

    @property
    def exit_code(self) -> int:
        """As of `ltlc falsify`: 0 nothing found; 1 a violation; 2 a failed simulation; 3 something open or idle."""
        return self._made.exit_code

    def document(self) -> dict[str, Any]:
        """What `ltlc falsify --format json` prints."""
        return report.document(self._made, self._prepared.specification.source)

    def __str__(self) -> str:
        return report.text(self._made).rstrip()

    @property
    def _shown(self) -> Simulated | None:
        return self._made.smallest or self._made.found


def falsify(
    specification: Text,
    simulate: Simulate,
    parameters: Sequence[str] = (),
    *,
    inputs: Sequence[str] = (),
    seconds: float | None = None,
    simulations: int = 100,
    seed: int = 0,
    encoding: str = "episode",
    message_paths: Sequence[str | PathLike[str]] = (),
    budget: Budget | None = None,
) -> Falsified:
    """Parameters and inputs with which `simulate` gives a run that violates a property of `specification`.

    >>> import ltlc
    >>> def simulate(given):
    ...     return [(t, {"robot.velocity": given["gain"] * t}) for t in range(10)]
    >>> found = ltlc.falsify("never robot.velocity > 2", simulate, ["gain=0..0.1..1"])
    >>> found.violated, found.parameters
    ('line 1', {'gain': 0.3})

    `parameters` and `inputs` are declared as for the command, as in `speed=0.2..1.5` and `throttle=-1..1@8`; `seconds`
    are passed on. An exception that `simulate` raises is a simulation that failed.

    Raises UnusableInput if the first one fails, or as `ltlc.run`, and SpotMissing.
    """
    try:
        space = space_of(parameters, inputs, seconds)
    except ValueError as error:
        raise UnusableInput((), str(error)) from None
    paths = folders(message_paths)
    prepared = prepare(read(specification), paths, encoding_of(encoding), budget or Budget())
    simulator = _Simulator(prepared, ReadOptions(message_paths=tuple(paths)), simulate)
    try:
        begin = examples(prepared.specification, encoding_of(encoding), space, prepared.budget)
        made = search(simulator, space, simulations, seed, begin)
    except SimulationError as error:
        raise UnusableInput((), f"the first simulation, with all defaults, failed: {error}") from error.__cause__
    return Falsified(made, prepared, simulator.runs)


class _Simulator:
    """Simulates by a function, and judges; the runs that violate a property stay, by assignment.

    One judge opens them all, since what it prepares takes longer than a small run.
    """

    def __init__(self, prepared: Prepared, reading: ReadOptions, simulate: Simulate) -> None:
        self._prepared = prepared
        self._simulate = simulate
        self._opener: Open = open_recording
        self._judge = Judge(
            prepared.compiled,
            prepared.specification,
            reading,
            open=self._open,
            remarks=prepared.late,
            finds_all=False,
            measures=True,
            foresees=True,
        )
        self.runs: dict[str, Run] = {}

    def _open(self, path: Path, signals: Mapping[str, Signal], reading: ReadOptions) -> Recording:
        return self._opener(path, signals, reading)

    def __call__(self, assignment: Assignment) -> RunReport:
        try:
            path, self._opener = opening(self._prepared, self._simulate(assignment.document()))
        except Exception as error:
            raise SimulationError(f"{type(error).__name__}: {error}") from error
        found = whole(self._judge.judge(path))
        if is_violated(found):
            judge = replace(self._judge, open=self._opener, finds_all=True)
            self.runs[assignment.key] = run_of(self._prepared, judge, path, found)
        return found
