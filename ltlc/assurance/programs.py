"""Emitted code as something that can be replayed: for each target, what it is given and how it is run."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import ModuleType
from typing import Any, Protocol

from ltlc.assurance.courses import Courses
from ltlc.assurance.messages import Messages
from ltlc.assurance.replay import Run, Shown, Stepper
from ltlc.assurance.sources import given
from ltlc.assurance.timed_program import TimedClass
from ltlc.assurance.traffic import Event, Heard, Said, Settings, Traffic, steps_by_event
from ltlc.assurance.values import RATE, Frame, Samples
from ltlc.backends.python import standalone_classes
from ltlc.compiler import Compiled
from ltlc.runtime.times import duration
from ltlc.semantics.timed_atoms import timed_atoms
from ltlc.semantics.words import Letter
from ltlc.specification.expressions import Current, Input, New, Signal
from ltlc.specification.specification import Specification


class Program(Protocol):
    """The emitted code of one property."""

    def runs(self, compiled: Compiled, samples: Samples) -> Iterator[Run[Any]]:
        """The runs on which it is judged; `samples` are of what its messages say."""
        ...

    def start(self, settings: Any) -> Stepper[Any]:
        """Make it ready for the first event of a run."""
        ...


def programs(
    target: str, text: str, compiled: Sequence[Compiled], specification: Specification, messages: Messages
) -> Sequence[Program] | None:
    """For each property the program that its part of the output `text` is; None if the output is not code."""
    match target:
        case "python":
            module = load(text, "emitted")
            classes = standalone_classes(compiled, specification.source.name)
            return [
                TimedClass(module[w.name], _told(c)) if is_timed(c) else Standalone(module[w.name], w.parameters)
                for w, c in zip(classes, compiled, strict=True)
            ]
        case "ros2":
            node = load(text, "emitted")
            for topic in node["TOPICS"]:
                messages.is_installed(topic.message)
            settings = Settings(specification.rate, specification.timeout)
            return [
                TimedClass(node["PROPERTIES"][n].monitor, c.specification.inputs())
                if is_timed(c)
                else Monitored(node, n, settings, messages)
                for n, c in enumerate(compiled)
            ]
    return None


def _told(compiled: Compiled) -> list[Input]:
    """What a standalone class is told at a step, which keeps the history itself."""
    inputs = compiled.specification.inputs()
    return [*dict.fromkeys(i if isinstance(i, New) else Current(i.signal) for i in inputs)]


def is_timed(compiled: Compiled) -> bool:
    """Whether the property has clocks, or reads the past."""
    return bool(timed_atoms(compiled.formula))


def load(text: str, name: str) -> dict[str, Any]:
    """The names that a module with this text defines; `name` is what errors call it."""
    module = ModuleType(name)
    sys.modules[name] = module  # where dataclasses look up the annotations of their fields
    try:
        exec(compile(text, f"<{name}>", "exec"), module.__dict__)
    finally:
        del sys.modules[name]
    return module.__dict__


@dataclass(frozen=True)
class Standalone:
    """A class of the `python` target, whose `step` takes signals by name."""

    make: Callable[[], Any]
    parameters: Sequence[tuple[str, Signal]]

    def runs(self, compiled: Compiled, _: Samples) -> Iterator[Run[Frame]]:
        """Signals can have any value, also those that messages could not give them."""
        samples = Samples(compiled.specification, given(compiled.specification))
        courses = Courses(samples, compiled.monitor)
        for course in (*courses.guided(), *courses.random()):
            yield Run(course, samples.letters(course))

    def start(self, _: None) -> Stepper[Frame]:
        """A monitor before its first step."""
        monitor = self.make()

        def step(frame: Frame) -> Shown:
            values = {name: frame.sample[signal] for name, signal in self.parameters}
            return {"verdict": monitor.step(**values).value}

        return step


@dataclass(frozen=True)
class Monitored:
    """The property with a number in the plan of an emitted node: its readers, its signals, its session."""

    emitted: Mapping[str, Any]
    number: int
    settings: Settings
    messages: Messages
    _values: dict[Said, Sequence[Any]] = field(default_factory=dict)

    def runs(self, compiled: Compiled, samples: Samples) -> Iterator[Run[Event]]:
        """Guided runs at a rate that makes one step of all topics' messages; at random as the specification says."""
        traffic = Traffic(samples)
        courses = Courses(samples, compiled.monitor)
        for course in courses.guided():
            steps = [list[Letter | None]() for _ in traffic.sources.topics()]
            events = traffic.of_frames(course)
            yield Run(events, [s for found in samples.letters(course) for s in (*steps, found)], Settings(RATE))
        for events in traffic.at_random(self.settings):
            steps = steps_by_event(samples.origins, events, self.settings)
            yield Run(events, steps)

    def start(self, settings: Settings | None) -> Stepper[Event]:
        """A session of the plan; of its settings unless others are given."""
        plan = self._plan
        if settings is not None:
            timeout = None if settings.timeout is None else duration(settings.timeout)
            plan = replace(plan, rate=settings.rate, timeout=timeout)
        session = self.emitted["Session"](plan)
        (track,) = session.tracks

        def step(event: Event) -> Shown:
            if isinstance(event, Heard):
                session.message(event.time, event.said.topic, self._read(event.said))
            else:
                session.advance(event.time)
            return {
                "verdict": track.verdict.value,
                "steps": track.steps,
                "invalid": track.invalid,
                "episodes": track.episodes,
            }

        return step

    @cached_property
    def _plan(self) -> Any:
        """The emitted plan with this property alone, and with all that is read from its topics."""
        plan = self.emitted["PLAN"]
        (monitored,) = plan.properties[self.number : self.number + 1]
        signals = {signal.name: signal for signal in plan.signals}
        needed: dict[str, None] = {}
        todo = [wanted.signal for wanted in monitored.inputs]
        while todo:
            name = todo.pop()
            needed[name] = None
            todo += [part.signal for part in getattr(signals[name], "inputs", ())]
        topics = {signals[name].topic for name in needed if hasattr(signals[name], "topic")}
        kept = (s for s in plan.signals if s.name in needed or getattr(s, "topic", None) in topics)
        return replace(plan, signals=tuple(kept), properties=(monitored,))

    def _read(self, said: Said) -> Sequence[Any]:
        """What the emitted reader takes from a message that says this."""
        if said not in self._values:
            (topic,) = (t for t in self.emitted["TOPICS"] if t.name == said.topic)
            message = self.messages.build(topic.message, said.content)
            self._values[said] = self.emitted["unpacked"](topic.read(message))
        return self._values[said]
