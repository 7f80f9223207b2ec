"""Traffic on topics, and the steps that a property makes of it, by definition: the reference for sampling."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import count

from ltlc.assurance.histories import Instant, Origins, Sample, sample_text
from ltlc.assurance.messages import Content
from ltlc.assurance.values import PERIOD, Frame, Frames, Samples
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.words import Letter
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Signal

RANDOM_RUNS, RANDOM_EVENTS, RANDOM_MESSAGES = 30, 20, 60
MOST_EVENTS = 20_000
"""How many events random runs may have, all together, if there is more than one."""

_SECOND = 10**9

MOST_TICKS = 50
"""How many ticks or messages a timeout has that is waited for."""


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
class Passed:
    """It is `time` now."""

    time: Nanoseconds

    def __str__(self) -> str:
        return f"the time {self.time} ns"


Event = Heard | Passed


@dataclass(frozen=True, slots=True)
class Settings:
    """How samples are taken: at `rate` in Hz or at every message, for `timeout` s from the first step or for ever."""

    rate: float | None = None
    timeout: float | None = None


class Traffic:
    """Messages from which one property's samples come."""

    def __init__(self, samples: Samples) -> None:
        self.samples = samples
        self.sources = samples.sources
        self._messages: dict[Frame, tuple[Said, ...]] = {}

    def of_frames(self, course: Frames) -> tuple[Event, ...]:
        """Messages on all topics, one `PERIOD` after the other."""
        return tuple(event for number, frame in enumerate(course) for event in self._of_frame(number * PERIOD, frame))

    def _of_frame(self, time: Nanoseconds, frame: Frame) -> Iterator[Event]:
        if frame not in self._messages:
            self._messages[frame] = tuple(self._said(topic, frame.sample) for topic in self.sources.topics())
        yield from (Heard(time, said) for said in self._messages[frame])
        yield Passed(time)

    def _said(self, topic: str, sample: Sample) -> Said:
        on_topic = self.sources.on(topic, sample)
        return Said(topic, self.sources.content(on_topic), on_topic)

    def at_random(self, settings: Settings) -> Iterator[tuple[Event, ...]]:
        """Messages on one topic or another, some of them without some entries, after gaps of many lengths."""
        period = _nanoseconds(0.1) if settings.rate is None else round(_SECOND / settings.rate)
        gaps = [0, period // 3, period, 2 * period, 8 * period]
        if settings.timeout is not None and _nanoseconds(settings.timeout) < MOST_TICKS * period:
            gaps.append(_nanoseconds(settings.timeout))
        messages = [self._at_random() for _ in range(RANDOM_MESSAGES)]
        length = len(self.sources.topics()) * (self.samples.reach - 1 + RANDOM_EVENTS)
        for _ in range(max(1, min(RANDOM_RUNS, MOST_EVENTS // length))):
            yield tuple(self._events(messages, gaps, length))

    def _at_random(self) -> Said:
        sample = self.sources.without_entries(self.samples.draw().sample, self.samples.chance)
        return self._said(self.samples.chance.choice(list(self.sources.topics())), sample)

    def _events(self, messages: Sequence[Said], gaps: Sequence[Nanoseconds], length: int) -> Iterator[Event]:
        chance = self.samples.chance
        time = chance.choice([0, 1000 * _SECOND])
        for _ in range(length):
            yield Heard(time, chance.choice(messages))
            time += chance.choice(gaps)
        yield Passed(time)


def steps_by_event(origins: Origins, events: Sequence[Event], settings: Settings) -> list[list[Letter | None]]:
    """The steps of a property that each event leads to: their letters, or None where something is NaN."""
    timed = list(_ticks(events, settings.rate) if settings.rate else _messages(events))
    run = [instant for _, instant in timed]
    found = origins.steps(run)
    first = next((run[step.instant].time for step in found if step.letter is not None), math.inf)
    end = math.inf if settings.timeout is None else first + _nanoseconds(settings.timeout)
    by_event: list[list[Letter | None]] = [[] for _ in events]
    for step in found:
        event, instant = timed[step.instant]
        if instant.time <= end:
            by_event[event].append(step.letter)
    return by_event


def _messages(events: Sequence[Event]) -> Iterator[tuple[int, Instant]]:
    """Every message is an instant."""
    for number, event in enumerate(events):
        if isinstance(event, Heard):
            yield number, Instant(event.time, event.said.sample)


def _ticks(events: Sequence[Event], rate: float) -> Iterator[tuple[int, Instant]]:
    """The k-th tick, k = 0, 1, ..., is k / `rate` s after the first message, cut off below a nanosecond.

    It sees the messages up to its own time.
    It comes with the first event that shows that there is no further such message.
    """
    latest: dict[Signal, Value] = {}
    start: Nanoseconds | None = None
    ticks = (math.floor(k * _SECOND / Fraction(repr(rate))) for k in count())
    since = next(ticks)
    for number, event in enumerate(events):
        while start is not None and start + since < event.time + isinstance(event, Passed):
            yield number, Instant(start + since, dict(latest))
            since = next(ticks)
        if isinstance(event, Heard):
            latest |= event.said.sample
            start = event.time if start is None else start


def _nanoseconds(seconds: float) -> Nanoseconds:
    """A number of seconds as its author wrote it."""
    return round(Fraction(repr(seconds)) * _SECOND)
