"""Following a machine over packed columns, a group of letters after the other: where each leads."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ltlc.inputs.recordings.blocks import Places
from ltlc.monitoring.columns.bits import Bits, joined, lengths, merged
from ltlc.monitoring.columns.groups import Groups, Passed, Settings
from ltlc.monitoring.columns.tables import OPEN, QUIET, Keys, States, Tables

SHORT = 2000
"""Up to so many groups are taken one by one."""

TOGETHER = 32
"""From more runs of groups on, of which each waits for the one before, they are taken side by side."""


def run(tables: Tables, columns: Sequence[Sequence[Bits]], count: int, before: Sequence[int]) -> Iterator[Passed]:
    """Take `count` steps, at least one, with several properties that have these tables, as if they were one.

    `columns` are the atoms of each, in order, and `before` their states, none of which is final.
    """
    return _groups(tables, columns, before).passed(count)


def run_clocks(tables: Tables, atoms: Sequence[Bits], count: int, before: int) -> tuple[Passed, list[Settings]]:
    """As `run`, with one property; and where in these steps each clock is set."""
    groups = _groups(tables, [atoms], [before])
    [passed] = groups.passed(count)
    return passed, [groups.settings(clock, np.array([passed.steps])) for clock in tables.clocks]


def _groups(tables: Tables, columns: Sequence[Sequence[Bits]], before: Sequence[int]) -> Groups:
    """The groups of several properties, whose atoms are in `columns`, and their states `before`."""
    size, parts = columns[0][0].size, [joined(atom) for atom in zip(*columns, strict=True)]
    is_whole = tables.machine.restarts or not tables.machine.stutters
    places = None if is_whole else merged(parts, size)
    keys = tables.keys([bits.at(places) for bits in parts])
    return groups_of(tables, keys, places, np.arange(len(columns)) * size, np.array(before))


def groups_of(tables: Tables, keys: Keys, places: Places | None, firsts: Places, states: States) -> Groups:
    """The groups with these `keys` of several properties, or slices of one, that are in these `states` before.

    They are of the bytes `places`, None for all; `firsts` are the first ones of each.
    """
    starts = (firsts if places is None else places.searchsorted(firsts)) * (8 // tables.size)
    after = tables.constant.take(keys)
    after[starts] = tables.after.reshape(-1).take(np.multiply(states, tables.width, dtype=np.int64) + keys.take(starts))
    at = np.flatnonzero(after != QUIET)
    if len(at) < len(keys):
        after, keys, starts = after.take(at), keys.take(at), at.searchsorted(starts)
    _resolve(tables, after, keys)
    index = np.empty(len(at), np.int64)
    index[1:] = after[:-1]
    index[starts] = states
    index *= tables.width
    index += keys
    finals, ends = np.flatnonzero(after >= tables.machine.first_final), np.append(starts[1:], len(at))
    final = np.append(finals, len(at)).take(finals.searchsorted(starts))
    deciding = np.where(final < ends, final, -1)
    lasts = after.take(ends - 1)
    return Groups(tables, index, at, places, firsts, starts, np.minimum(final, ends), deciding, lasts)


def _resolve(tables: Tables, after: States, keys: Keys) -> None:
    """Put into `after` what depends on the state before, the longest runs of such groups step by step together."""
    pending = np.flatnonzero(after == OPEN)
    if not len(pending):
        return
    is_first = np.ones(len(pending), np.bool_)
    is_first[1:] = pending[1:] != pending[:-1] + 1
    numbers = np.flatnonzero(is_first)
    waiting = lengths(numbers, len(pending))
    order = np.argsort(-waiting, kind="stable")
    waiting, at = waiting[order], pending[numbers[order]]
    table, states, done = tables.after.reshape(-1), after[at - 1], 0
    while (active := int((-waiting).searchsorted(-done))) > TOGETHER:
        at = at[:active]
        states = table.take(np.multiply(states[:active], tables.width, dtype=np.int64) + keys[at])
        after[at] = states
        at += 1
        done += 1
    for first, rest in zip(at[:active].tolist(), (waiting[:active] - done).tolist(), strict=True):
        take = _one_by_one if rest < SHORT else _in_lanes
        after[first : first + rest] = take(tables, keys[first : first + rest], int(after[first - 1]))


def _one_by_one(tables: Tables, keys: Keys, state: int) -> States:
    states = []
    for key in keys.tolist():
        state = tables.row(key)[state]
        states.append(state)
    return np.array(states, np.int16)


def _in_lanes(tables: Tables, keys: Keys, state: int) -> States:
    """Lanes side by side from every state, then from one lane to the next, then each from where it begins."""
    table, count = tables.after.reshape(-1), len(keys)
    length = max(1, int(count**0.5))
    lanes = -(-count // length)
    padded = np.full(lanes * length, keys[-1], np.int64)
    padded[:count] = keys
    columns = np.ascontiguousarray(padded.reshape(lanes, length).T)
    states = np.repeat(np.arange(len(tables.after), dtype=np.int64)[:, None], lanes, 1)
    for column in columns:
        states = table.take(states * tables.width + column).astype(np.int64)
    begins = np.empty(lanes, np.int64)
    for lane, ends in enumerate(states.T.tolist()):
        begins[lane], state = state, ends[state]
    found = np.empty((length, lanes), np.int16)
    for number, column in enumerate(columns):
        found[number] = table.take(begins * tables.width + column)
        begins = found[number].astype(np.int64)
    return np.ascontiguousarray(found.T).reshape(-1)[:count]
