"""`ltlc build`: check, then monitors, the gate, and the output."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

from ltlc.automata import Budget
from ltlc.backends import FILE_NAMES
from ltlc.base.files import refuse_unwritable, write_all
from ltlc.frontend.language import STDIN
from ltlc.interfaces.building.build import TooLargeError, build
from ltlc.interfaces.building.targets import UnfitError, target_of
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import (
    FINDING,
    OK,
    UNUSABLE,
    compile_file,
    overwritten,
    refused,
    report,
    unusable,
    unwritable,
)
from ltlc.interfaces.commands.progress import progress, saying

CHECK_BUDGET = Budget(seconds=30.0, megabytes=1024)
"""What the analyses may use, all together."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc build` takes."""
    arguments.add_specification(parser, "the specification file; `-` for stdin, which needs --output")
    arguments.add_reading(parser)
    arguments.add_budget(parser, "limits for translating one property; judging it may take six times the seconds", 10.0)
    parser.add_argument(
        "-t",
        "--target",
        choices=tuple(FILE_NAMES),
        default="ros2",
        help="default: %(default)s",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="PATH",
        help="default: STEM_monitor.py, STEM.hoa, … in this folder; for ament, a folder",
    )
    parser.add_argument("--certificate", type=Path, metavar="PATH", help="write the monitors' certificates to PATH")
    parser.add_argument(
        "--program",
        action="store_true",
        help="with --certificate: also write the programs that run, for `ltlc certify --program`",
    )


def run(options: argparse.Namespace) -> int:
    """Write the output if every property passes the gate; otherwise say which does not, and why."""
    if options.specification == STDIN and options.output is None:
        return unusable("stdin has no name to derive that of the output from: give --output PATH")
    if options.program and options.certificate is None:
        return unusable("programs are written with certificates: give --certificate PATH, too")
    target = target_of(options.target, options.output, options.specification.stem)
    if twice := overwritten([*target.told, options.certificate], [options.specification]):
        return refused(twice)
    try:
        path = target.told[0]
        target.refuse()
        if options.certificate:
            path = options.certificate
            refuse_unwritable(path)
    except OSError as error:
        return unwritable(path, error)
    prepared = compile_file(options, analyses=CHECK_BUDGET, erroneous=FINDING)
    if isinstance(prepared, int):
        return prepared
    try:
        with progress("judging monitors", options.quiet) as watch:
            built = build(prepared.specification, prepared.compiled, target, options.msg_path, prepared.budget, watch)
    except UnfitError as error:
        report(error.diagnostics)
        return UNUSABLE if prepared.specification.guards else FINDING
    if not options.quiet:
        for label, summary in built.summaries():
            print(f"{label}: {summary}")
    if failures := built.failures():
        report(failures)
        return FINDING
    try:
        certificates = {options.certificate: built.certificates(options.program)} if options.certificate else {}
    except TooLargeError as error:
        return unusable(f"nothing was written: {error}")
    if built.made.note and not options.quiet:
        print(built.made.note)
    with saying("making the files", options.quiet):
        files = built.made.files()
    told = [*certificates, *target.told, *built.made.beside]
    return _write({**certificates, **files}, () if options.quiet else told)


def _write(files: Mapping[Path, str | bytes], told: Sequence[Path]) -> int:
    """Write all the files or none, and name those that are `told`; the exit code."""
    try:
        write_all(files)
    except OSError as error:
        return unwritable(error.filename, error)
    for path in told:
        print(f"wrote {path}")
    return OK
