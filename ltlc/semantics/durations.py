"""Durations: whole numbers of nanoseconds, and how they are written."""

from __future__ import annotations

from decimal import Decimal

Nanoseconds = int
"""A time or a duration. Times are integers everywhere: a double near 1.7e9 s is 0.24 µs wide."""

UNITS: dict[str, Nanoseconds] = {
    "ns": 1,
    "us": 10**3,
    "ms": 10**6,
    "s": 10**9,
    "min": 60 * 10**9,
    "h": 3600 * 10**9,
}
"""The units of durations, from the smallest to the largest."""


def duration_text(duration: Nanoseconds) -> str:
    """`duration` exactly, as the language writes it, with decimals if a whole number would have more than three digits.

    Full seconds need none: `1.5 s`, `12.4 ms`, `50 ms`, `2 min`.
    """
    unit = next((u for u in reversed(UNITS) if duration % UNITS[u] == 0), "ns") if duration else "s"
    whole = duration // UNITS[unit]
    if duration % UNITS["s"] == 0 or whole < 1000:
        return f"{whole} {unit}"
    unit = next(unit for unit in ("s", "ms", "us") if duration >= UNITS[unit])
    return f"{Decimal(duration) / UNITS[unit]:f} {unit}"


def seconds_text(time: Nanoseconds) -> str:
    """`time` in seconds, exactly: `5.000000001`."""
    sign, whole, rest = "-" * (time < 0), abs(time) // UNITS["s"], abs(time) % UNITS["s"]
    return f"{sign}{whole}.{rest:09}".rstrip("0").rstrip(".")
