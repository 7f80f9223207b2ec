"""What the commands have in common: reading a specification, reporting diagnostics, exit codes."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

from ltlc.automata import Budget, SpotMissing
from ltlc.compiler import Compiled, compile_specification
from ltlc.diagnostics import Diagnostic, Severity
from ltlc.language import load
from ltlc.language.specification import Specification
from ltlc.render import full
from ltlc.semantics.encodings import ENCODINGS

OK, FINDING, UNUSABLE, UNDECIDED = 0, 1, 2, 3
"""Exit codes: all well; a finding; unusable input or usage; nothing violated, but not everything decided."""

UNREADABLE = ("LTL901", "LTL902", "LTL903", "LTL904", "LTL905", "LTL906")
"""The codes of a file that is no specification at all."""


def report(diagnostics: Sequence[Diagnostic]) -> None:
    """Show `diagnostics` on stderr, in colour where a person reads it."""
    if diagnostics:
        colour = sys.stderr.isatty() and not os.environ.get("NO_COLOR")
        print(full.render(diagnostics, colour), file=sys.stderr)


def failure(diagnostics: Sequence[Diagnostic]) -> int:
    """The exit code for a file with these errors."""
    return UNUSABLE if any(d.code in UNREADABLE for d in diagnostics) else FINDING


def has_errors(diagnostics: Sequence[Diagnostic]) -> bool:
    """Whether one of `diagnostics` is an error."""
    return any(d.severity is Severity.ERROR for d in diagnostics)


def compile_file(options: argparse.Namespace) -> tuple[Specification, list[Compiled]] | int:
    """The specification that a command was given, with its monitors, or the exit code if there is none.

    Everything that is to be said about the file is reported.
    """
    specification, diagnostics = load(options.specification, options.msg_path)
    report(diagnostics)
    if specification is None:
        return failure(diagnostics)
    try:
        compiled, problems = compile_specification(specification, ENCODINGS[options.encoding], Budget(*options.budget))
    except SpotMissing as error:
        return unusable(str(error))
    report(problems)
    return FINDING if problems else (specification, compiled)


def unusable(reason: str) -> int:
    """Say why the input cannot be used; the exit code for that."""
    print(f"ltlc: {reason}", file=sys.stderr)
    return UNUSABLE
