"""`ltlc matrix`: which requirement is verified by which property, with which verdicts, and what is not covered."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from ltlc.base.diagnostics import Diagnostic
from ltlc.frontend.language import load, read_source
from ltlc.frontend.language.suppression import unsuppressed
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import UNUSABLE, failure, report, unusable
from ltlc.interfaces.commands.sources import found_in
from ltlc.semantics.encodings import ENCODINGS

if TYPE_CHECKING:
    from ltlc.monitoring.matrix.matrix import Matrix
    from ltlc.specification.specification import Specification

FORMS = ("text", "json", "html", "reqif", "needs")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc matrix` takes."""
    arguments.add_specifications(parser, "specification files, or folders of *.ltlc files; `-` for stdin")
    arguments.add_reading(parser)
    parser.add_argument(
        "--results",
        action="append",
        type=Path,
        default=[],
        metavar="FILE.parquet",
        help="what `ltlc run --results` has kept; may be repeated",
    )
    parser.add_argument(
        "--requirements",
        type=Path,
        metavar="FILE",
        help="the requirements that must be covered: on each line an id and, if you like, a text; `#` is a comment",
    )
    parser.add_argument("--format", choices=FORMS, default="text")


def run(options: argparse.Namespace) -> int:
    """Print the matrix; 1 if a requirement is violated or not covered, 3 if one does not hold yet, otherwise 0."""
    from ltlc.monitoring.campaigns.results import ResultsError, is_unfinished, outcomes_at
    from ltlc.monitoring.matrix.matrix import add_results, matrix_of

    paths, problems = found_in(options.specifications)
    report(problems)
    loaded = [_loaded(path, options) for path in paths]
    codes = [each for each in loaded if isinstance(each, int)]
    if problems or codes:
        return max([failure(problems), *codes])
    try:
        listed = _listed(options.requirements) if options.requirements else None
    except _ListError as error:
        return unusable(str(error))
    matrix = matrix_of([each for each in loaded if not isinstance(each, int)], listed)
    try:
        for path in options.results:
            add_results(matrix, outcomes_at(path))
            if is_unfinished(path):
                print(f"ltlc: the campaign of {path} has not finished: its latest results are missing", file=sys.stderr)
    except ResultsError as error:
        report([error.diagnostic])
        return UNUSABLE
    sys.stdout.write(_written(matrix, options.format))
    return matrix.exit_code


def _loaded(path: Path, options: argparse.Namespace) -> Specification | int:
    """The specification at `path`, or the exit code if it has errors, which are reported."""
    specification, diagnostics = load(path, options.msg_path, ENCODINGS[options.encoding])
    if specification is None:
        report(unsuppressed(diagnostics))
        return failure(diagnostics)
    return specification


class _ListError(Exception):
    """The list of requirements cannot be used; the text says why."""


def _listed(path: Path) -> dict[str, str]:
    """The ids in the file at `path`, with their texts, which may be empty. Raises _ListError."""
    source = read_source(path)
    if isinstance(source, Diagnostic):
        raise _ListError(source.message)
    found: dict[str, str] = {}
    for number, line in enumerate(source.text.splitlines(), 1):
        id, _, text = line.strip().replace("\t", " ").partition(" ")
        if id and not id.startswith("#"):
            if id in found:
                raise _ListError(f"{path}:{number}: `{id}` is listed twice")
            found[id] = text.strip()
    return found


def _written(matrix: Matrix, form: str) -> str:
    """The matrix in one of the FORMS."""
    match form:
        case "html":
            from ltlc.monitoring.matrix.page import page

            return page(matrix)
        case "reqif":
            from ltlc.monitoring.matrix.reqif import reqif

            return reqif(matrix)
        case "needs":
            from ltlc.monitoring.matrix.needs import needs_json

            return needs_json(matrix)
        case _:
            from ltlc.monitoring.matrix import forms

            return forms.json_text(matrix) if form == "json" else forms.text(matrix)
