"""The replay: the code as emitted is loaded and stepped, and must give the verdicts of the monitor it was made from."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice
from types import ModuleType
from typing import Any

from ltlc.assurance.runs import transition_runs
from ltlc.assurance.values import Sample, Samples, inputs_along
from ltlc.backends.python import standalone_classes
from ltlc.compiler import Compiled
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter
from ltlc.specification.evaluation import Input, Value, letter
from ltlc.specification.expressions import Current
from ltlc.specification.specification import Specification

MOST_GUIDED_RUNS = 1000
RANDOM_RUNS, RANDOM_STEPS = 30, 20

Stepper = Callable[[Sample, dict[Input, Value] | None], str]
"""Emitted code, ready for its first step: from a sample and the inputs made of it, the JSON name of the verdict."""


@dataclass(frozen=True, slots=True)
class Replayed:
    """The emitted code gave the monitor's verdicts on all `runs` runs; they had `letters` different letters."""

    runs: int
    letters: int


@dataclass(frozen=True, slots=True)
class Deviation:
    """After `run`, the emitted code says `emitted` where the monitor says `monitor`."""

    run: tuple[Sample, ...]
    monitor: Verdict
    emitted: str


def replay(compiled: Compiled, start: Callable[[], Stepper]) -> Replayed | Deviation:
    """Step code that `start` makes ready, on runs that take each transition of the monitor, and on random ones."""
    letters = set()
    count = 0
    for run in _runs(compiled):
        count += 1
        stepper = start()
        state, verdict = 0, Verdict.NOT_STARTED
        for step, values in enumerate(inputs_along(compiled.specification, run)):
            seen = None if values is None else letter(compiled.specification.atoms, values)
            if seen is not None:
                letters.add(seen)
                state = compiled.monitor.step(state, seen)
                verdict = compiled.monitor.verdicts[state]
            emitted = _answer(stepper, run[step], values)
            if emitted != verdict.value:
                return Deviation(run[: step + 1], verdict, emitted)
    return Replayed(count, len(letters))


def _answer(stepper: Stepper, sample: Sample, values: dict[Input, Value] | None) -> str:
    try:
        return stepper(sample, values)
    except Exception as error:  # whatever emitted code does wrong is a finding, not the end of the gate
        return f"{type(error).__name__}: {error}"


def _runs(compiled: Compiled) -> Iterator[tuple[Sample, ...]]:
    """Runs as samples of the signals of `compiled`."""
    samples = Samples(compiled.specification)
    if all(isinstance(wanted, Current) for wanted in compiled.specification.inputs()):
        yield from islice(_guided(compiled, samples.by_letter()), MOST_GUIDED_RUNS)
    for _ in range(RANDOM_RUNS):
        yield tuple(samples.draw() for _ in range(RANDOM_STEPS))


def _guided(compiled: Compiled, known: dict[Letter, list[Sample]]) -> Iterator[tuple[Sample, ...]]:
    """Runs that take each transition of the monitor, for each sample that is known of a letter."""
    for turn in range(max(map(len, known.values()), default=0)):
        for word in transition_runs(compiled.monitor, list(known)):
            yield tuple(known[seen][(turn + step) % len(known[seen])] for step, seen in enumerate(word))


def starters(
    target: str, text: str, compiled: Sequence[Compiled], specification: Specification
) -> list[Callable[[], Stepper]] | None:
    """For each property, what makes its emitted code ready; None if the output `text` is not code."""
    match target:
        case "python":
            module = load(text, "emitted")
            classes = standalone_classes(compiled, specification.source.name)
            return [partial(standalone_stepper, module[c.name], c.parameters) for c in classes]
        case "ros2":
            monitored = load(text, "emitted")["PROPERTIES"]
            return [
                partial(runtime_stepper, m.monitor, c.specification.inputs())
                for m, c in zip(monitored, compiled, strict=True)
            ]
    return None


def load(text: str, name: str) -> dict[str, Any]:
    """The names that a module with this text defines; `name` is what errors call it."""
    module = ModuleType(name)
    sys.modules[name] = module  # where dataclasses look up the annotations of their fields
    try:
        exec(compile(text, f"<{name}>", "exec"), module.__dict__)
    finally:
        del sys.modules[name]
    return module.__dict__


def standalone_stepper(make: Callable[[], Any], parameters: Sequence[tuple[str, Any]]) -> Stepper:
    """A monitor of the `python` target, whose `step` takes signals by name."""
    monitor = make()
    return lambda sample, _: str(monitor.step(**{name: sample[signal] for name, signal in parameters}).value)


def runtime_stepper(make: Callable[[], Any], inputs: Sequence[Input]) -> Stepper:
    """A monitor of the `ros2` target, whose `step` takes the inputs of the property in order."""
    monitor = make()

    def step(_: Sample, values: dict[Input, Value] | None) -> str:
        if values is not None:
            monitor.step(*(values[wanted] for wanted in inputs))
        return str(monitor.verdict.value)

    return step
