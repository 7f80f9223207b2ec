"""Reads formulas in Spot's syntax, from the command line or from a file, one or several on a line."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ltlc.analysis.comparison.questions import question_of_formulas, unused_name
from ltlc.analysis.comparison.results import Question
from ltlc.automata.spot_syntax import SpotSyntaxError, parse
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.semantics.ltl import Formula

NONE = "-"
"""A table's entry for no formula."""


@dataclass(frozen=True, slots=True)
class _Cell:
    """A part of a line between tabs, without the white space around it."""

    text: str
    span: Span


def questions_of_arguments(texts: Sequence[str]) -> tuple[list[Question], list[Diagnostic]]:
    """The question how the formulas `texts` relate, and their errors."""
    reader = _Reader()
    formulas: dict[str, Formula] = {}
    for text in texts:
        formula = reader.formula(Source("--ltl", text), _Cell(text, Span(0, len(text))))
        if formula is not None:
            formulas[unused_name(text.strip(), formulas)] = formula
    questions = [] if reader.problems else [question_of_formulas("formulas", None, formulas)]
    return questions, reader.problems


def questions_of_file(source: Source) -> tuple[list[Question], list[Diagnostic]]:
    """The questions in a file of formulas, and its errors.

    A line is a formula or, with a tab, a name and a formula; all of them are compared with one another. With more
    tabs, a line is a name and several formulas, which are compared with one another; `-` is none, and a first line
    without any formula heads the columns. A line that starts with `#` is a comment.
    """
    rows = list(_rows(source))
    if any(len(row) > 2 for row in rows):
        return _questions_of_table(source, rows)
    named, problems = formulas_of_file(source)
    formulas: dict[str, Formula] = {}
    for name, formula in named:
        formulas[unused_name(name, formulas)] = formula
    return ([] if problems else [question_of_formulas(source.name, None, formulas)]), problems


def formulas_of_file(source: Source) -> tuple[list[tuple[str, Formula]], list[Diagnostic]]:
    """Every formula in a file, with its name, or itself for a name, and its errors."""
    reader = _Reader()
    named = []
    for row in _rows(source):
        for column, cell in enumerate(row[min(1, len(row) - 1) :], 1):
            formula = reader.formula(source, cell)
            if formula is not None:
                name = row[0].text if len(row) <= 2 else f"{row[0].text} {column}"
                named.append((name, formula))
    if not named and not reader.problems:
        reader.problems.append(diagnostic("LTL904", source, Span(0, 0), "the file contains no formula"))
    return named, reader.problems


def _questions_of_table(source: Source, rows: list[list[_Cell]]) -> tuple[list[Question], list[Diagnostic]]:
    """A question for each line."""
    reader = _Reader()
    headings: list[str] = []
    if not any(_is_formula(cell.text) for cell in rows[0][1:]):
        headings = [cell.text for cell in rows.pop(0)[1:]]
    questions = []
    for row in rows:
        formulas: dict[str, Formula] = {}
        for column, cell in enumerate(row[1:]):
            formula = reader.formula(source, cell)
            if formula is not None:
                heading = headings[column] if column < len(headings) else f"formula {column + 1}"
                formulas[unused_name(heading, formulas)] = formula
        line = source.position(row[0].span.start).line
        if formulas:
            questions.append(question_of_formulas(row[0].text or f"line {line}", line, formulas))
    return ([] if reader.problems else questions), reader.problems


class _Reader:
    """Reads formulas and collects their errors."""

    def __init__(self) -> None:
        self.problems: list[Diagnostic] = []

    def formula(self, source: Source, cell: _Cell) -> Formula | None:
        """The formula in `cell`; None if it is empty or cannot be read."""
        if cell.text == NONE:
            return None
        try:
            return parse(cell.text)
        except SpotSyntaxError as error:
            start = min(cell.span.start + error.offset, cell.span.end)
            place = Span(start, min(start + 1, cell.span.end))
            message = f"not a formula in Spot's syntax: {error}"
            self.problems.append(diagnostic("LTL321", source, place, message))
            return None


def _is_formula(text: str) -> bool:
    try:
        parse(text)
    except SpotSyntaxError:
        return False
    return True


def _rows(source: Source) -> Iterator[list[_Cell]]:
    """The lines that are neither empty nor comments, as their cells."""
    offset = 0
    for line in source.text.splitlines(keepends=True):
        if line.strip() and not line.startswith("#"):
            yield list(_cells(line, offset))
        offset += len(line)


def _cells(line: str, offset: int) -> Iterator[_Cell]:
    for part in line.rstrip("\r\n").split("\t"):
        text = part.strip()
        start = offset + part.index(text)
        yield _Cell(text, Span(start, start + len(text)))
        offset += len(part) + 1
