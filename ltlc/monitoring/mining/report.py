"""What was found, as text and as JSON: values, and the recording and the moment that decide each."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from textwrap import indent
from typing import Any

from ltlc.base.provenance import provenance
from ltlc.frontend.language.parameters import Role
from ltlc.inputs.recordings.digests import digests
from ltlc.monitoring.judging.violations import spread
from ltlc.monitoring.mining.mine import Failure, Finding, Measured, Mined, Result
from ltlc.monitoring.mining.template import Trial
from ltlc.runtime import documents, reports
from ltlc.runtime.reports import printable
from ltlc.runtime.times import seconds


def text(mined: Mined, exact: bool = False) -> str:
    """A paragraph for each value: the property with it, what decides it, and what the other recordings say.

    Values are rounded outwards unless they are to be `exact`.
    """
    return "\n".join("".join(f"{line}\n" for line in _lines(mined, finding, exact)) for finding in mined.findings)


def _lines(mined: Mined, finding: Finding, exact: bool) -> Iterator[str]:
    sought, file = finding.sought, mined.template.source.name
    place = f"line {sought.line} of {file}"
    yield printable(place if sought.label == f"line {sought.line}" else f"{place} ({sought.label})") + ":"
    match finding.result:
        case Result.FOUND:
            shown = finding.shown(exact)
            yield f"  {printable(mined.template.property_text(shown))}"
            if shown != finding.trial:
                yield f"  rounded outwards; `--exact` gives {finding.trial.text}"
            yield from _decided(finding)
        case Result.NONE:
            assert finding.failure is not None
            yield f"  no value passes: in {_name(finding.failure.recording)}, even {_failed(finding.failure)}"
            yield from _shown(finding.failure)
        case Result.EVERY:
            never = ": never triggered in any recording" if finding.never_triggered else ""
            yield f"  every value passes, even {finding.trial.text}{never}"
        case Result.NOT_STARTED:
            yield "  not started in any recording"
    yield from _others(mined, finding, exact)


def _decided(finding: Finding) -> Iterator[str]:
    """What decides a value that was found; the smallest margin of all needs nothing that does."""
    if finding.failure is None:
        yield "  it passes in every recording, and no value is tighter"
        return
    yield f"  decided by {_name(finding.failure.recording)}: {_failed(finding.failure)}"
    yield from _shown(finding.failure)


def _failed(failure: Failure) -> str:
    """That the property fails with a value, and when."""
    track, session = failure.answer.failing, failure.answer.session
    verdict = track.verdict.value.replace("_", " ")
    when = f" at {reports.moment_text(track.decided_at, session.scale)}" if track.decided_at else ""
    owed = "" if track.decided_at else f"; {reports.explanation(session, track)[0]}"
    return f"with {failure.trial.text} it is {verdict}{when}{owed}"


def _shown(failure: Failure) -> Iterator[str]:
    """The state in which a property fails, as `ltlc run` shows it."""
    if failure.answer.failing.decided_at is not None:
        yield indent(reports.figure(failure.answer.session, failure.answer.failing), "    ").rstrip("\n")
        if found := spread(failure.answer.session, failure.answer.failing):
            yield f"    {found.text()}"


def _others(mined: Mined, finding: Finding, exact: bool) -> Iterator[str]:
    """What recordings say that do not decide."""
    if finding.result is Result.FOUND and len(finding.started) > 1:
        yield f"  passes in {len(finding.started)} recordings"
    closest = _closest(finding, exact)
    yield from _robustness(closest)
    for path, number in finding.alone.items():
        alone = None if number is None else Trial(finding.sought, number)
        shown = alone if alone is None or exact else alone.rounded
        common = f"; robustness with {finding.shown(exact).text}: {closest[path].sentence}" if path in closest else ""
        yield f"  {_name(path)} by itself: {'no value passes' if shown is None else shown.text}{common}"
    for path, remarks in finding.not_started.items():
        yield f"  not started in {_name(path)}: {'; '.join(remarks)}"
    if not_asked := _not_asked(mined, finding):
        yield f"  not examined, as no value would pass: {', '.join(map(_name, not_asked))}"


def _robustness(closest: Mapping[Path, Measured]) -> Iterator[str]:
    """The recording that passes by least, and why others have no margin."""
    if numbers := [each for each in closest.values() if each.report["margin"] is not None]:
        least = min(numbers, key=lambda each: each.least)
        yield f"  closest to failing: {_name(least.recording)}, robustness {least.sentence}"
    for reason, count in Counter(each.report["reason"] for each in closest.values()).items():
        where = "" if count == len(closest) else f" in {count} of {len(closest)} recordings"
        if reason is not None:
            yield f"  robustness: none{where}: {reason}"


def _closest(finding: Finding, exact: bool) -> dict[Path, Measured]:
    """What passes by least in each recording with the value that is shown, if it was asked for."""
    closest: dict[Path, Measured] = {}
    for each in finding.measured.get(finding.shown(exact), ()):
        closest[each.recording] = min(closest.get(each.recording, each), each, key=lambda of: of.least)
    return closest


def _not_asked(mined: Mined, finding: Finding) -> list[Path]:
    """The recordings after one with which no value passes."""
    asked = {*finding.started, *finding.not_started, *mined.unusable}
    return [path for path in mined.recordings if path not in asked]


def _name(path: Path) -> str:
    return printable(str(path))


def document(mined: Mined) -> str:
    """The JSON document of `ltlc mine`: exact values, and beside each that was found the rounded one."""
    files = (each for path in mined.recordings for each in digests(path))
    found = {
        "specification": mined.template.source.name,
        "recordings": [str(path) for path in mined.recordings],
        "unusable": [str(path) for path in mined.unusable],
        "looks": mined.looks,
        "properties": [_property(mined, finding) for finding in mined.findings],
        "diagnostics": [
            {"code": d.code, "name": d.name, "severity": d.severity.value, "message": d.message, "help": d.help}
            for d in mined.diagnostics
        ],
        "provenance": provenance([mined.template.source], files),
    }
    return json.dumps(found, indent=2, allow_nan=False) + "\n"


def _property(mined: Mined, finding: Finding) -> dict[str, Any]:
    sought = finding.sought
    is_found = finding.result is Result.FOUND
    return {
        "label": sought.label,
        "file": mined.template.source.name,
        "line": sought.line,
        "role": sought.parameter.role.value,
        "result": finding.result.name.lower(),
        **_value(finding.trial if is_found else None),
        "text": mined.template.property_text(finding.trial) if is_found else None,
        **_measured(finding, finding.trial),
        "rounded": _rounded(mined, finding) if is_found else None,
        "decided_by": finding.failure and _failure(finding.failure),
        "started": [str(path) for path in finding.started],
        "not_started": [str(path) for path in finding.not_started],
        "not_asked": [str(path) for path in _not_asked(mined, finding)],
        "never_triggered": finding.result is Result.EVERY and finding.never_triggered,
        "alone": [
            {"recording": str(path), **_value(None if number is None else Trial(sought, number))}
            for path, number in finding.alone.items()
        ],
    }


def _failure(failure: Failure) -> dict[str, Any]:
    track, session = failure.answer.failing, failure.answer.session
    violations = spread(session, track)
    return {
        "recording": str(failure.recording),
        **_value(failure.trial),
        "property": documents.property_report(session, track),
        "remarks": reports.explanation(session, track),
        "violations": None if violations is None else violations.document(),
    }


def _rounded(mined: Mined, finding: Finding) -> dict[str, Any]:
    trial = finding.trial.rounded
    return {**_value(trial), "text": mined.template.property_text(trial), **_measured(finding, trial)}


def _measured(finding: Finding, trial: Trial) -> dict[str, Any]:
    """By how much recordings pass with that value, if it was asked for."""
    found = [{"recording": str(m.recording), "label": m.label, **m.report} for m in finding.measured.get(trial, ())]
    return {"robustness": found} if found else {}


def _value(trial: Trial | None) -> dict[str, Any]:
    """A value, a duration in seconds, and as it is written."""
    if trial is None:
        return {"value": None, "value_ns": None, "written": None}
    value = trial.sought.values.at(trial.number)
    if trial.sought.parameter.role is Role.DURATION:
        return {"value": seconds(int(value)), "value_ns": int(value), "written": trial.text}
    return {"value": value, "value_ns": None, "written": trial.text}
