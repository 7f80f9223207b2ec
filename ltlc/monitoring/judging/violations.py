"""All violations of a property, as text and data."""

from __future__ import annotations

from typing import Any

from ltlc.dataclass import dataclass
from ltlc.monitoring.later import MOST, Violation, all_violations
from ltlc.runtime.documents import moment_report
from ltlc.runtime.reports import counted, moment_text
from ltlc.runtime.session import Session
from ltlc.runtime.times import Scale, seconds, span_text
from ltlc.runtime.tracking import Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict


def violations_report(session: Session, track: Track) -> dict[str, Any]:
    """The violations of a property in the JSON document of `ltlc run`; null if no more than the first is known."""
    found = all_violations(track)
    if found is None or session.time is None:
        return {"violations": None}
    return {"violations": [_report(session, each, session.time) for each in found]}


def _report(session: Session, violation: Violation, end: Nanoseconds) -> dict[str, Any]:
    until, lasted = violation.until, violation.lasted(end)
    return {
        **moment_report(violation.moment, session.beginning),
        "until": None if until is None else seconds(until),
        "until_ns": until,
        "lasted": seconds(lasted),
        "lasted_ns": lasted,
    }


@dataclass(frozen=True, slots=True)
class Spread:
    """How many violations there were, and for how long, from the shortest to the longest."""

    count: int
    lasted: tuple[Nanoseconds, ...]

    def text(self) -> str:
        """The same in a line."""
        if not any(self.lasted):
            return "1 violation, at an instant" if self.count == 1 else f"{self.count} violations, each at an instant"
        if self.count == 1:
            return f"1 violation, for {span_text(self.lasted[0])}"
        shortest, longest, median = self.lasted[0], self.lasted[-1], self.lasted[self.count // 2]
        between = f"for {span_text(shortest)} to {span_text(longest)}, median {span_text(median)}"
        return f"{self.count} violations, {between}, {span_text(sum(self.lasted))} in all"

    def document(self) -> dict[str, Any]:
        """The same in JSON, in seconds."""
        return {
            "count": self.count,
            "shortest": seconds(self.lasted[0]),
            "median": seconds(self.lasted[self.count // 2]),
            "longest": seconds(self.lasted[-1]),
            "total": seconds(sum(self.lasted)),
        }


def spread(session: Session, track: Track) -> Spread | None:
    """How the violations of a property are spread; None if there is none, or if only the first is known."""
    found, end = all_violations(track), session.time
    if not found or end is None:
        return None
    return Spread(len(found), tuple(sorted(each.lasted(end) for each in found)))


def only_first(track: Track) -> str:
    """Why no violation after the first is known; empty if all are, if there is none, and for properties of ids."""
    is_first = track.verdict is Verdict.VIOLATED and all_violations(track) is None and track.slices is None
    return "Only the first violation is known: the monitor for later ones exceeds its budget." if is_first else ""


def violations_text(session: Session, track: Track) -> str:
    """A line for each violation of a property: when it was, and for how long."""
    found = all_violations(track)
    if found is None or session.time is None:
        return f"{only_first(track)}\n"
    scale = session.scale.among(each.moment.time for each in found)
    count = f"{counted(len(found), 'violation')}{' or more' if len(found) >= MOST else ''}"
    lines = [f"{count}:", *(f"  {violation_text(scale, each, session.time)}" for each in found)]
    return "".join(f"{line}\n" for line in lines)


def violation_text(scale: Scale, violation: Violation, end: Nanoseconds) -> str:
    """When a violation was, and for how long, in a run up to `end`."""
    lasted = violation.lasted(end)
    long = f" for {span_text(lasted)}" if lasted else ""
    still = ", up to the end" if violation.until is None and lasted else ""
    return f"{moment_text(violation.moment, scale)}{long}{still}"
