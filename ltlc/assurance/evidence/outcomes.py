"""What the checks of evidence have found of each claim."""

from __future__ import annotations

from typing import NamedTuple

from ltlc.assurance.evidence.document import Claim, NotCovered
from ltlc.dataclass import dataclass


class Check(NamedTuple):
    """What one check has found of a claim.

    `what` was checked is `judge`, `recorded` or `specification`; `by` is the program. It has `shown` something, or
    there is a `refusal`: why the claim is not accepted or, if the check was not done, why it was not.
    """

    what: str
    by: str
    refusal: str | None
    was_done: bool = True
    shown: str = ""


@dataclass(frozen=True, slots=True)
class CheckedClaim:
    """What became of a claim; of a property of which nothing is claimed, there are no checks."""

    of: Claim | NotCovered
    checks: tuple[Check, ...] = ()

    @property
    def is_refused(self) -> bool:
        """Whether a check does not accept it."""
        return any(check.was_done and check.refusal is not None for check in self.checks)

    @property
    def is_accepted(self) -> bool:
        """Whether all checks were done, and each accepts it."""
        return bool(self.checks) and all(check.was_done and check.refusal is None for check in self.checks)
