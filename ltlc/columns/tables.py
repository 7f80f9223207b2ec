"""Running a machine over packed columns, several letters at a time.

A *group* is as many steps as have their letters in sixteen bits: eight of one or two atoms, four of three or four, two
of up to eight. Its *key* is these bits; for a machine and a key, tables have where each state leads. They are filled
for keys that occur. Most keys do nothing, or lead to one state from wherever, so that no group waits for another.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ltlc.columns.bits import Bits, Mask, joined, lengths, merged
from ltlc.columns.machine import Machine
from ltlc.recordings.blocks import Places

Keys = NDArray[np.uint16]
States = NDArray[np.int16]

_OPEN, _QUIET = -1, 0
"""Of a key: it depends on the state where it leads; it does nothing in any state. Nothing leads to state 0."""

_PART = 1 << 12
"""So many groups are searched at a time for the last at which something happened: of all properties, then of one."""

SHORT = 2000
"""Up to so many groups are taken one by one."""

TOGETHER = 32
"""From more runs of groups on, of which each waits for the one before, they are taken side by side."""


def _spread(width: int) -> NDArray[np.uint64]:
    """For each byte, its bits so far apart."""
    numbers = np.arange(256, dtype=np.uint64)
    parts = ((numbers >> np.uint64(j) & np.uint64(1)) << np.uint64(width * j) for j in range(8))
    spread: NDArray[np.uint64] = np.bitwise_or.reduce(list(parts))
    return spread


_SPREAD: dict[int, NDArray[Any]] = {4: _spread(4).astype(np.uint32), 8: _spread(8)}


Settings = tuple[Places, Mask]
"""The steps at which a clock is set, ascending, and whether it is started there; else it is stopped."""

Number = TypeVar("Number", int, NDArray[np.int64])

Path = list[tuple[int, int, int]]
"""Steps one after the other: the state before each, its letter, and the state after it."""


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


class _Happens:
    """What happens in a group, by the state before it and its key: how often, and how many steps have then passed."""

    def __init__(self, states: int, width: int) -> None:
        self.counts = np.zeros(states * width, np.uint8)
        self.lasts = np.zeros(states * width, np.uint8)
        self._width = width

    def put(self, keys: Places, steps: Sequence[Mask]) -> None:
        """At each of the `steps` of a group it happens with these states and keys."""
        counts, lasts = (table.reshape(-1, self._width) for table in (self.counts, self.lasts))
        counts[:, keys] = np.sum(steps, 0, np.uint8)
        for number, happens in enumerate(steps, 1):
            state, key = np.nonzero(happens)
            lasts[state, keys[key]] = number


class _Set:
    """At which steps of a group a clock is started and stopped, as bits, by the state before it and its key."""

    def __init__(self, states: int, width: int) -> None:
        self.starts = np.zeros(states * width, np.uint8)
        self.stops = np.zeros(states * width, np.uint8)
        self._width = width

    def put(self, keys: Places, steps: Sequence[tuple[Mask, Mask]]) -> None:
        """At the `steps` of groups it is started, and stopped, with these states and keys."""
        for table, masks in zip((self.starts, self.stops), zip(*steps, strict=True), strict=True):
            bits = sum(mask.astype(np.uint8) << number for number, mask in enumerate(masks))
            table.reshape(-1, self._width)[:, keys] = bits


class Tables:
    """The tables of a machine."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.size = 8 if machine.atoms <= 2 else 4 if machine.atoms <= 4 else 2
        self.width = 256 if machine.atoms <= 1 else 1 << 16
        states = len(machine.states)
        self._after = np.zeros((states, self.width), np.int16)
        self.clocks = [_Set(states, self.width) for _ in machine.clocks]
        self.changes = _Happens(states, self.width)
        self.opens = [_Happens(states, self.width) for _ in machine.opened]
        self._constant = np.zeros(self.width, np.int16)
        self._filled = np.zeros(self.width, np.bool_)
        self._rows: dict[int, list[int]] = {}
        self._table: list[list[int]] = machine.table.tolist()

    def run(self, columns: Sequence[Sequence[Bits]], count: int, before: Sequence[int]) -> Iterator[Passed]:
        """Take `count` steps, at least one, with each of several properties, one after the other, as if they were one.

        `columns` are the atoms of each, in order, and `before` their states, none of which is final.
        """
        return self._groups(columns, before).passed(count)

    def run_clocks(self, atoms: Sequence[Bits], count: int, before: int) -> tuple[Passed, list[Settings]]:
        """As `run`, with one property; and where in these steps each clock is set."""
        groups = self._groups([atoms], [before])
        [passed] = groups.passed(count)
        return passed, [groups.settings(clock, passed.steps) for clock in self.clocks]

    def _groups(self, columns: Sequence[Sequence[Bits]], before: Sequence[int]) -> _Groups:
        """The groups of several properties, whose atoms are in `columns`, and their states `before`."""
        states = np.array(before)
        size, parts = columns[0][0].size, [joined(atom) for atom in zip(*columns, strict=True)]
        places = None if self.machine.restarts else merged(parts, size)
        keys = self._keys([bits.at(places) for bits in parts])
        self._fill(keys)
        firsts = np.arange(len(columns)) * size
        starts = (firsts if places is None else places.searchsorted(firsts)) * (8 // self.size)
        after = self._constant.take(keys)
        after[starts] = self._after[states, keys[starts]]
        at = np.flatnonzero(after != _QUIET)
        if len(at) < len(keys):
            after, keys, starts = after.take(at), keys.take(at), at.searchsorted(starts)
        self._resolve(after, keys)
        index = np.empty(len(at), np.int64)
        index[1:] = after[:-1]
        index[starts] = states
        index *= self.width
        index += keys
        finals, ends = np.flatnonzero(after >= self.machine.first_final), np.append(starts[1:], len(at))
        deciding = np.append(finals, len(at)).take(finals.searchsorted(starts))
        lasts = after.take(ends - 1)
        return _Groups(self, index, at, places, firsts, starts, ends, deciding, lasts)

    def _keys(self, parts: Sequence[NDArray[np.uint8]]) -> Keys:
        """The keys of the bytes in `parts`, one array an atom."""
        if len(parts) == 1:
            return parts[0].astype(np.uint16)
        if len(parts) == 2:
            return parts[0] | parts[1].astype(np.uint16) << np.uint16(8)
        spread = _SPREAD[4 if len(parts) <= 4 else 8]
        keys = spread.take(parts[0])
        for number, part in enumerate(parts[1:], 1):
            keys |= (spread << spread.dtype.type(number)).take(part)
        found: Keys = keys.view(np.uint16)
        return found

    def letter(self, keys: Number, step: int) -> Number:
        """The letter of one step of the groups with these keys."""
        atoms = self.machine.atoms
        if atoms == 2:
            return keys >> step & 1 | (keys >> 8 + step & 1) << 1
        return keys >> step * (16 // self.size if atoms > 2 else 1) & (1 << atoms) - 1

    def _fill(self, keys: Keys) -> None:
        """Fill the tables for `keys`."""
        if len(keys) < SHORT:
            new = np.array([key for key in set(keys.tolist()) if not self._filled[key]], np.int64)
        else:
            occurs = np.zeros(self.width, np.bool_)
            occurs[keys] = True
            new = np.flatnonzero(occurs & ~self._filled)
        if not len(new):
            return
        machine, first = self.machine, np.arange(len(self.machine.states))[:, None]
        state = np.broadcast_to(first, (len(first), len(new)))
        changes: list[Mask] = []
        sets: list[list[tuple[Mask, Mask]]] = [[] for _ in machine.clocks]
        opens: list[list[Mask]] = [[] for _ in machine.opened]
        for step in range(self.size):
            letter = self.letter(new, step)[None, :]
            next_ = machine.table[state, letter]
            changes.append(machine.outputs[state] != machine.outputs[next_])
            for found, opened in zip(opens, machine.opened, strict=True):
                found.append(opened[state, letter])
            for pairs, clock in zip(sets, machine.clocks, strict=True):
                pairs.append((clock.starts[state, letter], clock.stops[state, letter]))
            state = next_
        self._after[:, new], self._filled[new] = state, True
        for happens, found in zip((self.changes, *self.opens), (changes, *opens), strict=True):
            happens.put(new, found)
        for clock_sets, pairs in zip(self.clocks, sets, strict=True):
            clock_sets.put(new, pairs)
        live = slice(1, machine.first_final)
        if machine.first_final > 1:
            ends = state[live]
            constant = np.where((ends == ends[0]).all(0), ends[0], _OPEN)
            done = (changes, *opens, *(masks for pairs in sets for masks in zip(*pairs, strict=True)))
            happens_not = ~np.logical_or.reduce([step[live].any(0) for masks in done for step in masks])
            is_quiet = (ends == first[live]).all(0) & happens_not
            self._constant[new] = np.where(is_quiet, _QUIET, constant)
        else:
            self._constant[new] = _OPEN

    def _resolve(self, after: States, keys: Keys) -> None:
        """Put into `after` what depends on the state before, the longest runs of such groups step by step together."""
        pending = np.flatnonzero(after == _OPEN)
        if not len(pending):
            return
        is_first = np.ones(len(pending), np.bool_)
        is_first[1:] = pending[1:] != pending[:-1] + 1
        numbers = np.flatnonzero(is_first)
        waiting = lengths(numbers, len(pending))
        order = np.argsort(-waiting, kind="stable")
        waiting, at = waiting[order], pending[numbers[order]]
        table, states, done = self._after.reshape(-1), after[at - 1], 0
        while (active := int((-waiting).searchsorted(-done))) > TOGETHER:
            at = at[:active]
            states = table.take(np.multiply(states[:active], self.width, dtype=np.int64) + keys[at])
            after[at] = states
            at += 1
            done += 1
        for first, rest in zip(at[:active].tolist(), (waiting[:active] - done).tolist(), strict=True):
            take = self._one_by_one if rest < SHORT else self._in_lanes
            after[first : first + rest] = take(keys[first : first + rest], int(after[first - 1]))

    def _one_by_one(self, keys: Keys, state: int) -> States:
        states = []
        for key in keys.tolist():
            if key not in self._rows:
                self._rows[key] = self._after[:, key].tolist()
            state = self._rows[key][state]
            states.append(state)
        return np.array(states, np.int16)

    def _in_lanes(self, keys: Keys, state: int) -> States:
        """Lanes side by side from every state, then from one lane to the next, then each from where it begins."""
        table, count = self._after.reshape(-1), len(keys)
        length = max(1, int(count**0.5))
        lanes = -(-count // length)
        padded = np.full(lanes * length, keys[-1], np.int64)
        padded[:count] = keys
        columns = np.ascontiguousarray(padded.reshape(lanes, length).T)
        states = np.repeat(np.arange(len(self._after), dtype=np.int64)[:, None], lanes, 1)
        for column in columns:
            states = table.take(states * self.width + column).astype(np.int64)
        begins = np.empty(lanes, np.int64)
        for lane, ends in enumerate(states.T.tolist()):
            begins[lane], state = state, ends[state]
        found = np.empty((length, lanes), np.int16)
        for number, column in enumerate(columns):
            found[number] = table.take(begins * self.width + column)
            begins = found[number].astype(np.int64)
        return np.ascontiguousarray(found.T).reshape(-1)[:count]

    def path(self, state: int, key: int) -> Path:
        """For each step of a group, the state before it, its letter, and the state after it."""
        found = []
        for step in range(self.size):
            letter = self.letter(key, step)
            after = self._table[state][letter]
            found.append((state, letter, after))
            state = after
        return found


@dataclass(frozen=True, slots=True)
class _Groups:
    """The groups that do something, by their numbers `at`, and their places `index` in the tables.

    They are of the bytes `places`, None for all. Of each property, the byte in `firsts` is the first one, and its
    groups are those from `starts` to before `ends`; that in `deciding` decides it, if it is one of these. Its state
    after all of them is in `lasts`.
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

    def passed(self, count: int) -> Iterator[Passed]:
        """What happened to each property in `count` steps."""
        before = replace(self, ends=np.minimum(self.deciding, self.ends))
        decided = zip(before.all_passed(count), self.deciding.tolist(), self.ends.tolist(), strict=True)
        for number, (passed, group, end) in enumerate(decided):
            yield passed if group >= end else self._until(passed, number, group)

    def settings(self, clock: _Set, count: int) -> Settings:
        """Where a clock is set in the first `count` steps, of one property."""
        starts, stops = clock.starts.take(self.index), clock.stops.take(self.index)
        groups = np.flatnonzero(starts | stops)
        starts, stops = (np.unpackbits(bits[groups], bitorder="little") for bits in (starts, stops))
        at = np.flatnonzero(starts | stops)
        steps = self._first_steps(groups, np.zeros_like(groups)).take(at >> 3) + (at & 7)
        end = int(steps.searchsorted(count))
        return steps[:end], starts[at[:end]].view(np.bool_)

    def all_passed(self, count: int) -> Iterator[Passed]:
        """What happened in the groups of each property, of which none decides it, in `count` steps."""
        changed = self._last_steps(self.tables.changes, self.ends > self.starts)
        counts, opened = [], []
        for opens in self.tables.opens:
            number = self._sums(opens.counts)
            counts.append(number.tolist())
            opened.append(self._last_steps(opens, number > 0))
        each = [list(zip(*of, strict=True)) if of else [()] * len(changed) for of in (counts, opened)]
        for state, change, counted, opening in zip(self.lasts.tolist(), changed, *each, strict=True):
            yield Passed(count, state, change, counted, opening)

    def _until(self, passed: Passed, number: int, group: int) -> Passed:
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

    def _last_steps(self, happens: _Happens, of: Mask) -> list[int]:
        """The last step of each of these properties at which it happens; -1 if there is none."""
        numbers = np.flatnonzero(of)
        groups = self._last_groups(happens.counts, numbers)
        is_found = groups >= 0
        numbers, groups = numbers[is_found], groups[is_found]
        found = np.full(len(of), -1)
        found[numbers] = self._first_steps(groups, numbers) + happens.lasts.take(self.index[groups]) - 1
        return found.tolist()

    def _last_groups(self, table: NDArray[np.uint8], numbers: Places) -> Places:
        """The last group of each property with one of these numbers that has something in `table`; -1: none."""
        starts, ends = self.starts[numbers], self.ends[numbers]
        groups = ends[:, None] - np.arange(1, _PART // max(1, len(numbers)) + 2)
        happens = (table.take(self.index.take(np.maximum(groups, 0))) != 0) & (groups >= starts[:, None])
        is_found = happens.any(1)
        found = np.where(is_found, ends - 1 - happens.argmax(1), -1)
        for number in np.flatnonzero(~is_found).tolist():
            found[number] = self._last_group(table, int(starts[number]), int(ends[number]) - groups.shape[1])
        return found

    def _last_group(self, table: NDArray[np.uint8], first: int, end: int) -> int:
        """The last of the groups from `first` to before `end` that has something in `table`; -1 if there is none."""
        size = _PART
        while end > first:
            start = max(first, end - size)
            hits = np.flatnonzero(table.take(self.index[start:end]))
            if len(hits):
                return start + int(hits[-1])
            end, size = start, min(2 * size, 16 * _PART)
        return -1

    def _first_steps(self, groups: Places, numbers: Places) -> Places:
        """The first steps of groups of the properties with these numbers."""
        bytes_, parts = np.divmod(self.at[groups], 8 // self.tables.size)
        places = bytes_ if self.places is None else self.places[bytes_]
        steps: Places = (places - self.firsts[numbers]) * 8 + parts * self.tables.size
        return steps
