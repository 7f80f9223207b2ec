"""What the Python interface raises for unusable input."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.base.diagnostics import Diagnostic, Severity
from ltlc.base.render import full


class UnusableInput(ValueError):  # noqa: N818  what it is called in the public interface
    """The input is unusable: `diagnostics` say why; as text, the errors among them with their places."""

    def __init__(self, diagnostics: Sequence[Diagnostic], message: str = "") -> None:
        errors = [each for each in diagnostics if each.severity is Severity.ERROR]
        super().__init__(message or full.render(errors).rstrip())
        self.diagnostics = tuple(diagnostics)

    def __reduce__(self) -> tuple[type[UnusableInput], tuple[Sequence[Diagnostic], str]]:
        return type(self), (self.diagnostics, str(self))
