"""What is known of the slices of a run that columns judge: a place in each of some columns for every id."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.monitoring.columns.bits import Bytes, Mask
from ltlc.monitoring.columns.ids import Numbers
from ltlc.monitoring.columns.machine import Machine
from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.series import UnsupportedError
from ltlc.monitoring.columns.tables import States
from ltlc.runtime.courses import Course
from ltlc.runtime.slice_ids import Slice
from ltlc.runtime.slice_steps import Slices
from ltlc.runtime.times import NEVER
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict


class Known:
    """What is known of each of the `slices` of a property, by the number of its id.

    states: of the machine, 0 before the first step
    is_decided: whether the verdict is permanent
    begins: by which message it is kept, as messages are counted
    stepped: the number of its last step
    owed, owed_at: the step at which its verdict changed last, and the time, if an obligation is open
    next: when a clock comes due next; `dues` are when each does
    latest, letters: by reading, the value in its last message with its id; and what held of that since
    """

    def __init__(self, slices: Slices, of: Prepared, machine: Machine) -> None:
        self._slices, self._of, self._machine = slices, of, machine
        self.numbers = Numbers()
        self.states: States = np.empty(0, np.int16)
        self.is_decided: Mask = np.empty(0, np.bool_)
        self.begins, self.stepped, self.owed, self.owed_at, self.next = (np.empty(0, np.int64) for _ in range(5))
        self.dues: list[Places] = [np.empty(0, np.int64) for _ in machine.clocks]
        self.latest: dict[str, Array] = {}
        self.letters: Bytes = np.empty(0, np.uint8)

    def require(self, latest: Mapping[str, Array]) -> None:
        """Raise UnsupportedError if there is no place for such values."""
        if any(name in self.latest and self.latest[name].dtype != values.dtype for name, values in latest.items()):
            raise UnsupportedError("values of another kind")

    def number(self, ids: Array) -> Places:
        """The numbers of `ids`, of which each has its place from now on."""
        found = self.numbers.of(ids)
        if len(self.numbers) > len(self.states):
            self._grow(2 * len(self.numbers))
        return found

    def begin(self, numbers: Places, messages: Places) -> None:
        """Slices that are not kept are from these messages on."""
        self.begins[numbers] = np.minimum(self.begins[numbers], messages)

    def see(self, numbers: Places, values: Mapping[str, Array], messages: Places) -> None:
        """The last messages of slices are those of these `messages` that have the `values`."""
        for name, column in values.items():
            if name not in self.latest:
                self.latest[name] = np.zeros(len(self.states), column.dtype)
            self.latest[name][numbers] = column.take(messages)

    def decide(self, numbers: Places | int) -> None:
        """The verdicts on slices are permanent."""
        self.is_decided[numbers], self.next[numbers] = True, NEVER

    def slice(self, number: int, time: Nanoseconds = 0) -> Slice:
        """A slice with a track, as if it had gone row by row; before its first step, it begins at `time`."""
        latest = {name: values[number : number + 1].tolist()[0] for name, values in self.latest.items()}
        one = self._slices.resumed(time, self.numbers.id(number), tuple(latest), list(latest.values()))
        state = int(self.states[number])
        if not state:
            return one
        if self.dues:  # Clock steps judge the values of the last step, which a monitor keeps for itself.
            one.monitor.step(time, *one.judged_on)
        one.monitor.state, _ = self._machine.states[state]
        one.monitor.verdict = one.verdict = self._of.states[one.monitor.state].verdict
        one.steps = int(self.stepped[number]) + 1
        if one.verdict is Verdict.PRESUMABLY_VIOLATED:
            one.owe(int(self.owed[number]), int(self.owed_at[number]))
        for name, due in zip(self._of.clocks, self.dues, strict=True):
            setattr(one.monitor, name, int(due[number]))
        if self.dues:
            one.monitor.due = int(self.next[number])
        return one

    def put(self, number: int, track: Course) -> None:
        """A slice goes on from where its `track` is, which is not decided."""
        self.states[number] = self._machine.numbers[track.monitor.state, 0]
        self.stepped[number] = track.steps - 1
        if (since := track.open_since) is not None:
            self.owed[number], self.owed_at[number] = since.step, since.time
        for name, due in zip(self._of.clocks, self.dues, strict=True):
            due[number] = getattr(track.monitor, name)
        self.next[number] = track.monitor.due

    def going(self) -> Places:
        """The slices that have begun and are not decided, in the order in which they began."""
        found = np.flatnonzero(~self.is_decided & (self.begins < NEVER))
        return found[np.argsort(self.begins[found], kind="stable")]

    def kept(self) -> Places:
        """The slices that are kept, in the order in which they are."""
        count = len(self.numbers)
        is_new = self._machine.as_new[self.states[:count]] & (self.next[:count] >= NEVER)
        found = np.flatnonzero(~self.is_decided[:count] & ~is_new)
        return found[np.argsort(self.begins[found], kind="stable")]

    def _grow(self, count: int) -> None:
        """Have room for so many."""
        self.states, self.is_decided = _longer(self.states, count, 0), _longer(self.is_decided, count, False)
        self.begins, self.next = _longer(self.begins, count, NEVER), _longer(self.next, count, NEVER)
        self.stepped, self.owed = _longer(self.stepped, count, 0), _longer(self.owed, count, 0)
        self.owed_at, self.letters = _longer(self.owed_at, count, 0), _longer(self.letters, count, 0)
        self.dues = [_longer(due, count, NEVER) for due in self.dues]
        self.latest = {name: _longer(values, count, values.dtype.type()) for name, values in self.latest.items()}


def _longer(column: Array, count: int, filled: object) -> Array:
    """The `column`, and more places that are `filled`."""
    found = np.full(count, filled, column.dtype)
    found[: len(column)] = column
    return found
