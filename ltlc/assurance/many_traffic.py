"""Traffic of which a property is judged many times side by side: messages, waiting, silence, and what comes of them."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from typing import Protocol

from ltlc.assurance.histories import Sample
from ltlc.assurance.replay import Id, SlicedRun
from ltlc.assurance.traffic import Begun, Event, Passed, Quiet, Settings, Traffic
from ltlc.assurance.walks import durations
from ltlc.compiler import Compiled
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.instants import Instant as Judged

RUNS, EVENTS = 60, 20


class ManyFollower(Protocol):
    """What the property makes of events in each slice."""

    def dues(self) -> list[Nanoseconds]:
        """When clocks of slices expire."""
        ...

    def take_all(self, event: Event) -> Mapping[Id, Sequence[Judged | None]]:
        """The steps that `event` leads to in each slice."""
        ...


class ManyTraffic(Traffic):
    """Messages on topics that some slices get, or all."""

    @abstractmethod
    def follower(self, compiled: Compiled, settings: Settings) -> ManyFollower:
        """What follows all slices in one run."""

    @abstractmethod
    def topics(self) -> list[str]:
        """Those that messages come on."""

    @abstractmethod
    def heard(self, time: Nanoseconds, topic: str) -> Event:
        """A message."""

    def runs(self, compiled: Compiled, settings: Settings) -> Iterator[SlicedRun[Event]]:
        """Messages, waiting and silence, around the times at which clocks of some slice expire."""
        longest = max(durations(compiled.specification.property), default=0)
        gaps = [*self._gaps(settings), 1, longest, longest + 1]
        for _ in range(RUNS):
            follower = self.follower(compiled, settings)
            events: list[Event] = []
            found: list[Mapping[Id, Sequence[Judged | None]]] = []
            for event in self._course(follower, settings, gaps):
                events.append(event)
                found.append(follower.take_all(event))
            steps = [[step for each in of.values() for step in each] for of in found]
            yield SlicedRun(events, steps, settings, found)

    def _course(self, follower: ManyFollower, settings: Settings, gaps: Sequence[Nanoseconds]) -> Iterator[Event]:
        chance, time = self.samples.chance, self.samples.chance.choice(self._starts)
        if chance.random() < 1 / 4:
            yield Begun(time)
        for _ in range(EVENTS):
            edges = [moment - time + side for moment in follower.dues() for side in (-1, 0, 1)]
            near = [gap for gap in edges if gap >= 0] if settings.rate is None else []
            time += chance.choice([0, chance.choice(gaps), *near, *near])
            kind = chance.randrange(8)
            topics = self.topics()
            if kind < 2 or not topics:
                yield Quiet(time) if kind and settings.rate is None else Passed(time)
                continue
            yield self.heard(time, chance.choice(topics))
        yield Passed(time + gaps[-1])

    def sample(self, topic: str) -> Sample:
        """The contents of a message on `topic`: at the edge of a condition, or random."""
        chance, known = self.samples.chance, list(self.samples.by_letter(self.samples.start).values())
        frame = chance.choice(chance.choice(known)) if known and chance.random() < 3 / 4 else self.samples.draw()
        return self.sources.on(topic, self.sources.without_entries(frame.sample, chance))
