"""`ltlc check`: what is wrong with specifications before they ever run."""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ltlc.analysis.subjects import Subject
from ltlc.automata import Budget, SpotMissing
from ltlc.commands import arguments
from ltlc.commands.common import FINDING, OK, Examined, examine, failure, has_errors, report, unusable
from ltlc.commands.mend import NotMendedError, mend, show_difference
from ltlc.commands.sources import found_in
from ltlc.diagnostics import Diagnostic, Severity
from ltlc.language import STDIN, read_source
from ltlc.render import concise
from ltlc.render import json as render_json

TEXT = ("full", "concise")
"""The forms that are for people."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc check` takes."""
    arguments.add_specifications(parser, "specification files; of a folder, all *.ltlc in it; `-` for stdin")
    arguments.add_reading(parser)
    parser.add_argument("--format", choices=(*TEXT, "json", "sarif"), default="full")
    parser.add_argument("--strict", action="store_true", help="warnings fail, as errors do")
    parser.add_argument("--pedantic", action="store_true", help="also what is opinion rather than fault")
    mends = parser.add_mutually_exclusive_group()
    mends.add_argument("--fix", action="store_true", help="mend what has one certain mend, and tell the rest")
    mends.add_argument("--diff", action="store_true", help="show what --fix would change, and do no more")
    arguments.add_budget(parser, "what all analyses of a file may use together", 30.0)


def run(options: argparse.Namespace) -> int:
    """Show all findings, and of each property whether it can hold and whether it can fail; the worst exit code."""
    if options.fix and STDIN in options.specifications and options.format not in TEXT:
        return unusable("--fix of stdin writes the text to stdout, where no document can stand beside it")
    paths, problems = found_in(options.specifications)
    if options.format in TEXT:
        _report(problems, options.format)
    code = failure(problems) if problems else OK
    if options.diff:
        return max([code, *(show_difference(path, options) for path in paths)])
    checked: list[Examined] = []
    mends = 0
    for path in paths:
        try:
            examined, done = _check(path, options)
        except (SpotMissing, NotMendedError) as error:
            return unusable(str(error))
        checked.append(examined)
        mends += done
        if options.format in TEXT:
            _show(examined, options, f"{path}: " if len(paths) > 1 else "")
    found = [*problems, *(each for examined in checked for each in examined.diagnostics)]
    if options.format not in TEXT:
        _print_document(checked, found, options.format)
    elif not options.quiet:
        _count(found, len(paths), mends)
    return max([code, *(_exit_code(examined, options.strict) for examined in checked)])


def _check(path: Path, options: argparse.Namespace) -> tuple[Examined, int]:
    """What is to be said of a file, after it is mended if that is asked for, and how often it was mended.

    Raises SpotMissing and NotMendedError.
    """
    source, mends = read_source(path), 0
    if options.fix and not isinstance(source, Diagnostic):
        source, mends = mend(path, source, options)
    return examine(source, options, Budget(*options.budget), pedantic=options.pedantic), mends


def _exit_code(examined: Examined, strict: bool) -> int:
    if examined.specification is None:
        return failure(examined.diagnostics)
    fails = has_errors(examined.diagnostics) or (strict and _has_warnings(examined.diagnostics))
    return FINDING if fails else OK


def _has_warnings(diagnostics: Sequence[Diagnostic]) -> bool:
    return any(each.severity is Severity.WARNING for each in diagnostics)


def _show(examined: Examined, options: argparse.Namespace, prefix: str) -> None:
    """Diagnostics on stderr, and on stdout a line for each property, unless that is for what was mended."""
    _report(examined.diagnostics, options.format)
    if not (options.quiet or (options.fix and STDIN in options.specifications)):
        for subject in examined.subjects:
            print(f"{prefix}{subject.label}: {_summary(subject)}")
    sys.stdout.flush()  # what follows on stderr is to come after it, where both go to one place


def _report(diagnostics: Sequence[Diagnostic], form: str) -> None:
    if form == "concise":
        sys.stderr.write(concise.render(diagnostics))
    else:
        report(diagnostics)


def _count(found: Sequence[Diagnostic], files: int, mends: int) -> None:
    """Say on stderr how much was found; nothing of one file without a finding."""
    if not found and not mends and files == 1:
        return
    counts = Counter(each.severity for each in found)
    parts = [_number(counts[severity], severity.value) for severity in Severity if counts[severity]]
    line = f"{', '.join(parts) or 'nothing found'} in {_number(files, 'file')}"
    waiting = sum(any(fix.is_certain for fix in each.fixes) for each in found)
    line += f"; {mends} mended" if mends else ""
    line += f"; {waiting} can be mended by --fix" if waiting else ""
    print(line, file=sys.stderr)


def _number(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _print_document(checked: Sequence[Examined], found: Sequence[Diagnostic], form: str) -> None:
    """All that was found as one document on stdout."""
    if form == "sarif":
        from ltlc.render import sarif

        document = sarif.document(found)
    else:
        properties = [_document(subject, examined) for examined in checked for subject in examined.subjects]
        document = {"properties": properties, "diagnostics": render_json.documents(found)}
    print(json.dumps(document, ensure_ascii=False, indent=2))


def _summary(subject: Subject) -> str:
    """What a property can do, in words."""
    if subject.monitor is None:
        return "not decided whether it can hold or fail"
    if subject.never_holds:
        return "cannot hold"
    return "cannot fail" if subject.always_holds else "can hold, can fail"


def _document(subject: Subject, examined: Examined) -> dict[str, Any]:
    """What a property can do, as an object of JSON; null where it was not decided."""
    known = subject.monitor is not None
    return {
        "file": examined.specification.source.name if examined.specification else None,
        "label": subject.label,
        "line": subject.specification.line,
        "text": subject.specification.text,
        "can_hold": not subject.never_holds if known else None,
        "can_fail": not subject.always_holds if known else None,
        "states": len(subject.monitor.verdicts) if subject.monitor else None,
    }
