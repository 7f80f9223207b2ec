"""The `ltlc` command: what it takes, and which module does it.

Exit codes: 0 all well; 1 a finding (errors, a failed gate, a violated property); 2 unusable input or usage; 3 nothing
violated, but something owed, never started or not decided.
"""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from ltlc import __version__
from ltlc.semantics.encodings import ENCODINGS

COMMANDS = {
    "new": "write a specification to start with, for the topics of a bag or of `ros2 topic list -t`",
    "check": "find what is wrong with a specification, without running it",
    "format": "write specifications in one canonical layout, in place",
    "build": "make monitors, judge them, and write a ROS 2 node or another target",
    "run": "judge a recorded run",
    "mine": "find the tightest thresholds and bounds, written as `?`, with which recorded runs pass",
    "certify": "check the certificates that someone else made, trusting neither Spot nor their monitors",
    "compare": "encodings of the same sentence, or formulas, side by side, with the runs that tell them apart",
    "explain": "say in plain English what properties mean, with example runs; or show the page of a diagnostic",
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; the result is the exit code of the process."""
    options = _parser().parse_args(arguments)
    module = importlib.import_module(f"ltlc.commands.{options.command}")
    try:
        return int(module.run(options))
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt:
        print("ltlc: interrupted", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="ltlc",
        description="Compile properties of robots into runtime monitors.",
        epilog="Exit codes: 0 all well; 1 a finding; 2 unusable input or usage; "
        "3 nothing violated, but something owed, never started or not decided.",
    )
    parser.add_argument("--version", action="version", version=f"ltlc {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    parsers = {name: commands.add_parser(name, help=text, description=text) for name, text in COMMANDS.items()}
    for name in ("check", "build", "run", "certify"):
        _add_specification(parsers[name])
    _add_check(parsers["check"])
    _add_new(parsers["new"])
    _add_format(parsers["format"])
    _add_budget(parsers["build"], "what translating one property may use; judging it, six times the seconds", 10.0)
    _add_budget(parsers["run"], "what the translation of one property may use", 10.0)
    _add_build(parsers["build"])
    _add_run(parsers["run"])
    _add_mine(parsers["mine"])
    parsers["certify"].add_argument("certificate", metavar="CERTIFICATE", type=Path, help="the file of certificates")
    parsers["certify"].add_argument(
        "--code",
        metavar="FILE",
        type=Path,
        help="emitted Python, a node or monitors, or C beside its header, to be read back",
    )
    _add_compare(parsers["compare"])
    _add_explain(parsers["explain"])
    return parser


def _add_specification(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("specification", metavar="PROPS", type=Path, help="the specification file")
    _add_encoding(parser)
    _add_message_paths(parser)


def _add_encoding(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--encoding", choices=list(ENCODINGS), default="episode", help="how scopes are read (default: %(default)s)"
    )


def _add_message_paths(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--msg-path",
        action="append",
        type=Path,
        default=[],
        metavar="DIR",
        help="further definitions: .msg, .srv and .action files, or ROS packages; may be repeated",
    )


def _add_budget(parser: argparse.ArgumentParser, what: str, seconds: float) -> None:
    parser.add_argument(
        "--budget",
        type=_budget,
        default=(seconds, 1024),
        metavar="SECONDS[,MB]",
        help=f"{what} (default: {seconds:g} seconds, 1024 megabytes)",
    )


def _budget(text: str) -> tuple[float, int]:
    """Seconds, and megabytes if given after a comma."""
    seconds, _, megabytes = text.partition(",")
    try:
        budget = float(seconds), int(megabytes) if megabytes else 1024
    except ValueError:
        budget = (0.0, 0)
    if not (0 < budget[0] < float("inf") and budget[1] > 0):
        raise argparse.ArgumentTypeError(f"{text!r} is not positive seconds and megabytes, such as 10 or 10,1024")
    return budget


def _add_check(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--format", choices=("full", "concise", "json", "sarif"), default="full")
    parser.add_argument("--strict", action="store_true", help="warnings fail, as errors do")
    parser.add_argument("--pedantic", action="store_true", help="also what is opinion rather than fault")
    _add_budget(parser, "what all analyses together may use", 30.0)


def _add_new(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "bag",
        metavar="BAG",
        nargs="?",
        type=Path,
        help="a bag with the topics; without one they are read from stdin, as `ros2 topic list -t` writes them",
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="a file that is not there yet (default: stdout)"
    )
    _add_message_paths(parser)


def _add_format(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "specifications", metavar="PROPS", nargs="+", type=Path, help="specification files; - is from stdin to stdout"
    )
    parser.add_argument(
        "--check", action="store_true", help="write nothing: fail, and name the files that would change"
    )
    parser.add_argument(
        "--diff", action="store_true", help="write nothing: show what would change, and fail if it does"
    )


def _add_explain(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("subject", metavar="PROPS_OR_CODE", help="a specification file, or a code such as LTL101")
    _add_encoding(parser)
    _add_message_paths(parser)
    _add_budget(parser, "what explaining the whole file may use", 30.0)


def _add_build(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--target",
        choices=("ros2", "ament", "python", "c", "hoa", "dot", "json"),
        default="ros2",
        help="default: %(default)s",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="PATH",
        help="default: STEM_monitor.py, STEM.hoa, … here; of ament, a folder",
    )
    parser.add_argument("--certificate", type=Path, metavar="PATH", help="write the monitors' certificates to PATH")


def _add_run(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "recordings",
        metavar="RECORDING",
        nargs="+",
        help="a recorded run: a bag, .csv, .jsonl or .parquet; a folder of them, a pattern such as 'drives/**/*.mcap', "
        "an address such as s3://bucket/drives",
    )
    _add_campaign(parser.add_argument_group("many recordings"))
    parser.add_argument("--format", choices=("text", "json", "junit"), default="text")
    parser.add_argument("--verdicts", action="store_true", help="in JSON, the verdict after each step")
    parser.add_argument(
        "--timing",
        action="store_true",
        help="say on stderr which way each property was judged, why, and how long it took",
    )
    parser.add_argument(
        "--report",
        type=Path,
        metavar="FILE.html",
        help="write a page for a browser: verdicts over the signals, the monitors, what failed",
    )
    parser.add_argument(
        "--output",
        type=Path,
        metavar="FILE.mcap",
        help="write the verdicts as topics with the times of the recording, for Foxglove and PlotJuggler",
    )
    parser.add_argument(
        "--from",
        dest="since",
        type=_time,
        metavar="TIME",
        help="judge from TIME on, in seconds as in the recording (default: that of its first row)",
    )
    parser.add_argument(
        "--until",
        type=_time,
        metavar="TIME",
        help="judge up to TIME, in seconds as in the recording (default: that of its last row)",
    )
    parser.add_argument(
        "--stamp",
        choices=("log", "header"),
        default="log",
        help="of a bag, when messages were recorded, or the time in their headers (default: %(default)s)",
    )


def _add_campaign(parser: argparse._ArgumentGroup) -> None:
    parser.add_argument("--jobs", type=_count, metavar="N", help="how many are judged at a time (default: all CPUs)")
    parser.add_argument(
        "--engine",
        metavar="ADDRESS",
        help="judge them on the workers of the Dask scheduler at ADDRESS, such as tcp://host:8786; "
        "`local` starts one with --jobs workers",
    )
    parser.add_argument(
        "--results",
        type=Path,
        metavar="FILE.parquet",
        help="keep what each shows in a table; with the same FILE, only what is missing, failed or changed is judged",
    )
    parser.add_argument("--summary", type=Path, metavar="FILE.html", help="write a page about all of them")


def _add_mine(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("specification", metavar="PROPS", type=Path, help="the specification file, with `?` in it")
    parser.add_argument(
        "recordings", metavar="RECORDING", nargs="+", help="recorded runs, folders and patterns, as of `ltlc run`"
    )
    parser.add_argument("--format", choices=("text", "json"), default="text")
    parser.add_argument("--each", action="store_true", help="also the tightest value of each recording by itself")
    parser.add_argument(
        "--write", metavar="FILE", type=Path, help="write the specification with the values to FILE, if all are found"
    )
    _add_message_paths(parser)
    _add_budget(parser, "what the translation of one property may use", 10.0)


def _time(text: str) -> int:
    from ltlc.runtime.times import nanoseconds

    try:
        return nanoseconds(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a time in seconds, such as 12.5") from None


def _names(text: str) -> list[str]:
    names = [name.strip() for name in text.split(",")]
    if not all(names):
        raise argparse.ArgumentTypeError(f"{text!r} is not a list of names, such as episode,dwyer")
    return names


def _count(text: str) -> int:
    if not (text.isdecimal() and 0 < int(text) <= 100_000):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 1 to 100000")
    return int(text)


def _add_compare(parser: argparse.ArgumentParser) -> None:
    what = parser.add_argument_group("what is compared, one of these").add_mutually_exclusive_group(required=True)
    what.add_argument("specification", metavar="PROPS", nargs="?", type=Path, help="each property under each encoding")
    what.add_argument("--ltl", metavar="FORMULA", nargs="+", help="formulas in Spot's syntax, with one another")
    what.add_argument(
        "--ltl-file",
        metavar="FILE",
        type=Path,
        help="formulas in a file, one a line or NAME<tab>FORMULA; with more tabs, those of each line",
    )
    what.add_argument(
        "--corpus",
        metavar="NAME",
        help="ways to make a monitor, on dac, eh, hkrss, p, random, blowup, or the formulas in a file",
    )
    parser.add_argument(
        "--encodings",
        "--encoding",
        type=_names,
        metavar="A,B,…",
        help="default: episode,pointwise,pointwise-strong,dwyer",
    )
    parser.add_argument(
        "--encoding-file", metavar="FILE", type=Path, action="append", default=[], help="further encodings; repeatable"
    )
    parser.add_argument("--reading", choices=("both", "infinite", "finite"), default="both", help="of runs")
    parser.add_argument(
        "--recording",
        metavar="FILE",
        type=Path,
        action="append",
        default=[],
        help="where would the choice have mattered?",
    )
    parser.add_argument("--seed", type=int, default=0, help="of the corpus `random` (default: %(default)s)")
    parser.add_argument("--count", type=_count, default=100, help="of formulas of `random` (default: %(default)s)")
    parser.add_argument("--format", choices=("text", "json", "csv", "md", "html"), default="text")
    _add_message_paths(parser)
    _add_budget(parser, "what each translation and each question may use", 10.0)


if __name__ == "__main__":
    sys.exit(main())
