"""The letters of each slice of a property that is judged for each id: all are followed, and none is forgotten."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence

from ltlc.assurance.evidence.document import StatedSlice
from ltlc.dataclass import dataclass
from ltlc.monitoring.letters import Letters
from ltlc.runtime.properties import Change
from ltlc.runtime.sampling import Value
from ltlc.runtime.session import Session
from ltlc.runtime.slice_ids import Ids, Slice
from ltlc.runtime.slice_keys import Cut, Id, Part, Row
from ltlc.runtime.slice_steps import Slices
from ltlc.runtime.slices import Slicing
from ltlc.runtime.tracking import Track
from ltlc.semantics.durations import Nanoseconds

MOST_SLICES = 100
"""Evidence has the letters of so many ids."""


@dataclass(frozen=True)
class LetteredSlicing:
    """Judges as `by` does, and keeps the letters of each slice, which are to be kept as in `letters`."""

    by: Slicing
    letters: Callable[[], Letters]

    def start(self, track: Track, session: Session) -> Slices:
        """Judge the property of `track` so, in a session that begins."""
        cut = Cut(self.by.signals, self.by.keys, self.by.variable, track.property)
        return LetteredSlices(track, session, cut, Ids(self.by.limit), self.letters)


class LetteredSlices(Slices):
    """Slices with their letters: of each id, in the order in which they came."""

    def __init__(self, track: Track, session: Session, cut: Cut, ids: Ids, letters: Callable[[], Letters]) -> None:
        super().__init__(track, session, cut, ids, frozenset())
        self._new_letters = letters
        self._lettered: dict[Id, Letters] = {}
        self._ended: dict[Id, tuple[Slice, Nanoseconds]] = {}
        self._now = 0

    def take(self, time: int, row: Row, values: Sequence[Value], changes: list[Change]) -> None:
        """Samples and messages came in, all is held to then; `changes` grows."""
        self._now = time
        super().take(time, row, values, changes)

    def _new(self, time: int, id_: Id) -> Slice | None:
        return next((one for one in self._ending() if one.id == id_), None) or super()._new(time, id_)

    def _going_on(self) -> list[Slice]:
        return [*super()._going_on(), *self._ending()]

    def _ending(self) -> list[Slice]:
        """The slices that were decided at this very time: what comes at it has lines, too."""
        return [one for one, time in self._ended.values() if time == self._now]

    def _share(self, time: int, part: Part, given: Sequence[Value]) -> None:
        super()._share(time, part, given)
        for one in self._ending():
            self.cut.share(one.known)

    def _born(self, time: int, id_: Id) -> Slice:
        self._lettered[id_] = self._new_letters()
        return super()._born(time, id_)

    def _step(self, time: int, one: Slice) -> None:
        values, steps = self._look(one.known), self.track.steps
        super()._step(time, one)
        if self.track.steps > steps:
            self._lettered[one.id].step(time, self.track.property.given(values))

    def _drop(self, one: Slice) -> None:
        if one.decided_at is not None:
            self._ended[one.id] = one, one.decided_at.time
        super()._drop(one)

    def stated(self, end: Nanoseconds) -> tuple[StatedSlice, ...] | str:
        """All slices of a run that ends then; or why evidence does not have them."""
        if len(self._lettered) > MOST_SLICES:
            return f"it is judged for more than {MOST_SLICES} ids"
        return tuple(self._stated(id_, letters, end) for id_, letters in self._lettered.items())

    def _stated(self, id_: Id, letters: Letters, end: Nanoseconds) -> StatedSlice:
        is_over = id_ in self._ended
        one, until = self._ended[id_] if is_over else (self.ids.slices[id_], end)
        letters.settle(until if is_over else None, is_over=True)
        return StatedSlice(json.dumps(id_), letters.lines, until, one.verdict, until)
