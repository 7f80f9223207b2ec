"""The matrix as a table in text, and as a JSON document."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from ltlc.base.provenance import provenance
from ltlc.base.render.table import aligned
from ltlc.monitoring.campaigns.tally import Result
from ltlc.monitoring.matrix.matrix import Covered, Judged, Matrix, State, Traced
from ltlc.runtime.reports import counted, printable


def text(matrix: Matrix) -> str:
    """A line for each requirement and property that verifies it, then what is not covered, and a line for all."""
    lines = []
    if matrix.requirements:
        head = ["requirement", "verified by", "at", "state", "results", "triggered"]
        shown = len(head) if matrix.has_results else 3
        rows = [row[:shown] for row in (head, *_rows(matrix))]
        lines = [*aligned(rows, right=range(5, 6)), ""]
    for title, told in gaps(matrix).items():
        lines += [f"{title}:", *(f"  {printable(each)}" for each in told), ""]
    return "".join(f"{line}\n" for line in [*lines, summary(matrix)])


def _rows(matrix: Matrix) -> Iterator[list[str]]:
    for covered in matrix.requirements:
        first, state = printable(covered.id), covered.state.value
        if not covered.properties:
            yield [first, "", "", state, "", ""]
        for each in covered.properties:
            triggered = "" if each.triggered is None else str(each.triggered)
            yield [first, printable(each.label), printable(each.place), state, results_text(each), triggered]
            first = state = ""


def results_text(of: Traced) -> str:
    """`1 violated, 2 presumably satisfied`: of how many recordings the property came out how."""
    results = [each.result for each in of.fresh]
    told = [f"{results.count(kind)} {kind.value}" for kind in Result if kind in results]
    if stale := len(of.judged) - len(results):
        told.append(f"{stale} stale")
    return ", ".join(told) or "not run"


def gaps(matrix: Matrix) -> dict[str, list[str]]:
    """What is not covered, under titles, in sentences; without results these are omitted."""
    told = {
        "Requirements without a property": [_named(each) for each in matrix.uncovered],
        "Requirements that the list does not have": [_named(each) for each in matrix.unlisted],
        "Properties without a requirement": [f"{each.label} ({each.place})" for each in matrix.untraced],
    }
    if matrix.has_results:
        idle = [each for each in matrix.properties if each.state is State.IDLE]
        told |= {
            "Not run": [f"{each.label} ({each.place})" for each in matrix.not_run],
            "Never triggered": [f"{each.label} ({each.place})" for each in idle],
            "Stale: the specification has changed since": [
                f"{name}: {counted(number, 'recording')}" for name, number in matrix.stale.items()
            ],
            "Of a specification that was not given": [
                f"{name}: {counted(number, 'recording')}" for name, number in matrix.foreign.items()
            ],
            "Not judged": [f"{name}: {message}" for name, message in matrix.unread],
        }
    return {title: lines for title, lines in told.items() if lines}


def _named(of: Covered) -> str:
    return f"{of.id}: {of.text}" if of.text else of.id


def summary(matrix: Matrix) -> str:
    """How many requirements and properties stand how."""
    states = [each.state for each in matrix.requirements]
    shown = list(State) if matrix.has_results else [State.NO_PROPERTY]
    words = {State.HOLDS: "that hold", State.NO_PROPERTY: "without a property"}
    parts = [f"{states.count(state)} {words.get(state, state.value)}" for state in shown if state in states]
    told = f": {', '.join(parts)}" if parts else ""
    properties = counted(len(matrix.properties), "property", "properties")
    return f"{counted(len(states), 'requirement')}{told}; {properties}"


def document(matrix: Matrix) -> dict[str, Any]:
    """The JSON document of `ltlc matrix`."""
    numbers = {id(each): number for number, each in enumerate(matrix.properties)}
    return {
        "requirements": [
            {
                "id": each.id,
                "text": each.text,
                "is_listed": each.is_listed,
                "state": each.state.name.lower(),
                "properties": [numbers[id(of)] for of in each.properties],
            }
            for each in matrix.requirements
        ],
        "properties": [_property(each) for each in matrix.properties],
        "not_covered": {
            "requirements_without_property": [each.id for each in matrix.uncovered],
            "requirements_not_listed": [each.id for each in matrix.unlisted],
            "properties_without_requirement": [numbers[id(each)] for each in matrix.untraced],
            "never_run": [numbers[id(each)] for each in matrix.not_run],
            "not_judged": [{"recording": name, "message": message} for name, message in matrix.unread],
        },
        "stale": matrix.stale,
        "of_other_specifications": matrix.foreign,
        "provenance": provenance(matrix.sources, ()),
    }


def _property(of: Traced) -> dict[str, Any]:
    return {
        "label": of.label,
        "file": of.source.name,
        "line": of.line,
        "text": of.text,
        "requirement": of.requirement.document() if of.requirement else None,
        "state": of.state.name.lower(),
        "triggered": of.triggered,
        "results": [_result(each) for each in of.judged],
    }


def _result(of: Judged) -> Mapping[str, Any]:
    return {
        "recording": of.recording,
        "files": of.files,
        "result": of.result.name.lower(),
        "triggered": of.triggered,
        "offset": of.offset,
        "is_stale": of.is_stale,
        "error": of.error,
    }


def json_text(matrix: Matrix) -> str:
    """The JSON document, as text."""
    return json.dumps(document(matrix), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
