"""A property for each id: a run is sliced, and each slice is judged as a run."""

from __future__ import annotations

from dataclasses import dataclass

from ltlc.runtime.sampling import Derived, Reading
from ltlc.runtime.session import Session
from ltlc.runtime.slice_ids import Ids
from ltlc.runtime.slice_keys import Cut, Key
from ltlc.runtime.slice_steps import Slices
from ltlc.runtime.slice_ticks import TickedSlices
from ltlc.runtime.tracking import Track


@dataclass(frozen=True, slots=True)
class Slicing:
    """A property is judged for each id, on the slice of the run for it.

    `signals` are those of a slice, each after its parts; in it, `variable` has the id.
    At most `limit` ids are kept, None is any number. Of a slice whose monitor is in one
    of the states `as_new`, with no clock running, nothing need be kept.
    """

    signals: tuple[Reading | Derived, ...]
    keys: tuple[Key, ...]
    variable: str
    limit: int | None = None
    as_new: frozenset[int] = frozenset()

    def start(self, track: Track, session: Session) -> Slices:
        """Judge the property of `track` so, in a session that begins."""
        cut = Cut(self.signals, self.keys, self.variable, track.property)
        ids, rate = Ids(self.limit), session.plan.rate
        if rate is None:
            return Slices(track, session, cut, ids, self.as_new)
        return TickedSlices(track, session, cut, ids, rate)
