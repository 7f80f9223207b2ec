"""Following slices over their messages, as if all were one run: where each leads, and when its clocks are due."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Places
from ltlc.monitoring.columns.bits import Bytes
from ltlc.monitoring.columns.follow import groups_of
from ltlc.monitoring.columns.groups import Groups, Passed
from ltlc.monitoring.columns.ids import Runs
from ltlc.monitoring.columns.tables import States, Tables
from ltlc.runtime.times import NEVER
from ltlc.semantics.durations import Nanoseconds


@dataclass(frozen=True)
class Followed:
    """Some runs, each up to the step that decides it, as long as no clock comes due."""

    runs: Runs
    groups: Groups

    @cached_property
    def decisions(self) -> tuple[Places, Places, Places]:
        """The runs that a step decides, by place, these steps, and the states that they lead to."""
        return self.groups.decisions()

    def before(self, place: int, changed: int) -> Passed:
        """What happened in a run before the step that decides it; its verdict `changed` last in another group."""
        return self.groups.until(Passed(0, 0, changed, (), ()), place, int(self.groups.deciding[place]))

    def dues(self, times: Places, before: Sequence[Places], until: Nanoseconds) -> tuple[list[Places], Places]:
        """Of each clock when it is due after each run, or before what decides that; and when one first is too early.

        Messages come at `times`, clocks were due `before`, and after its last message a run goes on `until` then.
        """
        at, decided, _ = self.decisions
        ends, limits = np.full(len(self.runs.numbers), until), self.runs.lengths.copy()
        ends[at], limits[at] = times[self.runs.message(at, decided)], decided
        after, first = [], np.full(len(ends), NEVER)
        for sets, clock, due in zip(self.groups.tables.clocks, self.groups.tables.machine.clocks, before, strict=True):
            runs, steps, starts = self.groups.settings(sets, limits)
            set_at = times.take(self.runs.message(runs, steps))
            found, early = _dues(runs, set_at, np.where(starts, set_at + clock.duration, NEVER), due, ends)
            after.append(found)
            first = np.minimum(first, early)
        return after, first


def _dues(runs: Places, set_at: Places, dues: Places, before: Places, ends: Places) -> tuple[Places, Places]:
    """When a clock is due after each run, and when it first is too early, being set again, or at an end, after that.

    In `runs`, ascending, it is set to be due at `dues`; it was due `before`.
    """
    firsts = np.flatnonzero(np.diff(runs, prepend=-1))
    lasts = np.append(firsts, len(runs))[1:] - 1
    holds = np.append(set_at[1:], 0)[: len(runs)]
    holds[lasts] = ends.take(runs.take(lasts))
    holds_first, after = ends.copy(), before.copy()
    of = runs.take(firsts)
    holds_first[of], after[of] = set_at.take(firsts), dues.take(lasts)
    first = np.where(before < holds_first, before, NEVER)
    early = np.flatnonzero(dues < holds)
    np.minimum.at(first, runs[early], dues[early])
    return after, first


def follow(tables: Tables, runs: Runs, letters: Bytes, before: States) -> Followed:
    """Take the messages of `runs`, of which there is one, that have these `letters`, from the states `before`."""
    padded, sizes = runs.padded(letters), (runs.lengths + 7) >> 3
    bits = (padded & np.uint8(1 << atom) for atom in range(tables.machine.atoms))
    keys = tables.keys([np.packbits(each, bitorder="little") for each in bits])
    return Followed(runs, groups_of(tables, keys, None, sizes.cumsum() - sizes, before))
