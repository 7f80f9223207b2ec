"""A run: samples come in, properties are stepped, verdicts come out."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass

from ltlc.runtime.sampling import Derived, Reading, Sampler, Value, Window
from ltlc.runtime.ticks import Pace, Stepped, Ticks
from ltlc.runtime.times import NEVER, seconds_text
from ltlc.runtime.tracking import Change, MonitoredProperty, Track


@dataclass(frozen=True, slots=True)
class Plan:
    """What to monitor: signals (each after its parts), properties and settings.

    `rate` is in Hz and `timeout` in ns; None where there is none.
    """

    signals: tuple[Reading | Derived, ...]
    properties: tuple[MonitoredProperty, ...]
    rate: float | None = None
    timeout: int | None = None


@dataclass(frozen=True, slots=True)
class Loss:
    """`count` messages were lost; if that is not all that is known, perhaps more."""

    count: int = 0
    is_all: bool = True


class Session:
    """One run of a plan.

    Without a rate, `message` is a step of every property one of whose signals gets a
    sample by it, or that wants its news, from the first on at which all its inputs have
    values. With a rate of f Hz a property has ticks, k/f s after the first message on
    a topic that it reads, for k = 0, 1, ...; a tick is a sample of every signal that
    has a value, and a step if its inputs have values. A tick sees the messages up to
    and including its own time; of two samples of a signal it sees the last. What reads
    nothing but which messages come has ticks from the beginning of the session on.

    Between steps time passes: properties with clocks take clock steps (`Track.hold`),
    at one time before the steps. What reads nothing but which messages come has its
    first step when the session begins, with `begin` or else with the first message.

    The run is over `timeout` after its first step: what comes later is not taken.
    Times are in ns and must not decrease; after a jump back, begin a new session.
    A `track` follows each property.
    """

    def __init__(
        self, plan: Plan, keep_verdicts: bool = False, track: type[Track] = Track
    ) -> None:
        self.plan = plan
        inputs = [i for p in plan.properties for i in p.inputs]
        self.sampler = Sampler(plan.signals, inputs)
        self.tracks = tuple(track(p, keep_verdicts) for p in plan.properties)
        self.steps = 0
        self.time: int | None = None
        self.is_over = False
        self.began: int | None = None
        self._has_begun = False
        self._end = NEVER
        self._stepped = [
            (track, self.sampler.window(track.property.inputs)) for track in self.tracks
        ]
        self._timed = [track for track in self.tracks if track.property.timed]
        self._fields = _fields(plan)
        self.messages = dict.fromkeys(self._fields, 0)
        self.lost: dict[str, Loss] = {}
        self.malformed: dict[str, int] = {}
        self._taken = dict.fromkeys(self._fields, 0)
        self._paces: list[Pace] = []
        self._tickless = [
            (track, self.topics(window))
            for track, window in self._stepped
            if plan.rate is not None
        ]

    def fields(self, topic: str) -> tuple[str, ...]:
        """The signals read from `topic`, in the order in which `message` wants them."""
        return self._fields[topic]

    def lose(self, topic: str, count: int | None = None) -> None:
        """`count` messages on `topic` were lost; None: some may have been."""
        before = self.lost.get(topic, Loss())
        is_all = before.is_all and count is not None
        self.lost[topic] = Loss(before.count + (count or 0), is_all)

    @property
    def is_incomplete(self) -> bool:
        """Whether something that was sent could not be judged."""
        return bool(self.lost or self.malformed)

    def begin(self, time: int) -> list[Change]:
        """The session begins at `time`, before the first message has come."""
        if self._go_on(time) and self._begin_session(time):
            return self._first_steps(time)
        return []

    def message(self, time: int, topic: str, values: Sequence[Value]) -> list[Change]:
        """A message came in: `values` of the fields of `topic`, None for no sample."""
        self.messages[topic] += 1
        return self.judge(time, topic, values)

    def judge(
        self, time: int, topic: str, values: Sequence[Value] | None
    ) -> list[Change]:
        """Judge a message that was counted when it came in.

        If it is malformed, `values` is None: it is news, but has no samples.
        """
        names = self._fields[topic]
        if values is None:
            self.malformed[topic] = self.malformed.get(topic, 0) + 1
            values = (None,) * len(names)
        present = [value for value in values if value is not None]
        if len(present) < len(names):
            pairs = zip(names, values, strict=True)
            names = tuple(name for name, value in pairs if value is not None)
        return self._take(time, frozenset({topic}), names, present)

    def samples(
        self,
        time: int,
        names: tuple[str, ...],
        values: Sequence[Value],
        also: Iterable[str] = (),
    ) -> list[Change]:
        """Samples of the readings `names` came in, all at the same time.

        There was a message on the topic of each, and on those in `also`.
        """
        of = (self.sampler.topics[name] for name in names)
        topics = frozenset(also).union(*of)
        for topic in topics:
            self.messages[topic] += 1
        return self._take(time, topics, names, values)

    def _take(
        self,
        time: int,
        topics: frozenset[str],
        names: tuple[str, ...],
        values: Sequence[Value],
    ) -> list[Change]:
        """Messages on `topics` came in with samples of the readings `names`."""
        changes = self._pass(time)
        if not self._go_on(time):
            return changes
        is_first = self._begin_session(time)
        for topic in topics:
            self._taken[topic] += 1
        taken = self.sampler.converted(names, values)
        if self.sampler.not_measured:
            self.sampler.count(names, taken)
        if self.plan.rate is None:
            if names:
                self.steps += 1
            self.sampler.hear(topics)
            fresh = self.sampler.take(time, names, taken)
            changes += self._step(time, fresh, topics)
            if is_first:
                changes += self._first_steps(time)
        elif topics:
            self._start_ticks(time, topics)
            numbers = {topic: self._taken[topic] for topic in topics}
            for pace in self._paces:
                pace.keep(names, taken, numbers)
        return changes

    def topics(self, window: Window) -> frozenset[str]:
        """The topics that what is looked at is read from."""
        read = (self.sampler.topics[name] for name in window.signals)
        return window.topics.union(*read)

    def _start_ticks(self, time: int, topics: Container[str] | None = None) -> None:
        """The ticks begin of what reads one of `topics`; None: of what needs none."""
        starting: list[tuple[Track, frozenset[str]]] = []
        left: list[tuple[Track, frozenset[str]]] = []
        for track, read in self._tickless:
            begins = track.property.from_session
            if topics is not None:
                begins = any(topic in topics for topic in read)
            (starting if begins else left).append((track, read))
        self._tickless = left
        if starting:
            pace = self._pace_from(time)
            for track, read in starting:
                pace.join(track, read)

    def _pace_from(self, time: int) -> Pace:
        """The pace whose ticks begin at `time`, with none of them done."""
        for pace in self._paces:
            if pace.ticks.start == time and not pace.ticks.count:
                return pace
        self._paces.append(self._new_pace(time))
        return self._paces[-1]

    def _new_pace(self, start: int) -> Pace:
        """Ticks that begin at `start`, before any property has joined them."""
        plan = self.plan
        assert plan.rate is not None
        inputs = [i for p in plan.properties for i in p.inputs]
        return Pace(Ticks(plan.rate, start), Sampler(plan.signals, inputs))

    def sampler_of(self, track: Track) -> Sampler:
        """The sampler that has the samples that a property looks at."""
        paces = self._paces
        own = (p for p in paces if any(each is track for each, _ in p.stepped))
        pace = next(own, None)
        return self.sampler if pace is None else pace.sampler

    @property
    def unseen(self) -> dict[str, int]:
        """How many messages on each topic no tick has seen: others came before it."""
        if self.plan.rate is None:
            return {}
        seen = [pace.seen for pace in self._paces]
        return {
            topic: n - max((each.get(topic, 0) for each in seen), default=0)
            for topic, n in self._taken.items()
        }

    def advance(self, time: int) -> list[Change]:
        """It is `time` now: do what is due by then, and see whether the run is over.

        Called at the end of a recording, and now and then while a live run goes on.
        """
        changes = self._pass(time)
        if self._go_on(time):
            for pace in self._paces:
                if pace.ticks.next() <= time:
                    changes += self._tick(pace)
        return changes

    def due(self) -> int | None:
        """When the next clock step comes, unless a step comes first; None: never."""
        due = min((track.due for track in self._timed), default=NEVER)
        return due if due <= self._end and due < NEVER else None

    def _pass(self, time: int) -> list[Change]:
        """Do the ticks before `time`, and the clock steps up to and including it."""
        changes: list[Change] = []
        while self._paces:
            pace = min(self._paces, key=lambda pace: pace.ticks.next())
            if pace.ticks.next() >= min(time, self._end + 1):
                break
            changes += self._tick(pace)
            # Where the run is still to begin, another property may say when it ends.
            if pace.is_settled and (self._has_begun or self.plan.timeout is None):
                until = min(time, self._end + 1, self.due() or time)
                # The last is done: slopes ask when the sample before was taken.
                self._repeat(pace, max(0, pace.ticks.before(until) - 1))
        return changes + self._hold(min(time, self._end))

    def _hold(self, time: int) -> list[Change]:
        """Take the clock steps up to and including `time`, in their order."""
        changes = [change for track in self._timed for change in track.hold(time)]
        return sorted(changes, key=lambda change: change.moment.time)

    def _go_on(self, time: int) -> bool:
        """Set the time; whether the run still goes on at it."""
        if self.is_over:
            return False
        if self.time is not None and time < self.time:
            now = seconds_text(self.time)
            raise ValueError(f"time goes back from {now} s to {seconds_text(time)} s")
        self.is_over = time > self._end
        self.time = min(time, self._end)
        return not self.is_over

    def _begin_session(self, time: int) -> bool:
        """The session begins at `time`, unless it has begun."""
        if self.began is not None:
            return False
        self.began = time
        for track in self._timed:
            track.begin(time)
        if self.plan.rate is not None:
            self._start_ticks(time)
        return True

    def _first_steps(self, time: int) -> list[Change]:
        """Step what begins with the session and has not: no message has come."""
        if self.plan.rate is not None:
            return []
        self.sampler.hear(frozenset())
        waiting = [
            (track, window)
            for track, window in self._stepped
            if track.property.from_session and not track.steps
        ]
        return self._judge(time, waiting)

    def _step(
        self, time: int, fresh: frozenset[str], topics: Iterable[str]
    ) -> list[Change]:
        """Step the properties that read a signal with a new sample, or the news."""
        stepped = [
            (track, window)
            for track, window in self._stepped
            if not window.signals.isdisjoint(fresh)
            or not window.topics.isdisjoint(topics)
        ]
        return self._judge(time, stepped)

    def _judge(self, time: int, stepped: Iterable[Stepped]) -> list[Change]:
        """Step those of the properties whose inputs have values."""
        changes = []
        for track, window in stepped:
            values = window.values()
            if values is None:
                track.hear(time, window.news())
                continue
            change = track.step(time, values)
            if not self._has_begun and track.steps:
                self._begin(time)
            if change is not None:
                changes.append(change)
        return changes

    def _begin(self, time: int) -> None:
        """The run begins with its first step; from now on its last moment is known."""
        self._has_begun = True
        if self.plan.timeout is not None:
            self._end = time + self.plan.timeout

    def _tick(self, pace: Pace) -> list[Change]:
        time = pace.ticks.next()
        changes = self._hold(time)
        self.steps += 1
        fresh = pace.tick()
        stepped = [
            (track, window)
            for track, window in pace.stepped
            if window.topics or not window.signals.isdisjoint(fresh)
        ]
        return changes + self._judge(time, stepped)

    def _repeat(self, pace: Pace, times: int) -> None:
        """Count ticks without doing them, so that a gap of an hour costs no time."""
        ticks = pace.ticks
        numbers = range(ticks.count, ticks.count + times)
        ticks.count += times
        self.steps += times
        for track, _ in pace.stepped:
            track.repeat(times, map(ticks.at, numbers))


def _fields(plan: Plan) -> dict[str, tuple[str, ...]]:
    """The readings of each topic."""
    readings = [s for s in plan.signals if isinstance(s, Reading)]
    topics = dict.fromkeys(r.topic for r in readings)
    return {t: tuple(r.name for r in readings if r.topic == t) for t in topics}
