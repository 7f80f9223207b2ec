"""The conformance suite: what each tool gets right of its cases. docs/conformance.md describes it.

    python -m benchmarks.conformance [--tool COMMAND | --answers FILE] [--peers FOLDER] [--cases FIRST-LAST] [--wrong]
    python -m benchmarks.conformance questions         print what a tool is given, a line for each case
    python -m benchmarks.conformance export FOLDER     write cases as files: props.ltlc, run.csv, run.mcap, case.json
    python -m benchmarks.conformance coverage          print how many cases tell each wrong reading
    python -m benchmarks.conformance check             ask the reference, and the judge from Coq, of every case anew
    python -m benchmarks.conformance make JOURNAL      draw new cases (--seconds N, --seed N)
    python -m benchmarks.conformance add JOURNAL…      number those that are new, and add them (--most N)

Exit code 1 if an answer of ltlc or of the tool is wrong or missing, or a check fails; 2 if there are no usable answers.
"""

from __future__ import annotations

import argparse
import json
import shlex
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from benchmarks.conformance import cases as suite
from benchmarks.conformance import export, journal, peers, proved, score, ways
from benchmarks.conformance.cases import Case
from benchmarks.conformance.definition import definition
from benchmarks.conformance.readings import BY_PARTS, READINGS, tells

UNUSABLE = 2


