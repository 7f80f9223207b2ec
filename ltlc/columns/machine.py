"""A property as one table: its monitor and which of its scopes are open, by letters as numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ltlc.columns.bits import Mask
from ltlc.columns.values import predicate
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor, Target

Letters = NDArray[np.int64]
"""A number for each letter, by the number of the letter: bit i says whether atom i holds."""

MOST_ATOMS = 8
MOST_STATES = 64


@dataclass(frozen=True, slots=True)
class Slot:
    """A scope of a property: when it opens and closes, and the number of the scope it is in the body of, or None."""

    opening: Formula
    closing: Formula | None
    overlapping: bool
    parent: int | None


@dataclass(frozen=True)
class Machine:
    """`table[q, letter]` is the state after a letter, `opened[i][q, letter]` whether an episode of slot i opens.

    State 0 is that before the first step. Of each state, `states` has the monitor's and, as bits, the open slots;
    `outputs` numbers its verdict, -1 before the first step. The permanent states come last, from `first_final` on.
    """

    atoms: int
    table: NDArray[np.int64]
    opened: tuple[Mask, ...]
    states: tuple[tuple[int, int], ...]
    outputs: NDArray[np.int64]
    first_final: int
    allowed: Mask
    numbers: Mapping[tuple[int, int], int] = field(repr=False, default_factory=dict)

    @cached_property
    def stutters(self) -> bool:
        """Whether a letter that comes again changes nothing, and opens nothing."""
        letters = np.arange(self.table.shape[1])
        again = self.table[self.table, letters]
        opens = np.zeros_like(again, np.bool_)
        for opened in self.opened:
            opens |= opened[self.table, letters]
        return bool(((again == self.table) & ~opens)[:, self.allowed].all())


def machine(monitor: Monitor, alphabet: Alphabet, slots: Sequence[Slot]) -> Machine | None:
    """The machine of a property; None if it would be too large."""
    if len(alphabet.atoms) > MOST_ATOMS:
        return None
    holds = _holds(alphabet)
    edges = _edges(monitor, holds)
    events = [_events(slot, holds) for slot in slots]
    states, table, opened = [(-1, 0)], [], []
    numbers = {(-1, 0): 0}
    for state, open_ in states:
        after = edges[max(state, 0)]
        bits, opens = _scopes(open_, slots, events, len(after))
        is_final = np.array([verdict.is_permanent for verdict in monitor.verdicts])
        if state >= 0 and is_final[state]:
            after, opens = np.full_like(after, state), np.zeros_like(opens)
        bits = np.where(is_final[after], 0, bits)
        row = []
        for next_ in zip(after.tolist(), bits.tolist(), strict=True):
            if next_ not in numbers:
                numbers[next_] = len(states)
                states.append(next_)
            row.append(numbers[next_])
        if len(states) > MOST_STATES:
            return None
        table.append(row)
        opened.append(opens)
    return _ordered(monitor, alphabet, holds, states, np.array(table), np.array(opened))


def _holds(alphabet: Alphabet) -> dict[str, Mask]:
    """For each atom, the letters in which it holds."""
    letters = np.arange(1 << len(alphabet.atoms))
    return {atom: (letters >> number & 1).astype(np.bool_) for number, atom in enumerate(alphabet.atoms)}


def _edges(monitor: Monitor, holds: Mapping[str, Mask]) -> list[Letters]:
    """For each state of the monitor, where each letter leads."""
    known: dict[Target, Letters] = {}
    count = len(next(iter(holds.values()), np.zeros(1)))

    def targets(target: Target) -> Letters:
        if target >= 0:
            return np.full(count, target)
        if target not in known:
            atom, low, high = monitor.decisions[~target]
            known[target] = np.where(holds[monitor.atoms[atom]], targets(high), targets(low))
        return known[target]

    return [targets(edge) for edge in monitor.edges]


def _events(slot: Slot, holds: dict[str, Mask]) -> tuple[Mask, Mask]:
    """The letters at which a slot opens, and closes."""
    count = len(next(iter(holds.values()), np.zeros(1)))
    closes = np.zeros(count, np.bool_) if slot.closing is None else predicate(slot.closing, holds)
    return np.broadcast_to(predicate(slot.opening, holds), count), np.broadcast_to(closes, count)


def _scopes(open_: int, slots: Sequence[Slot], events: Sequence[tuple[Mask, Mask]], count: int) -> tuple[Letters, Mask]:
    """After each of the `count` letters, which slots are open, as bits, and which have opened that were closed.

    As `Episodes.step` does it. A slot stands after that in the body of which it is.
    """
    began = np.zeros((len(slots), count), np.bool_)
    stepped: list[Mask] = []
    is_open: list[Mask] = []
    is_new: list[Mask] = []
    for number, (slot, (opening, closing)) in enumerate(zip(slots, events, strict=True)):
        was_open = np.full(count, bool(open_ >> number & 1))
        steps, new = np.ones(count, np.bool_), np.zeros(count, np.bool_)
        if slot.parent is not None:
            steps = stepped[slot.parent] & is_open[slot.parent]
            new = is_new[slot.parent] | began[slot.parent]
        was_open &= ~new
        began[number] = steps & ~closing & opening & ~was_open
        stepped.append(steps)
        is_new.append(new)
        is_open.append((was_open & ~(steps & closing)) | began[number])
    bits = sum((mask.astype(np.int64) << number for number, mask in enumerate(is_open)), np.zeros(count, np.int64))
    return bits, began


def _ordered(
    monitor: Monitor,
    alphabet: Alphabet,
    holds: Mapping[str, Mask],
    states: Sequence[tuple[int, int]],
    table: NDArray[np.int64],
    opened: Mask,
) -> Machine:
    """The machine, its permanent states last."""
    kinds = [-1 if state < 0 else list(type(monitor.verdicts[0])).index(monitor.verdicts[state]) for state, _ in states]
    finals = [state >= 0 and monitor.verdicts[state].is_permanent for state, _ in states]
    order = sorted(range(len(states)), key=finals.__getitem__)
    place = np.argsort(order)
    kept = tuple(states[number] for number in order)
    return Machine(
        len(alphabet.atoms),
        place[table[order]],
        tuple(np.ascontiguousarray(opened[order, slot]) for slot in range(opened.shape[1])),
        kept,
        np.array(kinds)[order],
        finals.count(False),
        _allowed(alphabet, holds),
        {state: number for number, state in enumerate(kept)},
    )


def _allowed(alphabet: Alphabet, holds: Mapping[str, Mask]) -> Mask:
    """The letters that exist."""
    count = len(next(iter(holds.values()), np.zeros(1)))
    allowed = np.ones(count, np.bool_)
    for group in alphabet.groups:
        numbers = [sum(1 << n for n, atom in enumerate(group.atoms) if atom in v) for v in group.valuations]
        code = sum((holds[atom].astype(np.int64) << n for n, atom in enumerate(group.atoms)), np.zeros(count, np.int64))
        allowed &= np.isin(code, numbers)
    return allowed
