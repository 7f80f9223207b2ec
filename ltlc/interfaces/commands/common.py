"""What the commands have in common: reading a specification, reporting diagnostics, exit codes."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ltlc.automata import Budget, SpotMissing
from ltlc.base.diagnostics import Diagnostic, Severity
from ltlc.base.render import full
from ltlc.base.source import Source
from ltlc.frontend.language import read_source
from ltlc.interfaces.commands.progress import progress
from ltlc.semantics.encodings import ENCODINGS

if TYPE_CHECKING:
    from ltlc.analysis.examine import Examined
    from ltlc.interfaces.api.prepare import Prepared

OK, FINDING, UNUSABLE, UNDECIDED = 0, 1, 2, 3
"""Exit codes: all well; a finding; unusable input or usage; nothing violated, but something still open, not started or
not decided."""

RULES = "@"
"""What is named so is no file, but a rule pack: `@px4`."""

ABOUT_FILES = "LTL9"
"""What codes begin with for files that cannot be read, or are not specifications."""


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


def examine(
    read: Source | Diagnostic,
    options: argparse.Namespace,
    budget: Budget,
    *,
    pedantic: bool = False,
    controls: Sequence[str] = (),
    recordings: Sequence[Path] = (),
) -> Examined:
    """Load what was `read` of a specification, which is about `recordings`, and analyse it. Raises SpotMissing."""
    from ltlc.analysis import examine

    encoding = ENCODINGS[options.encoding]
    with progress("checking", options.quiet) as watch:
        return examine.examine(
            read,
            options.msg_path,
            encoding,
            budget,
            watch,
            pedantic=pedantic,
            controls=controls,
            recordings=recordings,
        )


def compile_file(
    options: argparse.Namespace,
    recordings: Sequence[Path] = (),
    analyses: Budget | None = None,
    erroneous: int = UNUSABLE,
) -> Prepared | int:
    """The specification that a command was given, with its monitors, or the exit code: `erroneous` if it has an error.

    The messages that `recordings` define are known.

    Errors and warnings of the front end, and of the analyses if they have a budget, are reported, if the file does not
    suppress them.
    """
    from ltlc.base.errors import UnusableInput
    from ltlc.interfaces.api.prepare import prepare

    encoding, budget = ENCODINGS[options.encoding], Budget(*options.budget)
    try:
        with progress("making monitors" if analyses is None else "checking", options.quiet) as watch:
            source = read_specification(options.specification, options.msg_path, recordings)
            prepared = prepare(source, options.msg_path, encoding, budget, watch, recordings, analyses)
    except UnusableInput as error:
        report(without_notes(error.diagnostics))
        return max(erroneous, failure(error.diagnostics))
    except SpotMissing as error:
        return unusable(str(error))
    report(without_notes(prepared.diagnostics))
    return prepared


def read_specification(
    path: Path, message_paths: Sequence[str], recordings: Sequence[Path] = ()
) -> Source | Diagnostic:
    """The text of the file at `path`, or of the rules called so that are about `recordings`, or why there is none."""
    if not str(path).startswith(RULES):
        read = read_source(path)
        return _or_pack(path, read) if isinstance(read, Diagnostic) else read
    from ltlc.rules.about import specification

    source, notes = specification(str(path), message_paths, recordings)
    report(notes)
    return source


def _or_pack(path: Path, error: Diagnostic) -> Diagnostic:
    """Why the file at `path` cannot be read; if a rule pack has its name, with a hint."""
    from ltlc.rules import packs

    is_pack = not error.help and path.parts[:1] and path.parts[0] in packs()
    return replace(error, help=f"write `{RULES}{path}` for the rule pack") if is_pack else error


def overwritten(outputs: Sequence[Path | None], inputs: Sequence[str | Path]) -> Path | None:
    """The first of `outputs` that is one of `inputs`, lies in a folder that is one, or is another output, too."""
    read = [os.path.realpath(each) for each in inputs]
    written: list[str] = []
    for path in filter(None, outputs):
        name = os.path.realpath(path)
        if name in written or any(name == each or name.startswith(f"{each}{os.sep}") for each in read):
            return path
        written.append(name)
    return None


def refused(path: Path) -> int:
    """Report that `path` must not be overwritten; the exit code."""
    return unusable(f"{path} is not written: that file is an input, or another output; give another name")


def unwritable(path: Path | str, error: OSError) -> int:
    """Say why a file cannot be written; the exit code for that."""
    return unusable(f"{path} cannot be written: {error.strerror or error}")


def unusable(reason: str) -> int:
    """Say why the input cannot be used; the exit code for that."""
    print(f"ltlc: {reason}", file=sys.stderr)
    return UNUSABLE
