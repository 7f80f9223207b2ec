"""What can be wrong with the input of a comparison."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from ltlc.diagnostics import Diagnostic, Severity
from ltlc.limits import Budget, Exceeded, run_all

Result = TypeVar("Result")


class UnusableInput(ValueError):  # noqa: N818  what it is called in the public interface
    """There is nothing to compare; `diagnostics` say why, the message has the errors among them."""

    def __init__(self, diagnostics: Sequence[Diagnostic], message: str = "") -> None:
        super().__init__(message or "; ".join(d.message for d in diagnostics if d.severity is Severity.ERROR))
        self.diagnostics = tuple(diagnostics)


def within(budget: Budget, job: Callable[[], Result], what: str) -> Result:
    """The result of `job`, which reads `what`, done in a child process with `budget`. Raises UnusableInput."""
    [outcome] = run_all([job], budget)
    if isinstance(outcome, Exceeded):
        raise UnusableInput((), f"{what} {outcome}")
    return outcome
