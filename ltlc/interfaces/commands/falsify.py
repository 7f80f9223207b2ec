"""`ltlc falsify`: parameters and inputs of a simulation with which a property is violated."""

from __future__ import annotations

import argparse
import json
import shutil
import signal
import sys
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path

from ltlc.automata import Budget
from ltlc.base.errors import UnusableInput
from ltlc.base.files import scratch
from ltlc.falsification import keeping
from ltlc.falsification import report as reports
from ltlc.falsification.assignment import Assignment
from ltlc.falsification.command import Command, command_of
from ltlc.falsification.examples import examples
from ltlc.falsification.falsify import Falsification, Watch, falsify
from ltlc.falsification.parameters import space_of
from ltlc.falsification.simulation import Outcome, Simulated, SimulationError, violated_first, whole
from ltlc.inputs.recordings.digests import digests
from ltlc.interfaces.api.falsify import judge_of
from ltlc.interfaces.api.prepare import Prepared
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import compile_file, report, unusable, unwritable, without_notes
from ltlc.monitoring.judging.run import Judge, RunReport
from ltlc.semantics.encodings import ENCODINGS
from ltlc.semantics.verdicts import Verdict


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc falsify` takes."""
    arguments.add_specification(parser)
    parser.add_argument(
        "--simulate",
        metavar="COMMAND",
        required=True,
        help="simulates once: it gets {NAME} of a parameter or {parameters}, a JSON file with all of them, and writes "
        "a recording to {recording} with an ending, as in {recording}.mcap",
    )
    parser.add_argument(
        "--parameter",
        action="append",
        default=[],
        metavar="NAME=VALUES",
        help="what may be changed: speed=0.2..1.5, speed=0.2..0.5..1.5 with a default, boxes:int=0..5, floor=dry,wet; "
        "may be repeated",
    )
    parser.add_argument(
        "--input",
        action="append",
        default=[],
        metavar="NAME=VALUES@POINTS",
        help="what changes during a run: throttle=-1..1@8 has eight control points, which are as far apart; "
        "may be repeated",
    )
    parser.add_argument(
        "--property",
        action="append",
        default=[],
        metavar="LABEL",
        help="a property to be violated (default: any of the file); may be repeated",
    )
    parser.add_argument("--seconds", type=float, help="how long a simulation is to run; needed for --input")
    parser.add_argument(
        "--simulations", type=arguments.count, default=100, metavar="N", help="how many at most (default: %(default)s)"
    )
    parser.add_argument(
        "--seed", type=_seed, default=0, metavar="N", help="another one searches elsewhere (default: %(default)s)"
    )
    parser.add_argument(
        "--jobs",
        type=arguments.count,
        default=1,
        metavar="N",
        help="how many simulations run at a time, which changes nothing but how long it takes (default: %(default)s)",
    )
    parser.add_argument(
        "--time-limit",
        type=arguments.duration,
        default=60 * 10**9,
        metavar="DURATION",
        help="a simulation that takes longer is ended, and has failed (default: 60 s)",
    )
    parser.add_argument(
        "--keep",
        type=Path,
        default=Path("falsified"),
        metavar="DIR",
        help="the folder for the recording and the parameters of what is found (default: %(default)s)",
    )
    parser.add_argument("--format", choices=("text", "json"), default="text")
    arguments.add_reading(parser)
    arguments.add_budget(parser, "limits for translating one property", 10.0)


def _seed(text: str) -> int:
    if not (text.isascii() and text.isdecimal() and len(text) < 10):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 0 on")
    return int(text)


def run(options: argparse.Namespace) -> int:
    """Search, report, and keep what is found."""
    try:
        space = space_of(options.parameter, options.input, options.seconds)
        command = command_of(options.simulate, space, options.time_limit)
    except ValueError as error:
        return unusable(str(error))
    try:
        keeping.refuse(options.keep)
    except OSError as error:
        return unwritable(options.keep, error)
    prepared = compile_file(options)
    if isinstance(prepared, int):
        return prepared
    try:
        prepared = prepared.only(options.property)
    except UnusableInput as error:
        return unusable(str(error))
    with _environments(options.jobs) as environments, scratch() as folder, _ended_as_by_ctrl_c():
        if len(environments) < options.jobs:
            return unusable(f"--jobs {options.jobs}: only {len(environments)} ROS domains are free on this machine")
        judge = judge_of(prepared, map(str, options.msg_path))
        simulations = _Simulations(replace(command, environments=environments), judge, folder)
        try:
            begin = examples(prepared.specification, ENCODINGS[options.encoding], space, Budget(*options.budget))
            found = falsify(simulations, space, options.simulations, options.seed, begin, _watch(options))
        except SimulationError as error:
            return unusable(f"the first simulation, with all defaults, failed: {error}")
        return _told(found, prepared, options)


@contextmanager
def _environments(jobs: int) -> Iterator[Sequence[Mapping[str, str]]]:
    """The variables that each of so many simulations at a time has: a ROS domain of its own, unless it is alone."""
    if jobs == 1:
        yield [{}]
        return
    from ltlc.falsification.domains import free_domains  # which one job does without

    with free_domains(jobs) as domains:
        yield [{"ROS_DOMAIN_ID": str(domain)} for domain in domains]


@contextmanager
def _ended_as_by_ctrl_c() -> Iterator[None]:
    """A request to end, as a CI server makes it, is taken as Ctrl-C is: what runs is ended, what was found is kept."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


class _Simulations:
    """Simulates by a command in a folder for each time, and judges.

    Of the folders, the last two stay with a violation of the property that was violated first: what that is shrunk to,
    and, if Ctrl-C comes before that is known, what it was shrunk to before.
    """

    def __init__(self, command: Command, judge: Judge, folder: Path) -> None:
        self._command = command
        self._judge = judge
        self._folder = folder
        self._is_first = True
        self._label: str | None = None
        self._kept: list[Path] = []

    def __call__(self, assignments: Iterable[Assignment]) -> Generator[tuple[Assignment, Outcome], None, None]:
        with closing(self._command.simulate(assignments, self._folder)) as left:
            for assignment, folder, recording in left:
                outcome = recording if isinstance(recording, SimulationError) else self._judged(recording)
                if not isinstance(outcome, SimulationError) and self._is_sought(outcome):
                    self._kept.append(folder)
                    gone, self._kept = self._kept[:-2], self._kept[-2:]
                else:
                    gone = [folder]
                for each in gone:
                    shutil.rmtree(each, ignore_errors=True)
                yield assignment, outcome

    def _is_sought(self, judged: RunReport) -> bool:
        first = violated_first(judged)
        if self._label is None and first is not None:
            self._label = first.property.label
        tracks = [] if judged.session is None else judged.session.tracks
        return any(track.property.label == self._label and track.verdict is Verdict.VIOLATED for track in tracks)

    def _judged(self, recording: Path) -> Outcome:
        judged = self._judge.judge(recording)
        if self._is_first and judged.session is not None:
            self._is_first = False
            report(without_notes(judged.diagnostics))
        return whole(judged)


def _watch(options: argparse.Namespace) -> Watch | None:
    """Says on stderr what came of each simulation."""
    if options.quiet or options.format != "text":
        return None

    def watch(simulated: Simulated, what_for: str) -> None:
        print(reports.simulated_text(simulated, what_for), file=sys.stderr, flush=True)

    return watch


def _told(found: Falsification, prepared: Prepared, options: argparse.Namespace) -> int:
    """Print the report, and keep what was found; the exit code."""
    shown = found.smallest or found.found
    path = None if shown is None or shown.report is None else Path(shown.report.recording)
    files = () if path is None else digests(path)
    made = reports.document(found, prepared.specification.source, prepared.left_out, files)
    document = json.dumps(made, indent=2) + "\n"
    sys.stdout.write(document if options.format == "json" else reports.text(found, prepared.left_out))
    if path is not None:
        try:
            keeping.keep(path.parent, options.keep, document)
        except OSError as error:
            return unwritable(options.keep, error)
        if not options.quiet:
            print(f"ltlc: wrote {options.keep}: {path.name}, parameters.json, {keeping.REPORT}", file=sys.stderr)
    return found.exit_code
