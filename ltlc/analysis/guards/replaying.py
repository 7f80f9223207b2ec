"""The guards of a file along runs that are found or tried, as `ltlc run --guard` takes them along a recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ltlc.analysis.guards.differences import Difference, content_of
from ltlc.monitoring.guarding.recording import GuardedRun, Guarding
from ltlc.monitoring.guarding.report import Done
from ltlc.monitoring.judging.run import Judge, readings
from ltlc.runtime.guarding import Action, Deed
from ltlc.runtime.times import SECOND
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Field


class Replay:
    """Takes the guards of the file `name` along runs; `signals` and `fields` are what they read, by name."""

    def __init__(self, name: str, guarding: Guarding, judge: Judge) -> None:
        """`judge` has the monitors of the file."""
        plan = judge.plan(())
        self.name = name
        self.signals = {name: judge.signals[name] for name in readings(plan)}
        definitions = {name: signal.definition for name, signal in self.signals.items()}
        self.fields = {name: field for name, field in definitions.items() if isinstance(field, Field)}
        self.specification = guarding.specification
        self.raws = {guard.out: guard.raw for guard in self.specification.guards}
        commands = {name: name for name, field in self.fields.items() if field.topic in self.raws}
        hushed = replace(guarding, solved=[replace(each, find_play=lambda *_: None) for each in guarding.solved])
        self._hushed, self._explained = (GuardedRun(each, judge.signals, commands, plan) for each in (hushed, guarding))
        self._run = self._hushed
        self._contents = {f.name: content_of(f) for guard in self.specification.guards for f in guard.fallbacks}

    @property
    def topics(self) -> dict[str, None]:
        """The topics of what they read, in the order of the properties."""
        return dict.fromkeys(field.topic for field in self.fields.values())

    @property
    def heard(self) -> set[str]:
        """The topics of messages that are no commands."""
        return {*self.topics} - {*self.raws}

    def begin(self, *, explained: bool = False) -> None:
        """Begin a run; only one that is `explained` has the plays that are avoided among its reasons."""
        self._run = self._explained if explained else self._hushed
        self._run.restart()

    def due(self) -> Nanoseconds | None:
        """When a guard may act by itself next; None: never."""
        return self._run.due()

    def take(self, time: Nanoseconds, topic: str | None, values: Mapping[Field, Value]) -> list[Done]:
        """What they do up to a `time`, then with a message on a topic, or a command that asks to leave on it."""
        done = len(self._run.done)
        self._run.act(time)
        if topic is not None:
            samples = {name: values[field] for name, field in self.fields.items() if field in values}
            self._run.row(time, samples, (self.raws.get(topic, topic),))
        return self._run.done[done:]

    def last(self, out: str) -> Done:
        """What was done with the last command on a topic."""
        return next(
            each for each in reversed(self._run.done) if each.deed.command is not None and out in each.deed.outs
        )

    def content(self, deed: Deed) -> object:
        """What has left that is no command."""
        return None if deed.message is None else self._contents[deed.message]

    def passes(self, difference: Difference) -> bool:
        """Whether a guard lets the last command of a run through, of whose values there is an example."""
        if difference.example is None:
            return False
        rows = [dict(zip(difference.example.signals, row, strict=True)) for row in difference.example.steps]
        before = [topic for topic in self.topics if topic not in (*self.raws, difference.topics[0])]
        moves = zip(difference.topics, difference.delays, rows[1:], strict=True)
        self.begin()
        time, done = SECOND, list[Done]()
        for topic, delay, row in [*((topic, 1, rows[0]) for topic in before), *moves]:
            time += delay
            known = {field: _sample(row[name]) for name, field in self.fields.items() if name in row}
            of_topic = {field: value for field, value in known.items() if field.topic == topic}
            done = self.take(time, topic, of_topic) or done
        return bool(done) and done[-1].deed.action is Action.PASSED


def _sample(value: Any) -> Any:
    """A value of an example as the runtime has it."""
    if isinstance(value, list):
        return tuple(map(_sample, value))
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value
