"""The tables of a machine: what comes of several letters at a time.

A *group* is as many steps as have their letters in sixteen bits: eight of one or two atoms, four of three or four, two
of up to eight. Its *key* is these bits; for a machine and a key, tables have where each state leads. They are filled
for keys that occur. Most keys do nothing, or lead to one state from wherever, so that no group waits for another.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ltlc.inputs.recordings.blocks import Places
from ltlc.monitoring.columns.bits import Bytes, Mask
from ltlc.monitoring.columns.machine import Machine

Keys = NDArray[np.uint16]
States = NDArray[np.int16]

OPEN, QUIET = -1, 0
"""Of a key: it depends on the state where it leads; it does nothing in any state. Nothing leads to state 0."""

SHORT = 2000
"""Up to so many keys are looked at one by one."""


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


class Happens:
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


class Sets:
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
    """The tables of a machine, filled for keys that have occurred.

    `after` has where each state leads, `constant` where a key leads from any state, or `OPEN`, or `QUIET`. `clocks`,
    `changes`, `opens` and `returns` say at which steps of a group clocks are set, the verdict changes, a scope opens,
    and a slice is kept again that need not be kept. If `pausing` makes the machine with pauses, these are its tables,
    or there are tables of that for where a clock comes due.
    """

    def __init__(self, machine: Machine, pausing: Callable[[], Machine | None] | None = None) -> None:
        self.machine = machine
        self._pausing = pausing
        self.size = 8 if machine.atoms <= 2 else 4 if machine.atoms <= 4 else 2
        self.width = 256 if machine.atoms <= 1 else 1 << 16
        states = len(machine.states)
        self.after = np.zeros((states, self.width), np.int16)
        self.clocks = [Sets(states, self.width) for _ in machine.clocks]
        self.changes = Happens(states, self.width)
        self.opens = [Happens(states, self.width) for _ in machine.opened]
        self.returns = Happens(states, self.width) if machine.as_new.any() else None
        self.constant = np.zeros(self.width, np.int16)
        self._filled = np.zeros(self.width, np.bool_)
        self._rows: dict[int, list[int]] = {}
        self._table: list[list[int]] = machine.table.tolist()

    @cached_property
    def pausing(self) -> Tables | None:
        """Tables of the machine with pauses, if there is one beside this."""
        found = None if self._pausing is None or self.machine.pause else self._pausing()
        return None if found is None else Tables(found)

    @cached_property
    def lasting(self) -> Tables:
        """The same, except that no step leads to a permanent state: it changes nothing."""
        return Tables(self.machine.lasting)

    def keys(self, parts: Sequence[Bytes]) -> Keys:
        """The keys of the bytes in `parts`, one array an atom; the tables are filled for them."""
        keys = self._joined(parts)
        self._fill(keys)
        return keys

    def row(self, key: int) -> list[int]:
        """Where a key leads from each state."""
        if key not in self._rows:
            self._rows[key] = self.after[:, key].tolist()
        return self._rows[key]

    def _joined(self, parts: Sequence[Bytes]) -> Keys:
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
        returns: list[Mask] = []
        for step in range(self.size):
            letter = self.letter(new, step)[None, :]
            next_ = machine.table[state, letter]
            changes.append(machine.outputs[state] != machine.outputs[next_])
            for found, opened in zip(opens, machine.opened, strict=True):
                found.append(opened[state, letter])
            returns.append(machine.returns[state, letter])
            for pairs, clock in zip(sets, machine.clocks, strict=True):
                pairs.append((clock.starts[state, letter], clock.stops[state, letter]))
            state = next_
        self.after[:, new], self._filled[new] = state, True
        for happens, found in zip((self.changes, *self.opens), (changes, *opens), strict=True):
            happens.put(new, found)
        if self.returns is not None:
            self.returns.put(new, returns)
        for clock_sets, pairs in zip(self.clocks, sets, strict=True):
            clock_sets.put(new, pairs)
        live = slice(1, machine.first_final)
        if machine.first_final > 1:
            ends = state[live]
            constant = np.where((ends == ends[0]).all(0), ends[0], OPEN)
            done = (changes, returns, *opens, *(masks for pairs in sets for masks in zip(*pairs, strict=True)))
            happens_not = ~np.logical_or.reduce([step[live].any(0) for masks in done for step in masks])
            is_quiet = (ends == first[live]).all(0) & happens_not
            self.constant[new] = np.where(is_quiet, QUIET, constant)
        else:
            self.constant[new] = OPEN

    def path(self, state: int, key: int) -> Path:
        """For each step of a group, the state before it, its letter, and the state after it."""
        found = []
        for step in range(self.size):
            letter = self.letter(key, step)
            after = self._table[state][letter]
            found.append((state, letter, after))
            state = after
        return found
