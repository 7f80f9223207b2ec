"""The emitted class of a property with clocks as something that can be replayed: given times with what it reads."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

from ltlc.assurance.histories import History, Openings, sample_text
from ltlc.assurance.replay import Run, Shown, Stepper
from ltlc.assurance.sources import given, without_news
from ltlc.assurance.values import Frame, Samples, instants_of
from ltlc.assurance.walks import LONGEST_WALK, Heard, Walk, Walks
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.program.lowering import read
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.words import Letter
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Input, New, Read
from ltlc.specification.shapes import Shape

RANDOM_RUNS, RUNS_WITH_OPENINGS = 100, 300
"""How many runs are random; more where values are taken at openings, which nothing but such runs shows."""

FURTHER = 8
"""How many steps follow on a walk, so that a wrong state is told from the right one."""


@dataclass(frozen=True, slots=True)
class Given:
    """At `time` the class is given `values`, one for each input, None for one without; None: the time passes."""

    time: Nanoseconds
    values: tuple[Value | None, ...] | None
    text: str = "nothing"

    def __str__(self) -> str:
        return f"{self.text} at {self.time} ns"


@dataclass(frozen=True)
class TimedClass:
    """A class whose `step` takes the time and the values of `inputs`; it is made with the session's beginning."""

    make: Callable[[Nanoseconds], Any]
    inputs: Sequence[Input]

    def runs(self, compiled: Compiled, _: Samples) -> Iterator[Run[Given]]:
        """By every letter in every situation of the clocks, where one frame decides it; at random besides."""
        specification = without_news(compiled.specification)
        walks, samples = Walks(compiled), Samples(specification, given(specification))
        if samples.reach == 1 and not samples.origins.remembers:
            yield from self._telling(walks, samples)
        for _run in range(RUNS_WITH_OPENINGS if samples.origins.remembers else RANDOM_RUNS):
            frames = samples.course(samples.reach - 1 + walks.chance.randint(1, LONGEST_WALK))
            history = History(samples.origins, instants_of(frames))
            values = self._values(history, len(frames))
            kept = [n for n in range(len(frames)) if values[n] is not None]
            late = _Late(compiled, walks, len(frames))
            events = [(frames[n], late.values(values[n], n), late.news(n)) for n in kept]
            letters = [
                partial(late.letters, n, history.openings, history.values(samples.origins.wanted, n), news)
                for n, (_, _, news) in zip(kept, events, strict=True)
            ]
            told = [(frame, read, walks.told(news)) for frame, read, news in events]
            yield self._run(walks.at_random(letters, history.openings), told)

    def describe(self, shape: Shape) -> None:
        """Its class, and what it is told."""
        shape.add((self.make, tuple(self.inputs)))

    def _telling(self, walks: Walks, samples: Samples) -> Iterator[Run[Given]]:
        """Walks that tell something, each with some more steps that show where it has led.

        Of one that ends with time, silence up to then shows what the next step, which catches up, might hide.
        """
        known, nonsense = samples.by_letter(()), samples.invalid()
        pulses = {each.name for each in walks.news}
        for told in walks.telling(list(known)):
            further = [walks.with_news(walks.chance.choice(list(known))) for _ in range(FURTHER)]
            letters = [*(step.letter for step in told.steps), *further]
            if nonsense is None and any(isinstance(letter, Heard) for letter in letters):
                continue
            frames = [
                nonsense if nonsense and isinstance(letter, Heard) else walks.chance.choice(known[letter - pulses])
                for letter in letters
            ]
            events = [
                (frame, self._values(History(samples.origins, instants_of([frame])), 1)[0], walks.told(letter))
                for frame, letter in zip(frames, letters, strict=True)
            ]
            yield self._run(walks.walk(told, [partial(_always, letter) for letter in further]), events)
            if told.steps and told.until > told.steps[-1].time:
                yield self._run(walks.walk(told, []), events[: len(told.steps)])

    def _run(self, walk: Walk, events: Sequence[tuple[Frame, dict[Read, Value] | None, set[New]]]) -> Run[Given]:
        given_ = [self._given(time, *event) for time, event in zip(walk.times, events, strict=False)]
        return Run([*given_, Given(walk.times[-1], None)], walk.judged, walk.session)

    def _values(self, history: History, count: int) -> list[dict[Read, Value] | None]:
        """What the class is told at each of the first `count` instants; None before all of it has a value."""
        wanted = [each for each in self.inputs if not isinstance(each, New)]
        return [history.values(wanted, n) for n in range(count)]

    def _given(self, time: Nanoseconds, frame: Frame, values: dict[Read, Value] | None, told_of: set[New]) -> Given:
        assert values is not None
        news = {each: each in told_of for each in self.inputs if isinstance(each, New)}
        told = [each.signal.name for each, has_come in news.items() if has_come]
        shown = f"{sample_text(frame.sample)}{f', new {told}' if told else ''}"
        return Given(time, tuple((values | news).get(each) for each in self.inputs), shown)

    def start(self, session: Nanoseconds) -> Stepper[Given]:
        """A monitor before its first step."""
        monitor = self.make(session)

        def step(event: Given) -> Shown:
            if event.values is not None:
                monitor.step(event.time, *event.values)
            while event.time > monitor.due:
                monitor.expire()
            return {"verdict": monitor.verdict.value, "invalid": monitor.invalid}

        return step


def _always(letter: Letter) -> list[Letter | None]:
    return [letter]


class _Late:
    """What a property does not wait for comes in a run of `count` frames from some frame on, often from the first."""

    def __init__(self, compiled: Compiled, walks: Walks, count: int) -> None:
        self._walks = walks
        by_read = {read(each): each for each in compiled.specification.inputs()}
        chance = walks.chance
        late = {by_read[e.input]: e.news for e in compiled.machine.excused if e.news}
        self._first: dict[Read, int] = {each: chance.choice([0, chance.randint(0, count)]) for each in late}
        arrivals = {read(wanted): news for wanted, news in walks.arrivals.items()}
        self._news: dict[Read, list[Letter]] = {each: [arrivals[new] for new in news] for each, news in late.items()}

    def values(self, values: dict[Read, Value] | None, number: int) -> dict[Read, Value]:
        """The values at a frame, without those that have not come."""
        return {each: value for each, value in (values or {}).items() if self._first.get(each, 0) <= number}

    def news(self, number: int) -> Letter:
        """Any news; of what brings no value yet, seldom."""
        news = self._walks.with_news(frozenset())
        silent = frozenset[str]().union(
            *(n for each, of in self._news.items() if self._first[each] > number for n in of)
        )
        return news if self._walks.chance.random() < 1 / 8 else news - silent

    def letters(
        self, number: int, openings: Openings, values: Mapping[Read, Value] | None, news: Letter
    ) -> list[Letter | None]:
        """The next step, at which the inputs have `values`; the messages, if they have none yet, or if one is NaN.

        So it is if news has come of all that should have brought a value.
        """
        heard = Heard(news & self._walks.messages)
        if values is None:
            return [heard]
        missing = (each for each, first in self._first.items() if first > number)
        if any(not any(new.isdisjoint(news) for new in self._news[each]) for each in missing):
            return [None, heard]
        seen = openings.step(self.values(dict(values), number))
        return [None, heard] if seen is None else [seen | news]
