"""What a question about a specification finds, as data that can leave the process that found it."""

from __future__ import annotations

from dataclasses import dataclass

from ltlc.analysis.examples import Example
from ltlc.codes import diagnostic
from ltlc.diagnostics import Diagnostic, Label
from ltlc.source import Source, Span


@dataclass(frozen=True, slots=True)
class Finding:
    """A diagnostic before it is put to its source; see `ltlc.diagnostics.Diagnostic`."""

    code: str
    place: Span
    message: str
    label: str = ""
    secondary: tuple[Label, ...] = ()
    help: str = ""
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
