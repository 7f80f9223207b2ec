"""Why a question has no answer, other than a limit."""

from __future__ import annotations


class NotDecidedError(RuntimeError):
    """The methods at hand do not answer the question."""


class DisagreementError(RuntimeError):
    """Two procedures that should agree do not: neither is believed."""

    def __init__(self, what: str) -> None:
        super().__init__(f"two procedures disagree on {what}; this is a bug in ltlc, please report it")
