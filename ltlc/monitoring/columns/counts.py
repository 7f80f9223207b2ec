"""What a property counts: how often it has occurred by each of many steps, and until when that is often enough."""

from __future__ import annotations

import numpy as np

from ltlc.backends.counts import Counting
from ltlc.inputs.recordings.blocks import Places
from ltlc.monitoring.columns.bits import Mask
from ltlc.runtime.properties import Monitor
from ltlc.runtime.times import NEVER
from ltlc.semantics.verdicts import Verdict


class Count:
    """How often something has occurred at steps that come at `times`, and at which its condition `holds`.

    is_reached: at which steps it has occurred as often as it is asked for
    moves: where the monitor has something to note
    """

    def __init__(self, counted: Counting, monitor: Monitor, holds: Mask, times: Places) -> None:
        """Before these steps, of which there is one, it is as `monitor` has it."""
        self._counted = counted
        self._holds = holds
        self.moves = occurs = holds
        if counted.of.begins:
            was = np.append(getattr(monitor, counted.held), holds[:-1])
            self.moves, occurs = holds != was, holds & ~was
        self._at = np.flatnonzero(occurs)
        before = np.array(getattr(monitor, counted.times), np.int64)
        self._times = np.concatenate((before, times[self._at]))
        self._dues = self._all_dues(monitor, len(before), int(times[0]))
        dues = self._dues.take(occurs.cumsum())
        self.is_reached: Mask = dues >= times
        self._ends = np.flatnonzero(self.is_reached[:-1] & (dues[:-1] < times[1:]))

    def _all_dues(self, monitor: Monitor, before: int, begins: int) -> Places:
        """When the clock is due once it has occurred so often more, where it did so often `before`."""
        of, due = self._counted.of, getattr(monitor, self._counted.clock)
        if of.presumed and of.duration is not None and monitor.verdict is Verdict.NOT_STARTED:
            due = begins + of.duration
        dues = np.full(len(self._at) + 1, due)
        first = max(1, of.times - before)
        firsts = self._times[max(0, before + 1 - of.times) : max(0, len(self._times) + 1 - of.times)]
        if first < len(dues):
            dues[first:] = NEVER if of.duration is None else firsts + of.duration
        return dues

    def until(self, step: int) -> int:
        """The first step from the one before this one on, after which it is late before the next; NEVER if none is."""
        number = int(self._ends.searchsorted(step - 1))
        return int(self._ends[number]) if number < len(self._ends) else NEVER

    def put(self, monitor: Monitor, step: int) -> int:
        """Have `monitor` as after this step; when its clock is due, NEVER if it is late then."""
        counted, number = self._counted, int(self._at.searchsorted(step, "right"))
        times = getattr(monitor, counted.times)
        times.clear()
        end = len(self._times) - len(self._at) + number
        times.extend(self._times[max(0, end - counted.of.times) : end].tolist())
        if counted.of.begins:
            setattr(monitor, counted.held, bool(self._holds[step]))
        due = int(self._dues[number])
        setattr(monitor, counted.clock, due)
        return due if self.is_reached[step] else NEVER
