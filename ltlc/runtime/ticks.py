"""Ticks: moments at which samples are looked at, and what is seen at each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction

from ltlc.runtime.sampling import Sampler, Value, Window
from ltlc.runtime.times import SECOND
from ltlc.runtime.tracking import Track


class Ticks:
    """Moments at which samples are looked at: `start` + k / `rate` for k = 0, 1, ...

    `rate` is what its author wrote, which `repr` writes, too; what is left below a ns
    is cut off, and no error adds up over a long run.
    """

    __slots__ = ("count", "period", "start")

    def __init__(self, rate: float, start: int) -> None:
        self.period = SECOND / Fraction(repr(rate))
        self.start = start
        self.count = 0

    def next(self) -> int:
        """When the next tick is due."""
        return self.at(self.count)

    def at(self, number: int) -> int:
        """When the tick with this number, counted from 0, is due."""
        period = self.period
        return self.start + number * period.numerator // period.denominator

    def before(self, time: int) -> int:
        """How many ticks, the next one included, are due before `time`."""
        period = self.period
        first_not = -((self.start - time) * period.denominator // period.numerator)
        return max(0, first_not - self.count)


Stepped = tuple[Track, Window]
"""A property in a run, and what it reads."""


class Pace:
    """The ticks of the properties whose ticks begin at one time, and what they see.

    `sampler` has a sample of every signal at each tick, `latest` what the next tick
    sees, `seen` how many messages of each topic ticks have seen.
    """

    def __init__(self, ticks: Ticks, sampler: Sampler) -> None:
        self.ticks = ticks
        self.sampler = sampler
        self.stepped: list[Stepped] = []
        self.topics: set[str] = set()
        self.latest: dict[str, Value] = {}
        self.heard: set[str] = set()
        self.waiting: dict[str, tuple[str, int]] = {}
        self.seen: dict[str, int] = {}
        self.quiet = 0

    def join(self, track: Track, topics: Iterable[str]) -> None:
        """The ticks of a property, which reads `topics`, begin with these."""
        self.stepped.append((track, self.sampler.window(track.property.inputs)))
        self.topics.update(topics)

    def keep(
        self, names: Iterable[str], values: Iterable[Value], numbers: Mapping[str, int]
    ) -> None:
        """Keep samples for the next tick: from messages with these numbers on topics.

        Of those that no property here reads, nothing is kept.
        """
        numbers = {t: n for t, n in numbers.items() if t in self.topics}
        if not numbers:
            return
        self.quiet = 0
        self.heard.update(numbers)
        self.waiting |= {topic: (topic, number) for topic, number in numbers.items()}
        for name, value in zip(names, values, strict=True):
            (topic,) = self.sampler.topics[name]
            if topic in numbers:
                self.latest[name] = value
                self.waiting[name] = (topic, numbers[topic])

    def tick(self) -> frozenset[str]:
        """Take the next tick; the signals that have a new sample by it."""
        time = self.ticks.next()
        self.ticks.count += 1
        self.quiet += 1
        for topic, _ in set(self.waiting.values()):
            self.seen[topic] = self.seen.get(topic, 0) + 1
        self.waiting.clear()
        self.sampler.hear(self.heard)
        self.heard.clear()
        return self.sampler.take(time, tuple(self.latest), self.latest.values())

    @property
    def is_settled(self) -> bool:
        """Whether, up to the next message or clock step, every tick does the same."""
        if self.quiet <= self.sampler.reach + 1:
            return False
        return all(track.is_settled for track, _ in self.stepped)
