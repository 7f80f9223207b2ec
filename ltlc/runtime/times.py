"""Times: whole numbers of nanoseconds, read and written as seconds."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from decimal import Decimal
from enum import Enum

from ltlc.dataclass import dataclass

SECOND = 10**9
NEVER = 1 << 62
"""Later than any time of a run, which is before the year 2116."""


def nanoseconds(text: str) -> int:
    """The time of so many seconds, to the nearest ns. Raises ValueError."""
    try:
        exact = Decimal(text)
        if abs(exact) * SECOND < NEVER:
            return int(exact.quantize(Decimal("1e-9")).scaleb(9))
    except ArithmeticError:
        pass
    raise ValueError(f"not a time in seconds: {text}")


def duration(seconds: float) -> int:
    """A duration as its author wrote it, which `repr` does, too; at most `NEVER`."""
    return NEVER if seconds * SECOND >= NEVER else nanoseconds(repr(seconds))


def seconds(time: int) -> float:
    """A time for programs that want seconds; the nearest double."""
    return time / SECOND


def seconds_text(time: int) -> str:
    """A time in s, exactly: `1700000000.1`."""
    whole, rest = divmod(abs(time), SECOND)
    sign = "-" if time < 0 else ""
    return f"{sign}{whole}.{rest:09}".rstrip("0").rstrip(".")


class Times(Enum):
    """How times are shown to a reader."""

    OFFSET = "since the beginning of the recording"
    ABSOLUTE = "in full"
    BOTH = "since the beginning of the run, and of a violation in full, too"


@dataclass(frozen=True, slots=True)
class Scale:
    """How times are written for a reader: since `zero`, or in full if that is None.

    A time since `zero` is rounded to that many `digits` after the point: milliseconds,
    or as many as it takes to distinguish the times that are shown together (`among`).
    With `has_clock`, the time of what went wrong is written in full, too.
    """

    zero: int | None = None
    digits: int = 3
    has_clock: bool = False

    def among(self, times: Iterable[int]) -> Scale:
        """The same, with enough digits for no two of `times` to look alike."""
        offsets = {time - (self.zero or 0) for time in times}
        for digits in (self.digits, 6):
            if len({_rounded(offset, digits) for offset in offsets}) == len(offsets):
                return replace(self, digits=digits)
        return replace(self, digits=9)

    def text(self, time: int) -> str:
        """A time of the run: `+15.752 s`."""
        if self.zero is None:
            return f"{seconds_text(time)} s"
        offset = _rounded(time - self.zero, self.digits)
        return f"{'+' if offset >= 0 else ''}{seconds_text(offset)} s"


def _rounded(time: int, digits: int) -> int:
    unit = int(10 ** (9 - digits))
    return (time + unit // 2) // unit * unit


def span_text(time: int) -> str:
    """How long something takes, to the millisecond; what is less than one in full."""
    return f"{seconds_text(_rounded(time, 3) or time)} s"