def main(arguments: Sequence[str] | None = None) -> int:
    """Do what the command line asks for."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    is_named = bool(given) and given[0] in (*COMMANDS, "-h", "--help")
    options = _parser().parse_args(given if is_named else ["score", *given])
    try:
        return COMMANDS[options.command](options)
    except score.UnusableAnswersError as error:
        print(f"conformance: {error}", file=sys.stderr)
        return UNUSABLE
    except OSError as error:
        print(f"conformance: {error.filename}: {error.strerror}", file=sys.stderr)
        return UNUSABLE


def _parser() -> argparse.ArgumentParser:
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser("python -m benchmarks.conformance", description=__doc__, formatter_class=form)
    commands = parser.add_subparsers(dest="command", required=True)
    some = argparse.ArgumentParser(add_help=False)
    some.add_argument("--suite", type=Path, default=suite.FILE, metavar="FILE", help="other cases than those here")
    some.add_argument("--cases", type=_numbers, metavar="FIRST-LAST", help="only the cases with these numbers")
    scoring = commands.add_parser("score", parents=[some], help="print what each tool gets right (the default)")
    one = scoring.add_mutually_exclusive_group()
    one.add_argument("--tool", metavar="COMMAND", help="a command that answers on stdout what it is asked on stdin")
    one.add_argument("--answers", type=Path, metavar="FILE", help="what a tool has answered")
    scoring.add_argument("--timeout", type=float, default=600.0, metavar="SECONDS", help="for --tool (600)")
    scoring.add_argument("--peers", type=Path, metavar="FOLDER", help="site-packages with rtamt and reelay")
    scoring.add_argument("--wrong", action="store_true", help="list each case that is answered wrongly")
    commands.add_parser("questions", parents=[some], help="print what a tool is given")
    commands.add_parser("export", parents=[some], help="write cases as files").add_argument("folder", type=Path)
    commands.add_parser("coverage", parents=[some], help="print how many cases tell each wrong reading")
    checking = commands.add_parser("check", parents=[some], help="judge every case anew, also by the judge from Coq")
    checking.add_argument("--judge", type=Path, default=proved.JUDGE, metavar="FILE", help="what make -C proofs builds")
    making = commands.add_parser("make", help="draw new cases")
    making.add_argument("journal", type=Path)
    making.add_argument("--seconds", type=float, default=60.0)
    making.add_argument("--seed", type=int, default=0)
    making.add_argument("--judge", type=Path, default=proved.JUDGE, metavar="FILE", help="what make -C proofs builds")
    adding = commands.add_parser("add", parents=[some], help="number new cases, and add them")
    adding.add_argument("journals", type=Path, nargs="+")
    adding.add_argument("--most", type=int, default=5000, help="so many cases at most altogether (5000)")
    return parser


def _numbers(text: str) -> range:
    first, _, last = text.partition("-")
    if not first.isdecimal() or not (last or first).isdecimal():
        raise argparse.ArgumentTypeError(f"`{text}` is not FIRST-LAST, such as 1-200")
    return range(int(first), int(last or first) + 1)


def _score(options: argparse.Namespace) -> int:
    cases = suite.load(options.suite, options.cases)
    own: list[score.Score] = []
    others: list[score.Score] = []
    if options.tool is not None:
        command = shlex.split(options.tool)
        own.append(score.scored(options.tool, cases, score.asked(command, cases, options.timeout)))
    elif options.answers is not None:
        own.append(score.scored(options.answers.name, cases, score.read(options.answers)))
    else:
        own = [score.scored(way, cases, ways.answers(way, cases)) for way in ways.WAYS]
        others = [score.scored(name, cases, found) for name, found in peers.answers(cases, options.peers)]
    head = suite.head(options.suite)
    print(f"{head['suite']} {head['version']}, {len(cases):,} cases\n\n{score.table([*own, *others], len(cases))}")
    by_number = {case.number: case for case in cases}
    for each in [*own, *others] if options.wrong else []:
        for number, found in each.wrong.items():
            case = by_number[number]
            wanted, said = json.dumps(case.expected.changes), json.dumps(found.changes)
            print(f"{each.tool}: case {number}: `{case.sentence}`: {said}, but expected {wanted}")
    return 0 if all(each.is_full for each in own) else 1


def _questions(options: argparse.Namespace) -> int:
    for case in suite.load(options.suite, options.cases):
        print(json.dumps(case.question(), allow_nan=False))
    return 0


def _export(options: argparse.Namespace) -> int:
    cases = suite.load(options.suite, options.cases)
    export.export(cases, options.folder)
    bags = sum(case.has_messages for case in cases)
    print(f"{len(cases):,} cases in {options.folder}, {bags:,} of them also as MCAP")
    return 0


def _coverage(options: argparse.Namespace) -> int:
    cases = suite.load(options.suite, options.cases)
    print("| family | wrong reading | cases |\n|---|---|---|")
    for name, reading in READINGS.items():
        print(f"| {reading.family} | {reading.about} | {sum(name in case.readings for case in cases):,} |")
    shares = sum(case.proved for case in cases)
    print(f"\n{len(cases):,} cases; {shares:,} ({shares / max(1, len(cases)):.0%}) proved by the extracted judge")
    return 0


def _check(options: argparse.Namespace) -> int:
    problems = 0
    for case in suite.load(options.suite, options.cases):
        for problem in problems_of(case, options.judge):
            problems += 1
            print(f"case {case.number}: {problem}")
    print(f"{problems} problems")
    return 1 if problems else 0


def problems_of(case: Case, judge: Path | None) -> list[str]:
    """What is wrong with a case; without a `judge`, what the reference finds."""
    found = definition(case.text).verdicts(case.recording)
    by_parts = BY_PARTS in case.readings
    problems = []
    if not by_parts and found != case.expected:
        problems.append(f"the reference finds {found}")
    if by_parts and (found.changes == case.expected.changes or not case.proved):
        problems.append("it is not proved, or does not differ from what its parts decide")
    told = [name for name in case.readings if name in READINGS and not tells(name, case.text, case.recording, found)]
    problems += [f"it does not tell {name}" for name in told if not by_parts]
    if judge is not None and case.proved:
        is_proved, refused = proved.proof(case, judge)
        problems += refused or ([] if is_proved else ["it is not proved"])
    return problems


def _make(options: argparse.Namespace) -> int:
    for outcome, count in journal.hunt(options.journal, options.judge, options.seed, options.seconds).most_common():
        print(f"{count:,} {outcome}")
    return 0


def _add(options: argparse.Namespace) -> int:
    known = suite.load(options.suite) if options.suite.exists() else []
    added = journal.chosen(known, options.journals, options.most)
    suite.save([*known, *added], options.suite)
    print(f"{len(added):,} added, {len(known) + len(added):,} cases")
    return 0


COMMANDS: Mapping[str, Callable[[argparse.Namespace], int]] = {
    "score": _score,
    "questions": _questions,
    "export": _export,
    "coverage": _coverage,
    "check": _check,
    "make": _make,
    "add": _add,
}

if __name__ == "__main__":
    sys.exit(main())
