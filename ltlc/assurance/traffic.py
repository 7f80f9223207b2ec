"""Traffic on topics, and the steps that a property makes of it, by definition: the reference for sampling."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

from ltlc.assurance.histories import History, Instant, Origins, Sample, sample_text, topics_of
from ltlc.assurance.messages import Content
from ltlc.assurance.replay import Run
from ltlc.assurance.sources import Sources
from ltlc.assurance.values import PERIOD, Frame, Frames, Samples
from ltlc.assurance.walks import durations
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.instants import Instant as Judged
from ltlc.semantics.timed_atoms import counts_of, messages_of, news_that_counts, timed_atoms
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import trackers_of
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Signal

RANDOM_RUNS, RANDOM_EVENTS, RANDOM_MESSAGES = 30, 20, 60
MOST_EVENTS = 20_000
"""How many events random runs may have, all together, if there is more than one."""

TIMED_RUNS, RUNS_WITH_OPENINGS, TIMED_EVENTS = 200, 600, 8
"""Runs around the times at which clocks expire; more where values are taken at openings, which take more to show."""

_SECOND = 10**9

MOST_TICKS = 50
"""How many ticks or messages a wait has, for a timeout or for a clock."""


@dataclass(frozen=True, eq=False, slots=True)
class Said:
    """A message on `topic`, by what it says at which place, and the values of what is read from it."""

    topic: str
    content: Content
    sample: Sample


@dataclass(frozen=True, slots=True)
class Heard:
    """A message comes in."""

    time: Nanoseconds
    said: Said

    def __str__(self) -> str:
        return f"a message on {self.said.topic} at {self.time} ns with {sample_text(self.said.sample)}"


@dataclass(frozen=True, slots=True)
class Together:
    """Messages come in at the same moment, as one step; a node takes them one by one."""

    time: Nanoseconds
    said: tuple[Said, ...]

    @property
    def sample(self) -> dict[Signal, Value]:
        """What all of them say."""
        return {signal: value for each in self.said for signal, value in each.sample.items()}

    @property
    def topics(self) -> frozenset[str]:
        """Those that they come on."""
        return frozenset(each.topic for each in self.said)

    def __str__(self) -> str:
        return f"messages at {self.time} ns with {sample_text(self.sample)}"


@dataclass(frozen=True, slots=True)
class Passed:
    """It is `time` now."""

    time: Nanoseconds

    def __str__(self) -> str:
        return f"the time {self.time} ns"


@dataclass(frozen=True, slots=True)
class Begun:
    """The session begins at `time`, before any message."""

    time: Nanoseconds

    def __str__(self) -> str:
        return f"the beginning of the session at {self.time} ns"


@dataclass(frozen=True, slots=True)
class Quiet:
    """Nothing comes up to `time`: only the timer rings that the session asks for."""

    time: Nanoseconds

    def __str__(self) -> str:
        return f"silence up to {self.time} ns"


Event = Begun | Heard | Together | Passed | Quiet


@dataclass(frozen=True, slots=True)
class Settings:
    """How samples are taken: at `rate` in Hz or at every message, for `timeout` ns from the first step or forever."""

    rate: float | None = None
    timeout: Nanoseconds | None = None


def rings(due: Callable[[], Nanoseconds | None], until: Nanoseconds) -> Iterator[Nanoseconds]:
    """When a timer rings up to a time, which is set anew to what is `due`. Raises RuntimeError if that is the same."""
    rang = None
    while (time := due()) is not None and time <= until:
        if time == rang:
            raise RuntimeError(f"the timer rings at {time} ns again and again")
        yield time
        rang = time


class Traffic:
    """Messages from which one property's samples come; with `at_once`, also several at a moment, and before time 0."""

    def __init__(self, samples: Samples, at_once: bool = False) -> None:
        self.samples = samples
        self.at_once = at_once
        self._starts = [0, 1000 * _SECOND, *([-1000 * _SECOND] if at_once else [])]
        self.sources = samples.sources
        self._messages: dict[Frame, tuple[Said, ...]] = {}

    def of_frames(self, course: Frames) -> tuple[Event, ...]:
        """Messages on all topics, one `PERIOD` after the other."""
        return tuple(event for number, frame in enumerate(course) for event in self._of_frame(number * PERIOD, frame))

    def _of_frame(self, time: Nanoseconds, frame: Frame) -> Iterator[Event]:
        yield from (Heard(time, said) for said in self.all(frame))
        yield Passed(time)

    def all(self, frame: Frame) -> tuple[Said, ...]:
        """Messages on all topics."""
        if frame not in self._messages:
            self._messages[frame] = tuple(self._said(topic, frame.sample) for topic in self.sources.topics())
        return self._messages[frame]

    def _said(self, topic: str, sample: Sample) -> Said:
        on_topic = self.sources.on(topic, sample)
        return Said(topic, self.sources.content(on_topic), on_topic)

    def at_random(self, compiled: Compiled, settings: Settings) -> Iterator[Run[Event]]:
        """Messages on one topic or another, some of them without some entries, after gaps of many lengths."""
        gaps, followed = self._gaps(settings), Followed(compiled, self.sources)
        messages = [self._at_random(settings) for _ in range(RANDOM_MESSAGES)]
        length = len(self.sources.topics()) * (self.samples.reach - 1 + RANDOM_EVENTS)
        for _ in range(max(1, min(RANDOM_RUNS, MOST_EVENTS // length))):
            events = tuple(self._events(messages, gaps, length))
            follower = Follower(followed, settings)
            yield Run(events, [follower.take(event) for event in events], settings)

    def _gaps(self, settings: Settings) -> list[Nanoseconds]:
        period = _nanoseconds(0.1) if settings.rate is None else round(_SECOND / settings.rate)
        gaps = [0, period // 3, period, 2 * period, 8 * period]
        if settings.timeout is not None and settings.timeout < MOST_TICKS * period:
            gaps.append(settings.timeout)
        return gaps

    def _at_random(self, settings: Settings) -> Said:
        """A message that may lack entries, but not all with a rate: ticks of what is given samples begin with one."""
        whole = self.samples.draw().sample
        sample = self.sources.without_entries(whole, self.samples.chance)
        topic = self.samples.chance.choice(list(self.sources.topics()))
        said = self._said(topic, sample)
        is_nothing = self.at_once and settings.rate is not None and not said.sample
        return self._said(topic, whole) if is_nothing else said

    def _events(self, messages: Sequence[Said], gaps: Sequence[Nanoseconds], length: int) -> Iterator[Event]:
        chance = self.samples.chance
        time = chance.choice(self._starts)
        for _ in range(length):
            yield Heard(time, chance.choice(messages))
            time += chance.choice(gaps)
        yield Passed(time)

    def in_time(self, compiled: Compiled, settings: Settings) -> Iterator[Run[Event]]:
        """Runs of messages, waiting and silence, around the times at which clocks expire."""
        longest = max(durations(compiled.specification.property), default=0)
        followed = Followed(compiled, self.sources)
        length = max(1, len(self.sources.topics())) * (self.samples.reach - 1 + TIMED_EVENTS)
        most = RUNS_WITH_OPENINGS if self.samples.origins.remembers else TIMED_RUNS
        for number in range(max(1, min(most, MOST_EVENTS // length))):
            chosen = settings if number % 2 else _at_the_pace_of(longest, settings)
            follower = Follower(followed, chosen)
            events: list[Event] = []
            steps: list[list[Judged | None]] = []
            for event in self._around_expiry(follower, chosen, longest):
                events.append(event)
                steps.append(follower.take(event))
            yield Run(events, steps, chosen)

    def _around_expiry(self, follower: Follower, settings: Settings, longest: Nanoseconds) -> Iterator[Event]:
        """What happens next depends on what has become of what happened before."""
        chance, gaps = self.samples.chance, [*self._gaps(settings), 1, longest, longest + 1]
        most = math.inf if settings.rate is None else MOST_TICKS * _SECOND / settings.rate
        time = chance.choice(self._starts)
        if chance.random() < 1 / 4:
            yield Begun(time)
        for frame in self.samples.course(self.samples.reach - 1):
            yield from (Heard(time, said) for said in self.all(frame))
            time += gaps[2]
        for _ in range(TIMED_EVENTS):
            moments = () if follower.run is None else [moment for _, moment in follower.run.dues()]
            edges = [moment - time + side for moment in moments for side in (-1, 0, 1)]
            near = [gap for gap in edges if 0 <= gap <= most]
            time += chance.choice([0, chance.choice([gap for gap in gaps if gap <= most]), *near, *near])
            yield from self._at(time, settings)

    def _at(self, time: Nanoseconds, settings: Settings) -> Iterator[Event]:
        """One message, messages on all topics, or none, as where no topic is read."""
        chance = self.samples.chance
        match chance.randrange(8 if self.sources.topics() else 2):
            case 0:
                yield Passed(time)
            case 1:
                yield Passed(time) if settings.rate else Quiet(time)
            case 2:
                yield Heard(time, self._at_random(settings))
            case kind:
                known = list(self.samples.by_letter(self.samples.start).values())
                frame = chance.choice(chance.choice(known)) if known else self.samples.draw()
                said = self.all(frame)
                if self.at_once and kind == 3:
                    yield Together(time, said)
                else:
                    yield from (Heard(time, each) for each in (said if kind < 5 else (chance.choice(said),)))


def _at_the_pace_of(longest: Nanoseconds, settings: Settings) -> Settings:
    """`settings` with a rate at which the longest duration takes few ticks, if there is a rate."""
    slow = 7 * _SECOND / longest if longest else 1.0
    return settings if settings.rate is None or settings.rate < slow else replace(settings, rate=slow)


class Followed:
    """What followers of a property have in common, in all runs."""

    def __init__(self, compiled: Compiled, sources: Sources) -> None:
        self.origins = Origins(compiled.specification, sources.signals)
        messages = messages_of(timed_atoms(compiled.formula))
        self.messages = {name: topics_of(compiled.specification.arrival(name)) for name in messages}
        """The topics from whose messages ages count, by the name of the news."""
        self.waits = bool(compiled.machine.waits_for)
        self.timed = trackers_of(compiled.formula), news_that_counts(compiled.formula)
        self.counts = counts_of(compiled.formula)


class Follower:
    """What a property makes of events, one after the other, by definition: its steps, and the clock steps between."""

    def __init__(self, of: Followed, settings: Settings) -> None:
        self._of = of
        self._history = History(of.origins)
        self._settings = settings
        self._came: dict[str, Nanoseconds] = {}
        self._end = math.inf
        self._latest: dict[Signal, Value] = {}
        self._heard: frozenset[str] = frozenset()
        self._start: Nanoseconds | None = None
        self._tick = 0
        self.run: TimedRun | None = None

    def take(self, event: Event) -> list[Judged | None]:
        """The steps that `event` leads to, up to its time: their letters, or None where something is NaN."""
        if self.run is None:
            self.run = self._begun(event)
            if self.run is None:
                return []
            if not self._of.waits and self._settings.rate is not None:
                self._start = event.time
        found = [each for tick in self._ticks(event) for each in self._judged(self.run, tick)]
        match event:
            case Begun(time) if not self._of.waits and self._settings.rate is None:
                found += self._judged(self.run, Instant(time, {}, concerns_all=True))
            case Heard(time, said):
                found += self._taken(self.run, time, said.sample, frozenset({said.topic}))
            case Together(time):
                found += self._taken(self.run, time, event.sample, event.topics)
            case _:
                pass
        return [*found, *self._held(self.run, event.time)]

    def _taken(
        self, run: TimedRun, time: Nanoseconds, sample: Sample, topics: frozenset[str]
    ) -> Iterable[Judged | None]:
        """What messages on `topics` lead to."""
        if self._settings.rate is None:
            return self._judged(run, Instant(time, sample, topics))
        self._start = time if self._start is None else self._start
        self._latest |= sample
        self._heard |= topics
        self._came |= dict.fromkeys(topics, time)
        return self._hear(run, time, topics) if time != self._start + self._period() else ()

    def _begun(self, event: Event) -> TimedRun | None:
        """The session begins, at the latest with the first message."""
        return self._new_run(event.time) if isinstance(event, Begun | Heard | Together) else None

    def _new_run(self, began: Nanoseconds) -> TimedRun:
        return TimedRun(*self._of.timed, began, self._history.openings.clock_step, self._of.counts)

    def _ticks(self, event: Event) -> Iterator[Instant]:
        """Those that `event` shows to be due: a tick sees the messages up to its own time."""
        end = event.time + isinstance(event, Passed)
        while self._start is not None and (time := self._start + self._period()) < end:
            self._tick += 1
            yield Instant(time, dict(self._latest), self._heard, concerns_all=True)
            self._heard = frozenset()

    def _period(self) -> Nanoseconds:
        """How long after the first message the next tick is: k / `rate` s, cut off below a nanosecond."""
        assert self._settings.rate is not None
        return math.floor(self._tick * _SECOND / Fraction(repr(self._settings.rate)))

    def _judged(self, run: TimedRun, instant: Instant) -> list[Judged | None]:
        """What the property makes of an instant; where it is no step, ages count from its messages all the same."""
        held = self._held(run, instant.time)
        step = self._history.step(instant)
        if instant.time > self._end:
            return held
        is_tick = self._settings.rate is not None
        now = {t for t in instant.heard if self._came[t] == instant.time} if is_tick else instant.heard
        if step is None:
            return [*held, *self._hear(run, instant.time, now)]
        if step.letter is None:
            return [*held, None, *self._hear(run, instant.time, now)]
        if run.time is None and self._settings.timeout is not None:
            self._end = min(self._end, instant.time + self._settings.timeout)
        letter = step.letter.difference(self._of.messages).union(self._told(now))
        return [*held, *self._noted(run.step(instant.time, letter))]

    def _told(self, topics: Collection[str]) -> set[str]:
        return {name for name, of in self._of.messages.items() if not of.isdisjoint(topics)}

    def _hear(self, run: TimedRun, time: Nanoseconds, topics: Collection[str]) -> list[Judged | None]:
        """Messages on `topics` that make no step."""
        return self._noted(run.hear(time, self._told(topics))) if time <= self._end else []

    def _held(self, run: TimedRun, time: Nanoseconds) -> list[Judged | None]:
        return self._noted(run.hold(int(min(time, self._end))))

    def _noted(self, judged: Iterable[Judged]) -> list[Judged | None]:
        """What is judged, one after the other: values at an opening depend on it."""
        found: list[Judged | None] = []
        for each in judged:
            self._history.openings.note(each)
            found.append(each)
        return found


def _nanoseconds(seconds: float) -> Nanoseconds:
    """A number of seconds as its author wrote it."""
    return round(Fraction(repr(seconds)) * _SECOND)
