"""Diagnostics as SARIF 2.1.0 (OASIS), which code hosts and editors take in."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import PurePath
from typing import Any
from urllib.parse import quote

from ltlc.base import codes
from ltlc.base.diagnostics import Diagnostic, Fix, Label
from ltlc.base.provenance import provenance
from ltlc.base.source import Source, Span

SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
"""What the schema calls itself."""


RequirementOf = Callable[[Diagnostic], Mapping[str, Any]]
"""The requirement of the property that a diagnostic is about, as an object of JSON; empty if there is none."""


def document(
    diagnostics: Sequence[Diagnostic],
    sources: Iterable[Source] = (),
    requirement_of: RequirementOf = lambda diagnostic: {},
) -> dict[str, Any]:
    """A log of one run of ltlc on `sources`, with all `diagnostics`."""
    used = sorted({diagnostic.code for diagnostic in diagnostics})
    made_of = provenance(sources)
    driver = {"name": "ltlc", "version": made_of["ltlc"], "rules": [_rule(code) for code in used]}
    if made_of["commit"]:
        driver["properties"] = {"commit": made_of["commit"]}
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "artifacts": [
            {"location": {"uri": _uri(each["name"])}, "hashes": {"sha-256": each["sha256"]}}
            for each in made_of["specifications"]
        ],
        "results": [_result(each, used.index(each.code), requirement_of(each)) for each in diagnostics],
    }
    return {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}


def _rule(code: str) -> dict[str, Any]:
    known = codes.CODES[code]
    page = codes.page(code)
    return {
        "id": code,
        "name": "".join(part.capitalize() for part in known.name.split("-")),
        "shortDescription": {"text": known.title},
        "help": {"text": page, "markdown": page},
        "defaultConfiguration": {"level": known.severity.value},
    }


def _result(diagnostic: Diagnostic, rule: int, requirement: Mapping[str, Any]) -> dict[str, Any]:
    message = diagnostic.message + (f"\n{diagnostic.help}" if diagnostic.help else "")
    result: dict[str, Any] = {
        "ruleId": diagnostic.code,
        "ruleIndex": rule,
        "level": diagnostic.severity.value,
        "message": {"text": message},
        "locations": [_location(diagnostic.source, diagnostic.primary)],
    }
    if diagnostic.secondary:
        result["relatedLocations"] = list(_related(diagnostic))
    if diagnostic.fixes:
        result["fixes"] = [_fix(diagnostic.source, fix) for fix in diagnostic.fixes]
    if requirement:
        result["properties"] = {"requirement": requirement}
    return result


def _fix(source: Source, fix: Fix) -> dict[str, Any]:
    replacements = [
        {"deletedRegion": _region(source, span), "insertedContent": {"text": text}} for span, text in fix.edits
    ]
    change = {"artifactLocation": {"uri": _uri(source.name)}, "replacements": replacements}
    return {"description": {"text": fix.title}, "artifactChanges": [change]}


def _related(diagnostic: Diagnostic) -> Iterable[dict[str, Any]]:
    for number, label in enumerate(diagnostic.secondary):
        text = {"message": {"text": label.text}} if label.text else {}
        yield {"id": number, **_location(diagnostic.source, label), **text}


def _location(source: Source, label: Label | None) -> dict[str, Any]:
    physical: dict[str, Any] = {"artifactLocation": {"uri": _uri(source.name)}}
    if label is not None:
        physical["region"] = _region(source, label.span)
    return {"physicalLocation": physical}


def _region(source: Source, span: Span) -> dict[str, int]:
    start, end = source.position(span.start), source.position(span.end)
    return {
        "startLine": start.line,
        "startColumn": start.column,
        "endLine": end.line,
        "endColumn": end.column,
    }


def _uri(name: str) -> str:
    """The name of a file as a URI reference."""
    path = PurePath(name)
    return path.as_uri() if path.is_absolute() else quote(path.as_posix())
