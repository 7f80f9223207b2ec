"""`ltlc mine`: the tightest values of thresholds and bounds with which every recording passes."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ltlc.automata import Budget, SpotMissing
from ltlc.base.files import refuse_unwritable, write_text
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import FINDING, UNUSABLE, overwritten, refused, report, unusable, without_notes
from ltlc.interfaces.commands.progress import progress, saying
from ltlc.monitoring.campaigns.places import find, is_address
from ltlc.monitoring.mining import report as reports
from ltlc.monitoring.mining.mine import Mined, mine
from ltlc.monitoring.mining.oracle import TooHardError
from ltlc.monitoring.mining.template import load


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc mine` takes."""
    arguments.add_specification(parser, "the specification file, which contains `?`; `-` for stdin")
    arguments.add_recordings(parser)
    parser.add_argument("--format", choices=("text", "json"), default="text")
    parser.add_argument(
        "--each", action="store_true", help="also report the tightest value of each recording by itself"
    )
    parser.add_argument(
        "--robustness", action="store_true", help="also report by how much the recordings pass with the values found"
    )
    parser.add_argument(
        "--exact", action="store_true", help="print and write the tightest values to the last digit, not rounded"
    )
    parser.add_argument(
        "--write", metavar="FILE", type=Path, help="write the specification with the values to FILE, if all are found"
    )
    arguments.add_message_paths(parser)
    arguments.add_budget(parser, "limits for translating one property", 10.0)


def run(options: argparse.Namespace) -> int:
    """Find the values, show them in the format asked for, and write the file that has them if that is asked for."""
    from ltlc.frontend.language.suppression import suppress, unsuppressed

    with saying("looking for recordings", options.quiet):
        found = find(options.recordings)
    template, diagnostics = load(options.specification, options.msg_path, found.paths)
    if template is None:
        report(unsuppressed(diagnostics))
        return UNUSABLE
    report(without_notes(suppress(template.sample, diagnostics)))
    if options.write is not None:
        try:
            refuse_unwritable(options.write)
        except OSError as error:
            return unusable(f"{options.write} cannot be written: {error.strerror or error}")
    report(found.problems)
    elsewhere = [place.name for place in found.places if is_address(place.name)]
    if found.problems or elsewhere:
        return unusable(f"{elsewhere[0]} is not on this machine: copy it first") if elsewhere else UNUSABLE
    paths = found.paths
    if overwritten((options.write,), paths):
        return refused(options.write)
    try:
        with progress("reading recordings", options.quiet) as watch:
            reading = arguments.reading(options)
            budget = Budget(*options.budget)
            mined = mine(template, paths, budget, watch, options.each, reading, options.robustness)
    except SpotMissing as error:
        return unusable(str(error))
    except TooHardError as error:
        report(error.diagnostics)
        return FINDING
    report(mined.diagnostics)
    sys.stdout.write(reports.document(mined) if options.format == "json" else reports.text(mined, options.exact))
    return mined.exit_code if options.write is None else _write(mined, options.write, options.exact)


def _write(mined: Mined, path: Path, exact: bool) -> int:
    """Write the specification with its values to `path`, if all were found and all recordings read; the exit code."""
    values = mined.values(exact)
    if values is None or mined.unusable:
        why = "a recording could not be read" if mined.unusable else "not all values were found"
        print(f"ltlc: {path} is not written: {why}", file=sys.stderr)
        return mined.exit_code
    try:
        write_text(path, mined.template.text(values))
    except OSError as error:
        print(f"ltlc: {path} cannot be written: {error.strerror or error}", file=sys.stderr)
        return UNUSABLE
    return mined.exit_code
