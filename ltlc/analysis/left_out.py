"""Fixes that omit what makes no difference, a property or a bound, where the text shows clearly what that is."""

from __future__ import annotations

import re

from ltlc.base.diagnostics import Fix, Help
from ltlc.base.source import Source, Span

_LABEL = re.compile(r"[ \t]*(?:\w+[ \t]*:\s*)?")
_END = re.compile(r"[ \t]*(?:#[^\n]*)?(?:\n|\Z)")
_LAST_BOUND = re.compile(r"\s+(?:within|for)\s+[\d.]+\s*\w+(?=\)*\Z)")
_FIRST_BOUND = re.compile(r"\(*(within\s+[\d.]+\s*\w+\s*,\s*)")


def without_property(advice: str, source: Source, span: Span) -> Help:
    """`advice` to omit the property at `span`: its lines, if it has them for itself, with its label."""
    start, text = _label_start(source.text, span), source.text
    end = _END.match(text, span.end)
    if start is None or end is None:
        return Help(advice)
    return Help(advice, (Fix(f"omit `{source.excerpt(span)}`", ((Span(start, end.end()), ""),)),))


def _label_start(text: str, span: Span) -> int | None:
    """Where the lines of the property at `span` begin, if nothing but a label is before it."""
    line = text.rfind("\n", 0, span.start) + 1
    if text[line : span.start].isspace() and text[:line].rstrip().endswith(":"):
        line = text.rfind("\n", 0, len(text[:line].rstrip())) + 1
    return line if _LABEL.fullmatch(text, line, span.start) else None


def without_bound(source: Source, span: Span) -> tuple[Fix, ...]:
    """The fix that takes the bound from what is at `span`, if that begins or ends with one."""
    first = _FIRST_BOUND.match(source.text, span.start, span.end)
    last = _LAST_BOUND.search(source.text, span.start, span.end)
    place = Span(*first.span(1)) if first else Span(*last.span()) if last else None
    return () if place is None else (Fix(f"omit `{source.excerpt(place).strip(', ')}`", ((place, ""),)),)
