"""What happened in the groups of letters that a machine was followed over."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Places
from ltlc.monitoring.columns.bits import Bytes, Mask, lengths
from ltlc.monitoring.columns.tables import Happens, Sets, States, Tables

PART = 1 << 12
"""So many groups are searched at a time for the last at which something happened, of few properties."""

RARE = 8
"""Where fewer than one in so many groups are asked for, each is looked for among the properties."""

MANY = 16
"""For more properties, or slices, than so many, all groups are searched."""

Settings = tuple[Places, Places, Mask]
"""Of which properties, ascending, at which steps a clock is set, and whether it starts there; otherwise it stops."""

_FIRST = np.array([(1 << count) - 1 for count in range(9)], np.uint8)
"""The first bits of a byte, so many."""


@dataclass(frozen=True, slots=True)
class Passed:
    """What became of a machine: it took `steps` steps and is in `state`, or would be final with the next.

    `changed` is the last of these at which the verdict changed, `counts` and `opened` are, by slot, how many episodes
    opened where none was open, and the last step at which one did; -1 where there was none.
    """

    steps: int
    state: int
    changed: int
    counts: tuple[int, ...]
    opened: tuple[int, ...]


@dataclass(frozen=True)
class Groups:
    """The groups that do something, by their numbers `at`, and their places `index` in the tables.

    They are of the bytes `places`, None for all. Of each property, the byte in `firsts` is the first one, and its
    groups are those from `starts` to before `ends`, or to before that in `deciding`, which decides it; -1 if none does.
    Its state after all of them is in `lasts`.
    """

    tables: Tables
    index: Places
    at: Places
    places: Places | None
    firsts: Places
    starts: Places
    ends: Places
    deciding: Places
    lasts: States

    @cached_property
    def _numbers(self) -> Places:
        """Of each group, the number of its property."""
        return np.arange(len(self.starts)).repeat(lengths(self.starts, len(self.at)))

    def _of(self, groups: Places) -> Places:
        """The numbers of the properties that these groups, ascending, are of."""
        if len(groups) * RARE < len(self.at):
            return self.starts.searchsorted(groups, "right") - 1
        return self._numbers.take(groups)

    def _where(self, happens: Happens) -> Places:
        """The groups in which it happens."""
        return np.flatnonzero(happens.counts.take(self.index) != 0)  # which is faster than without `!= 0`

    def passed(self, count: int) -> Iterator[Passed]:
        """What happened to each property in `count` steps."""
        for number, (passed, group) in enumerate(zip(self._before(count), self.deciding.tolist(), strict=True)):
            yield passed if group < 0 else self.until(passed, number, group)

    def settings(self, clock: Sets, counts: Places) -> Settings:
        """Where a clock is set in so many first steps of each property."""
        starts, stops = clock.starts.take(self.index), clock.stops.take(self.index)
        groups = np.flatnonzero((starts | stops) != 0)
        numbers = self._of(groups)
        firsts = self._first_steps(groups, numbers)
        are_taken = _FIRST.take(counts.take(numbers) - firsts, mode="clip")
        is_start, is_stop = (_bits(each.take(groups) & are_taken) for each in (starts, stops))
        at = np.flatnonzero(is_start | is_stop)
        of = at >> 3
        return numbers.take(of), firsts.take(of) + (at & 7), is_start.take(at)

    def last(self, happens: Happens, of: Mask) -> Places:
        """The last step of each of these, before a group that decides it, at which it happens; -1 if there is none."""
        numbers = np.flatnonzero(of)
        if len(numbers) > MANY:
            groups = self._where(happens)
            numbers = self._of(groups)
            is_taken = of[numbers] & (groups < self.ends[numbers])
        else:
            limits = zip(self.starts[numbers].tolist(), self.ends[numbers].tolist(), strict=True)
            groups = np.array([self._last_group(happens.counts, *each) for each in limits], np.int64)
            is_taken = groups >= 0
        groups, numbers, found = groups[is_taken], numbers[is_taken], np.full(len(of), -1)
        found[numbers] = (
            self._first_steps(groups, numbers) + happens.lasts.take(self.index[groups]) - 1
        )  # the last wins
        return found

    def decisions(self) -> tuple[Places, Places, Places]:
        """Those that a step decides, by number, these steps, and the states that they lead to."""
        numbers = np.flatnonzero(self.deciding >= 0)
        groups = self.deciding[numbers]
        paths = list(self._paths(groups))
        before = [states < self.tables.machine.first_final for states, _ in paths]
        return numbers, self._first_steps(groups, numbers) + np.sum(before, 0) - 1, paths[-1][1]

    def changes(self, of: Mask) -> Iterator[tuple[Places, Places, Places, Places]]:
        """Where the verdict changes: of which of these, at which step, and from which state to which."""
        groups = self._where(self.tables.changes) if of.any() else self.starts[:0]
        numbers = self._of(groups)
        groups, numbers = groups[of[numbers]], numbers[of[numbers]]
        first, outputs = self._first_steps(groups, numbers), self.tables.machine.outputs
        for step, (before, after) in enumerate(self._paths(groups)):
            at = np.flatnonzero(outputs[before] != outputs[after])
            yield numbers[at], first[at] + step, before[at], after[at]

    def _paths(self, groups: Places) -> Iterator[tuple[Places, Places]]:
        """For each step of `groups`, the states before and after it."""
        states, keys = np.divmod(self.index[groups], self.tables.width)
        for step in range(self.tables.size):
            before = states
            states = self.tables.machine.table[before, self.tables.letter(keys, step)]
            yield before, states

    def _before(self, count: int) -> Iterator[Passed]:
        """What happened in the groups of each property before one that decides it, in `count` steps."""
        changed = self.last(self.tables.changes, self.ends > self.starts).tolist()
        counts, opened = [], []
        for opens in self.tables.opens:
            number = self._sums(opens.counts)
            counts.append(number.tolist())
            opened.append(self.last(opens, number > 0).tolist())
        each = [list(zip(*of, strict=True)) if of else [()] * len(changed) for of in (counts, opened)]
        for state, change, counted, opening in zip(self.lasts.tolist(), changed, *each, strict=True):
            yield Passed(count, state, change, counted, opening)

    def until(self, passed: Passed, number: int, group: int) -> Passed:
        """What happened up to the step that is the first to lead to a final state, in a group after those `passed`."""
        tables, machine = self.tables, self.tables.machine
        path = tables.path(*divmod(int(self.index[group]), tables.width))
        decided = next(step for step, (_, _, after) in enumerate(path) if after >= machine.first_final)
        first = int(self._first_steps(np.array([group]), np.array([number]))[0])
        changed, counts, opened = passed.changed, list(passed.counts), list(passed.opened)
        for step, (state, letter, after) in enumerate(path[:decided], first):
            if machine.outputs[state] != machine.outputs[after]:
                changed = step
            for slot, opens in enumerate(machine.opened):
                if opens[state, letter]:
                    counts[slot] += 1
                    opened[slot] = step
        return Passed(first + decided, path[decided][0], changed, tuple(counts), tuple(opened))

    def _sums(self, table: NDArray[np.uint8]) -> Places:
        """What the groups of each property have in `table`, together."""
        found, limits = table.take(self.index), np.stack((self.starts, self.ends), axis=1).reshape(-1)
        sums = np.add.reduceat(found, limits[: len(limits) - (limits[-1] == len(found))], dtype=np.int64)[::2]
        return np.where(self.ends > self.starts, sums, 0)

    def _last_group(self, table: NDArray[np.uint8], first: int, end: int) -> int:
        """The last of the groups from `first` to before `end` that has something in `table`; -1 if there is none."""
        size = PART
        while end > first:
            start = max(first, end - size)
            hits = np.flatnonzero(table.take(self.index[start:end]))
            if len(hits):
                return start + int(hits[-1])
            end, size = start, min(2 * size, 16 * PART)
        return -1

    def _first_steps(self, groups: Places, numbers: Places) -> Places:
        """The first steps of groups of the properties with these numbers."""
        at, size = self.at[groups], self.tables.size
        shift = (8 // size).bit_length() - 1
        bytes_ = at >> shift
        places = bytes_ if self.places is None else self.places[bytes_]
        steps: Places = (places - self.firsts[numbers]) * 8 + (at & (1 << shift) - 1) * size
        return steps


def _bits(packed: Bytes) -> Mask:
    """Eight booleans for each byte."""
    return np.unpackbits(packed, bitorder="little").view(np.bool_)
