"""The limits of a job, and the wording for one that exceeds them."""

from __future__ import annotations

from enum import Enum

from ltlc.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Budget:
    """What one job may use: seconds of time on the clock, and megabytes of memory beside those taken before."""

    seconds: float = 10.0
    megabytes: int = 1024

    def __post_init__(self) -> None:
        if not (self.seconds > 0 and self.megabytes > 0):
            raise ValueError(f"a budget must be positive: {self.seconds} s, {self.megabytes} MB")


UNBOUNDED = Budget(seconds=10 * 366 * 86_400, megabytes=1 << 40)
"""More than any job needs, within what the system accepts: ten years, an exabyte."""


class Limit(Enum):
    """Which limit a job ran into."""

    TIME = "time"
    MEMORY = "memory"
    NESTING = "nesting"
    """The formula is nested too deeply for the stack of Python or of Spot."""
    ENGINE = "engine"
    """Spot gave up, or the child ended in a way that names no other limit."""


@dataclass(frozen=True, slots=True)
class Exceeded:
    """There is no result, because of `limit`; `detail` is what the engine said, and may be empty."""

    limit: Limit
    budget: Budget
    detail: str = ""

    @property
    def reason(self) -> str:
        """Why there is no result: what the engine said, or otherwise the limit."""
        return self.detail or f"it {self}"

    def __str__(self) -> str:
        match self.limit:
            case Limit.TIME:
                return f"takes longer than {round(self.budget.seconds, 2) or self.budget.seconds:g} s"
            case Limit.MEMORY:
                return f"needs more than {self.budget.megabytes} MB of memory"
            case Limit.NESTING:
                return "is nested too deeply"
            case Limit.ENGINE:
                return f"is beyond the automata library: {self.detail}"
