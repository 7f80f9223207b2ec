"""A run: samples come in, properties are stepped, verdicts come out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from ltlc.runtime.readers import Clocks, Readers, Stepped
from ltlc.runtime.sampling import Derived, Reading, Sampler, Update, Value, Window
from ltlc.runtime.ticks import Pace, Paces
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


@dataclass(frozen=True, slots=True)
class Route:
    """Where messages on `topics` with samples of the readings `names` lead to.

    That is the `update` of the samples, the properties that they concern, and those of
    which the messages renew ages, those of these signals.
    """

    names: tuple[str, ...]
    topics: frozenset[str]
    update: Update
    stepped: tuple[Stepped, ...]
    aged: tuple[tuple[Track, frozenset[str]], ...]


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
    at one time before the steps. Messages renew ages as they come; one that makes no
    step is a clock step where an age was late, unless a tick is due now. What reads
    nothing but which messages come has its first step when the session begins, with
    `begin` or else with the first message.

    The run is over `timeout` after its first step: what comes later is not taken.
    Times are in ns and must not decrease; after a jump back, begin a new session.
    A `track` follows each property.
    """

    def __init__(
        self, plan: Plan, keep_verdicts: bool = False, track: type[Track] = Track
    ) -> None:
        self.plan = plan
        self.sampler = self._new_sampler()
        self.tracks = tuple(track(p, keep_verdicts) for p in plan.properties)
        self.steps = 0
        self.time: int | None = None
        self.is_over = False
        self.began: int | None = None
        self.has_begun = False
        self.end = NEVER
        self.stepped = [
            (track, self.sampler.window(track.property.inputs)) for track in self.tracks
        ]
        self._fields = _fields(plan)
        self.messages = dict.fromkeys(self._fields, 0)
        self.lost: dict[str, Loss] = {}
        self.malformed: dict[str, int] = {}
        self.paces = None if plan.rate is None else self._new_paces(plan.rate)
        self.watch(self.tracks)

    def _new_sampler(self) -> Sampler:
        inputs = [i for p in self.plan.properties for i in p.inputs]
        return Sampler(self.plan.signals, inputs)

    def _new_paces(self, rate: float) -> Paces:
        waiting = [(track, self.topics(window)) for track, window in self.stepped]
        return Paces(rate, self._new_sampler, waiting, self._fields)

    def watch(self, tracks: Iterable[Track]) -> None:
        """From now on, what comes and time itself concern these properties only.

        What others do with them in between may have changed when they are due.
        """
        self._watched = {id(track) for track in tracks}
        self._readers = Readers(s for s in self.stepped if id(s[0]) in self._watched)
        self._clocks = Clocks(t for t in self.tracks if id(t) in self._watched)
        self._goes_by_time = self.paces is not None or bool(self._clocks)
        self._routes: dict[tuple[tuple[str, ...], frozenset[str]], Route] = {}
        self._whole: dict[str, Route] = {}

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
        changes: list[Change] = []
        if self._go_on(time) and self._begin_session(time):
            self._first_steps(time, changes)
        return changes

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
        route = self._whole.get(topic)
        if route is None:
            route = self.route(self._fields[topic], frozenset({topic}))
            self._whole[topic] = route
        if values is None:
            self.malformed[topic] = self.malformed.get(topic, 0) + 1
            values = (None,) * len(route.names)
        return self._take(time, route, values)

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
        return self.follow(time, self.route(names, frozenset(also)), values)

    def follow(self, time: int, route: Route, values: Sequence[Value]) -> list[Change]:
        """Samples of the readings of a `route` came in, and messages on its topics."""
        for topic in route.topics:
            self.messages[topic] += 1
        return self._take(time, route, values)

    def route(
        self, names: tuple[str, ...], also: frozenset[str] = frozenset()
    ) -> Route:
        """Where samples of the readings `names` lead to, until `watch` is called.

        There are messages on the topic of each, and on those in `also`.
        """
        route = self._routes.get((names, also))
        if route is None:
            topics = also.union(*(self.sampler.topics[name] for name in names))
            update = self.sampler.update(names)
            concerned = self._readers.concerned(update.fresh, topics)
            route = Route(names, topics, update, concerned, tuple(self._aged(topics)))
            self._routes[names, also] = route
        return route

    def _aged(self, topics: frozenset[str]) -> Iterator[tuple[Track, frozenset[str]]]:
        """The properties that ask for ages of signals that come on these topics."""
        for track, _ in self._readers.stepped:
            of = track.property
            ages = (*of.ages, *(age for event in of.events for age in event.ages))
            signals = {age.signal for age in ages}
            of_signal = self.sampler.topics
            heard = frozenset(s for s in signals if not topics.isdisjoint(of_signal[s]))
            if heard:
                yield track, heard

    def _take(self, time: int, route: Route, values: Sequence[Value]) -> list[Change]:
        """Messages came in, with `values` of the readings of their `route`."""
        changes = self._pass(time) if self._goes_by_time else []
        if not self._go_on(time):
            return changes
        is_first = self.began is None and self._begin_session(time)
        for track, heard in route.aged:
            track.hear(time, heard)
        for value in values:
            if value.__class__ is not float:
                route, values = self._converted(route, values)
                break
        if self.paces is not None:
            taken = dict(zip(route.names, values, strict=True))
            self.paces.keep(time, route.topics, taken)
            renewed = [track for track, _ in route.aged if track.is_renewed]
            self._renew(time, self.paces.without_tick(time, renewed), changes)
            return changes
        if route.names:
            self.steps += 1
        self.sampler.hear(route.topics)
        route.update.take(time, values)
        self._judge(time, route.stepped, changes)
        if route.aged:
            self._renew(time, (track for track, _ in route.aged), changes)
        if is_first:
            self._first_steps(time, changes)
        return changes

    def _converted(
        self, route: Route, values: Sequence[Value]
    ) -> tuple[Route, Sequence[Value]]:
        """The samples among `values` as they are kept, and the route of these."""
        taken = self.sampler.converted(route.names, values)
        self.sampler.count(taken)
        if len(taken) < len(route.names):
            route = self.route(tuple(taken), route.topics)
        return route, tuple(taken.values())

    def topics(self, window: Window) -> frozenset[str]:
        """The topics that what is looked at is read from."""
        read = (self.sampler.topics[name] for name in window.signals)
        return window.topics.union(*read)

    def sampler_of(self, track: Track) -> Sampler:
        """The sampler that has the samples that a property looks at."""
        pace = None if self.paces is None else self.paces.of(track)
        return self.sampler if pace is None else pace.sampler

    @property
    def unseen(self) -> dict[str, int]:
        """How many messages on each topic no tick has seen: others came before it."""
        return {} if self.paces is None else self.paces.unseen()

    def advance(self, time: int) -> list[Change]:
        """It is `time` now: do what is due by then, and see whether the run is over.

        Called at the end of a recording, and now and then while a live run goes on.
        """
        changes = self._pass(time)
        if self._go_on(time) and self.paces is not None:
            while (pace := self.paces.before(time + 1)) is not None:
                changes += self._tick(pace)
        return changes

    def due(self) -> int | None:
        """When to look for the next clock step, by `advance`; None: never.

        None comes before, unless a step comes first.
        """
        due = self._clocks.due()
        return due if due <= self.end and due < NEVER else None

    def _pass(self, time: int) -> list[Change]:
        """Do the ticks before `time`, and the clock steps up to and including it."""
        if self.paces is None:
            return self._clocks.hold(min(time, self.end))
        changes: list[Change] = []
        while pace := self.paces.before(min(time, self.end + 1)):
            changes += self._tick(pace)
            # Where the run is still to begin, another property may say when it ends.
            if pace.is_settled and (self.has_begun or self.plan.timeout is None):
                until = min(time, self.end + 1, self._clocks.due())
                # The last is done: slopes ask when the sample before was taken.
                self._repeat(pace, max(0, pace.ticks.before(until) - 1))
        return changes + self._clocks.hold(min(time, self.end))

    def _go_on(self, time: int) -> bool:
        """Set the time; whether the run still goes on at it."""
        if self.is_over:
            return False
        if self.time is not None and time < self.time:
            now = seconds_text(self.time)
            raise ValueError(f"time goes back from {now} s to {seconds_text(time)} s")
        if time > self.end:
            self.is_over, self.time = True, self.end
            return False
        self.time = time
        return True

    def _begin_session(self, time: int) -> bool:
        """The session begins at `time`, unless it has begun."""
        if self.began is not None:
            return False
        self.began = time
        self._clocks.begin(time)
        if self.paces is not None:
            self.paces.start(time)
        return True

    def _first_steps(self, time: int, changes: list[Change]) -> None:
        """Step what begins with the session and has not: no message has come."""
        if self.paces is None:
            stepped = self._readers.stepped
            waiting = [s for s in stepped if s[0].property.from_session]
            self.sampler.hear(())
            self._judge(time, [s for s in waiting if not s[0].steps], changes)

    def _judge(
        self, time: int, stepped: Iterable[Stepped], changes: list[Change]
    ) -> None:
        """Step those of the properties whose inputs have values; `changes` grows."""
        for track, window in stepped:
            values = window.values()
            if values is not None:
                change = track.step(time, values)
                if change is not None:
                    changes.append(change)
                if not self.has_begun and track.steps:
                    self._begin(time)
            if track.property.timed:
                self._clocks.note(track)

    def _renew(self, time: int, tracks: Iterable[Track], changes: list[Change]) -> None:
        """Take the clock steps at which late ages are young, by what made no step."""
        for track in tracks:
            if track.is_renewed:
                changes += track.renew(time)
                self._clocks.note(track)

    def _begin(self, time: int) -> None:
        """The run begins with its first step; from now on its last moment is known."""
        self.has_begun = True
        if self.plan.timeout is not None:
            self.end = time + self.plan.timeout

    def _tick(self, pace: Pace) -> list[Change]:
        time = pace.ticks.next()
        changes = self._clocks.hold(time)
        self.steps += 1
        stepped = [s for s in pace.tick() if id(s[0]) in self._watched]
        self._judge(time, stepped, changes)
        self._renew(time, (track for track, _ in stepped), changes)
        return changes

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
    names: dict[str, list[str]] = {}
    for signal in plan.signals:
        if isinstance(signal, Reading):
            names.setdefault(signal.topic, []).append(signal.name)
    return {topic: tuple(of) for topic, of in names.items()}
