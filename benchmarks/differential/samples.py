"""The steps of a property on a recording: what it reads at each, which messages are news, and when topics spoke.

By `docs/language.md`, 'Steps, time and missing data' and 'When a run begins'; ticks begin with the first message on a
topic that the property reads, and ages count from the message itself.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from benchmarks.differential.names import Said
from benchmarks.differential.values import Computed, Frame, Key, Latched, NoValueError, valued

SECOND = 10**9


@dataclass(frozen=True)
class Row:
    """Messages of one time: for each topic that has one, the values of its signals."""

    time: int
    messages: Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Recording:
    """Rows in the order of time, from when the session listens, and until when it does."""

    rows: Sequence[Row]
    begin: int
    end: int


@dataclass(frozen=True)
class Step:
    """A step: the values that the property reads, the topics that have news, and what holds by these values alone."""

    time: int
    samples: Mapping[Key, Any]
    news: frozenset[str]
    truths: Sequence[bool]


@dataclass(frozen=True)
class Look:
    """What was read when messages came: a step, unless something has no value yet or is invalid."""

    time: int
    samples: Mapping[Key, Any]
    news: frozenset[str]
    fresh: frozenset[str]


@dataclass
class Run:
    """The valid steps of a property, how many were none, and of each topic the messages that were heard.

    A message that a step at its time sees counts from that on; any other from its time on, while the step before is
    held. So it has the number of a step, a time from which on it counts while this step is held, and when it came.
    """

    steps: list[Step] = field(default_factory=list)
    invalid: int = 0
    heard: dict[str, list[tuple[int, int, int]]] = field(default_factory=dict)
    looks: list[Look] = field(default_factory=list)


@dataclass(frozen=True)
class Reads:
    """What a property reads: samples, and topics by their news or age only.

    It waits for the units in `waited`, and not for the others; what is `made` of samples is by its name.
    """

    keys: frozenset[Key]
    topics: frozenset[str]
    names: Said
    waited: Collection[frozenset[Key]]
    excused: Collection[frozenset[Key]]
    made: Mapping[str, Latched | Computed] = field(default_factory=dict)

    @property
    def all_topics(self) -> frozenset[str]:
        """Every topic of which a message is a step."""
        of = (self.names.signals[name].topic for name in self.signals)
        told = (each.topics for each in self.made.values())
        return self.topics.union(*told) | {topic for topic in of if topic is not None}

    @property
    def signals(self) -> frozenset[str]:
        """The signals of which samples are kept, those of which others are made included."""
        parts = (key for each in self.made.values() for key in each.keys)
        return frozenset(name for name, _ in (*self.keys, *parts) if name not in self.made)

    @property
    def from_session(self) -> bool:
        """Whether it begins with the session: it waits for no value."""
        return not self.waited


Truths = Callable[[Mapping[Key, Any]], Sequence[bool] | None]
"""What holds of some values; None where an expression has no value."""


class Sampler:
    """Takes samples of what is read, and makes steps."""

    def __init__(self, reads: Reads, truths: Truths) -> None:
        self.reads = reads
        self.truths = truths
        self.run = Run()
        self.history: dict[str, list[Any]] = {name: [] for name in (*reads.signals, *reads.made)}

    def sample(self, values: Mapping[str, Any]) -> None:
        """New samples of some signals."""
        for name, value in values.items():
            if name in self.history:
                self.history[name].append(value)

    def know(self, time: int, topics: Collection[str], fresh: frozenset[str]) -> None:
        """What came at a time on these topics is known, though there are no steps yet."""
        for name, each in self.reads.made.items():
            self._make(name, each, frozenset(topics), fresh)
        for topic in topics:
            self.hear(topic, time, -1)

    def look(self, time: int, news: Mapping[str, int], fresh: frozenset[str] = frozenset()) -> None:
        """A step, if all has a value, at which messages are seen that came on these topics at these times."""
        for name, each in self.reads.made.items():
            self._make(name, each, frozenset(news), fresh)
        now = {(name, 0): known[-1] for name, known in self.history.items() if known}
        self.run.looks.append(Look(time, now, frozenset(news), fresh))
        before = len(self.run.steps)
        self._step(time, frozenset(news))
        is_step = len(self.run.steps) > before
        for topic, came in news.items():
            if came == time:
                self.hear(topic, time, before if is_step else before - 1)

    def _make(self, name: str, what: Latched | Computed, news: frozenset[str], fresh: frozenset[str]) -> None:
        """Latch the value of a signal, if what has to hold does and all of it has a value; or compute a sample."""
        if any(len(self.history[part]) <= ago for part, ago in what.keys):
            return
        frame = Frame({(part, ago): self.history[part][-1 - ago] for part, ago in what.keys}, news=news)
        if isinstance(what, Latched):
            self.history[name] = _latched(what, frame) or self.history[name]
        elif not fresh.isdisjoint(part for part, _ in what.keys):
            self.history[name] += _computed(what, frame)

    def hear(self, topic: str, time: int, step: int) -> None:
        """A message came on a topic at `time`, while the `step` of this number is held, or at it."""
        self.run.heard.setdefault(topic, []).append((step, time, time))

    def _step(self, time: int, news: frozenset[str]) -> None:
        found: dict[Key, Any] = {}
        for name, ago in self.reads.keys:
            known = self.history[name]
            if len(known) > ago:
                found[name, ago] = known[-1 - ago]
        if any(unit - found.keys() for unit in self.reads.waited):
            return
        absent = [unit for unit in self.reads.excused if unit - found.keys()]
        topics = [{self.reads.names.signals[name].topic for name, _ in unit} for unit in absent]
        if any(each <= news for each in topics):
            self.run.invalid += 1
            return
        truths = None if any(value != value for value in found.values()) else self.truths(found)
        if truths is None:
            self.run.invalid += 1
            return
        self.run.steps.append(Step(time, found, news, truths))


def _latched(what: Latched, frame: Frame) -> list[Any]:
    """The value that is latched; nothing if none is."""
    try:
        value = valued(frame.samples[what.name, 0])
        return [value] if what.holds(frame) else []
    except NoValueError:
        return []


def _computed(what: Computed, frame: Frame) -> list[Any]:
    """The sample of what is computed; of a predicate there is none where it has no value."""
    try:
        return [what.of(frame)]
    except NoValueError:
        return [] if what.is_predicate else [math.nan]


def run_of(reads: Reads, recording: Recording, truths: Truths) -> Run:
    """The run of a property on a recording."""
    sampler = Sampler(reads, truths)
    if reads.names.rate is None:
        _by_messages(sampler, recording)
    else:
        _by_ticks(sampler, recording, reads.names.rate)
    return sampler.run


def _by_messages(sampler: Sampler, recording: Recording) -> None:
    reads = sampler.reads
    topics, waits = reads.all_topics, reads.from_session
    if waits and (not recording.rows or recording.begin < recording.rows[0].time):
        sampler.look(recording.begin, {})
        waits = False
    for row in recording.rows:
        mine = topics & row.messages.keys()
        fresh = frozenset(name for topic in mine for name in row.messages[topic])
        for topic in mine:
            sampler.sample(row.messages[topic])
        if mine or waits:
            sampler.look(row.time, dict.fromkeys(mine, row.time), fresh)
        waits = False


def _by_ticks(sampler: Sampler, recording: Recording, rate: Fraction) -> None:
    reads = sampler.reads
    topics = reads.all_topics
    mine = [row for row in recording.rows if topics & row.messages.keys()]
    if not mine and not reads.from_session:
        return
    start = recording.begin if reads.from_session else mine[0].time
    latest: dict[str, Any] = {}
    number = place = 0
    while (time := start + int(number * SECOND / rate)) <= recording.end:
        news: dict[str, int] = {}
        while place < len(mine) and mine[place].time <= time:
            for topic in topics & mine[place].messages.keys():
                latest |= mine[place].messages[topic]
                news[topic] = mine[place].time
                if mine[place].time < time:
                    sampler.hear(topic, mine[place].time, len(sampler.run.steps) - 1)
            place += 1
        sampler.sample(latest)
        sampler.look(time, news, frozenset(latest))
        number += 1
    for row in mine[place:]:
        for topic in topics & row.messages.keys():
            sampler.hear(topic, row.time, len(sampler.run.steps) - 1)


@dataclass(frozen=True)
class Renewed:
    """A run in which messages that are no step, but renew an age that was too old, are steps that have no news.

    `numbers` are those of the steps that are held.
    """

    run: Run
    numbers: Sequence[int]


def renewed(run: Run, ages: Mapping[str, Collection[int]], began: int) -> Renewed:
    """The instants of their own of messages on topics whose `ages` are compared with durations."""
    places = {(number, step.time) for number, step in enumerate(run.steps)}
    for topic, durations in ages.items():
        latest = began
        for number, time, came in run.heard.get(topic, []):
            if number >= 0 and time - latest > min(durations):
                places.add((number, time))
            latest = came
    ordered = sorted(places)
    steps = [
        step if step.time == time else Step(time, step.samples, frozenset(), step.truths)
        for step, time in ((run.steps[number], time) for number, time in ordered)
    ]
    heard = {
        topic: [(bisect_right(ordered, (number, time)) - 1, time, came) for number, time, came in found]
        for topic, found in run.heard.items()
    }
    return Renewed(Run(steps, run.invalid, heard), [number for number, _ in ordered])


def ended(recording: Recording, first: int | None, timeout: int | None) -> Recording:
    """The recording up to the end of the run, `timeout` after its first step."""
    if first is None or timeout is None or first + timeout >= recording.end:
        return recording
    end = first + timeout
    return Recording([row for row in recording.rows if row.time <= end], recording.begin, end)
