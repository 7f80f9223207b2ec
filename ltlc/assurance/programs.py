"""Emitted code as something that can be replayed: for each target, what it is given and how it is run."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property
from types import ModuleType
from typing import Any, Protocol

from ltlc.assurance.courses import Courses
from ltlc.assurance.instance_traffic import InstanceTraffic
from ltlc.assurance.messages import Messages
from ltlc.assurance.replay import Run, Shown, Stepper, settled
from ltlc.assurance.sliced_traffic import SlicedTraffic
from ltlc.assurance.sources import given
from ltlc.assurance.timed_program import TimedClass
from ltlc.assurance.traffic import Begun, Event, Heard, Passed, Quiet, Said, Settings, Together, Traffic, rings
from ltlc.assurance.values import RATE, Frame, Samples
from ltlc.backends.python import standalone_classes
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.semantics.instants import Instant
from ltlc.semantics.timed_atoms import timed_atoms
from ltlc.specification.expressions import Current, Input, New, Signal
from ltlc.specification.shapes import Shape
from ltlc.specification.specification import Instances, Slicing, Specification


class Program(Protocol):
    """The emitted code of one property."""

    def runs(self, compiled: Compiled, samples: Samples) -> Iterator[Run[Any]]:
        """The runs on which it is judged; `samples` are those of its messages."""
        ...

    def start(self, settings: Any) -> Stepper[Any]:
        """Make it ready for the first event of a run."""
        ...

    def describe(self, shape: Shape) -> None:
        """Add all that decides what it does to `shape`."""
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
            node = Emitted(text)
            settings = Settings(specification.rate, specification.timeout)
            return [Monitored(node, number, settings, messages) for number in range(len(compiled))]
        case _:
            return None


def _told(compiled: Compiled) -> list[Input]:
    """The arguments of a step of a standalone class, which keeps the history itself."""
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
        """Signals can have any value of their types, also those that messages could not give them together."""
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

    def describe(self, shape: Shape) -> None:
        """Its class, and which parameter of `step` takes which signal."""
        names: tuple[str, ...] = vars(self.make)["step"].__code__.co_varnames
        shape.add((self.make, tuple((names.index(name), signal) for name, signal in self.parameters)))


class Emitted:
    """What an emitted node defines, with its signals by name, by topic and by place, and its topics by name.

    Its text is compiled where it is needed first, which takes time: one property is judged in a child.
    """

    def __init__(self, text: str) -> None:
        self._text = text

    @cached_property
    def names(self) -> Mapping[str, Any]:
        """What its text defines."""
        return load(self._text, "emitted")

    @cached_property
    def plan(self) -> Any:
        """Its signals and properties."""
        return self.names["plan"]()

    @cached_property
    def topics(self) -> Mapping[str, Any]:
        """The topics it reads, by name."""
        return {topic.name: topic for topic in self.names["topics_to_read"]()}

    @cached_property
    def by_name(self) -> Mapping[str, Any]:
        """The signals of its plan."""
        return {signal.name: signal for signal in self.plan.signals}

    @cached_property
    def places(self) -> Mapping[str, int]:
        """The numbers of its signals."""
        return {name: place for place, name in enumerate(self.by_name)}

    @cached_property
    def on_topic(self) -> Mapping[str, list[str]]:
        """The names of the signals that are read from each topic."""
        found: dict[str, list[str]] = {}
        for name, signal in self.by_name.items():
            if hasattr(signal, "topic"):
                found.setdefault(signal.topic, []).append(name)
        return found


@dataclass(frozen=True)
class Monitored:
    """The property with a number in the plan of an emitted node: its readers, its signals, its session."""

    emitted: Emitted
    number: int
    settings: Settings
    messages: Messages
    _values: dict[Said, Sequence[Any]] = field(default_factory=dict)

    def runs(self, compiled: Compiled, samples: Samples) -> Iterator[Run[Event]]:
        """Guided runs at a rate that makes one step of all topics' messages; at random as the specification says."""
        if isinstance(slicing := compiled.specification.slicing, Slicing):
            yield from SlicedTraffic(samples, slicing, self.messages).runs(compiled, self.settings)
            return
        if isinstance(slicing, Instances):
            yield from InstanceTraffic(samples, slicing).runs(compiled, self.settings)
            return
        traffic = Traffic(samples)
        if is_timed(compiled) or not traffic.sources.topics():
            yield from traffic.in_time(compiled, self.settings)
            return
        courses = Courses(samples, compiled.monitor)
        for course in courses.guided():
            steps = [list[Instant | None]() for _ in traffic.sources.topics()]
            events = traffic.of_frames(course)
            yield Run(events, [s for found in samples.letters(course) for s in (*steps, found)], Settings(RATE))
        yield from traffic.at_random(compiled, self.settings)

    def start(self, settings: Settings) -> Stepper[Event]:
        """A session of the plan, with other settings than its own if they differ from those of the specification."""
        plan = self._plan
        if settings != self.settings:
            plan = replace(plan, rate=settings.rate, timeout=settings.timeout)
        names = self.emitted.names
        rows = names["ByRows"](names["Session"](plan))
        (track,) = rows.tracks

        def step(event: Event) -> Shown:
            before = track.verdict.value
            changes = self._taken(rows, event)
            if track.slices is not None:
                return _shown_of_slices(track, before, changes)
            return {
                "verdict": track.verdict.value,
                "steps": track.steps,
                "invalid": track.invalid,
                "episodes": track.episodes,
                "changes": [(change.moment.time, change.current.value) for change in changes],
            }

        return step

    def describe(self, shape: Shape) -> None:
        """The part of the plan that its session is made with, and the readers of its topics."""
        read = dict.fromkeys(signal.topic for signal in self._plan.signals if hasattr(signal, "topic"))
        shape.add((self._plan, tuple(self.emitted.topics[name] for name in read)))

    def _taken(self, rows: Any, event: Event) -> list[Any]:
        """The changes that `event` leads to."""
        match event:
            case Begun(time):
                return [*rows.begin(time)]
            case Heard(time, said):
                return [*rows.message(time, said.topic, self.read(said))]
            case Passed(time):
                return [*rows.advance(time)]
            case Together():
                raise TypeError("a node takes messages one by one")
            case Quiet():
                pass
        return [change for due in rings(rows.due, event.time) for change in rows.advance(due)]

    @cached_property
    def _plan(self) -> Any:
        """The emitted plan with this property alone, and with all that is read from its topics."""
        emitted, plan = self.emitted, self.emitted.plan
        (monitored,) = plan.properties[self.number : self.number + 1]
        needed: set[str] = set()
        todo = _signals(monitored, emitted)
        while todo:
            name = todo.pop()
            needed.add(name)
            todo += [part.signal for part in getattr(emitted.by_name[name], "inputs", ())]
        topics = {emitted.by_name[name].topic for name in needed if hasattr(emitted.by_name[name], "topic")}
        needed.update(name for topic in topics for name in emitted.on_topic[topic])
        kept = sorted(needed, key=emitted.places.__getitem__)
        return replace(plan, signals=tuple(emitted.by_name[name] for name in kept), properties=(monitored,))

    def read(self, said: Said) -> Sequence[Any]:
        """What the emitted reader takes from a message with these contents."""
        if said not in self._values:
            topic = self.emitted.topics[said.topic]
            message = self.messages.build(topic.message, said.content)
            self._values[said] = self.emitted.names["unpacked"](topic.read(message))
        return self._values[said]


def _shown_of_slices(track: Any, before: str, changes: Sequence[Any]) -> Shown:
    ids, found = track.slices.ids, [(change.moment.time, change.current.value) for change in changes]
    shown: Shown = {"verdict": track.verdict.value, "settled": settled(before, found)}
    if track.slices.openings is None:
        return shown | {"violated": {id_: each.failure.time for id_, each in ids.violated.items()}}
    # A tick opens one instance, however many messages came for it.
    return shown if track.slices.session.plan.rate else shown | {"failed": ids.failed}


def _signals(monitored: Any, emitted: Emitted) -> list[str]:
    """The signals of an emitted plan that a property reads, with those that it is sliced by, and arrays of elements."""
    wanted, slicing = [each.signal for each in monitored.inputs], monitored.slicing
    if slicing is None:
        return wanted
    keys = getattr(slicing, "keys", ())
    arrays = {element: array for key in keys for array, element in key.elements.items()}
    opening = emitted.on_topic[slicing.topic] if hasattr(slicing, "mark") else ()
    named = (*(key.name for key in keys), *opening, *(arrays.get(name, name) for name in wanted))
    return [name for name in named if name in emitted.by_name]
