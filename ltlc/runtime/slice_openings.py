"""Messages open instances of a property, each of which is judged from there on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from operator import attrgetter

from ltlc.runtime.episodes import forked, state_of
from ltlc.runtime.properties import Monitor
from ltlc.runtime.sampling import Value
from ltlc.runtime.slice_ids import Messages, Slice
from ltlc.runtime.slice_keys import Opener
from ltlc.runtime.times import NEVER
from ltlc.semantics.verdicts import Verdict

LATER = NEVER - 1
"""When no clock is ever due that is set."""

FEW = 4
"""Fewer slices are not worth asking which of them a step changes."""


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
        is_timed = before.property.timed
        self._quick = attrgetter("state", "due") if is_timed else attrgetter("state")
        self._uncounted: Counter[str] = Counter()
        self._probe = self._made_probe()

    def _made_probe(self) -> Monitor | None:
        """A monitor to try steps of instances; None if states do not decide these."""
        of = self.before.property
        has_more = bool(of.kept or of.events or of.excused or of.ages)
        is_open = all(not each.inner and each.closes is None for each in of.scopes)
        # A clock without bounds is that of a count, which has more than its state.
        bounds = [each.bounds for each in of.clocks]
        is_simple = len(bounds) == 1 and bool(bounds[0]) and is_open and not has_more
        return forked(self.before.monitor) if is_simple else None

    def changed(
        self, time: int, values: Sequence[Value], steps: int, given: list[Slice]
    ) -> list[Slice]:
        """Those that a step may change, after so many; the others have taken it.

        Most instances wait in one of a few states, until their clock is due. If that is
        later, all of a state step as one does whose clock is due after all others.
        """
        if self._probe is None or len(given) < FEW:
            return given
        found, stays = [], dict[int, bool]()
        for one in given:
            # Due later, and ever, is nothing but the clock: a step that is due `again`
            # would have been taken, and after one that was late nothing is due.
            monitor = one.monitor
            if time < monitor.due < NEVER and one is not self.before:
                state = monitor.state
                if state not in stays:
                    stays[state] = self._stays(self._probe, state, time, values)
                if stays[state]:
                    one.steps, one.judged_on = steps + 1, values
                    continue
            found.append(one)
        return found

    def _stays(
        self, probe: Monitor, state: int, time: int, values: Sequence[Value]
    ) -> bool:
        """Whether a step changes nothing in a state, and sets no clock."""
        [clock] = self.before.property.clocks
        probe.state, probe.due, probe.invalid = state, LATER, 0
        setattr(probe, clock.due, LATER)
        probe.step(time, *values)
        is_set = probe.due != LATER or getattr(probe, clock.due) != LATER
        return probe.state == state and not is_set and not probe.invalid

    def open(self) -> Slice | None:
        """A message comes: an instance that has had no step; None without a place."""
        number = self.messages.number()
        if not self.messages.find_place():
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
        # Clocks that were set at different times distinguish most of them.
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
