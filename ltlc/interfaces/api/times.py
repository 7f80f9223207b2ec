"""Times as programs have them: seconds as numbers or texts, exact to the nanosecond; or none, where none matters."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal

from ltlc.base.errors import UnusableInput
from ltlc.compiler import Compiled
from ltlc.inputs.recordings.reading import Limit, limit
from ltlc.semantics.encodings import reads_time
from ltlc.specification.expressions import Signal, Slope
from ltlc.specification.specification import Specification

Seconds = float | str | Decimal
"""A time or a duration as it is written: 0.1 is a tenth of a second, whatever the nearest double is."""


def limit_of(seconds: Seconds) -> Limit:
    """A time of a recording or, as in "+10", since its beginning. Raises UnusableInput if it is not a time."""
    try:
        return limit(str(seconds))
    except ValueError:
        raise UnusableInput((), f"{seconds!r} is not a time in seconds, such as 12.5") from None


def needs_time(specification: Specification, compiled: Sequence[Compiled]) -> str:
    """Why verdicts depend on when steps are, and not on their order only; empty if they do not."""
    if specification.rate is not None or specification.timeout is not None:
        return "`_rate_` and `_timeout_` count it"
    for each in compiled:
        if reads_time(each.specification.property) or any(_has_slope(i.signal) for i in each.specification.inputs()):
            return f"`{each.specification.label}` depends on it"
    return ""


def _has_slope(signal: Signal) -> bool:
    return any(isinstance(part, Slope) or _has_slope(part.signal) for part in signal.inputs)
