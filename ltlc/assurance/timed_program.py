"""The emitted class of a property with clocks as something that can be replayed: given times with what it reads."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from ltlc.assurance.histories import History, Instant, sample_text
from ltlc.assurance.replay import Run, Shown, Stepper
from ltlc.assurance.sources import given, without_news
from ltlc.assurance.values import PERIOD, Frame, Samples
from ltlc.assurance.walks import LONGEST_WALK, Walks
from ltlc.compiler import Compiled
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.words import Letter
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Input, New

TIMED_RUNS = 300


@dataclass(frozen=True, slots=True)
class Given:
    """At `time` the class is given `values`, one for each input; None: the time passes."""

    time: Nanoseconds
    values: tuple[Value, ...] | None
    text: str = "nothing"

    def __str__(self) -> str:
        return f"{self.text} at {self.time} ns"


@dataclass(frozen=True)
class TimedClass:
    """A class whose `step` takes the time and the values of `inputs`; it is made with the session's beginning."""

    make: Callable[[Nanoseconds], Any]
    inputs: Sequence[Input]

    def runs(self, compiled: Compiled, _: Samples) -> Iterator[Run[Given]]:
        """At random, with news and without, at times at which clocks expire, just before and just after them."""
        specification = without_news(compiled.specification)
        walks, samples = Walks(compiled), Samples(specification, given(specification))
        for _run in range(TIMED_RUNS):
            frames = self._frames(walks, samples)
            values = self._values(samples, frames)
            kept = [n for n in range(len(frames)) if values[n] is not None]
            found = samples.letters(frames) if samples.sources.signals else [[frozenset[str]()]] * len(frames)
            letters = [_with_news(found[n][0], walks) for n in kept]
            times, session, judged = walks.through(letters)
            events = [self._given(times[k], values[n], letters[k], frames[n]) for k, n in enumerate(kept)]
            invalid = [*([None] * (letter is None) for letter in letters), []]
            steps = [[*now, *none] for now, none in zip(judged, invalid, strict=True)]
            yield Run([*events, Given(times[-1], None)], steps, session)

    def _frames(self, walks: Walks, samples: Samples) -> tuple[Frame, ...]:
        length = walks.chance.randint(1, LONGEST_WALK)
        if samples.reach > 1 or not samples.sources.signals:
            return samples.course(samples.reach - 1 + length)
        known = list(samples.by_letter(()).values())
        return tuple(walks.chance.choice(walks.chance.choice(known)) for _ in range(length))

    def _values(self, samples: Samples, frames: Sequence[Frame]) -> list[dict[Input, Value] | None]:
        history = History(samples.origins, [Instant(n * PERIOD, frame.sample) for n, frame in enumerate(frames)])
        wanted = [each for each in self.inputs if not isinstance(each, New)]
        return [history.values(wanted, n) for n in range(len(frames))]

    def _given(
        self, time: Nanoseconds, values: dict[Input, Value] | None, letter: Letter | None, frame: Frame
    ) -> Given:
        assert values is not None
        news = {each: f"new {each.signal.name}" in (letter or ()) for each in self.inputs if isinstance(each, New)}
        told = [each.signal.name for each, arrived in news.items() if arrived]
        text = f"{sample_text(frame.sample)}{f', new {told}' if told else ''}"
        return Given(time, tuple((values | news)[each] for each in self.inputs), text)

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


def _with_news(letter: Letter | None, walks: Walks) -> Letter | None:
    return None if letter is None else walks.with_news(letter)
