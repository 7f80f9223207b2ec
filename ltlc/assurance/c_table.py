"""Tables in emitted C or Rust, to be replayed: of ids, and what is shown of each; of open instances."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from typing import Any

from ltlc.assurance.c_program import CProgram
from ltlc.assurance.compiled_program import VERDICTS, require_refused, take
from ltlc.assurance.instance_traffic import InstanceTraffic
from ltlc.assurance.library import Loaded, Monitors
from ltlc.assurance.messages import Messages
from ltlc.assurance.replay import Id, Run, Shown, Stepper
from ltlc.assurance.sliced_traffic import SlicedTraffic, Told
from ltlc.assurance.traffic import Begun, Event, Settings, Together
from ltlc.assurance.values import Samples
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.runtime.times import NEVER
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Signal
from ltlc.specification.specification import Instances, Slicing


class Table(Monitors):
    """A table of ids in a library in one run; as a monitor, but of all ids."""

    def __init__(self, library: Loaded) -> None:
        super().__init__(library)
        self._functions.gate_step_of.argtypes = [ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p]
        self._functions.gate_step_of.restype = ctypes.c_bool
        self._functions.gate_show_of.argtypes = [ctypes.c_void_p, ctypes.c_int64, ctypes.POINTER(ctypes.c_int64)]
        self._functions.gate_show_of.restype = ctypes.c_bool

    def step_of(self, time: Nanoseconds, id_: int, sample: dict[Signal, Value], topic: str) -> bool:
        """A message of one id has come."""
        self._fill(sample, [topic])
        return bool(self._functions.gate_step_of(self._self, time, id_, self._samples))

    def left_out(self) -> int:
        """How many messages found no place."""
        return self.show(0)[1]

    def show_of(self, id_: int) -> tuple[Verdict, Nanoseconds] | None:
        """The verdict of an id, and when it came; None if it is not kept."""
        if not self._functions.gate_show_of(self._self, id_, self._shown):
            return None
        return VERDICTS[self._shown[0]], self._shown[1]


@dataclass(frozen=True)
class TableProgram(CProgram):
    """The only property in emitted C or Rust, which is judged for each id."""

    messages: Messages

    def runs(self, compiled: Compiled, samples: Samples) -> Iterator[Run[Any]]:
        """Messages with a few ids."""
        slicing = compiled.specification.slicing
        assert isinstance(slicing, Slicing)
        yield from SlicedTraffic(samples, slicing, self.messages).runs(compiled, self.libraries.own)

    def start(self, settings: Settings) -> Stepper[Event]:
        """A table before a run. Raises CompilerError."""
        table = Table(self.libraries.of(settings))
        ids = set[int]()

        def step(event: Event) -> Shown:
            if isinstance(event, Told):
                ids.update(_whole(ident.id) for ident, _ in event.parts)
            _take(table, event)
            known = {id_: found for id_ in ids if (found := table.show_of(id_)) is not None}
            verdict = VERDICTS[table.show(0)[0]]
            violated = {id_: since for id_, (one, since) in known.items() if one is Verdict.VIOLATED}
            owed = {id_ for id_, (one, _) in known.items() if one is Verdict.PRESUMABLY_VIOLATED}
            return {"verdict": verdict.value, "violated": violated, "owed": owed}

        return step


@dataclass(frozen=True)
class InstancesProgram(CProgram):
    """The only property in emitted C or Rust, which is judged from each message on."""

    def runs(self, compiled: Compiled, samples: Samples) -> Iterator[Run[Any]]:
        """Messages, some of which open instances."""
        slicing = compiled.specification.slicing
        assert isinstance(slicing, Instances)
        yield from InstanceTraffic(samples, slicing).runs(compiled, self.libraries.own)

    def start(self, settings: Settings) -> Stepper[Event]:
        """Instances before a run. Raises CompilerError."""
        instances = self.libraries.of(settings).monitors()

        def step(event: Event) -> Shown:
            if not take(instances, event):
                raise RuntimeError(f"{event} is refused")
            require_refused(instances, event)
            verdict, failed, owing, _ = instances.show(0)
            return {"verdict": VERDICTS[verdict].value, "failed": failed, "owing": owing}

        return step


def _take(table: Table, event: Event) -> None:
    """Whatever an event brings; a deadline that comes again and again, or a call that is refused, is a fault."""
    match event:
        case Begun():
            is_taken = True
        case Told(time, said, parts):
            _require_refused(table, time)
            is_taken = all(table.step_of(time, _whole(i.id), dict(sample), said.topic) for i, sample in parts)
        case Together():
            raise TypeError("a message of an id comes alone")
        case _:
            is_taken = take(table, event)
    if not is_taken:
        raise RuntimeError(f"{event} is refused")


def _require_refused(table: Table, now: Nanoseconds) -> None:
    """Times before that of a message, and those that no run has, are refused and change nothing."""
    table.advance(now)
    before = table.memory()
    for time in (now - 1, NEVER, -NEVER):
        if table.step_of(time, 0, {}, "") or table.step(time, {}, ()) or table.memory() != before:
            raise RuntimeError(f"the time {time} ns is not refused after {now} ns")


def _whole(id_: Id) -> int:
    """An id in C or Rust."""
    assert isinstance(id_, int)
    return id_
