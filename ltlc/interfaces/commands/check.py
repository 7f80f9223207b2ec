"""`ltlc check`: finds mistakes in specifications before they ever run."""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ltlc.automata import Budget, SpotMissing
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Severity
from ltlc.base.render import concise
from ltlc.frontend.language import STDIN
from ltlc.interfaces.api.check import Check, check_of, unread_topic
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import (
    FINDING,
    OK,
    UNUSABLE,
    examine,
    failure,
    read_specification,
    report,
    unusable,
)
from ltlc.interfaces.commands.fix import NotFixedError, fix_source, show_difference
from ltlc.interfaces.commands.sources import found_in
from ltlc.interfaces.commands.watching import add_watch, watched

if TYPE_CHECKING:
    from ltlc.analysis.examine import Examined

ABOUT_RECORDINGS = ("LTL80", "LTL81", "LTL82")
"""What codes about unusable recordings begin with."""

TEXT = ("full", "concise")
"""The forms that are for people."""


class UnreadTopicError(ValueError):
    """A controller is said to send what no property reads."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc check` takes."""
    arguments.add_specifications(parser, "specification files, or folders of *.ltlc files; `-` for stdin")
    arguments.add_reading(parser)
    parser.add_argument("--format", choices=(*TEXT, "json", "sarif"), default="full")
    parser.add_argument("--strict", action="store_true", help="treat warnings as errors")
    parser.add_argument("--pedantic", action="store_true", help="also report matters of opinion")
    parser.add_argument(
        "--controls",
        action="append",
        default=[],
        metavar="TOPIC",
        help="what a controller sends: also report whether one can keep the properties; may be repeated",
    )
    parser.add_argument(
        "--recording",
        action="append",
        type=Path,
        default=[],
        metavar="RECORDING",
        help="a recorded run: use the messages it defines, and report what it lacks; may be repeated",
    )
    fixes = parser.add_mutually_exclusive_group()
    fixes.add_argument("--fix", action="store_true", help="apply every unambiguous fix, and report the rest")
    fixes.add_argument("--diff", action="store_true", help="only show what --fix would change")
    arguments.add_budget(parser, "limits for all analyses of a file together", 30.0)
    add_watch(parser)


def run(options: argparse.Namespace) -> int:
    """Check once, or whenever a file changes; the exit code."""
    if options.watch:
        return watched(_run, options, [*options.specifications, *options.recording, *options.msg_path])
    return _run(options)


def _run(options: argparse.Namespace) -> int:
    """Show all findings, and of each property whether it can hold and whether it can fail; the worst exit code."""
    if options.fix and STDIN in options.specifications and options.format not in TEXT:
        return unusable("--fix of stdin writes the text to stdout, which leaves no room for another document")
    paths, problems = found_in(options.specifications)
    if options.format in TEXT:
        _report(problems, options.format)
    code = failure(problems) if problems else OK
    if options.diff:
        return max([code, *(show_difference(path, options) for path in paths)])
    checked = Check(tuple(problems), ())
    fixes, ids = 0, dict[str, str]()
    for path in paths:
        try:
            found, done = _check(path, options, ids)
        except SpotMissing as error:
            return unusable(str(error))
        except (NotFixedError, UnreadTopicError) as error:
            code = unusable(str(error))
            continue
        checked = checked + found
        fixes += done
        code = max(code, _exit_code(found, options.strict))
        if options.format in TEXT:
            _show(found, options, f"{path}: " if len(paths) > 1 else "")
    if options.format not in TEXT:
        _print_document(checked, options.format)
    elif not options.quiet:
        _count(checked.diagnostics, len(paths), fixes)
    return code


