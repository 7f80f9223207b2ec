"""Measures expressions, state predicates and topics of a recording in one pass over its blocks."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ltlc.automata import Budget
from ltlc.backends.python.load import load_plan
from ltlc.base.source import Source
from ltlc.compiler import Compiled, compile_specification
from ltlc.frontend.language import load_text
from ltlc.frontend.starter.measured import Arrivals, Measured, Probe, Values
from ltlc.inputs.recordings import open_recording
from ltlc.inputs.recordings.blocks import Array
from ltlc.inputs.recordings.lacks import signals_of
from ltlc.inputs.recordings.reading import ReadOptions
from ltlc.monitoring.columns.derived import derive
from ltlc.monitoring.columns.prepared import prepare_all
from ltlc.monitoring.columns.series import Columns, Steps, UnsupportedError
from ltlc.monitoring.columns.values import predicate, value
from ltlc.program.lowering import condition, lowered
from ltlc.runtime.sampling import Derived, Reading, Window
from ltlc.runtime.session import Session
from ltlc.semantics.durations import UNITS, Nanoseconds
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.properties import predicates
from ltlc.specification.expressions import Call, Current, Expression, operands
from ltlc.specification.functions import Function
from ltlc.specification.specification import topics_of
from ltlc.specification.wire import DOUBLES, Numbers

WINDOWS = [each * 10**zeros * UNITS["s"] for zeros in range(4) for each in (1, 2, 5)]
"""The times in which messages are counted: of these the shortest in which there usually are `MESSAGES`."""

MESSAGES = 10

_BUDGET = Budget(10.0, 1024)
"""More than enough: all properties are of one shape."""


def measure(declarations: str, probes: Sequence[Probe], path: Path, message_paths: Sequence[str] = ()) -> Measured:
    """What the recording at `path` shows of `probes`, which speak of what is declared, and of the topics of these.

    What columns cannot compute is left out. Raises RecordingError and SpotMissing.
    """
    text = "\n".join([declarations, *(probe.property for probe in probes)])
    specification, problems = load_text(Source("measured", text), message_paths, recordings=[path])
    assert specification is not None, problems
    compiled, _ = compile_specification(specification, EPISODE, _BUDGET)
    session = Session(load_plan(compiled, specification))
    definitions = {k: of for each in prepare_all(compiled, specification.source) for k, of in each.definitions.items()}
    readings = [signal for signal in session.plan.signals if isinstance(signal, Reading)]
    computed = [signal for signal in session.plan.signals if isinstance(signal, Derived)]
    series = [_Series(*of) for of in zip(probes, compiled, (window for _, window in session.stepped), strict=True)]
    signals = signals_of(each.specification for each in compiled)
    times: dict[str, list[NDArray[np.int64]]] = {topic: [] for of in signals.values() for topic in topics_of(of)}
    span: list[Nanoseconds] = []
    for block in open_recording(path, signals, ReadOptions(message_paths=tuple(message_paths))).blocks():
        columns = Columns(block, session.sampler, readings)
        derive(columns, computed, session.sampler, definitions)
        for each in series:
            each.take(columns)
        for topic, found in times.items():
            found.append(block.times[columns.listed(columns.messages(topic))])
        if len(block.times):
            span += [int(block.times[0]), int(block.times[-1])]
        for name, of in columns.series.items():
            of.add_to(session.sampler, name)
        columns.release()
    came = {topic: np.concatenate(found) for topic, found in times.items() if any(map(len, found))}
    return Measured(
        {each.probe: each.values for each in series if not each.is_unsupported},
        {topic: _arrivals(of, span[0], span[-1]) for topic, of in came.items()},
    )


class _Series:
    """The values of a probe, at the steps of its property."""

    def __init__(self, probe: Probe, compiled: Compiled, window: Window) -> None:
        self.probe = probe
        self.values = Values()
        self.is_unsupported = False
        self._compiled = compiled
        self._window = window
        self._last = -np.inf
        if probe.kind == "number":
            self.values.possible = _possible(self._measured)

    @property
    def _measured(self) -> Expression:
        (atom,) = self._compiled.specification.atoms
        return operands(atom.condition)[0]

    def take(self, columns: Columns) -> None:
        """Take the next block."""
        if self.is_unsupported:
            return
        try:
            steps = columns.steps(self._window.inputs, self._window.topics)
            found = np.broadcast_to(self._value(steps), len(steps))
        except UnsupportedError:
            self.is_unsupported = True
            return
        self._add(found)

    def _value(self, steps: Steps) -> Array | np.bool_ | np.float64 | bool | str:
        property_ = self._compiled.specification
        if self.probe.kind != "predicate":
            return value(lowered(self._measured), steps)
        (formula,) = predicates(property_.property)
        holds = {a.name: np.broadcast_to(value(condition(a.condition), steps), len(steps)) for a in property_.atoms}
        return predicate(formula, holds)

    def _add(self, found: Array) -> None:
        values = self.values
        if found.dtype.kind == "f":
            found = found[~np.isnan(found)]
        if not len(found):
            return
        values.count += len(found)
        if values.are_few:
            values.different.update(found.tolist() if found.dtype == object else np.unique(found).tolist())
        if found.dtype != object:
            values.least, values.most = min(values.least, float(found.min())), max(values.most, float(found.max()))
            numbers = found.astype(np.float64)
            values.only_grow &= bool(numbers[0] >= self._last and (np.diff(numbers) >= 0).all())
            self._last = numbers[-1]


def _possible(expression: Expression) -> Numbers:
    """Which numbers `expression` can be."""
    match expression:
        case Current(signal):
            return signal.numbers
        case Call(Function.MIN | Function.MAX, (Current(array),)):
            return array.numbers
        case _:
            return DOUBLES


def _arrivals(times: NDArray[np.int64], first: Nanoseconds, last: Nanoseconds) -> Arrivals:
    """Those of messages at `times`, in a recording that goes from the `first` time to the `last`."""
    gaps = np.diff(times)
    usual = int(np.median(gaps)) if len(gaps) else 0
    gap = max(int(gaps.max()) if len(gaps) else 0, last - int(times[-1]))
    window = next((each for each in WINDOWS if each >= MESSAGES * usual), WINDOWS[-1])
    ends = np.append(times[1:] - 1, last)
    ends = ends[ends >= times[0] + window]
    counts = times.searchsorted(ends, "right") - times.searchsorted(ends - window, "right")
    return Arrivals(len(times), int(times[0]) - first, gap, usual, window, int(counts.min()) if len(counts) else 0)
