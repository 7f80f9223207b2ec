"""Durations with a unit in nanoseconds, exactly."""

from __future__ import annotations

from fractions import Fraction

from ltlc.frontend.language.names import Checker
from ltlc.frontend.syntax import tree as syntax
from ltlc.semantics.durations import UNITS, Nanoseconds

LONGEST = 100 * 366 * 24 * UNITS["h"]
"""ns; times fit in 62 bits."""


def nanoseconds(checker: Checker, node: syntax.DurationLiteral) -> Nanoseconds | None:
    """The duration of `node` in nanoseconds; None, and an error reported, if that is too long or not a whole number."""
    roughly = float(node.number) * UNITS[node.unit]
    if roughly > LONGEST:
        checker.report("LTL217", node.span, f"`{checker.written(node)}` is longer than a hundred years")
        return None
    exact = Fraction(node.number) * UNITS[node.unit] if roughly > 1e-9 else Fraction(roughly)
    if exact.denominator == 1:
        return int(exact)
    message = f"`{checker.written(node)}` is not a whole number of nanoseconds"
    checker.report("LTL217", node.span, message, help="time is counted in whole nanoseconds")
    return None


def of_seconds(number: float) -> Nanoseconds:
    """`number` seconds as they were written, to the nearest nanosecond; at least 0 and at most `LONGEST`."""
    return round(Fraction(repr(min(max(number, 0.0), LONGEST / UNITS["s"]))) * UNITS["s"])
