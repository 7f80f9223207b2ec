"""A property as one table: its monitor and which of its scopes are open, by letters as numbers.

Of a property with clocks, the table has the results of steps, and when clocks are set. Where clock steps come by
themselves that change something, letters have a pause, and the table what comes in it (`pauses`); otherwise it is said
of as long as no clock comes due.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ltlc.dataclass import dataclass
from ltlc.monitoring.columns.bits import Mask
from ltlc.monitoring.columns.control import Control, Letters
from ltlc.monitoring.columns.pauses import Rows, Setting, pauses_of, rows_of
from ltlc.monitoring.columns.values import predicate
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.ltl import Formula
from ltlc.semantics.verdicts import Verdict

MOST_ATOMS = 8
MOST_STATES = 64

LEFT = (-2, 0)
"""The state after a step that is left to the monitor."""


@dataclass(frozen=True, slots=True)
class Slot:
    """A scope of a property: when it opens and closes, and the number of the scope it is in the body of, or None."""

    opening: Formula
    closing: Formula | None
    overlapping: bool
    parent: int | None

    @property
    def events(self) -> tuple[Formula, ...]:
        """What opens it, and what closes it, if anything does."""
        return (self.opening,) if self.closing is None else (self.opening, self.closing)


@dataclass(frozen=True)
class Machine:
    """`table[q, letter]` is the state after a letter, `opened[i][q, letter]` whether an episode of slot i opens.

    State 0 is that before the first step. Of each state, `states` has the monitor's and, as bits, the open slots;
    `outputs` numbers its verdict, -1 before the first step. The permanent states come last, from `first_final` on, and
    so does that after a step that is left to the monitor. The masks of `clocks` are by `[q, letter]`, too. A slice of a
    run need not be kept in those that are `as_new`. Of the bits of a letter, `atoms`, the last ones are a pause.
    """

    atoms: int
    pause: int
    table: NDArray[np.int64]
    opened: tuple[Mask, ...]
    states: tuple[tuple[int, int], ...]
    outputs: NDArray[np.int64]
    first_final: int
    allowed: Mask
    clocks: tuple[Setting, ...]
    as_new: Mask
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

    @cached_property
    def returns(self) -> Mask:
        """By state and letter, whether a slice that need not be kept is kept from this step on."""
        return self.as_new[:, None] & ~self.as_new[self.table]

    @cached_property
    def rests(self) -> bool:
        """Whether no clock runs where a slice need not be kept, unless one has come due."""
        runs, before = np.zeros(len(self.states), np.bool_), None
        while before is None or (runs != before).any():
            before = runs.copy()
            for clock in self.clocks:
                np.logical_or.at(runs, self.table, clock.starts | (before[:, None] & ~clock.stops))
        return not (runs & self.as_new).any()

    @cached_property
    def restarts(self) -> bool:
        """Whether a letter that comes again starts a clock."""
        letters = np.arange(self.table.shape[1])
        return any(clock.starts[self.table, letters][:, self.allowed].any() for clock in self.clocks)

    @cached_property
    def lasting(self) -> Machine:
        """The same, except that no step leads to a permanent state: it changes nothing."""
        is_final = self.table >= self.first_final
        clocks = [replace(c, starts=c.starts & ~is_final, stops=c.stops & ~is_final) for c in self.clocks]
        stays = np.arange(len(self.table))[:, None]
        return replace(self, table=np.where(is_final, stays, self.table), clocks=tuple(clocks))


def machine(
    control: Control,
    atoms: Sequence[str],
    news: Collection[str],
    alphabet: Alphabet,
    slots: Sequence[Slot],
    *,
    has_pauses: bool = False,
) -> Machine | None:
    """The machine of a property with these `atoms`, of which those in `news` hold at steps only.

    None if it would be too large, or if there is more to its clocks than a machine has, with pauses or without.
    """
    pause = (pauses_of(control) - 1).bit_length() if has_pauses else 0
    if len(atoms) + pause > MOST_ATOMS:
        return None
    letters = np.arange(1 << (len(atoms) + pause))
    holds = {atom: (letters >> number & 1).astype(np.bool_) for number, atom in enumerate(atoms)}
    held, pauses = {**holds, **{name: np.zeros_like(letters, np.bool_) for name in news}}, letters >> len(atoms)
    allowed = _allowed(alphabet, holds, len(letters)) & (pauses < pauses_of(control))
    rows = rows_of(control, holds, held, pauses)
    if rows is None or not (has_pauses or rows.settles[:, allowed].all()):
        return None
    events = [_events(slot, holds, len(letters)) for slot in slots]
    found = _machine(control, rows, allowed, pause, slots, events)
    return found if found is None or found.stutters or has_pauses else None


def _machine(
    control: Control, rows: Rows, allowed: Mask, pause: int, slots: Sequence[Slot], events: Sequence[tuple[Mask, Mask]]
) -> Machine | None:
    """The machine of these `rows`, in which scopes have the `events`."""
    edges, is_final = rows.states, np.array([state.verdict.is_permanent for state in control.states])
    states, table, opened = [(-1, 0)], [], []
    goes_on = (edges[is_final] != np.flatnonzero(is_final)[:, None]).any()  # after a violation
    if control.clocks or goes_on:  # Clocks that come due lead to states that steps alone do not, and so do violations.
        states += [(state, bits) for state in range(len(is_final)) for bits in range(1 << len(slots))]
    numbers = {state: number for number, state in enumerate(states)}
    for state, open_ in states:
        after = edges[max(state, 0)]
        bits, opens = _scopes(open_, slots, events, len(after))
        if state == LEFT[0] or (state >= 0 and is_final[state]):
            after, opens = np.full_like(after, state), np.zeros_like(opens)
        else:
            after = np.where(rows.left[max(state, 0)] & ~is_final[after] & allowed, LEFT[0], after)
        bits = np.where(is_final[after] | (after == LEFT[0]), 0, bits)
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
    verdicts = [each.verdict for each in control.states]
    return _ordered(verdicts, allowed, pause, states, np.array(table), np.array(opened), rows.clocks, control.as_new)


def _events(slot: Slot, holds: dict[str, Mask], count: int) -> tuple[Mask, Mask]:
    """Those of the `count` letters at which a slot opens, and closes."""
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
    verdicts: Sequence[Verdict],
    allowed: Mask,
    pause: int,
    states: Sequence[tuple[int, int]],
    table: NDArray[np.int64],
    opened: Mask,
    clocks: Sequence[Setting],
    as_new: Collection[int],
) -> Machine:
    """The machine, its permanent states last."""
    kinds = [-1 if state < 0 else list(Verdict).index(verdicts[state]) for state, _ in states]
    finals = [state == LEFT[0] or (state >= 0 and verdicts[state].is_permanent) for state, _ in states]
    order = sorted(range(len(states)), key=finals.__getitem__)
    place = np.argsort(order)
    kept = tuple(states[number] for number in order)
    of = [max(state, 0) for state, _ in kept]
    return Machine(
        len(allowed).bit_length() - 1,
        pause,
        place[table[order]],
        tuple(np.ascontiguousarray(opened[order, slot]) for slot in range(opened.shape[1])),
        kept,
        np.array(kinds)[order],
        finals.count(False),
        allowed,
        tuple(replace(each, starts=each.starts[of], stops=each.stops[of]) for each in clocks),
        np.array([state in as_new for state, _ in kept]),
        {state: number for number, state in enumerate(kept)},
    )


def _allowed(alphabet: Alphabet, holds: Mapping[str, Mask], count: int) -> Mask:
    """Those of the `count` letters that exist."""
    allowed = np.ones(count, np.bool_)
    for group in alphabet.groups:
        numbers = [sum(1 << n for n, atom in enumerate(group.atoms) if atom in v) for v in group.valuations]
        code = sum((holds[atom].astype(np.int64) << n for n, atom in enumerate(group.atoms)), np.zeros(count, np.int64))
        allowed &= np.isin(code, numbers)
    return allowed
