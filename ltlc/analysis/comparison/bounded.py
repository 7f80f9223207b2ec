"""Input that exceeds its budget while it is read."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from ltlc.base.errors import UnusableInput
from ltlc.base.limits import Budget, Exceeded, run_all

Result = TypeVar("Result")


def within(budget: Budget, job: Callable[[], Result], what: str) -> Result:
    """The result of `job`, which reads `what`, done in a child process with `budget`. Raises UnusableInput."""
    [outcome] = run_all([job], budget)
    if isinstance(outcome, Exceeded):
        raise UnusableInput((), f"{what} {outcome}")
    return outcome
