"""What a question about a specification finds, as data that can leave the process that found it."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace

from ltlc.analysis.examples import Example
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Help, Label
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Finding:
    """A diagnostic before it is put to its source; see `ltlc.base.diagnostics.Diagnostic`."""

    code: str
    place: Span
    message: str
    label: str = ""
    secondary: tuple[Label, ...] = ()
    help: str | Help = ""
    example: Example | None = None

    def diagnostic(self, source: Source) -> Diagnostic:
        """The finding in `source`."""
        return diagnostic(
            self.code,
            source,
            self.place,
            self.message,
            label=self.label,
            secondary=self.secondary,
            help=self.help,
            example=self.example.as_json() if self.example else None,
        )


def once_of_copies(findings: Iterable[Finding], names: Collection[str]) -> Iterator[Finding]:
    """`findings` without repetitions for other copies of a `forall`, which differ in `names` only."""
    if not names:
        yield from findings
        return
    name = re.compile("|".join(sorted(map(re.escape, names), key=len, reverse=True)))
    same: dict[tuple[str, Span, str], list[Finding]] = {}
    for finding in findings:
        same.setdefault((finding.code, finding.place, name.sub("", finding.message)), []).append(finding)
    for first, *others in same.values():
        count = f"{len(others)} other {'copy' if len(others) == 1 else 'copies'}"
        yield replace(first, message=f"{first.message} (the same for {count} of `forall`)") if others else first
