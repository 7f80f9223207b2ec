"""Times: whole numbers of nanoseconds, read and written as seconds."""

from __future__ import annotations

from decimal import Decimal

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
