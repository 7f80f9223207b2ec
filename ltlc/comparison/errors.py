"""What can be wrong with the input of a comparison."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.diagnostics import Diagnostic, Severity


class UnusableInput(ValueError):  # noqa: N818  what it is called in the public interface
    """There is nothing to compare; `diagnostics` say why, the message has the errors among them."""

    def __init__(self, diagnostics: Sequence[Diagnostic], message: str = "") -> None:
        super().__init__(message or "; ".join(d.message for d in diagnostics if d.severity is Severity.ERROR))
        self.diagnostics = tuple(diagnostics)
