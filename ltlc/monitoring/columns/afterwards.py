"""What comes after the first violation of a property, taken forward by the same steps as the property."""

from __future__ import annotations

from dataclasses import replace

from ltlc.monitoring.columns.kept import KeptLetters
from ltlc.monitoring.columns.leaps import walk_and_leap
from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.series import Steps
from ltlc.monitoring.columns.tracks import Forward, Stretch
from ltlc.monitoring.columns.walk import Changes, Walk
from ltlc.monitoring.later import JudgedTrack, later_of
from ltlc.runtime.tracking import Track


class Afterwards:
    """Takes the violations of a property forward, `of` which it has what columns need, by some steps."""

    def __init__(self, track: Track, of: Prepared, steps: Steps) -> None:
        """The property has not taken the steps. Raises UnsupportedError."""
        later = later_of(track)
        self._track, self._of, self._before = track, of, later
        self._kept = KeptLetters(later, of, steps) if later is not None and of.openings else None
        self._taken = 0

    def begin(self) -> None:
        """The property takes the steps from now on, by itself."""
        self._taken = self._track.steps + self._track.invalid
        if isinstance(self._track, JudgedTrack):
            self._track.is_apart = True

    def follow(self, found: Stretch) -> None:
        """The property has taken the steps of `found`."""
        if isinstance(self._track, JudgedTrack):
            self._track.is_apart = False
        if (later := later_of(self._track)) is None:
            return
        if self._of.openings:
            kept = self._kept or KeptLetters(later, self._of, found.steps)
            found = replace(found, kept=kept)
        if later.restarts and self._of.tables is not None:
            walk_and_leap(Forward(later, self._of, self._of.tables), found)
            return
        first = 0 if self._before is not None else later.steps + later.skipped - self._taken
        Walk(later, found, found.kept or Changes(found)).take(first, len(found))
