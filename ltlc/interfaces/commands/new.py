"""`ltlc new`: a specification to start with, for the topics that a robot has."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from ltlc.automata import SpotMissing
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.files import write_text
from ltlc.base.source import Source
from ltlc.frontend.language import types_for
from ltlc.frontend.starter import Draft
from ltlc.frontend.starter.columns import tabled
from ltlc.frontend.starter.topics import MalformedLineError, Topic, listed, recorded
from ltlc.inputs.recordings import RecordingError
from ltlc.inputs.recordings.bags import is_bag
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import OK, RULES, UNUSABLE, read_specification, report, unusable, unwritable
from ltlc.monitoring.measuring.measure import measure


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc new` takes."""
    parser.add_argument(
        "recording",
        metavar="RECORDING",
        nargs="?",
        type=Path,
        help="a bag, .ulg, .csv, .jsonl or .parquet; without it, the output of `ros2 topic list -t` is read from stdin",
    )
    parser.add_argument(
        "--pack",
        metavar="NAME",
        help="write the rules of a pack, such as px4, to be changed; with a RECORDING, those that it has messages for",
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="a file that does not exist yet (default: stdout)"
    )
    arguments.add_message_paths(parser)


def run(options: argparse.Namespace) -> int:
    """Write a specification about the topics of a recording, or of those on standard input."""
    if options.output is not None and options.output.exists():
        return unusable(f"{options.output} already exists and is not overwritten")
    if options.pack:
        recordings = [options.recording] if options.recording else []
        source = read_specification(Path(RULES + options.pack), options.msg_path, recordings)
        if isinstance(source, Diagnostic):
            report([source])
            return UNUSABLE
        return _write(source.text, options.output)
    if options.recording is None and sys.stdin.isatty():
        return unusable("give a recording, or the topics on standard input: `ros2 topic list -t | ltlc new`")
    try:
        topics = _topics(options.recording, options.msg_path)
    except MalformedLineError as error:
        return unusable(str(error))
    except UnicodeDecodeError as error:
        return unusable(f"the topics are not UTF-8 text: {error.reason}")
    except RecordingError as error:
        report([error.diagnostic])
        return UNUSABLE
    recordings = [] if options.recording is None else [options.recording]
    types, problems = types_for(Source("ltlc new", ""), options.msg_path, recordings)
    report(problems)
    if problems:
        return UNUSABLE
    draft = Draft(topics, types)
    if draft.is_empty:
        return unusable(_nothing(draft))
    if options.recording is None:
        return _write(draft.text("a list of topics"), options.output)
    try:
        measured = measure(draft.declarations, draft.probes, options.recording, options.msg_path)
    except RecordingError as error:
        report([error.diagnostic])
        return UNUSABLE
    except SpotMissing as error:
        return unusable(str(error))
    text = draft.text(options.recording.resolve().name, measured, is_table=not is_bag(options.recording))
    return _write(text, options.output)


def _topics(path: Path | None, message_paths: Sequence[str]) -> Sequence[Topic]:
    """Raises MalformedLineError, UnicodeDecodeError and RecordingError."""
    if path is None:
        return listed(sys.stdin.read())
    return recorded(path) if is_bag(path) else tabled(path, types_for(Source("ltlc new", ""), message_paths)[0])


def _nothing(draft: Draft) -> str:
    omitted = draft.omitted
    more = f"\n  and {len(omitted) - 5} more" if omitted[5:] else ""
    return "\n  ".join(["there is no topic to write properties for", *omitted[:5]]) + more


def _write(text: str, path: Path | None) -> int:
    if path is None:
        sys.stdout.write(text)
        return OK
    try:
        write_text(path, text)
    except OSError as error:
        return unwritable(path, error)
    print(f"wrote {path}")
    return OK
