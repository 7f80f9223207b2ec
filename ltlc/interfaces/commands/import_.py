"""`ltlc import`: a specification of another tool, written in the language and compared with its formulas."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

from ltlc.automata import Budget, SpotMissing
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.files import write_text
from ltlc.base.source import Source, Span
from ltlc.frontend.language import read_text
from ltlc.importing.conversion import Imported, convert
from ltlc.importing.document import document, other_reading, rate
from ltlc.importing.forms import FORMS, FileForm, form_of, measure_of
from ltlc.importing.names import Signals
from ltlc.importing.requirement import Requirement, UnusableFileError
from ltlc.importing.writing import Reading
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import FINDING, OK, UNDECIDED, UNUSABLE, report, unusable, unwritable
from ltlc.interfaces.commands.progress import progress

MOST_BYTES = 50_000_000
"""FRET writes 10,000 bytes for each requirement."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc import` takes."""
    parser.add_argument("file", metavar="FILE", type=Path, help="a specification of another tool; `-` for stdin")
    parser.add_argument(
        "--from", dest="form", choices=tuple(FORMS), help="the form of the file (default: what its name says)"
    )
    parser.add_argument(
        "--reading",
        choices=("points", "signals"),
        help="whether formulas are judged at points, or at all times, values holding in between "
        "(default: signals for stl, otherwise points)",
    )
    parser.add_argument(
        "--step", type=arguments.duration, default=10**9, metavar="DURATION", help="between points (default: 1 s)"
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="a file that does not exist yet (default: stdout)"
    )
    arguments.add_budget(parser, "limits for each comparison", 10.0)


def run(options: argparse.Namespace) -> int:
    """Write what can be imported; 1 if something cannot, or means something else, 3 if something is not compared."""
    if options.output is not None and options.output.exists():
        return unusable(f"{options.output} already exists and is not overwritten")
    key = options.form or form_of(str(options.file))
    if key is None:
        return unusable(f"the name of {options.file} does not say what it is: give `--from {'|'.join(FORMS)}`")
    form = FORMS[key]
    step = options.step if (options.reading or form.reading) == "points" else None
    if step is not None and not rate(step):
        return unusable("`--step` must be a time whose frequency is a decimal number, such as 20 ms or 2 s")
    source = read_text(options.file, MOST_BYTES)
    if isinstance(source, Diagnostic):
        report([source])
        return UNUSABLE
    signals, reading = Signals(), Reading(step)
    try:
        requirements = read(source, form, signals, reading)
    except UnusableFileError as error:
        place = Span(error.offset, error.offset)
        report([diagnostic("LTL330", source, place, f"{source.name} cannot be imported as {form.name}: {error}")])
        return UNUSABLE
    try:
        with progress("comparing", options.quiet) as watch:
            imported = convert(requirements, signals, reading, Budget(*options.budget), watch)
    except SpotMissing as error:
        return unusable(str(error))
    findings = [each for of in imported for each in _findings(source, of, step)]
    report(findings)
    text = document(imported, signals, reading, form.name, options.file.name)
    if (code := _write(text, options.output, options.quiet)) != OK:
        return code
    codes = {each.code for each in findings} - {"LTL334"}
    return FINDING if codes & {"LTL331", "LTL332"} else UNDECIDED if codes else OK


def read(source: Source, form: FileForm, signals: Signals, reading: Reading) -> Sequence[Requirement]:
    """The requirements of a file: read twice, as what a name stands for may be known only at its end.

    Raises UnusableFileError.
    """
    measure = measure_of(form, reading.step)
    form.read(source, signals, measure)
    found = form.read(source, signals, measure)
    if not found:
        raise UnusableFileError("there is nothing in it to import")
    return found


def _findings(source: Source, each: Imported, step: int | None) -> Iterator[Diagnostic]:
    """What is to be said about a requirement; its points are a `step` apart."""
    if (found := _finding(source, each)) is not None:
        yield found
    for other in other_reading(each, step):
        message = f"the readings of `{each.requirement.id}` differ: {other}"
        yield diagnostic("LTL334", source, each.requirement.place, message)


def _finding(source: Source, each: Imported) -> Diagnostic | None:
    """What is to be said about a requirement, unless it is shown equal."""
    name, place = each.requirement.id, each.requirement.place
    if not each.text:
        return diagnostic("LTL331", source, place, f"`{name}` is not imported: {each.problem}")
    if each.requirement.meaning is None or (each.shown is not None and each.shown.is_equal):
        return None
    if each.shown is None:
        return diagnostic("LTL333", source, place, f"`{name}` is imported, but not shown equal: {each.problem}")
    run = each.shown.formula_only or each.shown.property_only
    who = "the original" if each.shown.formula_only else "the property"
    return diagnostic("LTL332", source, place, f"`{name}` is imported, but not equal: only {who} accepts `{run}`")


def _write(text: str, path: Path | None, quiet: bool) -> int:
    if path is None:
        print(text, end="")
        return OK
    try:
        write_text(path, text)
    except OSError as error:
        return unwritable(path, error)
    if not quiet:
        print(f"wrote {path}")
    return OK
