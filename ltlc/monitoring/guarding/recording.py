"""A recording as guards would have let it through: what they did with its commands, and the run that comes of it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path
from typing import cast

import numpy as np

from ltlc.base.diagnostics import Diagnostic
from ltlc.dataclass import dataclass
from ltlc.inputs.messages.texts import text_of
from ltlc.inputs.recordings import Block, Recording
from ltlc.inputs.recordings.bags import BagRecording
from ltlc.inputs.recordings.bags.fallbacks import message_of, samples_in
from ltlc.inputs.recordings.blocks import ROWS, Places, Samples, packed
from ltlc.inputs.recordings.reading import ReadOptions, kept_name
from ltlc.inputs.recordings.rows import Column
from ltlc.monitoring.guarding.arrangement import Arrangement, Solved
from ltlc.monitoring.guarding.followed import Followed
from ltlc.monitoring.guarding.report import Done, GuardReport
from ltlc.runtime import sampling
from ltlc.runtime.guarding import Deed, Guard, Guards, Message, Values
from ltlc.runtime.session import Plan
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.expressions import Field, Signal
from ltlc.specification.guards import Guard as Stated
from ltlc.specification.specification import Specification

Open = Callable[[Path, Mapping[str, Signal], ReadOptions], Recording]
"""Opens a recording, of which these signals are wanted."""

MakePlan = Callable[[Collection[str]], Plan]
"""The plan of a run in which samples of these signals come in themselves."""


@dataclass(frozen=True)
class Guarding:
    """The guards of `specification`, solved. If it `keeps_messages`, a report has what came in and what left whole."""

    specification: Specification
    solved: Sequence[Solved]
    keeps_messages: bool = False

    def through(
        self, plan: MakePlan, open_: Open, path: Path, signals: Mapping[str, Signal], reading: ReadOptions
    ) -> GuardedRecording:
        """What they let through of the recording at `path`, of which `signals` are wanted; `plan` is of those it has.

        Raises RecordingError.
        """
        wanted, commands = self.wanted(signals)
        if self.keeps_messages:
            guards = self.specification.guards
            reading = replace(reading, kept=frozenset(topic for each in guards for topic in (each.raw, each.out)))
        recording = open_(path, wanted, reading)
        if commands.keys().isdisjoint(recording.columns):
            unguarded, own = open_(path, signals, reading), {name: name for name in commands.values()}
            if not own.keys().isdisjoint(unguarded.columns):
                return GuardedRecording(self, plan, unguarded, signals, own, is_unguarded=True)
        return GuardedRecording(self, plan, recording, signals, commands)

    def wanted(self, signals: Mapping[str, Signal]) -> tuple[dict[str, Signal], dict[str, str]]:
        """`signals` with those of commands in the place of what is let through, and each with the name of that."""
        outs = {guard.out: guard for guard in self.specification.guards}
        asked = {
            name: _asked(outs[_topic(signal)], signal) for name, signal in signals.items() if _topic(signal) in outs
        }
        others = {name: signal for name, signal in signals.items() if name not in asked}
        twins = {twin.name: twin for twin in asked.values()}
        return {**others, **twins}, {twin.name: name for name, twin in asked.items()}


def _topic(signal: Signal) -> str:
    """The topic that `signal` is a field of; empty for one that is computed."""
    return signal.definition.topic if isinstance(signal.definition, Field) else ""


def _asked(guard: Stated, signal: Signal) -> Signal:
    """What the commands of `guard` have where what it lets through has `signal`."""
    assert isinstance(signal.definition, Field)
    twin = replace(signal.definition, topic=guard.raw)
    declared = (each for each in guard.asked if isinstance(each.definition, Field) and each.definition == twin)
    column = "/".join([guard.raw, *map(str, twin.path)])
    return next(declared, replace(signal, name=column, definition=twin))


@dataclass
class GuardedRecording:
    """The run that left guards; `commands` has the names that these are read by, each with that of what is let through.

    It `is_unguarded` if the recording has no commands, and what was recorded behind the guard was taken for them. What
    the guards have `done` is in the order of time; the `first` row has this time.
    """

    guarding: Guarding
    plan: MakePlan
    recording: Recording
    signals: Mapping[str, Signal]
    commands: Mapping[str, str]
    is_unguarded: bool = False
    done: list[Done] = field(default_factory=list)
    first: Nanoseconds | None = None

    @property
    def columns(self) -> tuple[str, ...]:
        """See `Recording`."""
        found = self.recording.columns
        own = [name for name in found if name not in self.commands or name in self.signals]
        return tuple(dict.fromkeys([*own, *(let for name, let in self.commands.items() if name in found)]))

    @property
    def definitions(self) -> Mapping[str, str]:
        """See `Recording`."""
        return self.recording.definitions

    @property
    def beginning(self) -> Nanoseconds | None:
        """See `Recording`."""
        return self.recording.beginning

    def absence(self, name: str) -> str:
        """See `Recording`."""
        return self.recording.absence(self._read_by(name))

    def remedy(self, name: str) -> str:
        """See `Recording`."""
        return self.recording.remedy(self._read_by(name))

    def _read_by(self, name: str) -> str:
        return next((command for command, let in self.commands.items() if let == name), name)

    def report(self, since: Nanoseconds | None, until: Nanoseconds | None) -> GuardReport:
        """What the guards did from the time `since` on, up to and including `until`; None is no limit."""
        done = [
            each
            for each in self.done
            if (since is None or each.deed.time >= since) and (until is None or each.deed.time <= until)
        ]
        definitions = {guard.out: self._definition(guard) for guard in self.guarding.specification.guards}
        return GuardReport(self.guarding.specification.guards, done, self.is_unguarded, definitions)

    def _definition(self, guard: Stated) -> str:
        """A text that defines what a guard lets through, in the form `ros2msg`: as the recording does, if it does."""
        types = dict(self.recording.types) if isinstance(self.recording, BagRecording) else {}
        return text_of(guard.message, types[guard.message].messages) if guard.message in types else guard.definition

    def remarks(self) -> list[Diagnostic]:
        """See `Recording`."""
        return self.recording.remarks()

    def blocks(self) -> Iterator[Block]:
        """See `Recording`."""
        plan = self.plan(self.columns)
        run = GuardedRun(self.guarding, self.signals, self.commands, plan, is_unguarded=self.is_unguarded)
        self.done = run.done
        wanted = {*self.recording.columns, *(kept_name(raw) for raw in run.raws)}
        for block in self.recording.blocks():
            if self.first is None and len(block.times):
                self.first = int(block.times[0])
            for time, names, values, topics in block.rows(wanted):
                run.row(time, dict(zip(names, values, strict=True)), topics)
                if len(run.taken) >= ROWS:
                    yield run.block()
            if len(block.times):
                run.act(int(block.times[-1]))
            yield run.block()


@dataclass(frozen=True, slots=True)
class Event:
    """A message of a guarded run; `values` are its samples."""

    time: Nanoseconds
    topic: str
    values: Values


class GuardedRun:
    """Guards along one run; `taken` are the messages that came on other topics, or left a guard.

    In the samples that come, those of commands go by the names in `commands`, each with that of what is let through.
    """

    def __init__(
        self,
        guarding: Guarding,
        signals: Mapping[str, Signal],
        commands: Mapping[str, str],
        plan: Plan,
        *,
        is_unguarded: bool = False,
    ) -> None:
        self.taken: list[Event] = []
        self.done: list[Done] = []
        self._signals, self._commands = signals, commands
        specification = guarding.specification
        self._lead, self._stated, self._keeps = specification.lead, specification.guards, guarding.keeps_messages
        self._whole: bytes | None = None
        self.raws = {guard.raw: guard.out for guard in specification.guards}
        self._outs = {guard.out for guard in specification.guards}
        if is_unguarded:
            self.raws = {out: out for out in self._outs}
        readings = [signal for signal in plan.signals if isinstance(signal, sampling.Reading)]
        self._topics = {signal.name: signal.topic for signal in readings}
        self._columns = {r.name: Column(signals[r.name].type, signals[r.name].numbers) for r in readings}
        properties = {each.label: each for each in specification.properties}
        self._arranged = [(some, Arrangement(some, properties, plan)) for some in guarding.solved]
        self._guards: Guards | None = None

    def restart(self) -> None:
        """Begin another run."""
        self.taken, self.done, self._guards = [], [], None

    def row(self, time: Nanoseconds, samples: Values, topics: Sequence[str]) -> None:
        """What came in at once: messages on other topics first, then commands."""
        messages: dict[str, dict[str, sampling.Value]] = {}
        commands: dict[str, dict[str, sampling.Value]] = {}
        for name, value in samples.items():
            if name in self._commands:
                let_through = self._commands[name]
                commands.setdefault(self._topics[let_through], {})[let_through] = value
            if name in self._topics and self._topics[name] not in self._outs:
                messages.setdefault(self._topics[name], {})[name] = value
        for topic in topics:
            if topic in self.raws:
                commands.setdefault(self.raws[topic], {})
            if topic not in self._outs:
                messages.setdefault(topic, {})
        self.act(time)
        for topic, values in messages.items():
            guards = self._begun(time)
            self.taken.append(Event(time, topic, values))
            guards.hear(time, topic, values)
        whole = {out: samples.get(kept_name(raw)) for raw, out in self.raws.items()}
        for out, values in commands.items():
            self._whole, is_first = whole[out], self._guards is None
            self._begun(time).command(time, out, values)
            if is_first and not self.taken:
                self._guards = None

    def act(self, time: Nanoseconds) -> None:
        """Do all that is due up to and including `time`, in its order."""
        while (due := self.due()) is not None and due <= time:
            self._begun(due).act(due)

    def act_live(self, time: Nanoseconds) -> None:
        """Do the same at `time`, which is late for what was due before."""
        if self._guards is not None:
            self._guards.act(time)

    def due(self) -> Nanoseconds | None:
        """When one of them may act by itself next, if nothing comes before; None: never."""
        return None if self._guards is None else self._guards.due()

    def _begun(self, time: Nanoseconds) -> Guards:
        """The guards; the session begins with the first message that comes on another topic or leaves."""
        if self._guards is None:
            self._guards = Guards([self._guard(some, each, time) for some, each in self._arranged], self._done)
        return self._guards

    def _guard(self, some: Solved, arrangement: Arrangement, began: Nanoseconds) -> Guard:
        messages = [message for guard in some.guards for message in self._fallbacks(guard)]
        return Guard(Followed(arrangement, began), some.arena.outs, messages, self._lead)

    def _message(self, deed: Deed) -> bytes | None:
        """The command of a deed, in CDR: as it was recorded, or with the values that are known of it."""
        if deed.command is None or self._whole is not None:
            return None if deed.command is None else self._whole
        (guard,) = (guard for guard in self._stated if guard.out in deed.outs)
        return message_of(guard, {self._signals[name]: value for name, value in deed.command.items()})

    def _fallbacks(self, guard: Stated) -> Iterator[Message]:
        """The fallbacks of a guard, with what they have of the signals that are read."""
        own = {name: self._signals[name] for name, topic in self._topics.items() if topic == guard.out}
        for fallback in guard.fallbacks:
            yield Message(fallback.name, guard.out, samples_in(fallback, guard, own))

    def _done(self, deed: Deed) -> None:
        followed = cast("Followed | None", deed.otherwise)
        play = None if followed is None else followed.play()
        self.done.append(Done(replace(deed, otherwise=None), play, self._message(deed) if self._keeps else None))
        if deed.values is not None:
            self.taken.append(Event(deed.time, deed.outs[0], deed.values))

    def block(self) -> Block:
        """The messages that were taken since the last one."""
        events, self.taken = self.taken, []
        times = np.array([event.time for event in events], np.int64)
        samples = {name: self._column(name, column, events) for name, column in self._columns.items()}
        topics = dict.fromkeys(event.topic for event in events)
        return Block(times, samples, {topic: _rows(event.topic == topic for event in events) for topic in topics})

    @staticmethod
    def _column(name: str, column: Column, events: Sequence[Event]) -> Samples:
        rows = _rows(name in event.values for event in events)
        return Samples(rows, packed([events[row].values[name] for row in rows.tolist()], column))


def _rows(having: Iterator[bool]) -> Places:
    return np.flatnonzero(np.fromiter(having, np.bool_)).astype(np.int64)
