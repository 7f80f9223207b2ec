"""A property as one table: its monitor and which of its scopes are open, by letters as numbers.

Of a property with clocks, the table has the results of steps as long as no clock comes due, and when clocks are set.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ltlc.dataclass import dataclass
from ltlc.monitoring.columns.bits import Mask
from ltlc.monitoring.columns.values import predicate
from ltlc.program.machine import Base, Outcome, State
from ltlc.program.properties import Question
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Decision, Target
from ltlc.semantics.verdicts import Verdict

Letters = NDArray[np.int64]
"""A number for each letter, by the number of the letter: bit i is whether atom i holds."""

MOST_ATOMS = 8
MOST_STATES = 64
MOST_DURATION = 1 << 60
"""Of a clock, in ns: a time and that are still an integer of 64 bits."""


class Control(NamedTuple):
    """What a lowered machine does with the letters of its property, which its decisions ask by `questions`.

    Of each clock that is an age, `clocks` has the atom that says that a message has come, and the duration; of a count,
    the atom that it is not late. A slice of a run in one of the states `as_new` need not be kept.
    """

    questions: tuple[Question, ...]
    clocks: tuple[tuple[str, Nanoseconds] | str | None, ...]
    states: tuple[State, ...]
    decisions: tuple[Decision, ...]
    outcomes: tuple[Outcome, ...]
    as_new: frozenset[int]

    def asked(self, number: int) -> Question | None:
        """What a decision asks of a letter; None if it asks about a clock whose lateness letters do not give."""
        if number < len(self.questions):
            return self.questions[number]
        clock = self.clocks[number - len(self.questions)]
        return Question(clock, False) if isinstance(clock, str) else None


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


@dataclass(frozen=True, slots=True)
class Setting:
    """Where a clock is set, to be due a `duration` in ns after the step, and where it is stopped."""

    starts: Mask
    stops: Mask
    duration: int


@dataclass(frozen=True)
class Machine:
    """`table[q, letter]` is the state after a letter, `opened[i][q, letter]` whether an episode of slot i opens.

    State 0 is that before the first step. Of each state, `states` has the monitor's and, as bits, the open slots;
    `outputs` numbers its verdict, -1 before the first step. The permanent states come last, from `first_final` on. The
    masks of `clocks` are by `[q, letter]`, too. A slice of a run need not be kept in those that are `as_new`.
    """

    atoms: int
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


def machine(
    control: Control, atoms: Sequence[str], news: Collection[str], alphabet: Alphabet, slots: Sequence[Slot]
) -> Machine | None:
    """The machine of a property with these `atoms`, of which those in `news` hold at steps only.

    None if it would be too large, or if there is more to its clocks than a machine has.
    """
    if len(atoms) > MOST_ATOMS:
        return None
    holds = _holds(atoms)
    allowed = _allowed(alphabet, holds)
    steps = _outcomes(control, [state.step for state in control.states], holds)
    edges = np.array([outcome.state for outcome in control.outcomes])[steps]
    held = {**holds, **{name: np.zeros_like(allowed) for name in news}}
    verdicts = [state.verdict for state in control.states]
    is_final = np.array([verdict.is_permanent for verdict in verdicts])
    clocks, settles = _settings(control, steps, holds), _settles(control, steps, edges, held) | is_final[edges]
    if clocks is None or not settles[:, allowed].all():
        return None
    events = [_events(slot, holds) for slot in slots]
    states, table, opened = [(-1, 0)], [], []
    goes_on = (edges[is_final] != np.flatnonzero(is_final)[:, None]).any()  # after a violation
    if control.clocks or goes_on:  # Clocks that come due lead to states that steps alone do not, and so do violations.
        states += [(state, bits) for state in range(len(is_final)) for bits in range(1 << len(slots))]
    numbers = {state: number for number, state in enumerate(states)}
    for state, open_ in states:
        after = edges[max(state, 0)]
        bits, opens = _scopes(open_, slots, events, len(after))
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
    return _ordered(verdicts, allowed, states, np.array(table), np.array(opened), clocks, control.as_new)


def _holds(atoms: Sequence[str]) -> dict[str, Mask]:
    """For each atom, the letters in which it holds."""
    letters = np.arange(1 << len(atoms))
    return {atom: (letters >> number & 1).astype(np.bool_) for number, atom in enumerate(atoms)}


def _outcomes(control: Control, targets: Sequence[Target], holds: Mapping[str, Mask]) -> NDArray[np.int64]:
    """For each of the `targets`, the number of the outcome of each letter, if no clock is late."""
    known: dict[Target, Letters] = {}
    count = len(next(iter(holds.values()), np.zeros(1)))

    def outcomes(target: Target) -> Letters:
        if target >= 0:
            return np.full(count, target)
        if target not in known:
            number, low, high = control.decisions[~target]
            asked = control.asked(number)
            is_high = asked is not None and holds[asked.name] == asked.holds
            known[target] = np.where(is_high, outcomes(high), outcomes(low))
        return known[target]

    return np.array([outcomes(target) for target in targets])


def _settles(control: Control, steps: NDArray[np.int64], edges: NDArray[np.int64], held: Mapping[str, Mask]) -> Mask:
    """For each state of the machine and each letter, whether no clock step that comes by itself changes anything."""
    again = np.array([outcome.again for outcome in control.outcomes])[steps]
    if not again.any():
        return np.ones_like(again)
    # Where none comes, it is not looked at where one would lead.
    expire = [0 if state.expire is None else state.expire for state in control.states]
    then = _outcomes(control, expire, held)[edges, np.arange(edges.shape[1])]
    changes = np.array([bool(outcome.sets) or outcome.again for outcome in control.outcomes])
    states = np.array([outcome.state for outcome in control.outcomes])
    settles: Mask = ~again | (~changes[then] & (states[then] == edges))
    return settles


def _settings(control: Control, steps: NDArray[np.int64], holds: Mapping[str, Mask]) -> list[Setting] | None:
    """For each clock but counts, where it is set, by the states of the machine; None if one is set in several ways.

    An age is set where a message has come. While it is late, there is more to steps than a machine has.
    """
    found = []
    for clock, kind in enumerate(control.clocks):
        if isinstance(kind, str):
            continue
        if kind is not None:
            news, duration = kind
            heard = np.broadcast_to(holds[news], steps.shape)
            found.append(Setting(heard, np.zeros_like(heard), duration))
            continue
        sets = [each for outcome in control.outcomes for each in outcome.sets if each.clock == clock]
        durations = {each.duration for each in sets if each.base is not Base.NEVER}
        has_several = len(durations) > 1 or any(each.base is Base.DUE for each in sets)
        if has_several or max(durations, default=0) > MOST_DURATION:
            return None
        starts = np.array([_sets(each, clock, {Base.NOW, Base.JUST_BEFORE}) for each in control.outcomes])
        stops = np.array([_sets(each, clock, {Base.NEVER}) for each in control.outcomes])
        found.append(Setting(starts[steps], stops[steps], max(durations, default=0)))
    return found


def _sets(outcome: Outcome, clock: int, bases: Collection[Base]) -> bool:
    return any(each.clock == clock and each.base in bases for each in outcome.sets)


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
    verdicts: Sequence[Verdict],
    allowed: Mask,
    states: Sequence[tuple[int, int]],
    table: NDArray[np.int64],
    opened: Mask,
    clocks: Sequence[Setting],
    as_new: Collection[int],
) -> Machine:
    """The machine, its permanent states last."""
    kinds = [-1 if state < 0 else list(Verdict).index(verdicts[state]) for state, _ in states]
    finals = [state >= 0 and verdicts[state].is_permanent for state, _ in states]
    order = sorted(range(len(states)), key=finals.__getitem__)
    place = np.argsort(order)
    kept = tuple(states[number] for number in order)
    of = [max(state, 0) for state, _ in kept]
    return Machine(
        len(allowed).bit_length() - 1,
        place[table[order]],
        tuple(np.ascontiguousarray(opened[order, slot]) for slot in range(opened.shape[1])),
        kept,
        np.array(kinds)[order],
        finals.count(False),
        allowed,
        tuple(Setting(clock.starts[of], clock.stops[of], clock.duration) for clock in clocks),
        np.array([state in as_new for state, _ in kept]),
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
