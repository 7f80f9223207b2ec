"""Values at openings along a run: what they are at each of its steps, by the definition of what opens scopes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ltlc.inputs.recordings.blocks import Places
from ltlc.monitoring.columns.bits import Mask
from ltlc.monitoring.columns.kept import FIRST, inputs_at, with_taken
from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.series import Given, Steps, UnsupportedError
from ltlc.monitoring.columns.values import not_numbers, value
from ltlc.monitoring.opened import Opened
from ltlc.runtime.sampling import Input, Value
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.properties import predicates
from ltlc.semantics.timed_atoms import Age, atoms_within, clock_operands, news_that_counts
from ltlc.specification.specification import PropertySpecification


class Registers:
    """The values at openings of one property, along a run that comes in parts.

    While a scope is open after the step before, its value is that at the step which opened it; else it is the latest.
    """

    def __init__(self, of: PropertySpecification, prepared: Prepared) -> None:
        """Before the first step. Raises UnsupportedError."""
        events = [event for clock in of.openings().values() for event in clock_operands(clock)]
        if any(isinstance(atom, Age) for event in events for atom in atoms_within(event)):
            raise UnsupportedError("an age opens or closes a scope at whose opening a value is read")
        self._prepared = prepared
        self._opened = Opened(of)
        self._bits = [self._opened.bit(clock) for clock in of.openings().values()]
        news = {each.name for part in predicates(of.property) for each in news_that_counts(part)}
        self._are_news = [atom.name in news for atom in of.atoms]
        self._taken: list[Value | None] = [None] * len(self._bits)

    def given(self, steps: Steps) -> Iterator[tuple[slice, Given]]:
        """`steps` in parts, in each of which the same values are taken. Raises UnsupportedError."""
        inputs, first, size = inputs_at(self._prepared, steps), 0, FIRST
        while first < len(steps):
            taken, part = tuple(self._taken), slice(first, min(len(steps), first + size))
            given = with_taken(self._prepared, steps, inputs, part, taken)
            if (moved := self._move(given, steps, first)) is not None:
                part = slice(first, moved + 1)
                given = with_taken(self._prepared, steps, inputs, part, taken)
            size = 4 * size if moved is None else FIRST
            yield part, given
            first = part.stop

    def _move(self, given: Given, steps: Steps, first: int) -> int | None:
        """The first step of the `given` ones, from `first` on, after which other values are taken; None: after none."""
        invalid = not_numbers(self._prepared.guards, given)
        valid = np.arange(len(given)) if invalid is None else np.flatnonzero(~invalid)
        masks = [np.broadcast_to(value(atom.holds, given), len(given))[valid] for atom in self._prepared.atoms]
        for number in self._telling(masks, steps.times[first:][valid]).tolist():
            letter = sum(1 << bit for bit, mask in enumerate(masks) if mask[number])
            step, before = first + int(valid[number]), self._opened.bits
            self._opened.step(steps.time(step), letter, step)
            if self._take(before, steps, step):
                return step
        return None

    def _telling(self, masks: Sequence[Mask], times: Places) -> Places:
        """Where a letter is not the one held, or its time that of the one before."""
        tells = np.ones(len(times), np.bool_)
        tells[1:] = times[1:] == times[:-1]
        for mask, is_news in zip(masks, self._are_news, strict=True):
            tells[1:] |= mask[1:] if is_news else mask[1:] != mask[:-1]
        return np.flatnonzero(tells)

    def _take(self, before: int, steps: Steps, step: int) -> bool:
        """Take the values of scopes that the step has opened; whether any has opened or closed."""
        after, moved = self._opened.bits, False
        for number, (bit, register) in enumerate(zip(self._bits, self._prepared.openings, strict=True)):
            if (before ^ after) & bit:
                moved = True
                self._taken[number] = steps.value(Input(register.signal), step) if after & bit else None
        return moved

    def are_known(self, until: Nanoseconds) -> bool:
        """Whether they are, in a run that ends at `until`: time opens and closes no scope between two steps."""
        return not self._opened.moves_by(until)
