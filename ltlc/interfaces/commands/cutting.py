"""`ltlc run --cut`: what was recorded around each violation, as a file of its own."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from ltlc.base.files import written
from ltlc.inputs.recordings.bags import is_bag
from ltlc.inputs.recordings.rows import RecordingError
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import OK, UNUSABLE, overwritten, refused, report, unusable, unwritable
from ltlc.interfaces.commands.progress import saying
from ltlc.monitoring.judging.extracts import Extract, extracts
from ltlc.monitoring.judging.run import RunReport
from ltlc.runtime.reports import counted
from ltlc.runtime.times import SECOND

if TYPE_CHECKING:
    from ltlc.inputs.recordings.bags.copying import Copier

BEFORE, AFTER = 5 * SECOND, 2 * SECOND


def add_cut(group: argparse._ArgumentGroup) -> None:
    """What is extracted, and where to."""
    group.add_argument(
        "--cut",
        type=Path,
        metavar="DIR",
        help="for each violation, write all messages recorded around it to an MCAP file in DIR",
    )
    group.add_argument(
        "--before",
        type=arguments.duration,
        metavar="TIME",
        help="begin so long before the violation, or before what was owed began (default: 5s)",
    )
    group.add_argument(
        "--after",
        type=arguments.duration,
        metavar="TIME",
        help="end so long after the violation (default: 2s)",
    )


def refuse_cut(path: Path, options: argparse.Namespace) -> int:
    """Say why the recording at `path` cannot be cut, or not to that folder; the exit code, 0 if it can."""
    if path.exists() and not is_bag(path):
        return unusable(f"--cut copies messages from a bag; {path} is a table")
    if options.stamp == "header":
        return unusable("--cut goes by the times at which messages were recorded; omit --stamp header")
    if overwritten([options.cut], [path]):
        return refused(options.cut)
    if options.cut.exists() and not options.cut.is_dir():
        return unusable(f"--cut {options.cut}: not a folder")
    return OK


def cut(found: RunReport, path: Path, options: argparse.Namespace) -> int:
    """Write the extracts of a recording that was judged; the exit code."""
    from ltlc.inputs.recordings.bags.copying import Copier

    before = BEFORE if options.before is None else options.before
    after = AFTER if options.after is None else options.after
    parts = [] if found.session is None else list(extracts(found.session, before, after))
    if not parts:
        if not options.quiet:
            print(f"ltlc: nothing is written to {options.cut}: no property is violated", file=sys.stderr)
        return OK
    try:
        options.cut.mkdir(parents=True, exist_ok=True)
        with Copier(path, tuple(map(str, options.msg_path))) as copier, saying("cutting", options.quiet) as say:
            for number, each in enumerate(parts, 1):
                if say is not None:
                    say(f"{number} of {len(parts)}")
                if code := _write(copier, each, path, options):
                    return code
    except RecordingError as error:
        report([error.diagnostic])
        return UNUSABLE
    except OSError as error:
        return unwritable(options.cut, error)
    return OK


def _write(copier: Copier, extract: Extract, path: Path, options: argparse.Namespace) -> int:
    """Write an extract, and name it; the exit code. Raises RecordingError."""
    target = options.cut / extract.name
    if overwritten([target], [path]):
        return refused(target)
    is_there = target.exists()
    # Time has gone on up to a violation that time alone decided only if a message says so.
    until = max(extract.until, copier.first_from(extract.last) or extract.until)
    try:
        with written(target) as file:
            count = copier.copy(extract.since, until, file)
    except OSError as error:
        return unwritable(target, error)
    if not options.quiet:
        done = "replaced" if is_there else "wrote"
        print(f"ltlc: {done} {target}: {extract.text}, {counted(count, 'message')}", file=sys.stderr)
    return OK
