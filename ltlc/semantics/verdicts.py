"""The four verdicts of a run that is still going on, and the one before its first step.

Bauer, Leucker and Schallhart, *Comparing LTL semantics for runtime verification*, 2010 (RV-LTL).
"""

from __future__ import annotations

from enum import Enum


class Verdict(Enum):
    """What is known of a property after the steps seen so far; the value is the name in JSON."""

    VIOLATED = "violated"
    """No infinite continuation satisfies the property. Permanent."""
    PRESUMABLY_VIOLATED = "presumably_violated"
    """Not decided; as a finite word, the run so far does not satisfy it: an obligation is open."""
    PRESUMABLY_SATISFIED = "presumably_satisfied"
    """Not decided; as a finite word, the run so far satisfies it."""
    SATISFIED = "satisfied"
    """Every infinite continuation satisfies the property. Permanent."""
    NOT_STARTED = "not_started"
    """There has been no step: some signal that the property reads has not had a value."""

    @property
    def is_permanent(self) -> bool:
        """Whether no continuation can change it."""
        return self in (Verdict.VIOLATED, Verdict.SATISFIED)

    @property
    def holds(self) -> bool:
        """Whether the steps so far, taken as a finite word, satisfy the property; false before the first step."""
        return self in (Verdict.SATISFIED, Verdict.PRESUMABLY_SATISFIED)
