"""The messages of slices in their order: one with an id is of its slice, any other is one of every slice."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import pairwise

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Places
from ltlc.monitoring.columns.bits import Bytes, Mask
from ltlc.monitoring.columns.ids import Runs, runs_of
from ltlc.monitoring.columns.known import Known
from ltlc.monitoring.columns.messages import Messages
from ltlc.monitoring.columns.others import Shared
from ltlc.runtime.sampling import New, Value
from ltlc.runtime.slice_ids import Slice
from ltlc.runtime.slice_keys import Cut
from ltlc.runtime.times import NEVER

MOST = 1 << 17
"""About so many messages of slices are taken at a time."""


@dataclass(frozen=True)
class Elements:
    """Messages in `rows` of a block, to the slices with these `numbers`, and none else before the row `end`.

    Each is one of the `own` messages, or a message that is `shared`. Which own one it is, or which was the last one of
    its slice, is in `lasts`; -1 if none was. `known` has the letters that held in slices before.
    """

    own: Messages
    shared: Shared
    known: Bytes
    rows: Places
    is_own: Mask
    numbers: Places
    lasts: Places
    end: int

    def __len__(self) -> int:
        return len(self.rows)

    @cached_property
    def times(self) -> Places:
        """The time of each."""
        times = self.shared.columns.times
        return times if self.is_whole and len(self) == len(times) else times.take(self.rows)

    @property
    def is_whole(self) -> bool:
        """Whether these are all messages with an id, and no others."""
        return not self.shared.signals and len(self) == len(self.own)

    @property
    def until(self) -> int:
        """The time up to which there are no others."""
        return int(self.shared.columns.times[self.end - 1])

    @cached_property
    def runs(self) -> Runs:
        """Those of slices."""
        return runs_of(self.numbers, None)

    @cached_property
    def early(self) -> int:
        """How many at first are not steps, as something shared has no value yet."""
        return int(self.rows.searchsorted(self.shared.first))

    @cached_property
    def invalid(self) -> Mask | None:
        """Which are not steps because something is NaN; None if all are steps."""
        return None if self.own.invalid is None else self.own.invalid.take(self.lasts)

    @cached_property
    def steps(self) -> Runs:
        """The runs without rows that are not steps."""
        if self.invalid is not None:
            return runs_of(self.numbers, np.flatnonzero(~self.invalid))
        return runs_of(self.numbers, np.arange(self.early, len(self))) if self.early else self.runs

    @cached_property
    def letters(self) -> Bytes:
        """The letter of each."""
        if not self.shared.signals:
            return self.own.letters if self.is_whole else self.own.letters.take(self.lasts)
        letters = self.shared.held(self.own.letters).take(self.lasts)
        is_new = np.flatnonzero(self.lasts < 0)
        letters[is_new] = self.known.take(self.numbers.take(is_new))
        if self.shared.own_news:
            is_own = np.flatnonzero(self.is_own)
            letters[is_own] = self.own.letters.take(self.lasts.take(is_own))
        letters |= self.shared.by_row.take(self.rows)
        return letters

    def values(self, cut: Cut, message: int, one: Slice) -> list[Value]:
        """What the property reads at one of them, which is of this slice."""
        row, last = int(self.rows[message]), int(self.lasts[message])
        found: list[Value] = []
        for place, wanted in enumerate(cut.window.inputs):
            if wanted.signal == cut.variable:
                found.append(one.id)
            elif wanted.signal in self.shared.signals:
                found.append(self.shared.value(wanted, row))
            elif isinstance(wanted, New):
                found.append(bool(self.is_own[message]))
            else:
                found.append(self.own.steps.value(wanted, last) if last >= 0 else one.judged_on[place])
        return found


def elements(own: Messages, shared: Shared, known: Known, numbers: Places) -> Iterator[Elements]:
    """The messages of a block in parts, `own` being of the slices with these `numbers`. Decided slices have none.

    After each part, the next is asked for when the slices are `known` as they are then.
    """
    size = max(1, MOST // max(1, len(known.numbers)))
    begins = (0, 0)
    for end in [*shared.rows[size::size].tolist(), len(shared.columns.times)]:
        ends = (int(own.rows.searchsorted(end)), int(shared.rows.searchsorted(end)))
        part, places = slice(begins[0], ends[0]), np.arange(begins[0], ends[0])
        rows, of = own.rows[part], numbers[part]
        if known.is_decided.any():
            is_taken = ~known.is_decided.take(of)
            rows, places, of = rows[is_taken], places[is_taken], of[is_taken]
        merged = _merged(rows, places, of, shared.rows[begins[1] : ends[1]], known)
        yield Elements(own, shared, known.letters, *merged, end)
        begins = ends


def _merged(
    rows: Places, places: Places, numbers: Places, shared: Places, known: Known
) -> tuple[Places, Mask, Places, Places]:
    """The messages with an id, and in the rows `shared` one of every slice that there is and that has none there.

    Of each its row, whether it has an id, its number, and the last message with an id that came to its slice; -1 if
    there was none.
    """
    if not len(shared) or not len(known.numbers):
        return rows, np.ones(len(rows), np.bool_), numbers, places
    count, first = len(known.numbers), np.full(len(known.numbers), -1)
    is_new = np.flatnonzero(known.begins.take(numbers) >= NEVER)[::-1]
    first[numbers.take(is_new)] = is_new
    born = np.sort(first[first >= 0])
    live = np.concatenate((known.going(), numbers.take(born)))
    counts = len(live) - len(born) + rows.take(born).searchsorted(shared)
    of = live.take(np.arange(int(counts.sum())) - (counts.cumsum() - counts).repeat(counts))
    at, ends = rows.searchsorted(shared), rows.searchsorted(shared, "right")
    given = np.arange(len(shared)).repeat(counts)
    own = np.where(at < ends, np.append(numbers, -1).take(at), -1)
    if (own >= 0).any():
        is_other = np.flatnonzero(own.take(given) != of)
        given, of = given.take(is_other), of.take(is_other)
        counts = np.bincount(given, minlength=len(shared))
    since = np.arange(len(shared) + 1).repeat(np.diff(ends, prepend=0, append=len(rows)))
    mine = np.concatenate(([0], counts.cumsum())).take(since) + np.arange(len(rows))
    theirs = ends.take(given) + np.arange(len(given))
    last = np.full((len(shared) + 1) * count, -1)
    last[since * count + numbers] = places
    for before, after in pairwise(last.reshape(-1, count)):  # `np.maximum.accumulate` takes four times as long
        np.maximum(before, after, out=after)
    is_own = np.zeros(len(mine) + len(theirs), np.bool_)
    is_own[mine] = True
    pairs = (rows, shared.take(given)), (numbers, of), (places, last.take(given * count + of))
    columns = [np.empty(len(is_own), np.int64) for _ in pairs]
    for column, pair in zip(columns, pairs, strict=True):
        column[mine], column[theirs] = pair
    return columns[0], is_own, columns[1], columns[2]
