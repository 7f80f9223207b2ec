"""The emitted C of a guard beside the runtime's guard, on the same events: the same answers at the same times."""

from __future__ import annotations

import ctypes
import math
import random
from collections.abc import Sequence

from ltlc.assurance.c_library import Library, compiler
from ltlc.assurance.library import Loaded, Monitors
from ltlc.assurance.messages import Messages
from ltlc.assurance.reading.c.guards import Texts, difference
from ltlc.assurance.sources import read, without_news
from ltlc.assurance.values import Samples
from ltlc.backends.c import Files
from ltlc.backends.c.guards import GuardFiles
from ltlc.backends.python.load import load_plan
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.bags.fallbacks import samples_in
from ltlc.program.guards import GuardProgram
from ltlc.program.types import Scalar, type_of
from ltlc.runtime.guarding import Action, Deed, Guard, Message
from ltlc.runtime.times import NEVER
from ltlc.runtime.watching import Watching
from ltlc.semantics.durations import UNITS, Nanoseconds
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Field, Signal
from ltlc.specification.specification import Specification, fields

HOLD, PASS = 0, 1
"""What a guard in C decides; a fallback is 2 + its number."""

EVENTS, LONGEST, LOST = 3000, 40, 3
"""How many events are compared, in runs of at most so many, which end so many after a guard has lost."""


class EmittedGuard(Monitors):
    """Guards of a library that share properties, in one run."""

    def __init__(self, library: Loaded, guard: GuardFiles) -> None:
        super().__init__(library)
        functions = library.functions
        self._outs = {topic: number for number, topic in enumerate(guard.commands)}
        self._topics = {topic: number for number, topic in enumerate(guard.others)}
        functions.gate_guard_due.restype = ctypes.c_int64
        functions.gate_guard_lost.restype = ctypes.c_bool
        time = ctypes.c_int64
        functions.gate_guard_command.argtypes = [ctypes.c_void_p, time, ctypes.c_void_p, ctypes.c_int]
        functions.gate_guard_hear.argtypes = [ctypes.c_void_p, time, ctypes.c_void_p, ctypes.c_int]
        functions.gate_guard_act.argtypes = [ctypes.c_void_p, time]
        self._run = ctypes.create_string_buffer(functions.gate_guard_size())
        functions.gate_guard_init(self._run)

    @property
    def has_lost(self) -> bool:
        """Whether it cannot keep its properties any more."""
        return bool(self._functions.gate_guard_lost(self._run))

    def command(self, time: Nanoseconds, out: str, sample: dict[Signal, Value]) -> int:
        """A command has come."""
        self._fill(sample, [out])
        return int(self._functions.gate_guard_command(self._run, time, self._samples, self._outs[out]))

    def hear(self, time: Nanoseconds, topic: str, sample: dict[Signal, Value]) -> int:
        """A message has come on another topic."""
        self._fill(sample, [topic])
        return int(self._functions.gate_guard_hear(self._run, time, self._samples, self._topics[topic]))

    def due(self) -> Nanoseconds:
        """When to call `act`."""
        return int(self._functions.gate_guard_due(self._run))

    def act(self, time: Nanoseconds) -> int:
        """It is `time` now."""
        return int(self._functions.gate_guard_act(self._run, time))


@dataclass(frozen=True, slots=True)
class Event:
    """A message on a topic, or with None time that passes up to `time`; `sample` are its values.

    What is due before it is done in time, or only now, where the guard `is_late`.
    """

    time: Nanoseconds
    topic: str | None
    sample: dict[Signal, Value]
    is_late: bool = False

    def __str__(self) -> str:
        values = ", ".join(f"{signal.name} = {value}" for signal, value in self.sample.items())
        return f"at {self.time} ns, {self.topic or 'nothing'}{f' with {values}' if values else ''}"


class Beside:
    """Both guards in one run; each call returns what the runtime's and the emitted one decided."""

    def __init__(self, emitted: EmittedGuard, guard: Guard) -> None:
        self.emitted, self.guard = emitted, guard
        self._sent = [(message.name, message.out) for message in guard.fallbacks]

    def take(self, event: Event) -> tuple[list[int], list[int]]:
        """What is due before an event, and the event."""
        right, found = self._late(event.time) if event.is_late else self._due(event.time)
        sample = {signal.name: value for signal, value in event.sample.items()}
        if event.topic in self.guard.outs:
            right.append(self._decided(self.guard.command(event.time, event.topic, sample)))
            found.append(self.emitted.command(event.time, event.topic, event.sample))
        elif event.topic is not None:
            right += map(self._decided, self.guard.hear(event.time, event.topic, sample))
            found.append(self.emitted.hear(event.time, event.topic, event.sample))
        return [*filter(None, right)], [*filter(None, found)]

    def _due(self, time: Nanoseconds) -> tuple[list[int], list[int]]:
        right: list[int] = []
        found: list[int] = []
        while (due := min(self.emitted.due(), self.guard.due() or NEVER)) <= time:
            right += map(self._decided, self.guard.act(due))
            while self.emitted.due() <= due:
                found.append(self.emitted.act(due))
        return right, found

    def _late(self, time: Nanoseconds) -> tuple[list[int], list[int]]:
        right = list(map(self._decided, self.guard.act(time)))
        found: list[int] = []
        while self.emitted.due() <= time:
            found.append(self.emitted.act(time))
        return right, found

    def _decided(self, deed: Deed) -> int:
        if deed.action in (Action.HELD, Action.LOST):
            return HOLD
        if deed.action is Action.PASSED:
            return PASS
        return PASS + 1 + self._sent.index((deed.message or "", deed.outs[0]))


