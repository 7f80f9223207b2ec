"""`ltlc compare`: encodings of a sentence, formulas, or guards side by side; or ways to make a monitor, on a corpus."""

from __future__ import annotations

import argparse
from pathlib import Path

from ltlc.automata import Budget, SpotMissing
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import FINDING, OK, UNDECIDED, failure, report, unusable
from ltlc.interfaces.commands.progress import progress, saying


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc compare` takes."""
    _add_subjects(
        parser.add_argument_group("what to compare, one of these").add_mutually_exclusive_group(required=True)
    )
    parser.add_argument(
        "other", metavar="OTHER", nargs="?", type=Path, help="compare the guards of PROPS with those of this file"
    )
    parser.add_argument(
        "--encodings",
        "--encoding",
        type=arguments.names,
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
        help="show where the choice would have made a difference",
    )
    parser.add_argument("--seed", type=int, default=0, help="of the corpus `random` (default: %(default)s)")
    parser.add_argument(
        "--count", type=arguments.count, default=100, help="of formulas of `random` (default: %(default)s)"
    )
    parser.add_argument("--format", choices=("text", "json", "csv", "md", "html"), default="text")
    arguments.add_message_paths(parser)
    arguments.add_budget(parser, "limits for each translation and each question", 10.0)


def _add_subjects(group: argparse._MutuallyExclusiveGroup) -> None:
    group.add_argument(
        "specification",
        metavar="PROPS",
        nargs="?",
        type=Path,
        help="compare the encodings of each property; `-` for stdin",
    )
    group.add_argument("--ltl", metavar="FORMULA", nargs="+", help="compare formulas in Spot's syntax")
    group.add_argument(
        "--ltl-file",
        metavar="FILE",
        type=Path,
        help="compare formulas in a file, one per line or NAME<tab>FORMULA; with more tabs, those of each line",
    )
    group.add_argument(
        "--corpus",
        metavar="NAME",
        help="compare ways to make a monitor, on dac, eh, hkrss, p, random, blowup, or the formulas in a file",
    )


def run(options: argparse.Namespace) -> int:
    """Print the comparison; 0 if all of it was decided, 3 if a limit was met, 1 if two procedures disagree."""
    if options.recording and options.specification is None:
        return unusable("formulas have no signals to record: --recording needs PROPS")
    if options.other is not None and (unfit := _unfit_for_guards(options)):
        return unusable(f"the guards of two files are compared without {unfit}")
    try:
        return _run(options)
    except SpotMissing as error:
        return unusable(str(error))


def _run(options: argparse.Namespace) -> int:
    """Compare or measure. Raises SpotMissing, already when it imports what it needs."""
    from ltlc.analysis.comparison.reference import Contradiction
    from ltlc.base.errors import UnusableInput

    try:
        if options.other is not None:
            return _compare_guards(options)
        return _compare(options) if options.corpus is None else _measure(options)
    except UnusableInput as error:
        report(error.diagnostics)
        return failure(error.diagnostics) if error.diagnostics else unusable(str(error))
    except Contradiction as error:
        return unusable(f"{error}; this is a bug in ltlc or Spot, please report it")


def _compare(options: argparse.Namespace) -> int:
    """Put encodings or formulas side by side."""
    from ltlc.interfaces.api.compare import compare

    with progress("comparing", options.quiet) as watch:
        table = compare(
            options.specification,
            ltl=options.ltl if options.ltl is not None else options.ltl_file,
            encodings=options.encodings,
            encoding_files=options.encoding_file,
            recordings=options.recording,
            reading=options.reading,
            message_paths=options.msg_path,
            budget=Budget(*options.budget),
            watch=watch,
        )
    report(table.diagnostics)
    print(table.formatted(options.format), end="")
    return OK if table.is_complete else UNDECIDED


def _unfit_for_guards(options: argparse.Namespace) -> str:
    """An option that has no meaning beside a second file; empty if there is none."""
    given = {
        "--encodings": options.encodings,
        "--encoding-file": options.encoding_file,
        "--reading": options.reading != "both",
        f"--format {options.format}": options.format not in ("text", "json"),
    }
    return next((name for name, is_given in given.items() if is_given), "")


def _compare_guards(options: argparse.Namespace) -> int:
    """Put the guards of two files side by side."""
    from ltlc.interfaces.api.compare_guards import compare_guards

    with saying("comparing the guards", options.quiet):
        found = compare_guards(
            options.specification, options.other, options.recording, options.msg_path, Budget(*options.budget)
        )
    report(found.diagnostics)
    print(found.text() if options.format == "text" else found.json(), end="")
    return OK if found.is_complete else UNDECIDED


def _measure(options: argparse.Namespace) -> int:
    """Try the ways to make a monitor on a corpus."""
    from ltlc.interfaces.api.corpus import measure_corpus

    with saying("measuring", options.quiet):
        done = measure_corpus(options.corpus, options.seed, options.count, Budget(*options.budget))
    print(done.formatted(options.format), end="")
    if not done.agrees:
        return FINDING
    return OK if done.is_complete else UNDECIDED
