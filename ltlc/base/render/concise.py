"""Diagnostics in one line each, as editors and `grep` like them: `file:line:column: error[LTL101] message`."""

from __future__ import annotations

from collections.abc import Iterable

from ltlc.base.diagnostics import Diagnostic
from ltlc.base.render.full import printable


def render(diagnostics: Iterable[Diagnostic]) -> str:
    """One line for each of `diagnostics`."""
    return "".join(_line(diagnostic) + "\n" for diagnostic in diagnostics)


def _line(diagnostic: Diagnostic) -> str:
    where = diagnostic.source.name
    if diagnostic.primary is not None:
        place = diagnostic.source.position(diagnostic.primary.span.start)
        where += f":{place.line}:{place.column}"
    text = f"{where}: {diagnostic.severity.value}[{diagnostic.code}] {diagnostic.message}"
    return printable(text).replace("\n", " ")
