"""`ltlc format`: specifications in the canonical layout, in place."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ltlc.base.diagnostics import Diagnostic
from ltlc.base.files import rewrite_text
from ltlc.base.render.difference import difference
from ltlc.base.source import Source
from ltlc.frontend.language import STDIN, read_source
from ltlc.frontend.layout import layout
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import FINDING, OK, UNUSABLE, report, unwritable
from ltlc.interfaces.commands.sources import found_in


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc format` takes."""
    arguments.add_specifications(
        parser, "specification files, or folders of *.ltlc files; `-` reads stdin and writes stdout"
    )
    parser.add_argument(
        "--check",
        action="store_true",
        help="write nothing: list the files that would change, and fail if there are any",
    )
    parser.add_argument(
        "--diff", action="store_true", help="write nothing: show what would change, and fail if anything would"
    )


def run(options: argparse.Namespace) -> int:
    """Lay out each file; name those that change."""
    paths, problems = found_in(options.specifications)
    report(problems)
    codes = [_format(path, options.check, options.diff, options.quiet) for path in paths]
    return max([UNUSABLE if problems else OK, *codes])


def _format(path: Path, check: bool, diff: bool, quiet: bool) -> int:
    """Lay out the file at `path`, or only say what would change; the exit code for it."""
    source = read_source(path)
    if isinstance(source, Diagnostic):
        report([source])
        return UNUSABLE
    text = layout(source)
    if not isinstance(text, str):
        report(text)
        return UNUSABLE
    if path == STDIN and not (check or diff):
        sys.stdout.write(text)
        return OK
    if text == source.text:
        return OK
    return _show(source, text, check, diff) if check or diff else _write(path, text, quiet)


def _show(source: Source, text: str, check: bool, diff: bool) -> int:
    if diff:
        sys.stdout.write(difference(source.name, source.text, text))
    if check:
        print(source.name)
    return FINDING


def _write(path: Path, text: str, quiet: bool) -> int:
    try:
        rewrite_text(path, text)
    except OSError as error:
        return unwritable(path, error)
    if not quiet:
        print(path)
    return OK
