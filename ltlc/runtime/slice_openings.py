"""Messages open instances of a property, each of which is judged from there on."""

from __future__ import annotations

from collections import Counter
from operator import attrgetter

from ltlc.runtime.episodes import state_of
from ltlc.runtime.slice_ids import Messages, Slice
from ltlc.runtime.slice_keys import Opener
from ltlc.runtime.times import NEVER
from ltlc.semantics.verdicts import Verdict


class Openings:
    """What opens instances, and the run `before` any of them as the property sees it.

    An instance goes on from there as what it is: what the past says, ages and values at
    openings are those of the whole run. Steps of the property are those of `before`.
    That all instances say what `always (new s implies P)` says: Coq, `each_step`.
    """

    def __init__(self, opener: Opener, messages: Messages, before: Slice) -> None:
        self.opener = opener
        self.messages = messages
        self.before = before
        before.number = -1  # it is none of those that are kept
        is_timed = before.property.timed
        self._quick = attrgetter("state", "due") if is_timed else attrgetter("state")
        self._uncounted: Counter[str] = Counter()

    def open(self) -> Slice | None:
        """A message comes: an instance that has had no step; None without a place."""
        number = self.messages.number()
        if not self.messages.find_place(number):
            return None
        one = self.before.fork()
        one.id, one.invalid_because, one.scheduled = number, self._uncounted, NEVER
        one.verdict, one.counted = Verdict.NOT_STARTED, self.messages.calm
        one.decided_at = None  # the run may be satisfied, whatever opens
        self.messages.keep(one)
        return one

    def withdraws(self, one: Slice) -> bool:
        """Whether what has not started is an instance, which then was none."""
        if one is self.before:
            return False
        self.messages.withdraw()
        return True

    def alike(self) -> list[Slice]:
        """Those instances that go on like an earlier one, which now stands for them."""
        # Clocks that were set at different times tell most of them apart.
        monitors = [one.monitor for one in self.messages.slices.values()]
        if len(set(map(self._quick, monitors))) == len(monitors):
            return []
        first: dict[tuple[object, ...], Slice] = {}
        found = []
        for one in self.messages.slices.values():
            earlier = first.setdefault(state_of(one.monitor), one)
            if earlier is not one:
                self.messages.merge(earlier, one)
                found.append(one)
        return found
