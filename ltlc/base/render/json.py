"""Diagnostics as plain data for programs; lines and columns count from 1, an `end` is the place after the last."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from ltlc.base.diagnostics import Diagnostic, Fix
from ltlc.base.source import Position, Source, Span


def documents(diagnostics: Iterable[Diagnostic]) -> list[dict[str, Any]]:
    """Each of `diagnostics` as an object of JSON."""
    return [document(diagnostic) for diagnostic in diagnostics]


def document(diagnostic: Diagnostic) -> dict[str, Any]:
    """One diagnostic: code, name, severity, message, span, related, help, example, fixes.

    Without a place in the text, `span` is the beginning of the file; `help` and `example` are null where there is none.
    """
    source = diagnostic.source
    return {
        "code": diagnostic.code,
        "name": diagnostic.name,
        "severity": diagnostic.severity.value,
        "message": diagnostic.message,
        "span": place(source, diagnostic.primary.span if diagnostic.primary else Span(0, 0)),
        "related": [{"span": place(source, label.span), "message": label.text} for label in diagnostic.secondary],
        "help": diagnostic.help or None,
        "example": plain(diagnostic.example),
        "fixes": [_fix(source, fix) for fix in diagnostic.fixes],
    }


def _fix(source: Source, fix: Fix) -> dict[str, Any]:
    edits = [{"span": place(source, span), "text": text} for span, text in fix.edits]
    return {"title": fix.title, "is_certain": fix.is_certain, "edits": edits}


def plain(value: Any) -> Any:
    """`value` with infinite numbers as strings, wherever they are in it: JSON has none."""
    match value:
        case dict():
            return {name: plain(each) for name, each in value.items()}
        case list():
            return [plain(each) for each in value]
        case float() if not math.isfinite(value):
            return repr(value)
    return value


def place(source: Source, span: Span) -> dict[str, Any]:
    """A span of `source` with the name of the file."""
    start, end = source.position(span.start), source.position(span.end)
    return {"file": source.name, "start": _position(start), "end": _position(end)}


def _position(position: Position) -> dict[str, int]:
    return {"line": position.line, "column": position.column}
