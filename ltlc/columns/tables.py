"""Running a machine over packed columns, several letters at a time.

A *group* is as many steps as have their letters in sixteen bits: eight of one or two atoms, four of three or four, two
of up to eight. Its *key* is these bits; for a machine and a key, tables have where each state leads. They are filled
for keys that occur. Most keys do nothing, or lead to one state from wherever, so that no group waits for another.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ltlc.columns.bits import Bits, Mask, merged
from ltlc.columns.machine import Machine
from ltlc.recordings.blocks import Places

Keys = NDArray[np.uint16]
States = NDArray[np.int16]

_OPEN, _QUIET = -1, 0
"""Of a key: it depends on the state where it leads; it does nothing in any state. Nothing leads to state 0."""

_PART = 1 << 12
"""So many groups are searched at a time for the last at which something happened."""

SHORT = 2000
"""Up to so many groups are taken one by one."""


def _spread(width: int) -> NDArray[np.uint64]:
    """For each byte, its bits so far apart."""
    numbers = np.arange(256, dtype=np.uint64)
    parts = ((numbers >> np.uint64(j) & np.uint64(1)) << np.uint64(width * j) for j in range(8))
    spread: NDArray[np.uint64] = np.bitwise_or.reduce(list(parts))
    return spread


_SPREAD: dict[int, NDArray[Any]] = {4: _spread(4).astype(np.uint32), 8: _spread(8)}


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


class Tables:
    """The tables of a machine."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self._size = 8 if machine.atoms <= 2 else 4 if machine.atoms <= 4 else 2
        self.width = 256 if machine.atoms <= 1 else 1 << 16
        states = len(machine.states)
        self._after = np.zeros((states, self.width), np.int16)
        self.changes = np.zeros((states, self.width), np.bool_)
        self.opens = [np.zeros((states, self.width), np.uint8) for _ in machine.opened]
        self._constant = np.zeros(self.width, np.int16)
        self._filled = np.zeros(self.width, np.bool_)
        self._rows: dict[int, list[int]] = {}
        self._table: list[list[int]] = machine.table.tolist()

    def run(self, columns: Sequence[Bits], count: int, state: int) -> Passed:
        """Take `count` steps, at least one, from `state`, which is not final; `columns` are the atoms, in order."""
        places = merged(columns)
        keys = self._keys([bits.packed if places is None else bits.packed.take(places) for bits in columns])
        self._fill(keys)
        before, after, at = self._chain(keys, state)
        keys = keys if len(at) == len(keys) else keys.take(at)
        finals = after >= self.machine.first_final
        if not finals.any():
            groups = _Groups(self, before, keys, at, places)
            return groups.passed(count, int(after[-1]), [])
        whole = int(finals.argmax())
        path = self.path(int(before[whole]), int(keys[whole]))
        decided = next(step for step, (_, letter, after) in enumerate(path) if after >= self.machine.first_final)
        first = self.first_step(int(at[whole]), places)
        groups = _Groups(self, before[:whole], keys[:whole], at[:whole], places)
        return groups.passed(first + decided, path[decided][0], path[:decided])

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

    def _letter(self, keys: Number, step: int) -> Number:
        """The letter of one step of the groups with these keys."""
        atoms = self.machine.atoms
        if atoms == 2:
            return keys >> step & 1 | (keys >> 8 + step & 1) << 1
        return keys >> step * (16 // self._size if atoms > 2 else 1) & (1 << atoms) - 1

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
        state, changes = np.broadcast_to(first, (len(first), len(new))), np.zeros((len(first), len(new)), np.bool_)
        opens = [np.zeros_like(changes, np.uint8) for _ in machine.opened]
        for step in range(self._size):
            letter = self._letter(new, step)[None, :]
            next_ = machine.table[state, letter]
            changes |= machine.outputs[state] != machine.outputs[next_]
            for found, opened in zip(opens, machine.opened, strict=True):
                found += opened[state, letter]
            state = next_
        self._after[:, new], self.changes[:, new], self._filled[new] = state, changes, True
        for found, table in zip(opens, self.opens, strict=True):
            table[:, new] = found
            changes = changes | (found > 0)
        live = slice(1, machine.first_final)
        if machine.first_final > 1:
            ends = state[live]
            constant = np.where((ends == ends[0]).all(0), ends[0], _OPEN)
            is_quiet = (ends == first[live]).all(0) & ~changes[live].any(0)
            self._constant[new] = np.where(is_quiet, _QUIET, constant)
        else:
            self._constant[new] = _OPEN

    def _chain(self, keys: Keys, state: int) -> tuple[States, States, Places]:
        """The states before and after the groups that do something, and their numbers; right up to the first final."""
        constant = self._constant.take(keys)
        constant[0] = _OPEN  # The state before the first step is no other.
        at = np.flatnonzero(constant != _QUIET)
        after, keys = (constant, keys) if len(at) == len(keys) else (constant.take(at), keys.take(at))
        after = self._one_by_one(keys, state) if len(at) < SHORT else self._resolved(after, keys, state)
        before = np.empty_like(after)
        before[0], before[1:] = state, after[:-1]
        return before, after, at

    def _one_by_one(self, keys: Keys, state: int) -> States:
        states = []
        for key in keys.tolist():
            if key not in self._rows:
                self._rows[key] = self._after[:, key].tolist()
            state = self._rows[key][state]
            states.append(state)
        return np.array(states, np.int16)

    def _resolved(self, after: States, keys: Keys, state: int) -> States:
        """`after`, with what depends on the state before."""
        table = self._after.reshape(-1)
        after[0] = self._after[state, keys[0]]
        pending = np.flatnonzero(after < 0)
        for _ in range(8):
            before = after[pending - 1]
            is_known = before >= 0
            known = pending[is_known]
            after[known] = table.take(before[is_known].astype(np.int64) * self.width + keys[known])
            pending = pending[~is_known]
            if not len(pending):
                return after
        return self._in_lanes(keys, state) if len(pending) > SHORT else self._rest(after, keys, pending)

    def _rest(self, after: States, keys: Keys, pending: Places) -> States:
        for number in pending.tolist():
            after[number] = self._after[after[number - 1], keys[number]]
        return after

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

    def first_step(self, group: int, places: Places | None) -> int:
        """The first step of a group; `places` are the bytes that there are groups of, None for all."""
        byte, part = divmod(group, 8 // self._size)
        return (byte if places is None else int(places[byte])) * 8 + part * self._size

    def path(self, state: int, key: int) -> Path:
        """For each step of a group, the state before it, its letter, and the state after it."""
        found = []
        for step in range(self._size):
            letter = self._letter(key, step)
            after = self._table[state][letter]
            found.append((state, letter, after))
            state = after
        return found


@dataclass(frozen=True, slots=True)
class _Groups:
    """The groups that do something, by their numbers `at`: the states before them, and their keys."""

    tables: Tables
    before: States
    keys: Keys
    at: Places
    places: Places | None

    def passed(self, steps: int, state: int, rest: Path) -> Passed:
        """What happened in them, and then along `rest`, to the step with the number `steps`."""
        machine, tables = self.tables.machine, self.tables
        index = self.before.astype(np.int64)
        index *= tables.width
        index += self.keys
        outputs = machine.outputs

        def changes(state: int, _: int, after: int) -> bool:
            return bool(outputs[state] != outputs[after])

        changed = self._last(index, tables.changes, steps, rest, changes)
        counts, opened = [], []
        for table, opens in zip(tables.opens, machine.opened, strict=True):

            def opening(state: int, letter: int, _: int, opens: Mask = opens) -> bool:
                return bool(opens[state, letter])

            found = table.reshape(-1).take(index)
            counts.append(int(found.sum()) + sum(opening(*step) for step in rest))
            opened.append(self._last(index, table, steps, rest, opening) if counts[-1] else -1)
        return Passed(steps, state, changed, tuple(counts), tuple(opened))

    def _last(
        self, index: NDArray[np.int64], table: NDArray[Any], steps: int, rest: Path, happens: Callable[..., bool]
    ) -> int:
        """The last step at which something `happens`, in a group that `table` tells, or in the `rest`; or -1."""
        for number in reversed(range(len(rest))):
            if happens(*rest[number]):
                return steps - len(rest) + number
        for end in range(len(index), 0, -_PART):
            start = max(0, end - _PART)
            found = np.flatnonzero(table.reshape(-1).take(index[start:end]))
            if len(found):
                group = start + int(found[-1])
                path = self.tables.path(int(self.before[group]), int(self.keys[group]))
                last = max(number for number, step in enumerate(path) if happens(*step))
                return self.tables.first_step(int(self.at[group]), self.places) + last
        return -1
