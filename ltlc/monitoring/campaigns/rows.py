"""Outcomes as rows of a table, one for each recording and property, and back again: nothing is lost on the way."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from ltlc.monitoring.campaigns.outcomes import Outcome, PropertyOutcome
from ltlc.monitoring.campaigns.places import Location

Row = dict[str, Any]

COLUMNS = {
    "recording": "string",
    "size": "int64",
    "version": "string",
    "property": "string",
    "file": "string",
    "line": "int64",
    "text": "string",
    "verdict": "string",
    "time_ns": "int64",
    "step": "int64",
    "by_time": "bool",
    "failing_state": "string",
    "because": "string",
    "open_since_ns": "int64",
    "episodes": "int64",
    "never_triggered": "bool",
    "robustness": "double",
    "steps": "int64",
    "invalid_steps": "int64",
    "is_damaged": "bool",
    "error_code": "string",
    "error": "string",
    "seconds": "double",
    "tries": "int64",
    "sentence": "string",
    "figure": "string",
    "report": "string",
    "recording_report": "string",
    "remarks": "string",
    "judged_with": "string",
    "ltlc": "string",
}
"""The columns and their types, as pyarrow calls them."""

_COPIED = ("file", "line", "text", "verdict", "episodes", "never_triggered", "steps", "invalid_steps")
"""Columns that are fields of a property's object in the JSON document."""


def rows_of(outcome: Outcome) -> list[Row]:
    """An outcome as rows, one for each property; of a recording without verdicts one, in which `property` is null."""
    error = outcome.error or {}
    common = {
        "recording": outcome.place.name,
        "size": outcome.place.size,
        "version": outcome.place.version,
        "is_damaged": outcome.report["is_damaged"],
        "error_code": error.get("code"),
        "error": error.get("message"),
        "seconds": outcome.seconds,
        "tries": outcome.tries,
        "recording_report": json.dumps(outcome.report),
        "remarks": json.dumps(outcome.remarks),
    }
    return [common | _row(each) for each in outcome.properties] or [common]


def _row(found: PropertyOutcome) -> Row:
    report = found.report
    row: Row = {"property": found.label, "sentence": found.sentence, "figure": found.figure}
    row |= {name: report[name] for name in _COPIED}
    row["robustness"] = (report.get("robustness") or {}).get("margin")
    row["report"] = json.dumps(report)
    decided = report["decided_at"]
    if decided is not None:
        row |= {name: decided[name] for name in ("time_ns", "step", "by_time")}
        row["failing_state"] = json.dumps(decided["values"])
        row["because"] = json.dumps(decided["because"])
    since = report["open_since"] or (decided or {}).get("open_since")
    row["open_since_ns"] = None if since is None else since["time_ns"]
    return row


def outcome_of(rows: Sequence[Mapping[str, Any]]) -> Outcome:
    """The outcome whose rows these are."""
    first = rows[0]
    properties = tuple(
        PropertyOutcome(json.loads(row["report"]), row["sentence"], row["figure"])
        for row in rows
        if row.get("property") is not None
    )
    return Outcome(
        place=Location(first["recording"], first["size"], first["version"]),
        report=json.loads(first["recording_report"]),
        properties=properties,
        remarks=tuple(json.loads(first["remarks"])),
        seconds=first["seconds"],
        tries=first["tries"],
    )
