"""A property in a library as something that can be replayed: given samples, as messages bring them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

from ltlc.assurance.courses import Courses
from ltlc.assurance.library import Loaded, Monitors
from ltlc.assurance.replay import Run, Shown, Stepper
from ltlc.assurance.traffic import Begun, Event, Heard, Passed, Quiet, Settings, Together, Traffic, rings
from ltlc.assurance.values import PERIOD, RATE, Samples
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.runtime.times import NEVER
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.timed_atoms import timed_atoms
from ltlc.semantics.verdicts import Verdict

VERDICTS = [Verdict.NOT_STARTED, *(verdict for verdict in Verdict if verdict is not Verdict.NOT_STARTED)]


class Libraries:
    """The same monitors under other settings than their own, for runs that want these; each is compiled once."""

    def __init__(self, make: Callable[[Settings], Loaded], own: Settings) -> None:
        self.own = own
        self.of = cache(make)


@dataclass(frozen=True)
class CompiledProgram:
    """The property with a number in what was compiled into libraries."""

    libraries: Libraries
    number: int

    def runs(self, compiled: Compiled, samples: Samples) -> Iterator[Run[Any]]:
        """Runs as a node has them; where all signals have samples at once, too."""
        traffic, own = Traffic(samples, at_once=True), self.libraries.own
        if timed_atoms(compiled.formula) or not traffic.sources.topics():
            yield from traffic.in_time(compiled, own)
            return
        courses = Courses(samples, compiled.monitor)
        settings = Settings(None if own.rate is None else RATE)
        for course in courses.guided():
            events: list[Together | Passed] = []
            steps: list[list[Any]] = []
            for number, (frame, found) in enumerate(zip(course, samples.letters(course), strict=True)):
                events.append(Together(number * PERIOD, traffic.all(frame)))
                steps.append(found if own.rate is None else [])
                if own.rate is not None:
                    events.append(Passed(number * PERIOD))
                    steps.append(found)
            yield Run(events, steps, settings)
        yield from traffic.at_random(compiled, own)

    def start(self, settings: Settings) -> Stepper[Event]:
        """Monitors before a run; a second copy is given all that is late at once. Raises CompilerError."""
        library = self.libraries.of(settings)
        careful, late = library.monitors(), library.monitors()

        def step(event: Event) -> Shown:
            settled = self._taken(careful, event)
            if not take(late, event) and settings.timeout is None:
                raise RuntimeError(f"{event} is refused")
            require_refused(late, event)
            if careful.show(self.number) != late.show(self.number):
                raise RuntimeError("deadlines that pass one by one and all at once lead to different verdicts")
            verdict, steps, invalid, _ = careful.show(self.number)
            return {"verdict": VERDICTS[verdict].value, "steps": steps, "invalid": invalid, "settled": settled}

        return step

    def _taken(self, monitors: Monitors, event: Event) -> list[tuple[Nanoseconds, str]]:
        """The verdicts at the ends of the moments that end with one that is new, up to `event`."""
        moments: list[tuple[Nanoseconds, str]] = []
        before = monitors.show(self.number)[0]

        def settle(time: Nanoseconds) -> None:
            nonlocal before
            now, _, _, since = monitors.show(self.number)
            if now != before:
                if since != time:
                    raise RuntimeError(f"the verdict is of {since} ns, not of {time} ns")
                moments.append((time, VERDICTS[now].value))
            before = now

        for due in rings(monitors.next_deadline, event.time - (not isinstance(event, Quiet))):
            monitors.advance(due)
            settle(due)
        if not isinstance(event, Quiet):
            take(monitors, event)
        settle(event.time)
        return moments


def take(monitors: Monitors, event: Event) -> bool:
    """Whether an event is taken."""
    match event:
        case Begun(time):
            return monitors.begin(time)
        case Heard(time, said):
            return monitors.step(time, dict(said.sample), [said.topic])
        case Together(time):
            return monitors.step(time, event.sample, sorted(event.topics))
        case Passed(time):
            return monitors.advance(time)
        case Quiet(time):
            for due in rings(monitors.next_deadline, time):
                monitors.advance(due)
            return True


def require_refused(monitors: Monitors, event: Event) -> None:
    """Times before that of a message, and those that no run has, are refused and change nothing."""
    if isinstance(event, Heard | Together):
        before = monitors.memory()
        for time in (event.time - 1, NEVER, -NEVER):
            if monitors.step(time, {}, ()) or monitors.memory() != before:
                raise RuntimeError(f"the time {time} ns is not refused after {event.time} ns")
