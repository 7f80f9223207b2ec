"""What the commands have in common: reading a specification, reporting diagnostics, exit codes."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ltlc.automata import Budget, SpotMissing
from ltlc.commands.progress import progress
from ltlc.compiler import Compiled, compile_specification
from ltlc.diagnostics import Diagnostic, Severity
from ltlc.language import in_order, load, load_text
from ltlc.render import full
from ltlc.semantics.encodings import ENCODINGS
from ltlc.source import Source
from ltlc.specification.specification import Specification

if TYPE_CHECKING:
    from ltlc.analysis.subjects import Subject

OK, FINDING, UNUSABLE, UNDECIDED = 0, 1, 2, 3
"""Exit codes: all well; a finding; unusable input or usage; nothing violated, but something owed, never started or not
decided."""

ABOUT_FILES = "LTL9"
"""How the codes begin that say that a file cannot be read, or is no specification at all."""


@dataclass(frozen=True, slots=True)
class Examined:
    """A specification, None if it has errors of form, with all that is to be said about it."""

    specification: Specification | None
    diagnostics: list[Diagnostic]
    subjects: Sequence[Subject] = ()


def report(diagnostics: Sequence[Diagnostic]) -> None:
    """Show `diagnostics` on stderr, in colour where a person reads it."""
    colour = sys.stderr.isatty() and not os.environ.get("NO_COLOR")
    sys.stderr.write(full.render(diagnostics, colour))


def without_notes(diagnostics: Sequence[Diagnostic]) -> list[Diagnostic]:
    """The errors and warnings among `diagnostics`."""
    return [each for each in diagnostics if each.severity is not Severity.NOTE]


def failure(diagnostics: Sequence[Diagnostic]) -> int:
    """The exit code for a file with these errors."""
    return UNUSABLE if any(d.code.startswith(ABOUT_FILES) for d in diagnostics) else FINDING


def has_errors(diagnostics: Sequence[Diagnostic]) -> bool:
    """Whether one of `diagnostics` is an error."""
    return any(d.severity is Severity.ERROR for d in diagnostics)


def examine(
    read: Source | Diagnostic, options: argparse.Namespace, budget: Budget, *, pedantic: bool = False
) -> Examined:
    """Load what was `read` of a specification, and analyse it. Raises SpotMissing."""
    from ltlc.analysis.analyse import analyse
    from ltlc.analysis.suppression import suppress

    if isinstance(read, Diagnostic):
        return Examined(None, [read])
    specification, diagnostics = load_text(read, options.msg_path, ENCODINGS[options.encoding])
    if specification is None:
        return Examined(None, diagnostics)
    with progress("checking", options.quiet) as watch:
        found = analyse(specification, ENCODINGS[options.encoding], budget, watch, pedantic=pedantic)
    diagnostics = in_order(suppress(specification, [*diagnostics, *found.diagnostics], pedantic=pedantic))
    return Examined(specification, diagnostics, found.study.subjects)


def compile_file(options: argparse.Namespace) -> tuple[Specification, list[Compiled]] | int:
    """The specification that a command was given, with its monitors, or the exit code if there is none.

    Errors and warnings of the front end are reported, if the file does not suppress them; the analyses are not asked.
    """
    from ltlc.analysis.suppression import suppress

    specification, diagnostics = load(options.specification, options.msg_path, ENCODINGS[options.encoding])
    if specification is None:
        report(diagnostics)
        return failure(diagnostics)
    report(without_notes(suppress(specification, diagnostics)))
    return compile_loaded(specification, options)


def compile_loaded(
    specification: Specification, options: argparse.Namespace
) -> tuple[Specification, list[Compiled]] | int:
    """`specification` with its monitors, or the exit code if there is one that cannot be made."""
    try:
        with progress("making monitors", options.quiet) as watch:
            compiled, problems = compile_specification(
                specification, ENCODINGS[options.encoding], Budget(*options.budget), watch
            )
    except SpotMissing as error:
        return unusable(str(error))
    report(problems)
    return FINDING if problems else (specification, compiled)


def unwritable(path: Path, error: OSError) -> int:
    """Say why a file cannot be written; the exit code for that."""
    return unusable(f"{path} cannot be written: {error.strerror or error}")


def unusable(reason: str) -> int:
    """Say why the input cannot be used; the exit code for that."""
    print(f"ltlc: {reason}", file=sys.stderr)
    return UNUSABLE
