"""`ltlc format`: specifications in the canonical layout, in place."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from difflib import unified_diff
from io import StringIO
from pathlib import Path

from ltlc.commands.common import FINDING, OK, UNUSABLE, report, unwritable
from ltlc.diagnostics import Diagnostic
from ltlc.files import rewrite_text
from ltlc.language import STDIN, read_source
from ltlc.layout import layout
from ltlc.source import Source


def run(options: argparse.Namespace) -> int:
    """Lay out each file; name those that change."""
    return max([_format(path, options.check, options.diff) for path in options.specifications])


def _format(path: Path, check: bool, diff: bool) -> int:
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
    return _show(source, text, check, diff) if check or diff else _write(path, text)


def _show(source: Source, text: str, check: bool, diff: bool) -> int:
    if diff:
        sys.stdout.writelines(_difference(source, text))
    if check:
        print(source.name)
    return FINDING


def _write(path: Path, text: str) -> int:
    try:
        rewrite_text(path, text)
    except OSError as error:
        return unwritable(path, error)
    print(path)
    return OK


def _difference(source: Source, text: str) -> Iterator[str]:
    """What changes, as `patch` takes it."""
    before, after = ([*StringIO(each, newline="\n")] for each in (source.text, text))
    for line in unified_diff(before, after, source.name, source.name):
        yield line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n"
