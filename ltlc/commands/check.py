"""`ltlc check`: what is wrong with a specification before it ever runs."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from typing import Any

from ltlc.analysis.subjects import Subject
from ltlc.automata import Budget, SpotMissing
from ltlc.commands.common import FINDING, OK, examine, failure, has_errors, report, unusable
from ltlc.diagnostics import Diagnostic, Severity
from ltlc.render import concise
from ltlc.render import json as render_json


def run(options: argparse.Namespace) -> int:
    """Show all findings, and of each property whether it can hold and whether it can fail."""
    try:
        examined = examine(options, Budget(*options.budget), pedantic=options.pedantic)
    except SpotMissing as error:
        return unusable(str(error))
    _show(options.format, examined.subjects, examined.diagnostics)
    if examined.specification is None:
        return failure(examined.diagnostics)
    fails = has_errors(examined.diagnostics) or (options.strict and _has_warnings(examined.diagnostics))
    return FINDING if fails else OK


def _has_warnings(diagnostics: Sequence[Diagnostic]) -> bool:
    return any(each.severity is Severity.WARNING for each in diagnostics)


def _show(form: str, subjects: Sequence[Subject], diagnostics: Sequence[Diagnostic]) -> None:
    """Diagnostics on stderr and a line for each property on stdout, or one document on stdout."""
    if form == "json":
        found = {"properties": [_document(s) for s in subjects], "diagnostics": render_json.documents(diagnostics)}
        print(json.dumps(found, ensure_ascii=False, indent=2))
        return
    if form == "sarif":
        from ltlc.render import sarif

        print(json.dumps(sarif.document(diagnostics), ensure_ascii=False, indent=2))
        return
    if form == "concise":
        sys.stderr.write(concise.render(diagnostics))
    else:
        report(diagnostics)
    for subject in subjects:
        print(f"{subject.label}: {_summary(subject)}")


def _summary(subject: Subject) -> str:
    """What a property can do, in words."""
    if subject.monitor is None:
        return "not decided whether it can hold or fail"
    if subject.never_holds:
        return "cannot hold"
    return "cannot fail" if subject.always_holds else "can hold, can fail"


def _document(subject: Subject) -> dict[str, Any]:
    """What a property can do, as an object of JSON; null where it was not decided."""
    known = subject.monitor is not None
    return {
        "label": subject.label,
        "line": subject.specification.line,
        "text": subject.specification.text,
        "can_hold": not subject.never_holds if known else None,
        "can_fail": not subject.always_holds if known else None,
        "states": len(subject.monitor.verdicts) if subject.monitor else None,
    }
