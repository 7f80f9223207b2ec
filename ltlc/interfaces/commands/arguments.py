"""Arguments that several commands take, and the kinds of values that arguments have."""

from __future__ import annotations

import argparse
import re
from decimal import Decimal
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ltlc.semantics.durations import UNITS, Nanoseconds
from ltlc.semantics.encodings import ENCODINGS

if TYPE_CHECKING:
    from ltlc.inputs.recordings.reading import Limit, ReadOptions


def add_specification(parser: argparse.ArgumentParser, help: str = "the specification file; `-` for stdin") -> None:
    """One specification."""
    parser.add_argument("specification", metavar="PROPS", type=Path, help=help)


def add_specifications(parser: argparse.ArgumentParser, help: str) -> None:
    """Several, and folders of them."""
    parser.add_argument("specifications", metavar="PROPS", nargs="+", type=_path, help=help)


def _path(text: str) -> Path:
    """A path; an empty one, as of a variable that is not set, would be this folder."""
    if not text:
        raise argparse.ArgumentTypeError("a name is empty")
    return Path(text)


def add_reading(parser: argparse.ArgumentParser) -> None:
    """How a specification is read."""
    parser.add_argument(
        "--encoding", choices=list(ENCODINGS), default="episode", help="how scopes are read (default: %(default)s)"
    )
    add_message_paths(parser)


def add_message_paths(parser: argparse.ArgumentParser) -> None:
    """Where further message types are defined."""
    parser.add_argument(
        "--msg-path",
        action="append",
        type=Path,
        default=[],
        metavar="PATH",
        help="additional definitions: .msg, .srv and .action files, ROS packages, or a bag that defines its messages; "
        "may be repeated",
    )


def add_budget(parser: argparse.ArgumentParser, what: str, seconds: float) -> None:
    """What the work may use."""
    parser.add_argument(
        "--budget",
        type=budget,
        default=(seconds, 1024),
        metavar="SECONDS[,MB]",
        help=f"{what} (default: {seconds:g} seconds, 1024 megabytes)",
    )


def add_recordings(parser: argparse.ArgumentParser) -> None:
    """Recordings, and what of them is read."""
    parser.add_argument(
        "recordings",
        metavar="RECORDING",
        nargs="+",
        help="a recorded run: a bag, .ulg, .csv, .jsonl or .parquet; a folder of them, a pattern such as "
        "'drives/**/*.mcap', an address such as s3://bucket/drives",
    )
    parser.add_argument(
        "--from",
        dest="since",
        type=time,
        metavar="TIME",
        help="start at TIME, in seconds as in the recording, or since its beginning, as in +10 "
        "(default: that of its first row)",
    )
    parser.add_argument(
        "--until",
        type=time,
        metavar="TIME",
        help="end at TIME, in seconds as in the recording, or since its beginning, as in +10 "
        "(default: that of its last row)",
    )
    parser.add_argument(
        "--stamp",
        choices=("log", "header"),
        default="log",
        help="in a bag, take the time at which messages were recorded, or that in their headers (default: %(default)s)",
    )
    parser.add_argument(
        "--absolute",
        action="store_true",
        help="in text, show times in full, as in the recording, not since its beginning",
    )


def reading(options: argparse.Namespace) -> ReadOptions:
    """How recordings are read."""
    from ltlc.inputs.recordings.reading import ReadOptions, Stamp
    from ltlc.runtime.times import Times

    times = Times.ABSOLUTE if options.absolute else Times.OFFSET
    return ReadOptions(Stamp(options.stamp), tuple(map(str, options.msg_path)), options.since, options.until, times)


def add_jobs(parser: Any) -> None:
    """How many recordings are read at a time; `parser` may be a group of one."""
    parser.add_argument("--jobs", type=count, metavar="N", help="how many to read at a time (default: all CPUs)")


def budget(text: str) -> tuple[float, int]:
    """Seconds, and megabytes if given after a comma."""
    seconds, _, megabytes = text.partition(",")
    try:
        found = float(seconds), int(megabytes) if megabytes else 1024
    except ValueError:
        found = (0.0, 0)
    if not (0 < found[0] < float("inf") and found[1] > 0):
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a positive number of seconds, or of seconds and megabytes, such as 10 or 10,1024"
        )
    return found


def time(text: str) -> Limit:
    """A time of a recording, or one that counts from its beginning."""
    from ltlc.inputs.recordings.reading import limit

    try:
        return limit(text)
    except ValueError:
        from ltlc.inputs.recordings.rows import calendar_help

        help = calendar_help(text)
        message = f"{text!r} is not a time in seconds, such as 12.5 or +12.5{f': {help}' if help else ''}"
        raise argparse.ArgumentTypeError(message) from None


def duration(text: str) -> Nanoseconds:
    """A duration with a unit, or in seconds: `500ms`, `5 s`, `2`."""
    match = re.fullmatch(rf"(\d+(?:\.\d+)?) ?({'|'.join(UNITS)})?", text.strip())
    if match is None:
        raise argparse.ArgumentTypeError(f"{text!r} is not a duration such as 5s or 500ms")
    number, unit = match.groups()
    return round(Decimal(number) * UNITS[unit or "s"])


def names(text: str) -> list[str]:
    """Names with commas between them."""
    found = [name.strip() for name in text.split(",")]
    if not all(found):
        raise argparse.ArgumentTypeError(f"{text!r} is not a list of names, such as episode,dwyer")
    return found


def count(text: str) -> int:
    """How many of something, at least one."""
    if not (text.isdecimal() and 0 < int(text) <= 100_000):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 1 to 100000")
    return int(text)
