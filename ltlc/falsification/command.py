"""A simulation that is a command: it gets its parameters by placeholders, and leaves a recording."""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import subprocess
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from ltlc.base.nearest import did_you_mean
from ltlc.dataclass import dataclass
from ltlc.falsification.assignment import Assignment, scalar_text
from ltlc.falsification.parameters import Space
from ltlc.falsification.simulation import SimulationError
from ltlc.inputs.recordings import is_recording
from ltlc.runtime.reports import printable
from ltlc.semantics.durations import Nanoseconds, duration_text

PARAMETERS, RECORDING, OUTPUT = "parameters.json", "recording", "output.txt"
"""What is in the folder of a simulation: what it gets, what it leaves, the latter with any ending, and what it says."""

MOST_SAID = 200
"""So many characters of what a simulation said last are shown."""


@dataclass(frozen=True)
class Command:
    """A command with its arguments, which have placeholders; each run of it may take so long."""

    arguments: Sequence[str]
    time_limit: Nanoseconds

    def __call__(self, assignment: Assignment, folder: Path) -> Path:
        """The recording that it leaves in `folder`, which is empty before. Raises SimulationError."""
        (folder / PARAMETERS).write_text(json.dumps(assignment.document(), indent=2) + "\n", encoding="utf-8")
        given = {
            **{name: value for name, value in assignment.values.items() if not isinstance(value, tuple)},
            "parameters": str(folder / PARAMETERS),
            "recording": str(folder / RECORDING),
            **({} if assignment.seconds is None else {"seconds": assignment.seconds}),
        }
        texts = {name: scalar_text(value) for name, value in given.items()}
        self._run([_filled(argument, texts) for argument in self.arguments], folder / OUTPUT)
        return _recording(folder)

    def _run(self, command: Sequence[str], output: Path) -> None:
        """Run `command`, and end what it started if it takes too long, or if we are interrupted."""
        with output.open("wb") as file:
            try:
                process = subprocess.Popen(
                    command, stdin=subprocess.DEVNULL, stdout=file, stderr=subprocess.STDOUT, start_new_session=True
                )
            except (OSError, ValueError) as error:
                reason = error.strerror if isinstance(error, OSError) else str(error)
                raise SimulationError(f"`{command[0]}` cannot be started: {reason}") from None
        try:
            code = process.wait(self.time_limit / 1e9)
        except subprocess.TimeoutExpired:
            raise SimulationError(f"it took more than {duration_text(self.time_limit)}{_said(output)}") from None
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)  # and what it left running
            process.wait()
        if code:
            how = f"ended with exit code {code}" if code > 0 else f"was ended by {signal.Signals(-code).name}"
            raise SimulationError(f"it {how}{_said(output)}")


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
    known = {"parameters", "recording"} | ({each.name for each in space.parameters} - inputs)
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


def _recording(folder: Path) -> Path:
    """The recording in `folder`. Raises SimulationError."""
    left = [each for each in sorted(folder.iterdir()) if each.name not in (PARAMETERS, OUTPUT)]
    found = [each for each in left if each.name == RECORDING or each.name.startswith(f"{RECORDING}.")]
    if not found:
        beside = f", but {left[0].name}" if left else ""
        raise SimulationError(f"it wrote no {{recording}}{beside}{_said(folder / OUTPUT)}")
    found = [each for each in found if is_recording(each)] or found
    if len(found) > 1:
        raise SimulationError(f"it wrote several recordings: {', '.join(each.name for each in found)}")
    return found[0]


def _said(output: Path) -> str:
    """The last line that a simulation has said, or nothing."""
    with output.open("rb") as file:
        file.seek(max(0, file.seek(0, os.SEEK_END) - MOST_SAID * 4))
        lines = file.read().decode(errors="replace").split("\n")
    last = printable(next((line.strip() for line in reversed(lines) if line.strip()), ""))
    return f": {last[:MOST_SAID]}" if last else ""
