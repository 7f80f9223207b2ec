"""Fixing specifications where a fix is unambiguous: `ltlc check --fix` and `--diff`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ltlc.base.diagnostics import Diagnostic
from ltlc.base.files import rewrite_text
from ltlc.base.fixes import apart, with_fixes
from ltlc.base.render.difference import difference
from ltlc.base.source import Source
from ltlc.frontend.language import STDIN, load_text, read_source
from ltlc.interfaces.commands.common import FINDING, OK, failure, report
from ltlc.semantics.encodings import ENCODINGS

ROUNDS = 100
"""How often a text is read again: what a fix makes readable may need another."""


class NotFixedError(Exception):
    """A file cannot be written; the message says which, and why."""


def fix_source(path: Path, source: Source, options: argparse.Namespace) -> tuple[Source, int]:
    """What of `source`, which was read from `path`, is left after all certain fixes, and how many there were.

    The file is written if there were any, the standard input goes to stdout in any case; what was done is said on
    stderr. Raises NotFixedError.
    """
    better, done = _fixed(source, options)
    if path == STDIN:
        sys.stdout.write(better.text)
    elif done:
        try:
            rewrite_text(path, better.text)
        except OSError as error:
            raise NotFixedError(f"{path} cannot be written: {error.strerror or error}") from None
    if not options.quiet:
        sys.stderr.writelines(f"ltlc: fixed {each}\n" for each in done)
    return better, len(done)


def show_difference(path: Path, options: argparse.Namespace) -> int:
    """Print what `fix_source` would change; 1 if that is something."""
    source = read_source(path)
    if isinstance(source, Diagnostic):
        report([source])
        return failure([source])
    better, done = _fixed(source, options)
    sys.stdout.write(difference(source.name, source.text, better.text))
    return FINDING if done else OK


def _fixed(source: Source, options: argparse.Namespace) -> tuple[Source, list[str]]:
    """`source` after all unambiguous fixes, and a description of each."""
    done: list[str] = []
    for _ in range(ROUNDS):
        _, found = load_text(source, options.msg_path, ENCODINGS[options.encoding], options.recording)
        fixes = apart(fix for each in found for fix in each.fixes if fix.is_certain)
        if not fixes:
            break
        for fix in fixes:
            place = source.position(fix.edits[0][0].start)
            done.append(f"{source.name}:{place.line}:{place.column}: {fix.title}")
        source = Source(source.name, with_fixes(source.text, fixes))
    return source, done
