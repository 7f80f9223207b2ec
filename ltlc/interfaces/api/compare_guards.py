"""Two guards side by side: what one lets through and the other does not, at all, and of recordings."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ltlc.analysis.errors import NotDecidedError
from ltlc.analysis.guards.differences import Beside, Difference, Side
from ltlc.analysis.guards.reasons import Reasons
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.errors import UnusableInput
from ltlc.base.limits import Budget
from ltlc.base.provenance import provenance
from ltlc.base.render.table import example_lines
from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.reading import ReadOptions
from ltlc.interfaces.api.guard import guarding_of
from ltlc.interfaces.api.prepare import Prepared, prepare, read
from ltlc.monitoring.guarding.arrangement import Solved
from ltlc.monitoring.guarding.compared import Compared
from ltlc.monitoring.guarding.recording import GuardedRun, Guarding
from ltlc.monitoring.judging.run import Judge, RunReport, readings
from ltlc.runtime.guarding import Action
from ltlc.runtime.times import SECOND
from ltlc.semantics.encodings import EPISODE
from ltlc.specification.arenas import Property
from ltlc.specification.specification import topics_of

MOST_LISTED = 10
"""So many commands of a recording are listed that only one guard lets through."""


@dataclass(frozen=True)
class OutCompared:
    """The guards of two files that send on `out`: runs at whose end only one lets a command through, and recordings.

    A run without an example may not be one that can happen. If a run was not found, and there may be one, `undecided`
    says why.
    """

    out: str
    names: tuple[str, str]
    differences: tuple[Difference, ...]
    undecided: str
    recordings: tuple[Compared, ...]

    def lines(self) -> Iterator[str]:
        """It as text."""
        yield f"guard of {self.out}"
        found = {each.passes: each for each in self.differences}
        for name, other in (self.names, self.names[::-1]):
            if (difference := found.get(name)) is not None:
                yield ""
                lets = "lets" if difference.example is not None else "may let"
                yield f"{name} {lets} a command through that {other} does not: {difference.reason}"
                yield from (f"  {line}" for line in _run_lines(difference))
            elif not self.undecided:
                yield ""
                yield f"{name} lets nothing through that {other} does not, as long as they have done the same before"
        if self.undecided:
            yield ""
            yield f"not compared: {self.undecided}"
        for each in self.recordings:
            yield ""
            yield from each.lines(MOST_LISTED)

    def document(self) -> dict[str, Any]:
        """It as JSON."""
        return {
            "out": self.out,
            "files": list(self.names),
            "undecided": self.undecided or None,
            "differences": [_document(each) for each in self.differences],
            "recordings": [each.document() for each in self.recordings],
        }


def _run_lines(difference: Difference) -> list[str]:
    if difference.example is None:
        return list(difference.events)
    return example_lines(difference.example.as_json())[1:]


def _document(difference: Difference) -> dict[str, Any]:
    return {
        "passes": difference.passes,
        "refuses": difference.refuses,
        "reason": difference.reason,
        "events": list(difference.events),
        "example": None if difference.example is None else difference.example.as_json(),
    }


@dataclass(frozen=True)
class GuardsCompared:
    """The guards of two files, by the topics on which both send; what is to be said of the input."""

    topics: tuple[OutCompared, ...]
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, Source]

    @property
    def is_complete(self) -> bool:
        """Whether all was decided."""
        return not any(
            each.undecided or any(difference.example is None for difference in each.differences) for each in self.topics
        )

    def text(self) -> str:
        """It as text."""
        return "\n\n".join("\n".join(each.lines()) for each in self.topics) + "\n"

    def json(self) -> str:
        """It as JSON."""
        made_of = provenance(self.sources)
        document = {"guards": [each.document() for each in self.topics], "provenance": made_of}
        return json.dumps(document, indent=2, allow_nan=False) + "\n"


def compare_guards(
    one: Path, two: Path, recordings: Sequence[Path], message_paths: Sequence[str], budget: Budget
) -> GuardsCompared:
    """The guards of the files `one` and `two` that send on the same topics. Raises UnusableInput and SpotMissing."""
    files = [prepare(read(path), message_paths, EPISODE, budget, recordings=recordings) for path in (one, two)]
    guardings = [guarding_of(each) for each in files]
    left, right = ({guard.out: some for some in each.solved for guard in some.guards} for each in guardings)
    if left.keys().isdisjoint(right):
        raise UnusableInput((), f"no guard of {one} sends on the topic of one of {two}")
    names = (str(one), str(two))
    pairs = list(zip(files, guardings, strict=True))
    reports = [[_judged(*each, path, message_paths) for each in pairs] for path in recordings]
    judges = [Judge(each.compiled, each.specification) for each in files]
    replays = {name: Replay(of, judge) for name, of, judge in zip(names, guardings, judges, strict=True)}
    found = []
    for out in (out for out in left if out in right):
        sides = _side(names[0], files[0], left[out]), _side(names[1], files[1], right[out])
        differences, undecided = _differences(*sides, out, replays)
        compared = [_compared(out, names, pair) for pair in reports]
        found.append(OutCompared(out, names, tuple(differences), undecided, tuple(compared)))
    told = [d for each in files for d in each.diagnostics]
    return GuardsCompared(tuple(found), tuple(told), (files[0].specification.source, files[1].specification.source))


def _compared(out: str, names: tuple[str, str], reports: Sequence[RunReport]) -> Compared:
    left, right = (each.guard for each in reports)
    session = reports[0].session
    assert left is not None
    assert right is not None
    assert session is not None
    return Compared(out, reports[0].recording, names, (left, right), session)


def _side(name: str, prepared: Prepared, some: Solved) -> Side:
    assert isinstance(some.find_play, Reasons)
    properties = tuple(Property(each.specification, each.formula, each.monitor) for each in prepared.compiled)
    return Side(name, some.guards, properties, some.find_play)


def _differences(left: Side, right: Side, out: str, runs: Mapping[str, Replay]) -> tuple[list[Difference], str]:
    """Shortest runs at whose end only one lets a command through, or why they are not known."""
    try:
        beside = Beside(left, right, out)
        found = beside.differences()
    except NotDecidedError as error:
        return [], str(error)
    found = [each if _is_shown(each, runs) else replace(each, example=None) for each in found]
    is_open = beside.is_partial and len(found) < len({left.name, right.name})
    return found, "runs in which several clocks are running when one passes its bound" if is_open else ""


def _is_shown(difference: Difference, runs: Mapping[str, Replay]) -> bool:
    """Whether the example of a difference, if there is one, makes it."""
    return runs[difference.passes].passes(difference) and not runs[difference.refuses].passes(difference)


@dataclass(frozen=True)
class Replay:
    """Tries runs that were found on the guards of a file."""

    guarding: Guarding
    judge: Judge

    def passes(self, difference: Difference) -> bool:
        """Whether the guard lets the last command of a run through, of whose values there is an example."""
        if difference.example is None:
            return False
        plan = self.judge.plan(())
        topics = {name: topic for name in readings(plan) for topic in topics_of(self.judge.signals[name])}
        outs = {guard.out: guard.raw for guard in self.guarding.specification.guards}
        own = {name: name for name, topic in topics.items() if topic in outs}
        run, time = GuardedRun(self.guarding, self.judge.signals, own, plan), SECOND
        rows = [dict(zip(difference.example.signals, row, strict=True)) for row in difference.example.steps]
        before = [topic for topic in dict.fromkeys(topics.values()) if topic not in (*outs, difference.topics[0])]
        moves = zip(difference.topics, difference.delays, rows[1:], strict=True)
        for topic, delay, row in [*((topic, 1, rows[0]) for topic in before), *moves]:
            time += delay
            run.act(time)
            if topic is not None:
                values = {name: _sample(row[name]) for name, of in topics.items() if of == topic and name in row}
                run.row(time, values, (outs.get(topic, topic),))
        return bool(run.done) and run.done[-1].deed.action is Action.PASSED


def _sample(value: Any) -> Any:
    """A value of an example as the runtime has it."""
    if isinstance(value, list):
        return tuple(map(_sample, value))
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value


def _judged(prepared: Prepared, guarding: Guarding, path: Path, message_paths: Sequence[str]) -> RunReport:
    """What the guards of a file do with a recording. Raises UnusableInput if it cannot be used, or is damaged."""
    reading = ReadOptions(message_paths=tuple(message_paths))
    found = Judge(prepared.compiled, prepared.specification, reading, guarding=guarding).judge(path)
    if found.session is None or found.is_damaged:
        raise UnusableInput(found.diagnostics)
    return found
