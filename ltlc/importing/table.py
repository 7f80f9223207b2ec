"""Tables of requirements, CSV: a line for each, with columns for its id, its text and its formula.

A formula is HPL, or has the operators of temporal logic, as letters or as words; else it is a property or a phrase of
this language, as `ltlc check` answers it.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping
from dataclasses import replace

from ltlc.base.source import Source, Span
from ltlc.frontend.syntax import tree
from ltlc.frontend.syntax.parse import parse as parsed
from ltlc.frontend.syntax.phrases import meant
from ltlc.importing import hpl, smv, stl
from ltlc.importing.infix import parse
from ltlc.importing.names import Kind, Signals
from ltlc.importing.operators import Measure
from ltlc.importing.requirement import Requirement, UnusableFileError
from ltlc.importing.values import FormulaError

NAME = "table"

FORM = replace(smv.FORM, words={**stl.WORDS, **smv.FORM.words})

COLUMNS: Mapping[str, tuple[str, ...]] = {
    "id": ("id", "reqid", "req_id", "requirement id", "key", "name", "label"),
    "text": ("text", "description", "requirement", "title", "english", "summary"),
    "formula": ("formula", "ltl", "mtl", "stl", "hpl", "property", "specification", "spec", "fretish", "ltlc"),
    "rationale": ("rationale", "reason"),
}
"""What the columns are called, in any case."""


def read(source: Source, signals: Signals, measure: Measure) -> list[Requirement]:
    """The requirements of a table; those without a formula are not imported. Raises UnusableFileError."""
    head = source.text.partition("\n")[0]
    delimiter = max(",;\t", key=head.count)
    try:
        rows = list(csv.reader(io.StringIO(source.text), delimiter=delimiter, strict=True))
    except csv.Error as error:
        raise UnusableFileError(f"not a table: {error}") from None
    heads = [cell.strip().lower() for cell in rows[0]] if rows else []
    places = {role: heads.index(name) for role, names in COLUMNS.items() for name in reversed(names) if name in heads}
    if "formula" not in places:
        raise UnusableFileError("no column is called `formula`")
    found, offset = [], 0
    for number, row in enumerate(rows[1:], 1):
        is_long = len(row) > len(heads) and any(row[len(heads) :])
        cells = {role: row[column].strip() if column < len(row) else "" for role, column in places.items()}
        if any(row):
            first = source.text.find(cells["formula"].partition("\n")[0] or row[0], offset)
            place = Span(first, first + len(cells["formula"])) if first >= 0 else None
            offset = max(offset, first)
            requirement = _requirement(number, cells, place, signals, measure)
            problem = "the line has more cells than the first one: put the formula in double quotes"
            found.append(replace(requirement, problem=problem, forms=(), said=()) if is_long else requirement)
    return found


def _requirement(
    number: int, cells: Mapping[str, str], place: Span | None, signals: Signals, measure: Measure
) -> Requirement:
    text = " ".join(cells["formula"].split())
    rationale = cells.get("rationale", "")
    found = Requirement(cells.get("id") or f"{number}", cells.get("text", ""), text, place, rationale=rationale)
    if not text:
        return replace(found, problem="it has no formula")
    if re.match(r"(globally|after\s+[(/~\w].*|until\s+[(/~\w].*):", text):
        (of_hpl,) = hpl.read(Source("", text), signals, measure)
        names = ("meaning", "forms", "said", "problem", "notes", "has_readings")
        kept = {name: getattr(of_hpl, name) for name in names}
        return replace(found, **kept)
    try:
        meaning = parse(text, FORM, signals, measure)
    except FormulaError as error:
        return _own(found, text, signals) or replace(found, problem=str(error))
    return replace(found, meaning=meaning, forms=(meaning,))


def _own(requirement: Requirement, text: str, signals: Signals) -> Requirement | None:
    """A property of this language, or a phrase that it is answered with; None if it is neither."""
    notes: tuple[str, ...] = ()
    if not _is_property(text):
        phrase = meant(text, "", _is_property)
        if phrase is None:
            return None
        text, notes = phrase
    (command,) = parsed(Source("", text))[0].commands
    assert isinstance(command, tree.PropertyCommand)
    for node, _ in tree.walk(command.property):
        compares = isinstance(node, tree.Comparison | tree.Arithmetic)
        kind = Kind.STRING if any(isinstance(c, tree.StringLiteral) for c in tree.children(node)) else Kind.NUMBER
        for child in tree.children(node):
            if isinstance(child, tree.Reference) and not child.steps:
                signals.keep(child.name.text)
                signals.use(child.name.text, kind if compares else Kind.BOOLEAN)
    if isinstance(command.property, tree.Reference):
        signals.keep(command.property.name.text)
        signals.use(command.property.name.text, Kind.BOOLEAN)
    return replace(requirement, said=(text,), notes=notes)


def _is_property(text: str) -> bool:
    """Whether `text` is one property."""
    found, problems = parsed(Source("", text))
    return not problems and len(found.commands) == 1 and isinstance(found.commands[0], tree.PropertyCommand)
