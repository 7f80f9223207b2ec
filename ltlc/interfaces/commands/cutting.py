"""`ltlc run --cut`: what was recorded around each violation, as a file of its own, from the command line."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from ltlc.inputs.recordings import is_table
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import OK, overwritten, refused, unusable
from ltlc.monitoring.judging.cutting import Cutting, folders_of
from ltlc.runtime.reports import counted
from ltlc.runtime.times import SECOND

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


def cutting(options: argparse.Namespace, campaign: Iterable[str] | None) -> Cutting | None:
    """How recordings are cut, each of those in a `campaign` into a folder of its own; None if they are not."""
    if options.cut is None:
        return None
    before = BEFORE if options.before is None else options.before
    after = AFTER if options.after is None else options.after
    folders = {} if campaign is None else folders_of(campaign)
    return Cutting(options.cut, before, after, tuple(map(str, options.msg_path)), folders)


def refuse_cut(cutting: Cutting, names: Sequence[str], options: argparse.Namespace) -> int:
    """Say why one of the recordings cannot be cut, or not to that folder; the exit code, 0 if all can."""
    folder = cutting.folder
    if (table := next((name for name in names if is_table(Path(name))), None)) is not None:
        return unusable(f"--cut copies messages from bags; {table} is a table")
    if options.stamp == "header":
        return unusable("--cut goes by the times at which messages were recorded; omit --stamp header")
    if overwritten([folder], names):
        return refused(folder)
    if folder.exists() and not folder.is_dir():
        return unusable(f"--cut {folder}: not a folder")
    own = {os.path.realpath(cutting.folder_of(name)) for name in names if name in cutting.folders}
    for name in names:
        if not own.isdisjoint(map(str, Path(os.path.realpath(name)).parents)):
            return unusable(f"{name} is a recording, and lies where extracts are written; give --cut another folder")
    return OK


def show_extracts(extracts: Iterable[Mapping[str, Any]], options: argparse.Namespace) -> None:
    """Name the extracts, which are as in the JSON document, unless `quiet`."""
    for each in extracts if not options.quiet else ():
        done = "replaced" if each["replaced"] else "wrote"
        text = f"{each['about']}, {counted(each['messages'], 'message')}"
        print(f"ltlc: {done} {each['file']}: {text}", file=sys.stderr)


def show_nothing_cut(options: argparse.Namespace) -> None:
    """Say that there is no extract, unless `quiet`."""
    if not options.quiet:
        print(f"ltlc: nothing is written to {options.cut}: no property is violated", file=sys.stderr)
