"""Traffic of which a property is judged from each message on: the run before any, and one for each, by definition."""

from __future__ import annotations

from collections.abc import Iterable

from ltlc.assurance.histories import Instant, Sample
from ltlc.assurance.many_traffic import ManyTraffic
from ltlc.assurance.replay import Id
from ltlc.assurance.traffic import Event, Followed, Follower, Heard, Said, Settings
from ltlc.assurance.values import Samples
from ltlc.compiler import Compiled
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.instants import Instant as Judged
from ltlc.semantics.timed_run import TimedRun
from ltlc.specification.specification import Instances, topics_of


class InstanceTraffic(ManyTraffic):
    """Messages, among them such as open instances, at most as many as may be open."""

    def __init__(self, samples: Samples, instances: Instances) -> None:
        super().__init__(samples)
        self.limit = instances.limit
        self.mark = instances.mark.name
        self.opener = topics_of(instances.signal)[0]
        self._opened = 0

    def follower(self, compiled: Compiled, settings: Settings) -> InstancesFollower:
        """What follows all instances in one run."""
        self._opened = 0
        return InstancesFollower(compiled, self, settings)

    def topics(self) -> list[str]:
        """Those that messages come on: the opener, and what the property reads but for its mark."""
        read = [topic for topic in self.sources.topics() if topic not in (self.mark, self.opener)]
        return [*read, *([] if self._opened == self.limit else [self.opener])]

    def heard(self, time: Nanoseconds, topic: str) -> Event:
        """A message, which may open an instance."""
        self._opened += topic == self.opener
        sample = self.sample(topic)
        return Heard(time, Said(topic, self.sources.content(sample), sample))


class InstancesFollower:
    """What all instances make of events; that with number 0 is the run without any."""

    def __init__(self, compiled: Compiled, traffic: InstanceTraffic, settings: Settings) -> None:
        self._of = Followed(compiled, traffic.sources)
        self._traffic = traffic
        self._settings = settings
        self._events: list[Event] = []
        self._instances = [InstanceFollower(self._of, traffic, settings)]

    def dues(self) -> list[Nanoseconds]:
        """When clocks of instances expire."""
        return [moment for one in self._instances if one.run for _, moment in one.run.dues()]

    def take_all(self, event: Event) -> dict[Id, list[Judged | None]]:
        """The steps that `event` leads to in each instance; in one that it opens, all before, too."""
        found: dict[Id, list[Judged | None]] = {n: one.take(event) for n, one in enumerate(self._instances)}
        if isinstance(event, Heard) and event.said.topic == self._traffic.opener:
            one = InstanceFollower(self._of, self._traffic, self._settings)
            before = [step for earlier in self._events for step in one.take(earlier)]
            found[len(self._instances)] = [*before, *one.open(event)]
            self._instances.append(one)
        self._events.append(event)
        return found


class InstanceFollower(Follower):
    """What one instance makes of the run; each message that may open one is a step of all."""

    def __init__(self, of: Followed, traffic: InstanceTraffic, settings: Settings) -> None:
        super().__init__(of, settings)
        self._opener = traffic.opener
        self._mark = frozenset({traffic.mark})
        self._news = frozenset[str]()

    def open(self, event: Heard) -> list[Judged | None]:
        """The steps that the message leads to that opens this instance."""
        self._news = self._mark
        found = self.take(event)
        self._news = frozenset()
        return found

    def _taken(
        self, run: TimedRun, time: Nanoseconds, sample: Sample, topics: frozenset[str]
    ) -> Iterable[Judged | None]:
        """What messages on `topics` lead to."""
        if self._settings.rate is None and self._opener in topics:
            return self._judged(run, Instant(time, sample, topics | self._news, concerns_all=True))
        return super()._taken(run, time, sample, topics | self._news)