def _check(path: Path, options: argparse.Namespace, ids: dict[str, str]) -> tuple[Check, int]:
    """The findings about a file, once it is fixed if that was requested, and the number of fixes.

    Those `ids` of requirements have been given, each in a file; its own are added. Raises SpotMissing, NotFixedError
    and UnreadTopicError.
    """
    source, fixes = read_specification(path, options.msg_path, options.recording), 0
    if options.fix and not isinstance(source, Diagnostic):
        source, fixes = fix_source(path, source, options)
    budget = Budget(*options.budget)
    examined = examine(
        source,
        options,
        budget,
        pedantic=options.pedantic,
        controls=tuple(dict.fromkeys(options.controls)),
        recordings=options.recording,
    )
    if unread := unread_topic(examined, options.controls):
        raise UnreadTopicError(f"{path}: {unread}")
    return check_of(_traced(_compared(examined, options), ids), source), fixes


def _traced(examined: Examined, ids: dict[str, str]) -> Examined:
    """`examined`, with the ids of its requirements that another file has given; the others are added to `ids`."""
    if examined.specification is None:
        return examined
    found, file = [], examined.specification.source.name
    for each in examined.specification.properties:
        id = each.requirement and each.requirement.id
        if id and ids.setdefault(id, file) != file:
            message = f"the requirement `{id}` also occurs in {ids[id]}"
            found.append(diagnostic("LTL111", examined.specification.source, each.whole(), message))
    return replace(examined, diagnostics=[*examined.diagnostics, *found])


def _compared(examined: Examined, options: argparse.Namespace) -> Examined:
    """`examined`, with what the recordings lack of what the specification reads."""
    if not options.recording:
        return examined
    from ltlc.inputs.recordings.lacks import lacks
    from ltlc.inputs.recordings.reading import ReadOptions

    reading = ReadOptions(message_paths=tuple(map(str, options.msg_path)))
    found = [each for path in options.recording for each in lacks(examined.specification, path, reading)]
    return replace(examined, diagnostics=[*examined.diagnostics, *found])


def _exit_code(found: Check, strict: bool) -> int:
    if found.has_errors:
        return UNUSABLE if any(map(_is_unreadable, found.diagnostics)) else failure(found.diagnostics)
    return FINDING if strict and _has_warnings(found.diagnostics) else OK


def _is_unreadable(found: Diagnostic) -> bool:
    return found.severity is Severity.ERROR and found.code.startswith(ABOUT_RECORDINGS)


def _has_warnings(diagnostics: Sequence[Diagnostic]) -> bool:
    return any(each.severity is Severity.WARNING for each in diagnostics)


def _show(found: Check, options: argparse.Namespace, prefix: str) -> None:
    """Diagnostics on stderr, and on stdout a line for each property, unless that is for what was fixed."""
    _report(found.diagnostics, options.format)
    if not (options.quiet or (options.fix and STDIN in options.specifications)):
        for each in found.properties:
            print(f"{prefix}{each}")
    sys.stdout.flush()  # what follows on stderr is to come after it, where both go to one place


def _report(diagnostics: Sequence[Diagnostic], form: str) -> None:
    if form == "concise":
        sys.stderr.write(concise.render(diagnostics))
    else:
        report(diagnostics)


def _count(found: Sequence[Diagnostic], files: int, fixes: int) -> None:
    """Say on stderr how much was found; nothing of one file without a finding."""
    if not found and not fixes and files == 1:
        return
    counts = Counter(each.severity for each in found)
    parts = [_number(counts[severity], severity.value) for severity in Severity if counts[severity]]
    line = f"{', '.join(parts) or 'nothing found'} in {_number(files, 'file')}"
    waiting = sum(any(fix.is_certain for fix in each.fixes) for each in found)
    line += f"; {fixes} fixed" if fixes else ""
    line += f"; {waiting} fixable with --fix" if waiting else ""
    print(line, file=sys.stderr)


def _number(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _print_document(checked: Check, form: str) -> None:
    """All that was found as one document on stdout."""
    document = checked.document()
    if form == "sarif":
        from ltlc.base.render import sarif

        document = sarif.document(checked.diagnostics, checked.sources, checked.requirement_of)
    print(json.dumps(document, ensure_ascii=False, indent=2))
