"""The possible outcomes of comparing a machine, or a text that contains one."""

from __future__ import annotations

from typing import Protocol

from ltlc.dataclass import dataclass
from ltlc.semantics.words import Letter


@dataclass(frozen=True, slots=True)
class ReadBack:
    """The text is the machine, with so many `states`."""

    states: int


@dataclass(frozen=True, slots=True)
class Difference:
    """What a machine or a text does differently or, if that is unknown, what in it is not understood.

    `state` is that of the machine, None if it is about all of it; `letter` what holds there, None if it is so whatever
    holds; `by_time`: at a clock step.
    """

    reason: str
    state: int | None = None
    letter: Letter | None = None
    by_time: bool = False

    def __str__(self) -> str:
        if self.state is None:
            return self.reason
        held = " and ".join(f"`{atom}`" for atom in sorted(self.letter or ())) or "none of the conditions"
        verb = "holds" if len(self.letter or ()) < 2 else "hold"
        instant = " at a clock step" if self.by_time else ""
        where = "" if self.letter is None else f" where {held} {verb}"
        return f"in state {self.state}{instant}{where}, {self.reason}"


class Written(Protocol):
    """What is written of a property in emitted files."""

    def read_back(self) -> ReadBack | Difference:
        """Compare the text with the machine."""
