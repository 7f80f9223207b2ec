"""Times as terms: an instant and so many nanoseconds, of which it is known only whether a clock is late."""

from __future__ import annotations

from ltlc.assurance.lowered.language import Apply, Moment, Term

TIME = Moment("time")
"""The time of the instant."""

HELD = Moment("time", -1)
"""The last nanosecond before a clock step, in which the letter before it was held, and at which it was due."""


def late(due: Term) -> Term:
    """That the time of the instant is past a due time."""
    return Apply("late", (due,))
