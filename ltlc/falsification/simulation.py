"""A simulation that was run and judged, or that failed."""

from __future__ import annotations

from collections.abc import Callable, Collection, Generator, Iterable, Mapping
from dataclasses import field

from ltlc.dataclass import dataclass
from ltlc.falsification.assignment import Assignment
from ltlc.monitoring.judging.run import RunReport
from ltlc.runtime.session import Session
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict


class SimulationError(Exception):
    """A simulation has failed: it has no recording that can be judged, for the reason that is the text."""


Outcome = RunReport | SimulationError
"""What was recorded as it was judged, of which all could be read, or why there is none."""

Simulate = Callable[[Iterable[Assignment]], Generator[tuple[Assignment, Outcome], None, None]]
"""Simulates, some at a time or one by one: what comes of each, in order. Closing it ends those under way."""


@dataclass(frozen=True)
class Simulated:
    """A simulation: its number, from 1 on, what it was given, and what came of it.

    It has `verdicts` and `margins` by property. The latter are the most that is still possible: what a run leaves open
    at its end counts as met. They are infinite where no comparison decides, and missing where the property cannot be
    measured. In it some properties were `untriggered`: no episode opened; and steps of some were `left_out`, for a
    reason. Or it failed, as `failure` says. The `report` is there if a property is violated.
    """

    number: int
    assignment: Assignment
    failure: str = ""
    verdicts: Mapping[str, Verdict] = field(default_factory=dict)
    margins: Mapping[str, float] = field(default_factory=dict)
    untriggered: Collection[str] = ()
    left_out: Mapping[str, str] = field(default_factory=dict)
    report: RunReport | None = None

    @property
    def session(self) -> Session | None:
        """The state of the run in which a property is violated."""
        return None if self.report is None else self.report.session

    @property
    def violated(self) -> Track | None:
        """The property that was violated first; None if none was."""
        return None if self.report is None else violated_first(self.report)

    @property
    def ended(self) -> float | None:
        """How long after the beginning of the run that was, in s; None if it is not known."""
        track = self.violated
        if track is None or track.decided_at is None or self.session is None or self.session.beginning is None:
            return None
        return (track.decided_at.time - self.session.beginning) / 1e9


def whole(report: RunReport) -> Outcome:
    """The same, if its recording could be read to the end."""
    if report.session is None or report.is_damaged:
        found = report.diagnostics[-1]
        reason = f"its recording cannot be judged: {found.message}"
        return SimulationError(f"{reason}; {found.help}" if found.help else reason)
    return report


def violated_first(report: RunReport) -> Track | None:
    """The property that was violated first; None if none was."""
    tracks = [] if report.session is None else report.session.tracks
    found = [track for track in tracks if track.verdict is Verdict.VIOLATED]
    return min(found, key=lambda track: track.decided_at.time if track.decided_at else 0, default=None)
