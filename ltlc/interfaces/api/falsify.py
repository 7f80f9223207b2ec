"""`ltlc.falsify`: a function that simulates, searched as `ltlc falsify` searches a command."""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any, assert_never

from ltlc.base.errors import UnusableInput
from ltlc.base.limits import UNBOUNDED, Budget, Exceeded, in_order, run_each
from ltlc.dataclass import dataclass
from ltlc.falsification import report
from ltlc.falsification.assignment import Assignment
from ltlc.falsification.examples import examples
from ltlc.falsification.falsify import Falsification
from ltlc.falsification.falsify import falsify as search
from ltlc.falsification.parameters import space_of
from ltlc.falsification.simulation import Outcome, Simulated, SimulationError, violated_first, whole
from ltlc.inputs.recordings import Recording, open_recording
from ltlc.inputs.recordings.reading import ReadOptions
from ltlc.interfaces.api.prepare import Prepared, Text, encoding_of, folders, prepare, read
from ltlc.interfaces.api.results import Run
from ltlc.interfaces.api.run import Recorded, opening, run_of
from ltlc.monitoring.judging.run import Judge, Open
from ltlc.specification.expressions import Signal

Simulate = Callable[[dict[str, Any]], Recorded]
"""Gets the values of parameters by name, of an input a list of times, in s, and values; gives the run."""


@dataclass(frozen=True)
class Falsified:
    """The result of `ltlc.falsify`; as text, what the command prints."""

    _made: Falsification
    _prepared: Prepared
    _runs: Mapping[int, Run]

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
        return None if self._shown is None else self._runs[id(self._shown.report)]

    @property
    def exit_code(self) -> int:
        """As of `ltlc falsify`: 0 nothing found; 1 a violation; 2 a failed simulation; 3 something open or idle."""
        return self._made.exit_code

    def document(self) -> dict[str, Any]:
        """What `ltlc falsify --format json` prints."""
        return report.document(self._made, self._prepared.specification.source, self._prepared.left_out)

    def __str__(self) -> str:
        return report.text(self._made, self._prepared.left_out).rstrip()

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
    properties: Sequence[str] = (),
    simulations: int = 100,
    jobs: int = 1,
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
    are passed on. A violation is looked for of the `properties` with these labels, or of any. An exception that
    `simulate` raises is a simulation that failed.

    With several `jobs`, so many simulations run at a time, each in a child process that this one is forked into, and
    what is found is the same. `simulate` need not be picklable, but what it gives; what it changes or prints is lost.

    Raises UnusableInput if the first simulation fails, or as `ltlc.run`; KeyboardInterrupt; and SpotMissing.
    """
    if jobs < 1 or (jobs > 1 and not hasattr(os, "fork")):
        raise UnusableInput((), f"{jobs} jobs: a number from 1 on; more than 1 where processes can be forked")
    try:
        space = space_of(parameters, inputs, seconds)
    except ValueError as error:
        raise UnusableInput((), str(error)) from None
    paths = folders(message_paths)
    prepared = prepare(read(specification), paths, encoding_of(encoding), budget or Budget()).only(properties)
    simulator = _Simulator(prepared, paths, simulate, jobs)
    try:
        begin = examples(prepared.specification, encoding_of(encoding), space, prepared.budget)
        made = search(simulator, space, simulations, seed, begin)
    except SimulationError as error:
        raise UnusableInput((), f"the first simulation, with all defaults, failed: {error}") from error.__cause__
    if made.is_interrupted:
        raise KeyboardInterrupt
    return Falsified(made, prepared, simulator.runs)


def judge_of(prepared: Prepared, message_paths: Iterable[str], open: Open = open_recording) -> Judge:
    """What judges simulations: up to the first violation of each property, with margins of what can still come."""
    return Judge(
        prepared.compiled,
        prepared.specification,
        ReadOptions(message_paths=tuple(message_paths)),
        open=open,
        remarks=prepared.late,
        finds_all=False,
        measures=True,
        foresees=True,
    )


class _Simulator:
    """Simulates by a function, some at a time in processes of their own, and judges; the runs that violate stay.

    One judge opens them all, since what it prepares takes longer than a small run.
    """

    def __init__(self, prepared: Prepared, message_paths: Sequence[str], simulate: Simulate, jobs: int) -> None:
        self._prepared = prepared
        self._simulate = simulate
        self._jobs = jobs
        self._opener: Open = open_recording
        self._judge = judge_of(prepared, message_paths, self._open)
        self.runs: dict[int, Run] = {}
        """By the identity of the report."""

    def _open(self, path: Path, signals: Mapping[str, Signal], reading: ReadOptions) -> Recording:
        return self._opener(path, signals, reading)

    def __call__(self, assignments: Iterable[Assignment]) -> Generator[tuple[Assignment, Outcome], None, None]:
        if self._jobs == 1:
            for assignment in assignments:
                yield assignment, self._judged(partial(self._simulate, assignment.document()))
            return
        given = list(assignments)
        jobs = [partial(_sent, self._simulate, each.document()) for each in given]
        with closing(run_each(jobs, UNBOUNDED, self._jobs, patience=0)) as results:
            for assignment, sent in zip(given, in_order(results), strict=True):
                yield assignment, self._judged(partial(_received, sent))

    def _judged(self, simulate: Callable[[], Recorded]) -> Outcome:
        try:
            path, self._opener = opening(self._prepared, simulate())
        except SimulationError as error:
            return error
        except Exception as error:
            failure = SimulationError(f"{type(error).__name__}: {error}")
            failure.__cause__ = error
            return failure
        found = whole(self._judge.judge(path))
        if not isinstance(found, SimulationError) and violated_first(found) is not None:
            judge = replace(self._judge, open=self._opener, finds_all=True)
            self.runs[id(found)] = run_of(self._prepared, judge, path, found)
        return found


def _sent(simulate: Simulate, given: dict[str, Any]) -> bytes | SimulationError:
    """In a process of its own: what `simulate` gives, as the other process gets it."""
    try:
        recorded = simulate(given)
        recorded = list(recorded) if isinstance(recorded, Iterator) else recorded
    except (Exception, SystemExit) as error:
        return SimulationError(f"{type(error).__name__}: {error}")
    try:
        return pickle.dumps(recorded)
    except Exception as error:
        told = f"{type(error).__name__}: {error}"
        return SimulationError(f"what it gave cannot be pickled, as several jobs need: {told}")


def _received(sent: bytes | SimulationError | Exceeded) -> Recorded:
    """What a simulation gave. Raises SimulationError."""
    match sent:
        case SimulationError():
            raise sent
        case Exceeded():
            raise SimulationError(f"its process crashed, or ran out of memory{sent.detail and f': {sent.detail}'}")
        case bytes():
            recorded: Recorded = pickle.loads(sent)
            return recorded
        case _:
            assert_never(sent)