class Drawn:
    """Events of a guard that are drawn: values of its properties, times where it is hardest."""

    def __init__(self, program: GuardProgram, samples: Sequence[Samples]) -> None:
        self.program, self._samples = program, samples
        self._outs = [guard.out for guard in program.guards]
        self._first = program.spoken or self._outs
        self._topics: dict[str, list[Signal]] = {}
        for signal in (s for some in samples for s in some.sources.signals):
            if isinstance(signal.definition, Field):
                self._topics.setdefault(signal.definition.topic, []).append(signal)

    def first(self, chance: random.Random) -> Event:
        """The event with which a session begins: a message that is heard, or leaves."""
        while (event := self.event(chance, UNITS["s"], NEVER)).topic not in self._first:
            pass
        return event

    def event(self, chance: random.Random, now: Nanoseconds, due: Nanoseconds) -> Event:
        """The next event, where something is due next."""
        time = now + chance.choice([0, 0, 1, UNITS["ms"], 10 * UNITS["ms"], 100 * UNITS["ms"], UNITS["s"]])
        if due < NEVER and chance.random() < 0.5:
            time = max(now, due + chance.choice([-self.program.lead, 0, self.program.lead]) + chance.choice([-1, 0, 1]))
        topic = chance.choice([None, *self._outs, *self._topics])
        values: dict[Signal, Value] = {}
        for some in self._samples:
            values |= some.next(()).sample
        own = {signal: values[signal] for signal in self._topics.get(topic or "", ()) if signal in values}
        if chance.random() < 0.1:
            own = {signal: _unknown(signal, value) for signal, value in own.items()}
        return Event(time, topic, own, chance.random() < 0.1)


def _unknown(signal: Signal, value: Value) -> Value:
    """NaN in the place of a number that can be that."""
    if type_of(signal).scalar not in (Scalar.SINGLE, Scalar.DOUBLE):
        return value
    return (math.nan,) if type_of(signal).is_array else math.nan


def flaw(
    files: Files,
    guards: Sequence[GuardFiles],
    programs: Sequence[GuardProgram],
    compiled: Sequence[Compiled],
    specification: Specification,
    messages: Messages,
) -> str | None:
    """What the texts of guards, or what they do, is otherwise than it should; None if nothing is found.

    Without a C compiler, they are not run.
    """
    path = compiler()
    for guard, program in zip(guards, programs, strict=True):
        texts = Texts(files.header, files.source, guard.header, guard.source)
        if (wrong := difference(texts, program, compiled)) is not None:
            return str(wrong)
        if path is None:
            continue
        parts = [compiled[number].specification for number in program.parts]
        drawn = Drawn(program, [Samples(without_news(each), read(each, messages)) for each in parts])
        deviates = deviation(Library(files, path, guard), guard, program, compiled, specification, drawn)
        if deviates is not None:
            return deviates
    return None


def deviation(
    library: Loaded,
    guard: GuardFiles,
    program: GuardProgram,
    compiled: Sequence[Compiled],
    specification: Specification,
    drawn: Drawn,
) -> str | None:
    """What the emitted guard does otherwise than the runtime's; None if nothing is found."""
    plan = load_plan(compiled, specification, guards=[program])
    (own,), sent = plan.guards, fallbacks(program, compiled)
    chance, left = random.Random(0), EVENTS
    while left > 0:
        event, since = drawn.first(chance), 0
        runtime = Guard(Watching(plan, own, event.time), own.outs, sent, own.lead)
        both = Beside(EmittedGuard(library, guard), runtime)
        for number in range(1, LONGEST + 1):
            right, found = both.take(event)
            if right != found or both.emitted.has_lost is not (runtime.lost is not None):
                return f"{_shown(guard, found)} instead of {_shown(guard, right)} after {number} events, {event}"
            left, since = left - 1, since + both.emitted.has_lost
            if since == LOST:
                break
            event = drawn.event(chance, event.time, both.emitted.due())
    return None


def fallbacks(program: GuardProgram, compiled: Sequence[Compiled]) -> list[Message]:
    """The fallbacks of guards as the runtime has them: samples of the signals that are read."""
    inputs = (i for number in program.parts for i in compiled[number].specification.inputs())
    read = dict.fromkeys(pair for i in inputs for pair in fields(i.signal))
    return [
        Message(fallback.name, guard.out, samples_in(fallback, guard, own))
        for guard in program.guards
        for own in [{signal.name: signal for signal, field in read if field.topic == guard.out}]
        for fallback in guard.fallbacks
    ]


def _shown(guard: GuardFiles, decisions: Sequence[int]) -> str:
    """Decisions in words."""
    sent = (name.removeprefix(f"{guard.prefix.upper()}_").lower() for name in guard.sent)
    names = ["nothing", "the command", *sent]
    return " and ".join(f"`{names[each]}`" for each in decisions) or "nothing"
