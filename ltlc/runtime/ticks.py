"""Ticks: moments at which samples are looked at, and what is seen at each."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from fractions import Fraction

from ltlc.runtime.readers import Readers, Stepped
from ltlc.runtime.sampling import Sampler, Value
from ltlc.runtime.times import NEVER, SECOND
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


class Pace:
    """The ticks of the properties whose ticks begin at one time, and what they see.

    `sampler` has a sample of every signal at each tick, `latest` what the next tick
    sees, `seen` how many messages of each topic ticks have seen. Properties that are
    `blind` read nothing.
    """

    def __init__(self, ticks: Ticks, sampler: Sampler) -> None:
        self.ticks = ticks
        self.sampler = sampler
        self.stepped: list[Stepped] = []
        self.readers = Readers(())
        self.blind: tuple[Stepped, ...] = ()
        self.topics: frozenset[str] = frozenset()
        self.latest: dict[str, Value] = {}
        self.heard: set[str] = set()
        self.waiting: dict[str, tuple[str, int]] = {}
        self.seen: dict[str, int] = {}
        self.quiet = 0

    def join(self, starting: Iterable[Waiting]) -> None:
        """The ticks of properties begin with these."""
        for track, topics in starting:
            self.stepped.append((track, self.sampler.window(track.property.inputs)))
            self.topics |= topics
        self.readers = Readers(self.stepped)
        self.blind = tuple(each for each in self.stepped if not each[0].property.inputs)

    def keep(self, taken: Mapping[str, Value], numbers: Mapping[str, int]) -> None:
        """Keep samples for the next tick: from messages with these numbers on topics.

        Of those that no property here reads, nothing is kept.
        """
        numbers = {t: n for t, n in numbers.items() if t in self.topics}
        self.quiet = 0
        self.heard.update(numbers)
        self.waiting |= {topic: (topic, number) for topic, number in numbers.items()}
        for name, value in taken.items():
            (topic,) = self.sampler.topics[name]
            if topic in numbers:
                self.latest[name] = value
                self.waiting[name] = (topic, numbers[topic])

    def tick(self) -> tuple[Stepped, ...]:
        """Take the next tick; the properties that have a step by it."""
        time = self.ticks.next()
        self.ticks.count += 1
        self.quiet += 1
        for topic, _ in set(self.waiting.values()):
            self.seen[topic] = self.seen.get(topic, 0) + 1
        self.waiting.clear()
        self.sampler.hear(self.sampler.news(self.heard))
        self.heard.clear()
        names, values = tuple(self.latest), tuple(self.latest.values())
        fresh = self.sampler.take(time, names, values, self.topics)
        return self.readers.concerned(fresh, self.topics) + self.blind

    @property
    def is_settled(self) -> bool:
        """Whether, up to the next message or clock step, every tick does the same."""
        if self.quiet <= self.sampler.reach + 1:
            return False
        return all(track.is_settled for track, _ in self.stepped)


Waiting = tuple[Track, frozenset[str]]
"""A property whose ticks have not begun, and the topics that it reads."""


class Paces:
    """The ticks of a session, in which a property has its own time for the first.

    `waiting` are those that have none yet, `begun` the paces of the others; `taken`
    counts the messages that came in on each of `topics`.
    """

    def __init__(
        self,
        rate: float,
        sampler: Callable[[], Sampler],
        waiting: Iterable[Waiting],
        topics: Iterable[str],
    ) -> None:
        """Each pace has a `sampler` of its own."""
        self.begun: list[Pace] = []
        self.waiting = list(waiting)
        self.taken = dict.fromkeys(topics, 0)
        self._rate = rate
        self._sampler = sampler
        self._of: dict[str, list[Pace]] = {topic: [] for topic in self.taken}
        self._next = NEVER

    def new(self, start: int) -> Pace:
        """Ticks that begin at `start`, before any property has joined them."""
        return Pace(Ticks(self._rate, start), self._sampler())

    def begin(self, pace: Pace, starting: Sequence[Waiting]) -> None:
        """The ticks of properties that wait begin with those of `pace`."""
        if pace not in self.begun:
            self.begun.append(pace)
            self._next = min(self._next, pace.ticks.next())
        self.waiting = [each for each in self.waiting if each not in starting]
        for topic in {topic for _, read in starting for topic in read} - pace.topics:
            self._of[topic].append(pace)
        pace.join(starting)

    def start(self, time: int) -> None:
        """The session begins at `time`, and the ticks of what needs no message."""
        self._start(time, [w for w in self.waiting if w[0].property.from_session])

    def keep(
        self, time: int, topics: Collection[str], taken: Mapping[str, Value]
    ) -> None:
        """Messages came in on `topics`, with samples for the next tick."""
        for topic in topics:
            self.taken[topic] += 1
        # Nothing waits for a topic that was heard before.
        first = {topic for topic in topics if self.taken[topic] == 1}
        if first:
            waiting = self.waiting
            self._start(time, [w for w in waiting if not first.isdisjoint(w[1])])
        numbers = {topic: self.taken[topic] for topic in topics}
        for pace in {id(p): p for topic in topics for p in self._of[topic]}.values():
            pace.keep(taken, numbers)

    def _start(self, time: int, starting: Sequence[Waiting]) -> None:
        """Ticks begin at `time`, with others that do, of which none is done."""
        if not starting:
            return
        at = (p for p in self.begun if p.ticks.start == time and not p.ticks.count)
        self.begin(next(at, None) or self.new(time), starting)

    def before(self, time: int) -> Pace | None:
        """That whose next tick comes first, if that is due before `time`."""
        if self._next >= time:  # ticks go on, so it is a bound from below
            return None
        pace = min(self.begun, key=lambda pace: pace.ticks.next())
        self._next = pace.ticks.next()
        return pace if self._next < time else None

    def without_tick(self, time: int, tracks: Sequence[Track]) -> list[Track]:
        """Those of `tracks` that have no tick at `time`, up to which all are done."""
        due = (p.stepped for p in self.begun if tracks and p.ticks.next() == time)
        ticking = [track for stepped in due for track, _ in stepped]
        return [track for track in tracks if not any(t is track for t in ticking)]

    def of(self, track: Track) -> Pace | None:
        """That of a property, once its ticks have begun."""
        own = (p for p in self.begun if any(each is track for each, _ in p.stepped))
        return next(own, None)

    def unseen(self) -> dict[str, int]:
        """How many messages on each topic no tick has seen: others came before it."""
        return {
            topic: n - max((p.seen.get(topic, 0) for p in self._of[topic]), default=0)
            for topic, n in self.taken.items()
        }
