"""The state of a run: data that the judges of incoming samples carry forward."""

from __future__ import annotations

from collections.abc import Callable

from ltlc.dataclass import dataclass
from ltlc.runtime.guard_plans import GuardPlan
from ltlc.runtime.properties import MonitoredProperty
from ltlc.runtime.sampling import Derived, Reading, Sampler
from ltlc.runtime.ticks import Paces
from ltlc.runtime.times import NEVER, Scale, Times
from ltlc.runtime.tracking import Observer, RecordedTrack, Track


@dataclass(frozen=True, slots=True)
class Plan:
    """What to monitor: signals (each after its parts), properties and settings.

    `rate` is in Hz and `timeout` in ns; None where there is none. `guards` keep some of
    the properties.
    """

    signals: tuple[Reading | Derived, ...]
    properties: tuple[MonitoredProperty, ...]
    rate: float | None = None
    timeout: int | None = None
    guards: tuple[GuardPlan, ...] = ()


@dataclass(frozen=True, slots=True)
class Loss:
    """`count` messages were lost; if that is not all that is known, perhaps more."""

    count: int = 0
    is_all: bool = True


class Session:
    """One run of a plan, as far as it is known.

    Whoever judges what comes in takes this forward: row by row (`ltlc.runtime.rows`),
    or in blocks by columns (`ltlc.monitoring.columns.session`), one where the other
    left it. What a run has shown is read from it. Times are in ns.

    plan: what is monitored
    fields: the signals read from each topic, in the order in which a message has them
    sampler: the samples of all signals, but those that ticks see
    tracks: what is known of each property
    stepped: each of these that is judged on the whole run, and what it reads
    sliced: what judges each of the others
    paces: the ticks, where there is a rate
    steps: how many rows with samples, or ticks, there were
    messages: how many messages came in on each topic; of these, `malformed` ones
    lost: messages on a topic that never came in
    began: when the session began, None before
    time: its status, None before it began
    has_begun: whether some property has had its first step
    end: the last moment of the run; a timeout counts from its first step
    is_over: whether that is past: nothing more is taken
    times: how the times of the run are shown
    zero: when the recording began, if the run began later
    absences: why nothing comes of signals or on topics, by name, if that is known
    """

    def __init__(
        self,
        plan: Plan,
        keep_verdicts: bool = False,
        observe: Callable[[], Observer] | None = None,
        make: Callable[[MonitoredProperty, bool, Observer | None], Track] | None = None,
    ) -> None:
        """Each property has an observer of its own, if `observe` makes them.

        `make` makes its track, whether or not it is recorded.
        """
        self.plan = plan
        self.fields = _fields(plan)
        self.sampler = self._new_sampler()
        if make is None and (keep_verdicts or observe):
            make = RecordedTrack
        self.tracks = tuple(
            make(p, keep_verdicts, observe and observe()) if make else Track(p)
            for p in plan.properties
        )
        self.stepped = [
            (track, self.sampler.window(track.property.inputs))
            for track in self.tracks
            if track.property.slicing is None
        ]
        self.paces = None if plan.rate is None else self._new_paces(plan.rate)
        self.steps = 0
        self.messages = dict.fromkeys(self.fields, 0)
        self.malformed: dict[str, int] = {}
        self.lost: dict[str, Loss] = {}
        self.began: int | None = None
        self.time: int | None = None
        self.has_begun = False
        self.end = NEVER
        self.is_over = False
        self.times = Times.OFFSET
        self.zero: int | None = None
        self.absences: dict[str, str] = {}
        for track in self.tracks:
            if track.property.slicing is not None:
                track.slices = track.property.slicing.start(track, self)
        found = (track.slices for track in self.tracks)
        self.sliced = [slices for slices in found if slices is not None]

    def _new_sampler(self) -> Sampler:
        whole = (p for p in self.plan.properties if p.slicing is None)
        inputs = [i for p in whole for i in p.inputs]
        return Sampler(self.plan.signals, inputs)

    def _new_paces(self, rate: float) -> Paces:
        waiting = [(track, window.read) for track, window in self.stepped]
        return Paces(rate, self._new_sampler, waiting, self.fields)

    def sampler_of(self, track: Track) -> Sampler:
        """The sampler that has the samples that a property looks at."""
        pace = None if self.paces is None else self.paces.of(track)
        return self.sampler if pace is None else pace.sampler

    @property
    def beginning(self) -> int | None:
        """What offsets count from; None before there is a time."""
        return self.began if self.zero is None else self.zero

    @property
    def scale(self) -> Scale:
        """How the times of the run are shown to a reader."""
        if self.times is Times.ABSOLUTE:
            return Scale()
        # What begins at 0 has one time only.
        has_clock = self.times is Times.BOTH and self.beginning != 0
        return Scale(self.beginning, has_clock=has_clock)

    @property
    def unseen(self) -> dict[str, int]:
        """How many messages on each topic no tick has seen: others came before it."""
        return {} if self.paces is None else self.paces.unseen()

    @property
    def is_incomplete(self) -> bool:
        """Whether something that was sent could not be judged."""
        left_out = any(slices.left_out for slices in self.sliced)
        return bool(self.lost or self.malformed or left_out)

    def begin_run(self, time: int) -> None:
        """The run begins with its first step; from now on its end is known."""
        self.has_begun = True
        if self.plan.timeout is not None:
            self.end = time + self.plan.timeout

    def lose(self, topic: str, count: int | None = None) -> None:
        """`count` messages on `topic` were lost; None: some may have been."""
        before = self.lost.get(topic, Loss())
        is_all = before.is_all and count is not None
        self.lost[topic] = Loss(before.count + (count or 0), is_all)


def _fields(plan: Plan) -> dict[str, tuple[str, ...]]:
    """The readings of each topic."""
    names: dict[str, list[str]] = {}
    for signal in plan.signals:
        if isinstance(signal, Reading):
            names.setdefault(signal.topic, []).append(signal.name)
    return {topic: tuple(of) for topic, of in names.items()}
