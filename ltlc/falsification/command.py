"""A simulation that is a command: it gets its parameters by placeholders, and leaves a recording."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import tempfile
import time
from collections import deque
from collections.abc import Generator, Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from ltlc.base.nearest import did_you_mean
from ltlc.dataclass import dataclass
from ltlc.falsification.assignment import Assignment, scalar_text
from ltlc.falsification.parameters import Space
from ltlc.falsification.process import Process, said, uninterrupted
from ltlc.falsification.simulation import SimulationError
from ltlc.inputs.recordings import is_recording
from ltlc.semantics.durations import Nanoseconds

PARAMETERS, RECORDING, OUTPUT = "parameters.json", "recording", "output.txt"
"""What is in the folder of a simulation: what it gets, what it leaves, the latter with any ending, and what it says."""

EVERY_SECONDS = 0.005
"""How often those that run are looked at."""


class Left(NamedTuple):
    """What a simulation has left in its `folder`: a recording, or none for a reason."""

    assignment: Assignment
    folder: Path
    recording: Path | SimulationError


class _Begun(NamedTuple):
    assignment: Assignment
    folder: Path
    job: int
    process: Process


@dataclass(frozen=True)
class Command:
    """A command with its arguments, which have placeholders; each run of it may take so long.

    As many run at a time as there are `environments`: each has the variables of one of them, beside ours.
    """

    arguments: Sequence[str]
    time_limit: Nanoseconds
    environments: Sequence[Mapping[str, str]] = ({},)

    def simulate(self, assignments: Iterable[Assignment], folder: Path) -> Generator[Left, None, None]:
        """What each leaves in a new folder in `folder`, in order. Closing it ends those under way."""
        waiting, jobs = iter(assignments), set(range(len(self.environments)))
        begun = deque[_Begun]()
        try:
            while True:
                if begun and not begun[0].process.is_running():
                    first = begun.popleft()
                    yield Left(first.assignment, first.folder, _recording(first))
                    continue
                free = jobs - {each.job for each in begun if each.process.is_running()}
                while free and (assignment := next(waiting, None)) is not None:
                    with uninterrupted():
                        begun.append(self._begin(assignment, Path(tempfile.mkdtemp(dir=folder)), min(free)))
                    free.remove(begun[-1].job)
                if not begun:
                    return
                time.sleep(EVERY_SECONDS)
        finally:
            for each in begun:
                each.process.end()
                shutil.rmtree(each.folder, ignore_errors=True)

    def _begin(self, assignment: Assignment, folder: Path, job: int) -> _Begun:
        (folder / PARAMETERS).write_text(json.dumps(assignment.document(), indent=2) + "\n", encoding="utf-8")
        given = {
            **{name: value for name, value in assignment.values.items() if not isinstance(value, tuple)},
            "parameters": str(folder / PARAMETERS),
            "recording": str(folder / RECORDING),
            "job": job,
            **({} if assignment.seconds is None else {"seconds": assignment.seconds}),
        }
        texts = {name: scalar_text(value) for name, value in given.items()}
        command = [_filled(argument, texts) for argument in self.arguments]
        process = Process(command, self.environments[job], folder / OUTPUT, self.time_limit)
        return _Begun(assignment, folder, job, process)


def command_of(text: str, space: Space, time_limit: Nanoseconds) -> Command:
    """The command that `text` is, which gets all parameters of `space`. Raises ValueError, whose text says why not."""
    try:
        arguments = shlex.split(text)
    except ValueError as error:
        raise ValueError(f"the command cannot be read: {str(error).lower()}") from None
    if not arguments:
        raise ValueError("the command is empty")
    used = {match[1] for argument in arguments for match in _PLACEHOLDER.finditer(argument) if match[1] is not None}
    inputs = {each.name for each in space.parameters if each.points}
    known = {"parameters", "recording", "job"} | ({each.name for each in space.parameters} - inputs)
    known |= set() if space.seconds is None else {"seconds"}
    for name in sorted(used - known):
        if name in inputs:
            raise ValueError(f"`{{{name}}}` is an input, whose values over time are in the file {{parameters}}")
        hint = did_you_mean(name, known) or f"there are {', '.join(f'{{{each}}}' for each in sorted(known))}"
        raise ValueError(f"there is no parameter for `{{{name}}}` (a brace is written {{{{): {hint}")
    if "recording" not in used:
        raise ValueError("the command does not get {recording}, the path without an ending of what it has to write")
    wanted = [each.name for each in space.parameters] + ([] if space.seconds is None else ["seconds"])
    if "parameters" not in used and (missing := [name for name in wanted if name not in used]):
        what = "{parameters}, a JSON file" if missing[0] in inputs else f"{{{missing[0]}}} or {{parameters}}"
        raise ValueError(f"the command does not get `{missing[0]}`: add {what}")
    return Command(arguments, time_limit)


_PLACEHOLDER = re.compile(r"\{\{|\}\}|\{([^{}]*)\}")


def _filled(argument: str, texts: dict[str, str]) -> str:
    return _PLACEHOLDER.sub(lambda match: match[0][0] if match[1] is None else texts[match[1]], argument)


def _recording(begun: _Begun) -> Path | SimulationError:
    """The recording in the folder of a simulation, or why there is none."""
    if begun.process.failure:
        return SimulationError(begun.process.failure)
    left = [each for each in sorted(begun.folder.iterdir()) if each.name not in (PARAMETERS, OUTPUT)]
    found = [each for each in left if each.name == RECORDING or each.name.startswith(f"{RECORDING}.")]
    if not found:
        beside = f", but {left[0].name}" if left else ""
        return SimulationError(f"it wrote no {{recording}}{beside}{said(begun.folder / OUTPUT)}")
    found = [each for each in found if is_recording(each)] or found
    if len(found) > 1:
        return SimulationError(f"it wrote several recordings: {', '.join(each.name for each in found)}")
    return found[0]
