"""Ids in a column: a number for each, and the messages of each, one after the other."""

from __future__ import annotations

from functools import cached_property
from itertools import islice

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.monitoring.columns.bits import Bytes
from ltlc.runtime.slice_keys import Id, id_of

SPREAD, FEW = 4, 1000
"""Whole ids are looked up in a table of at most so many places for each message, and of so many more."""


class Numbers:
    """A number for each id that has come, counted from 0."""

    def __init__(self) -> None:
        self._whole: Places = np.empty(0, np.int64)
        self._least = 0
        self._table: Places = np.empty(0, np.int64)
        self._by_id: dict[Id, int] | None = None
        self._listed: list[Id] = []

    def __len__(self) -> int:
        return len(self._whole) if self._by_id is None else len(self._by_id)

    def id(self, number: int) -> Id:
        """The id that has this number."""
        return int(self._whole[number]) if self._by_id is None else self._listed[number]

    def ids(self) -> list[Id]:
        """All of them, by number."""
        return list(self._whole.tolist()) if self._by_id is None else self._listed

    def of(self, column: Array) -> Places:
        """The numbers of the ids in `column`, in which none is NaN."""
        if self._by_id is None:
            whole = _whole(column)
            if whole is not None and self._has_room(whole):
                whole -= self._least
                return self._looked_up(whole)
            self._listed = self._whole.tolist()
            self._by_id = {id_: number for number, id_ in enumerate(self._listed)}
        known = self._by_id
        numbers = (known.setdefault(value, len(known)) for value in column.tolist())
        found = np.fromiter(numbers, np.int64, len(column))
        new = list(islice(reversed(known), len(known) - len(self._listed)))
        self._listed += [id_ for value in reversed(new) if (id_ := id_of(value)) is not None]
        return found

    def _has_room(self, whole: Places) -> bool:
        """Whether there is a table of all whole ids up to these, that is not much larger than there are messages."""
        if not len(whole):
            return True
        least, end = int(whole.min()), int(whole.max()) + 1
        if len(self._table):
            least, end = min(least, self._least), max(end, self._least + len(self._table))
        if end - least > SPREAD * (len(self) + len(whole)) + FEW:
            return False
        if end - least > len(self._table):
            table = np.full(end - least, -1)
            first = self._least - least
            table[first : first + len(self._table)] = self._table
            self._least, self._table = least, table
        return True

    def _looked_up(self, places: Places) -> Places:
        if len(self) and ((found := self._table.take(places)) >= 0).all():
            return found
        is_here = np.zeros(len(self._table), np.bool_)
        is_here[places] = True
        new = np.flatnonzero(is_here & (self._table < 0))
        self._table[new] = np.arange(len(self), len(self) + len(new))
        self._whole = np.concatenate((self._whole, new + self._least))
        return self._table.take(places)


def _whole(column: Array) -> Places | None:
    """A copy of ids as integers of 64 bits, if they are."""
    if column.dtype.kind not in "iuf" or column.max(initial=0) >= 1 << 63:
        return None
    with np.errstate(invalid="ignore"):
        whole = column.astype(np.int64)
    return whole if (whole == column).all() else None


@dataclass(frozen=True)
class Runs:
    """The messages of slices, those of one after the other: they are in `order`.

    The run of the slice with a number in `numbers` begins at a place in `firsts` of them, and is one of the `lengths`.
    """

    numbers: Places
    order: Places
    firsts: Places
    lengths: Places

    def taken(self, places: Places, lengths: Places) -> Runs:
        """The runs at `places`, each up to one of the `lengths`, which are not 0."""
        starts = self.firsts[places]
        firsts = lengths.cumsum() - lengths
        at = np.arange(int(lengths.sum())) + (starts - firsts).repeat(lengths)
        return Runs(self.numbers[places], self.order.take(at), firsts, lengths)

    def run(self, place: int) -> Places:
        """The messages of one of them."""
        first = int(self.firsts[place])
        return self.order[first : first + int(self.lengths[place])]

    def message(self, runs: Places, steps: Places) -> Places:
        """The messages at these places in these runs."""
        return self.order.take(self.firsts.take(runs) + steps)

    @cached_property
    def lasts(self) -> Places:
        """The last message of each."""
        return self.order.take(self.firsts + self.lengths - 1)

    def padded(self, letters: Bytes) -> Bytes:
        """The `letters` of the messages, those of each up to a multiple of eight: the last one is repeated."""
        counts = np.ones(len(self.order), np.int64)
        counts[self.firsts + self.lengths - 1] += -self.lengths % 8
        return letters.take(self.order).repeat(counts)


def runs_of(numbers: Places, messages: Places | None) -> Runs:
    """Those of `messages`, ascending, None for all, in which the ids have these `numbers`."""
    given = numbers if messages is None else numbers.take(messages)
    bits = max(0, len(given) - 1).bit_length()
    is_short = bits + int(given.max(initial=0)).bit_length() <= 32
    keys: Array = given.astype(np.uint32 if is_short else np.int64)  # the short ones are sorted in half the time
    keys <<= bits
    keys |= np.arange(len(given), dtype=keys.dtype)
    keys.sort()
    of, order = keys >> bits, np.bitwise_and(keys, (1 << bits) - 1, dtype=np.int64)
    is_first = np.ones(len(of), np.bool_)
    np.not_equal(of[1:], of[:-1], out=is_first[1:])
    firsts = np.flatnonzero(is_first)
    lengths = np.diff(firsts, append=len(of))
    return Runs(of.take(firsts).astype(np.int64), order if messages is None else messages.take(order), firsts, lengths)
