"""A property for each id, or for each message: on the slice of the run for it."""

from __future__ import annotations

from ltlc.dataclass import dataclass
from ltlc.runtime.instance_reports import ToldInstances
from ltlc.runtime.sampling import Derived, Reading
from ltlc.runtime.session import Session
from ltlc.runtime.slice_ids import Ids, Messages, Slice
from ltlc.runtime.slice_keys import Cut, Key, Opener
from ltlc.runtime.slice_openings import Openings
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


@dataclass(frozen=True, slots=True)
class Instances:
    """A property is judged anew from each message on `topic` on, which opens it.

    It is that of `after MARK, P`; MARK is news of the signal `mark`, on a topic of its
    name without messages: that message, to the instance it opens. `signals` are what
    it reads, each after its parts; `name` is what the author calls the topic. At most
    `limit` instances are open, None is any number.
    """

    signals: tuple[Reading | Derived, ...]
    name: str
    topic: str
    mark: str
    limit: int | None = None

    def start(self, track: Track, session: Session) -> Slices:
        """Judge the property of `track` so, in a session that begins."""
        opener = Opener(self.name, self.topic, self.mark)
        cut = Cut(self.signals, (), "", track.property, opener)
        known, because = cut.sampler.known, track.invalid_because
        before = Slice(0, track.property, because, known)
        openings = Openings(opener, Messages(self.limit), before)
        messages, rate = openings.messages, session.plan.rate
        if rate is None:
            return OpenedSlices(track, session, cut, messages, frozenset(), openings)
        return TickedOpenedSlices(track, session, cut, messages, rate, openings)


class OpenedSlices(ToldInstances, Slices):
    """Slices that messages open, and what is reported of them."""


class TickedOpenedSlices(ToldInstances, TickedSlices):
    """The same in ticks."""
