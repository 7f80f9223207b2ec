"""What can be done about a finding: its fixes, and a comment that suppresses it."""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.base.diagnostics import Diagnostic, Fix, Severity
from ltlc.base.source import Span
from ltlc.frontend.language.suppression import ANALYSES

ABOUT_COMMENTS = "LTL691"
"""A comment that suppresses nothing is not suppressed by another one."""


def fixes(found: Diagnostic) -> Iterator[Fix]:
    """The fixes of `found`, then how to suppress it, where that can be done."""
    yield from found.fixes
    if found.primary is None or found.code == ABOUT_COMMENTS:
        return
    if found.severity is not Severity.ERROR or found.code.startswith(ANALYSES):
        yield Fix(f"suppress {found.code} ({found.name}) here", (_suppression(found, found.primary.span.start),))


def _suppression(found: Diagnostic, offset: int) -> tuple[Span, str]:
    """A comment behind the line with `offset` or, if that has one, on a line of its own before it."""
    comment = f"# ltlc: ignore {found.code}"
    text, line = found.source.text, found.source.position(offset).line
    start = text.rfind("\n", 0, offset) + 1
    written = found.source.line(line)
    if "#" not in written:
        end = start + len(written.rstrip())
        return Span(end, end), f"  {comment}"
    indent = written[: len(written) - len(written.lstrip())]
    line_break = "\r\n" if text[: start + len(written) + 2].endswith("\r\n") else "\n"
    return Span(start, start), f"{indent}{comment}{line_break}"
