"""A run, judged row by row: samples come in, properties step, verdicts come out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from ltlc.dataclass import dataclass
from ltlc.runtime.properties import Change
from ltlc.runtime.readers import Clocks, Readers, Stepped
from ltlc.runtime.sampling import Update, Value
from ltlc.runtime.session import Session
from ltlc.runtime.ticks import Pace, Paces
from ltlc.runtime.times import NEVER, seconds_text
from ltlc.runtime.tracking import Track

if TYPE_CHECKING:
    from ltlc.runtime.slice_keys import Row
    from ltlc.runtime.slice_steps import Slices


@dataclass(frozen=True, slots=True)
class Route:
    """Where messages on `topics` with samples of the readings `names` lead to.

    That is the `update` of the samples, the news, the properties that they concern, and
    those of which the messages renew ages, those of these signals; and what they are to
    those that are `sliced`. Most messages have no more than samples to be taken; the
    others concern something that `has_more`.
    """

    names: tuple[str, ...]
    topics: frozenset[str]
    update: Update
    news: tuple[int, ...]
    stepped: tuple[Stepped, ...]
    aged: tuple[tuple[Track, frozenset[str]], ...]
    sliced: tuple[tuple[Slices, Row], ...]
    has_more: bool


UNKNOWN = -NEVER
"""Before any time of a run: before any message, something may be due."""


class ByRows:
    """Judges a session row by row.

    Without a rate, `message` is a step of every property one of whose signals gets a
    sample by it, or that wants its news, from the first on at which all that it waits
    for has values. With a rate of f Hz a property has ticks, k/f s after the first
    message on a topic that it reads, for k = 0, 1, ...; a tick is a sample of every
    signal that has a value, and a step if all that is waited for has one. A tick sees
    the messages up to and including its own time; of two samples of a signal it sees
    the last. What waits for no value has ticks from the beginning of the session on.

    Between steps time passes: properties with clocks take clock steps (`Track.hold`),
    at one time before the steps. Messages renew ages as they come; one that makes no
    step is a clock step where an age was late, unless a tick is due now. What waits
    for no value has its first step when the session begins, with `begin` or else with
    the first message.

    The run is over `timeout` after its first step: what comes later is not taken.
    Times are in ns and must not decrease; after a jump back, begin a new session.
    """

    def __init__(self, session: Session, tracks: Iterable[Track] | None = None) -> None:
        """Take `session` forward, and of its properties `tracks` only, by default all.

        If anyone else does so meanwhile, judge what comes then by another of these.
        """
        self.session = session
        self.tracks = session.tracks if tracks is None else tuple(tracks)
        self._judged = {id(track) for track in self.tracks}
        self._readers = Readers(s for s in session.stepped if id(s[0]) in self._judged)
        self._sliced = [s for s in session.sliced if id(s.track) in self._judged]
        has_news = session.sampler.news(session.fields)
        self._has_more = bool(session.paces or has_news)
        self._soon = UNKNOWN
        self._clocks = Clocks(track for track, _ in self._readers.stepped)
        self._aging = self._aging_by_topic()
        self._routes: dict[tuple[tuple[str, ...], frozenset[str]], Route] = {}
        self._whole: dict[str, Route] = {}

    def begin(self, time: int) -> list[Change]:
        """The session begins at `time`, before the first message has come."""
        changes: list[Change] = []
        if self._go_on(time) and self._begin_session(time):
            self._first_steps(time, changes)
        return changes

    def message(self, time: int, topic: str, values: Sequence[Value]) -> list[Change]:
        """A message came in: `values` of the fields of `topic`, None for no sample."""
        self.session.messages[topic] += 1
        return self.judge(time, topic, values)

    def judge(
        self, time: int, topic: str, values: Sequence[Value] | None
    ) -> list[Change]:
        """Judge a message that was counted when it came in.

        If it is malformed, `values` is None: it is news, but has no samples.
        """
        route = self._whole.get(topic) or self._all_of(topic)
        if values is None:
            malformed = self.session.malformed
            malformed[topic] = malformed.get(topic, 0) + 1
            values = (None,) * len(route.names)
        for value in values:
            if value.__class__ is not float:
                route, values = self._converted(route, values)
                break
        return self.follow(time, route, values, are_counted=True)

    def _all_of(self, topic: str) -> Route:
        """Where a message on `topic` leads to; found once for all."""
        route = self.route(self.session.fields[topic], frozenset({topic}))
        self._whole[topic] = route
        return route

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
        route = self.route(names, frozenset(also))
        return self.follow(time, *self._converted(route, values))

    def route(
        self, names: tuple[str, ...], also: frozenset[str] = frozenset()
    ) -> Route:
        """Where samples of the readings `names` lead to, which is found once.

        There are messages on the topic of each, and on those in `also`.
        """
        route = self._routes.get((names, also))
        if route is None:
            sampler = self.session.sampler
            topics = also.union(*(sampler.topics[name] for name in names))
            update = sampler.update(names, topics)
            concerned = self._readers.concerned(update.fresh, topics)
            news, aged = sampler.news(topics), tuple(self._aged(topics))
            rows = ((s, s.cut.row(names, topics)) for s in self._sliced)
            sliced = tuple((slices, row) for slices, row in rows if row.concerns)
            more = bool(self._has_more or update.arrays or aged or sliced)
            route = Route(names, topics, update, news, concerned, aged, sliced, more)
            self._routes[names, also] = route
        return route

    def _aging_by_topic(self) -> dict[str, list[tuple[int, str]]]:
        """The properties, by number, that ask for ages of what comes on a topic."""
        found: dict[str, list[tuple[int, str]]] = {}
        of_signal = self.session.sampler.topics
        for number, (track, _) in enumerate(self._readers.stepped):
            of = track.property
            ages = (*of.ages, *(age for event in of.events for age in event.ages))
            for signal in dict.fromkeys(age.signal for age in ages):
                for topic in of_signal[signal]:
                    found.setdefault(topic, []).append((number, signal))
        return found

    def _aged(self, topics: frozenset[str]) -> Iterator[tuple[Track, frozenset[str]]]:
        """The properties that ask for ages of signals that come on these topics."""
        heard: dict[int, set[str]] = {}
        for topic in topics:
            for number, signal in self._aging.get(topic, ()):
                heard.setdefault(number, set()).add(signal)
        for number in sorted(heard):
            yield self._readers.stepped[number][0], frozenset(heard[number])

    def follow(
        self,
        time: int,
        route: Route,
        values: Sequence[Value],
        are_counted: bool = False,
    ) -> list[Change]:
        """Messages came in, whose samples `values` are as they are kept."""
        session = self.session
        if not are_counted:
            messages = session.messages
            for topic in route.topics:
                messages[topic] += 1
        changes: list[Change] = []
        is_first = False
        if time > self._soon or time < (session.time or 0):
            is_first = session.began is None
            if not self._reach(time, changes):
                return changes
        session.time = time
        if route.has_more and self._take_more(time, route, values, changes):
            return changes
        if route.names:
            session.steps += 1
        known = session.sampler.known
        update = route.update
        # As `update.take` does: calling it would be much of what a message costs.
        for place, target in update.plain:
            known[target] = values[place]
        if update.deep or update.derived:
            update.take_more(known, time, values)
        if route.stepped:
            self._judge(time, known, route.stepped, changes, route.topics)
        if route.aged:
            self._renew(time, (track for track, _ in route.aged), changes)
        if is_first:
            self._first_steps(time, changes)
            self._soon = self._next()
        return changes

    def _reach(self, time: int, changes: list[Change]) -> bool:
        """Let time pass up to messages, the first of which begin the session.

        Comes back with whether the run still goes on; `changes` grows.
        """
        changes += self._pass(time)
        if not self._go_on(time):
            return False
        self._begin_session(time)
        self._soon = self._next()
        return True

    def _next(self) -> int:
        """Up to this, nothing is due before a message, and the run goes on."""
        if self.session.paces is not None:
            return UNKNOWN
        soon = (slices.soon for slices in self._sliced)
        return min(self._clocks.soon, self.session.end, *soon)

    def _take_more(
        self,
        time: int,
        route: Route,
        values: Sequence[Value],
        changes: list[Change],
    ) -> bool:
        """Take what messages are besides samples; whether these wait for a tick."""
        session = self.session
        if route.update.arrays:
            session.sampler.count(route.update.arrays, values)
        for track, heard in route.aged:
            track.hear(time, heard)
        for slices, row in route.sliced:
            slices.take(time, row, values, changes)
            if slices.soon < self._soon or session.end < self._soon:
                self._soon = self._next()
        if session.paces is not None:
            self._keep(session.paces, time, route, values, changes)
            return True
        if session.sampler.heard is not route.news:
            session.sampler.hear(route.news)
        return False

    def _keep(
        self,
        paces: Paces,
        time: int,
        route: Route,
        values: Sequence[Value],
        changes: list[Change],
    ) -> None:
        """Keep samples for the next tick."""
        paces.keep(time, route.topics, dict(zip(route.names, values, strict=True)))
        renewed = [track for track, _ in route.aged if track.is_renewed]
        self._renew(time, paces.without_tick(time, renewed), changes)

    def _converted(
        self, route: Route, values: Sequence[Value]
    ) -> tuple[Route, Sequence[Value]]:
        """The samples among `values` as they are kept, and the route of these."""
        taken = self.session.sampler.converted(route.names, values)
        if len(taken) < len(route.names):
            route = self.route(tuple(taken), route.topics)
        return route, tuple(taken.values())

    def advance(self, time: int) -> list[Change]:
        """It is `time` now: do what is due by then, and see whether the run is over.

        Called at the end of a recording, and now and then while a live run goes on.
        """
        session = self.session
        changes = self._pass(time)
        paces = session.paces
        if self._go_on(time) and paces is not None:
            while (pace := paces.before(time + 1)) is not None:
                changes += self._tick(pace)
        if not session.is_over:
            changes += [c for slices in self._sliced for c in slices.advance(time)]
        return changes

    def due(self) -> int | None:
        """When to look for the next clock step, by `advance`; None: never.

        None comes before, unless a step comes first.
        """
        due = 1 + min([self._clocks.soon, *(slices.soon for slices in self._sliced)])
        return due if due <= self.session.end and due < NEVER else None

    def _pass(self, time: int) -> list[Change]:
        """Do the ticks before `time`, and the clock steps up to and including it."""
        changes = self._pass_whole(time)
        if self._sliced:
            changes += [c for slices in self._sliced for c in slices.hold(time)]
            changes.sort(key=lambda change: change.moment.time)
        return changes

    def _pass_whole(self, time: int) -> list[Change]:
        """The same for the properties that are judged on the whole run."""
        session = self.session
        if session.paces is None:
            return self._clocks.hold(min(time, session.end))
        changes: list[Change] = []
        while pace := session.paces.before(min(time, session.end + 1)):
            changes += self._tick(pace)
            # Where the run is still to begin, another property may say when it ends.
            if pace.is_settled and (session.has_begun or session.plan.timeout is None):
                until = min(time, session.end + 1, self._clocks.soon + 1)
                # The last is done: slopes ask when the sample before was taken.
                self._repeat(pace, max(0, pace.ticks.before(until) - 1))
        return changes + self._clocks.hold(min(time, session.end))

    def _go_on(self, time: int) -> bool:
        """Set the time; whether the run still goes on at it."""
        session, self._soon = self.session, UNKNOWN
        if session.is_over:
            return False
        if session.time is not None and time < session.time:
            now = seconds_text(session.time)
            raise ValueError(f"time goes back from {now} s to {seconds_text(time)} s")
        if time > session.end:
            session.is_over, session.time = True, session.end
            return False
        session.time = time
        return True

    def _begin_session(self, time: int) -> bool:
        """The session begins at `time`, unless it has begun."""
        session = self.session
        if session.began is not None:
            return False
        session.began = time
        self._clocks.begin(time)
        if session.paces is not None:
            session.paces.start(time)
        for slices in self._sliced:
            slices.begin(time)
        return True

    def _first_steps(self, time: int, changes: list[Change]) -> None:
        """Step what begins with the session and has not: no message of it has come."""
        if self.session.paces is None:
            stepped = self._readers.stepped
            waiting = [s for s in stepped if s[0].property.from_session]
            sampler = self.session.sampler
            sampler.hear(())
            silent = [s for s in waiting if not s[0].steps and not s[0].invalid]
            self._judge(time, sampler.known, silent, changes)
            changes += [c for slices in self._sliced for c in slices.first_step(time)]

    def _judge(
        self,
        time: int,
        known: list[Value],
        stepped: Sequence[Stepped],
        changes: list[Change],
        topics: frozenset[str] = frozenset(),
    ) -> None:
        """Step those of the properties whose inputs have values; `changes` grows.

        Messages have come on `topics`; to a property that still waits they are lost.
        """
        for track, window in stepped:
            place = window.place
            values = (known[place],) if place >= 0 else window.values(known)
            if track.steps or None not in values or track.property.is_ready(values):
                previous = track.step(time, values)
                if previous is not None:  # as at the first step
                    changes.append(track.change(previous, time))
                    self._begin_run(time)
            else:
                self._skip(track, topics & window.read)
            if track.property.timed:
                self._note(track)

    def _begin_run(self, time: int) -> None:
        """The run begins with its first step; from then on its end is known."""
        if not self.session.has_begun:
            self.session.begin_run(time)
            self._soon = min(self._soon, self.session.end)

    def _note(self, track: Track) -> None:
        """A property with clocks has had a step, and may change sooner or later."""
        self._clocks.note(track)
        if (soon := self._clocks.soon) < self._soon:
            self._soon = soon

    def _skip(self, track: Track, topics: Iterable[str]) -> None:
        """Count messages before the first step; those that ticks saw, all at once."""
        paces = self.session.paces
        for topic in topics:
            so_far = track.skipped.get(topic, 0) + 1
            track.skipped[topic] = so_far if paces is None else paces.taken[topic]

    def _renew(self, time: int, tracks: Iterable[Track], changes: list[Change]) -> None:
        """Take the clock steps at which late ages are young, by what made no step."""
        for track in tracks:
            if track.is_renewed:
                changes += track.renew(time)
                self._note(track)

    def _tick(self, pace: Pace) -> list[Change]:
        time = pace.ticks.next()
        changes = self._clocks.hold(time)
        self.session.steps += 1
        heard = frozenset(pace.heard)
        stepped = [s for s in pace.tick() if id(s[0]) in self._judged]
        self._judge(time, pace.sampler.known, stepped, changes, heard)
        self._renew(time, (track for track, _ in stepped), changes)
        return changes

    def _repeat(self, pace: Pace, times: int) -> None:
        """Count ticks without doing them, so that a gap of an hour costs no time."""
        ticks = pace.ticks
        numbers = range(ticks.count, ticks.count + times)
        ticks.count += times
        self.session.steps += times
        for track, _ in pace.stepped:
            track.repeat(times, map(ticks.at, numbers))
