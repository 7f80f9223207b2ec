"""Finds the first of numbered values that passes, where all later ones pass, too."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from ltlc.dataclass import dataclass

WAYS = 4
"""Into so many parts one look at a recording divides what is left: the more, the fewer looks, each a little longer."""


@dataclass
class Search:
    """A search for the first number from `low` to `last` that passes.

    What is below `low` is not looked at, or does not pass; what is from `high` on passes, `last + 1` if nothing does
    that was tried. At `hints` it may be: these are tried next, and neither believed nor needed.
    """

    low: int
    last: int
    hints: Collection[int] = ()

    def __post_init__(self) -> None:
        self.high = self.last + 1

    @property
    def is_done(self) -> bool:
        """Whether `high` is what was searched for."""
        return self.low == self.high

    @property
    def found(self) -> int | None:
        """The first number that passes; None if none does."""
        return self.high if self.high <= self.last else None

    def numbers(self) -> list[int]:
        """What to try next: first both ends, then what divides the rest into equal parts, and the hints."""
        if self.is_done:
            return []
        if self.high > self.last:
            return sorted({self.low, self.last})
        here = [hint for hint in self.hints if self.low <= hint < self.high]
        start = min(here, default=self.low)
        parts = {start + (self.high - start) * part // WAYS for part in range(1, WAYS)}
        near = {hint + beside for hint in here for beside in (-1, 0, 1)}
        return sorted(number for number in parts | near if self.low <= number < self.high)

    def learn(self, passes: Mapping[int, bool]) -> None:
        """Take in which numbers pass."""
        passing = [number for number, does in passes.items() if does]
        failing = [number for number, does in passes.items() if not does]
        self.high = min([self.high, *passing])
        self.low = max([self.low, *(number + 1 for number in failing)])
        assert self.low <= self.high, "a weaker property fails where a stronger one passes"
