"""The letters of a run as evidence has them: lines where something changes, kept while it is judged.

An instant is a step, or a message that makes no step but from which an age counts. One has a line if it is the first,
if its letter is not the one held, or if its time is that of the last line; `docs/evidence.md` says it in full.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Container, Iterable, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ltlc.assurance.evidence.conditions import numbered_scopes
from ltlc.assurance.evidence.document import Line, StatedScope, Summed
from ltlc.backends.python.load import load_conditions
from ltlc.monitoring.opened import Opened
from ltlc.runtime.sampling import Value
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.properties import predicates
from ltlc.semantics.timed_atoms import news_that_counts
from ltlc.specification.expressions import Current
from ltlc.specification.specification import PropertySpecification

MOST_BYTES = 600
"""Lines that are longer altogether are summed up."""


class Letters:
    """The lines of one property in one run, which grow with it.

    A letter is a number, whose bits are those of the atoms. Steps by rows come one after the other, while it `is_told`
    of them; where columns take steps, these come all at once.
    """

    def __init__(self, of: PropertySpecification, is_at_ticks: bool) -> None:
        atoms = {atom.name: 1 << number for number, atom in enumerate(of.atoms)}
        news = {each.name for part in predicates(of.property) for each in news_that_counts(part)}
        self._of = of
        self._news = sum(bit for name, bit in atoms.items() if name in news)
        self._messages = {of.arrival(name).signal.name: atoms[name] for name in of.messages()}
        self._is_at_ticks = is_at_ticks
        self._steps = 0
        """How many were taken by rows."""
        self._opened = Opened(of) if of.openings() else None
        inputs, scopes = of.inputs(), [*numbered_scopes(of)]
        self._taken = [
            (inputs.index(Current(opening.signal)), 1 << len(atoms) + scopes.index(clock))
            for opening, clock in of.openings().items()
        ]
        """Of each value at an opening, its place among the inputs, and the bit of its scope."""
        self._kept: list[Value] = [0.0] * len(self._taken)
        self.is_told = True
        self.is_settled = False
        self._pending: list[tuple[Nanoseconds, int]] = []
        self._heard: dict[int, Nanoseconds] = {}
        self._parts: list[tuple[NDArray[np.int64], NDArray[np.int64]]] = []
        self._last: tuple[Nanoseconds, int] | None = None
        self._seen: Nanoseconds = 0
        self.first: Nanoseconds | None = None
        self.session: Nanoseconds | None = None
        self.are_ages_apart = False
        self._lines: list[Line] = []
        self._count = self._length = 0
        self._sha256 = hashlib.sha256()
        self._written: Nanoseconds | None = None
        self._forms: dict[int, str] = {}
        """Of each letter, the form of its lines, in which the time since the line before is missing."""

    @cached_property
    def _holds(self) -> Callable[..., Sequence[bool]]:
        """Which atoms hold where inputs have these values."""
        return load_conditions((atom.condition for atom in self._of.atoms), self._of.reads())

    def hear(self, time: Nanoseconds, signals: Container[str]) -> None:
        """Messages come from which the ages of these signals count, before they are judged by rows."""
        if self.is_told and not self.is_settled:
            bits = sum(bit for signal, bit in self._messages.items() if signal in signals)
            if bits:
                self._pending.append((time, bits))

    def step(self, time: Nanoseconds, values: Sequence[Value] | None) -> None:
        """A step with these values of the inputs was taken by rows; None: it was none.

        Values at openings are taken here: a monitor that has decided takes none, at whose time there can be more steps.
        """
        if not self.is_told or self.is_settled:
            return
        if values is None:
            self._flush()
            return
        now, messages = 0, sum(self._messages.values())
        before = 0 if self._opened is None else self._opened.bits
        for number, (place, bit) in enumerate(self._taken):
            if not before & bit:
                self._kept[number] = values[place]
        for number, holds in enumerate(self._holds(*values, *self._kept)):
            now |= holds << number
        if self._is_at_ticks:
            now &= ~messages
            while self._pending and self._pending[-1][0] == time:
                now |= self._pending.pop()[1]
        elif now & messages and self._pending and self._pending[-1][0] == time:  # no monitor is told of ages it ignores
            self._pending.pop()
        self._flush()
        self._add_one(time, now, is_step=True)
        self._steps += 1

    def repeat(self, times: int) -> None:
        """The last step was taken `times` more times."""
        self._steps += times

    def take(self, times: NDArray[np.int64], atoms: Iterable[NDArray[np.bool_]]) -> None:
        """Steps at these times are taken by columns, up to when it is settled next; each of the atoms holds there.

        Counts, which come after the atoms, follow from these.
        """
        self._flush()
        self.is_told = False
        if not len(times):
            return
        self._seen = int(times[-1])
        masks = list(atoms)[: len(self._of.atoms)]
        differs = np.zeros(len(times), np.bool_)
        differs[0] = True
        for number, mask in enumerate(masks):
            if self._news >> number & 1:
                differs |= mask
            else:
                differs[1:] |= mask[1:] != mask[:-1]
        at = _with_ties(times, differs)
        letters = np.zeros(len(at), np.int64)
        for number, mask in enumerate(masks):
            letters |= mask[at].astype(np.int64) << number
        self._add(times[at], letters)

    def _flush(self) -> None:
        """Messages have come that made no step."""
        pending, self._pending = self._pending, []
        for time, bits in pending:
            if self._last is None:
                self._heard |= {bit: time for bit in self._messages.values() if bit & bits}
            else:
                self._add_one(time, self._last[1] & ~self._news | bits)

    def _add_one(self, time: Nanoseconds, now: int, *, is_step: bool = False) -> None:
        """An instant."""
        self._seen = time
        if self._last is None or time == self._last[0] or now != self._last[1] & ~self._news:
            if self._opened is not None and is_step:
                self._opened.step(time, now, self._steps)
            self._add(np.array([time]), np.array([now]))

    def _add(self, times: NDArray[np.int64], letters: NDArray[np.int64]) -> None:
        """Instants at each of which there is a line, but perhaps at the first."""
        self._seen = int(times[-1])
        if self._last is None:
            self.first = int(times[0])
            self._begin(int(letters[0]))
        elif times[0] != self._last[0] and letters[0] == self._last[1] & ~self._news:
            times, letters = times[1:], letters[1:]
        if len(times):
            self._last = int(times[-1]), int(letters[-1])
            self._parts.append((times, letters if self._opened is None else letters | self._opened.bits))

    def _begin(self, now: int) -> None:
        """The first step: since when ages count, of which none has a message at it."""
        heard = {self._heard.get(bit) for bit in self._messages.values() if not bit & now}
        self.are_ages_apart = len(heard) > 1
        self.session = min((time for time in heard if time is not None), default=None)

    def settle(self, until: Nanoseconds | None, *, is_over: bool = False) -> None:
        """The steps so far can be written; if the property was decided at `until`, nothing later matters.

        From now on it is told of steps by rows. If it `is_over`, nothing more comes.
        """
        self.is_told = True
        if is_over:
            self._flush()
        self.is_settled = until is not None and self._seen > until
        if self._parts:
            times, letters = (np.concatenate(each) for each in zip(*self._parts, strict=True))
            self._parts = []
            end = len(times) if until is None else int(times.searchsorted(until, "right"))
            self._write(times[:end], letters[:end].tolist())

    def _write(self, times: NDArray[np.int64], letters: Sequence[int]) -> None:
        if not letters:
            return
        forms, before = self._forms, self._written
        for now in {*letters} - forms.keys():
            forms[now] = "+%d" + "".join(f" a{number}" for number in _numbers(now)) + "\n"
        gaps = np.diff(times, prepend=times[0] if before is None else before)
        text = "".join([forms[now] for now in letters]) % tuple(gaps.tolist())
        if before is None:
            text = f"at {times[0]}{text[2:]}"
        self._written = int(times[-1])
        self._count += len(letters)
        self._length += len(text)
        if self._length <= MOST_BYTES:
            self._lines += [Line(time, _numbers(now)) for time, now in zip(times.tolist(), letters, strict=True)]
        self._sha256.update(text.encode())

    def scopes(self, until: Nanoseconds) -> tuple[StatedScope, ...] | str:
        """When the scopes are open at whose opening values are taken, up to `until`; or why evidence cannot say it."""
        return () if self._opened is None else self._opened.stated(until)

    @property
    def lines(self) -> tuple[Line, ...] | Summed:
        """Those up to the time when it was settled last."""
        if self._length <= MOST_BYTES:
            return tuple(self._lines)
        return Summed(self._count, self._sha256.hexdigest())


def _numbers(bits: int) -> tuple[int, ...]:
    return tuple(number for number in range(bits.bit_length()) if bits >> number & 1)


def _with_ties(times: NDArray[np.int64], differs: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Where a letter `differs`, and what comes later at the same time."""
    numbers = np.arange(len(times))
    begins = np.ones(len(times), np.bool_)
    begins[1:] = times[1:] != times[:-1]
    if not begins.all():
        since = np.maximum.accumulate(np.where(begins, numbers, 0))
        differs = np.maximum.accumulate(np.where(differs, numbers, -1)) >= since
    return np.flatnonzero(differs)
