"""Random properties that take values at openings, as they are judged by all that ltlc has, and by definition."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from random import Random
from typing import Any

from openings_by_definition import DECLARATIONS, Draw, Node, Row, Run, is_step, text
from stepping import emitted, from_text

from ltlc.assurance.c_library import Library
from ltlc.assurance.compiled_program import VERDICTS
from ltlc.assurance.library import Monitors
from ltlc.backends.c import emit
from ltlc.backends.python import standalone_classes
from ltlc.backends.python.load import load_plan
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.inputs.recordings.blocks import blocks_of
from ltlc.inputs.recordings.rows import Column
from ltlc.inputs.recordings.rows import Row as RecordedRow
from ltlc.monitoring.columns.prepared import prepare_all
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.timed_atoms import atoms_within
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Signal, ValueType

KINDS = {name: Column(ValueType.NUMBER if name == "d" else ValueType.BOOLEAN) for name in "xydg"}
LATER = 25
"""How many ns a run is looked at after its last row: then nothing changes any more by itself."""


@dataclass(frozen=True)
class Case:
    """A property and a run."""

    node: Node
    rows: Sequence[Row]

    @property
    def specification(self) -> str:
        return f"{DECLARATIONS}p: {text(self.node)}\n"

    @property
    def end(self) -> int:
        return self.rows[-1].time + LATER


MOST_ATOMS = 6
"""Of what is drawn, so that monitors are made fast."""


def drawn(chance: Random) -> Case:
    """A case whose property the language has, and that takes values."""
    while True:
        draw = Draw(chance)
        case = Case(draw.property(), draw.rows())
        if "opening}" not in case.specification:
            continue
        specification, _ = load_text(Source("props.txt", case.specification))
        if specification is None:
            continue
        (property_,) = specification.properties
        if len(list(atoms_within(encode(property_.property, EPISODE)))) <= MOST_ATOMS:
            return case


Told = list[tuple[int, str]]
"""Verdicts, and when they came."""


def by_python(case: Case) -> tuple[Told, list[str]]:
    """What the emitted class says, and where that is not what the property is by definition."""
    compiled, _ = from_text(case.specification)
    (written,) = standalone_classes(compiled, "props.txt")
    monitor = emitted(compiled)[written.name](*([case.rows[0].time] if written.timed else []))
    run, values = Run(case.node, case.rows[0].time), dict[str, Any]()
    told: Told = []
    wrong: list[str] = []

    def look(time: int) -> None:
        run.hold(time)
        while written.timed and time > monitor.due:
            monitor.expire()
        compare(time)

    def compare(time: int) -> None:
        verdict = monitor.verdict.value
        if not run.instants:
            return
        if not told or told[-1][1] != verdict:
            told.append((time, verdict))
        if Verdict(verdict).is_permanent and time < case.end:
            return
        holds = run.satisfies(len(run.instants))
        if holds != Verdict(verdict).holds:
            wrong.append(f"{verdict} at {time}, where it {'holds' if holds else 'fails'}")

    now = case.rows[0].time
    for number, row in enumerate(case.rows):
        while now < row.time:
            now += 1
            look(now)
        values |= row.values
        if is_step(row, case.node, number == 0):
            told_now = {**values, "new g": "g" in row.values}
            given = {name: told_now[signal.name] for name, signal in written.parameters}
            run.step(row.time, {"d": 0.0, **values}, "g" in row.values)
            monitor.step(*([row.time] if written.timed else []), **given)
            compare(row.time)
    while now < case.end:
        now += 1
        look(now)
    return told, wrong


def by_rows_and_columns(case: Case, chance: Random) -> tuple[Told, Session, Session]:
    """What is told row by row; the session judged so, and one that was judged by columns, in some blocks."""
    compiled, specification = from_text(case.specification)
    plan = load_plan(compiled, specification, set(KINDS))
    by_rows = ByRows(Session(plan, True))
    by_blocks = ByBlocks(Session(plan, True), prepare_all(compiled, specification.source))
    wanted = {signal.name for signal in plan.signals}
    kinds = {name: kind for name, kind in KINDS.items() if name in wanted}
    rows = [RecordedRow(row.time, dict(row.values)) for row in case.rows]
    cut = chance.randint(0, len(rows))
    for part in (rows[:cut], rows[cut:]):
        for block in blocks_of(part, kinds):
            for time, names, values, topics in block.rows(wanted):
                by_rows.samples(time, names, values, topics)
            by_blocks.take(block)
    by_rows.advance(case.end)
    ByRows(by_blocks.session).advance(case.end)
    (track,) = by_rows.tracks
    return [(change.moment.time, change.current.value) for change in track.changes], by_rows.session, by_blocks.session


def by_c(cases: Sequence[Case], path: str) -> Iterator[Told]:
    """What emitted C says of each case, all of whose properties are in one file."""
    text_ = DECLARATIONS + "".join(f"p{n}: {text(case.node)}\n" for n, case in enumerate(cases))
    compiled, specification = from_text(text_)
    library = Library(emit(compiled, specification), path)
    signals = {i.signal.name: i.signal for each in compiled for i in each.specification.inputs()}
    for number, case in enumerate(cases):
        yield list(_by_c(case, library.monitors(), number, signals))


def _by_c(case: Case, monitors: Monitors, number: int, signals: Mapping[str, Signal]) -> Iterator[tuple[int, str]]:
    before, now = "not_started", case.rows[0].time
    monitors.begin(now)
    for row in [*case.rows, Row(case.end, {})]:
        for time in range(now + 1, row.time + 1):
            assert monitors.advance(time)
            verdict = VERDICTS[monitors.show(number)[0]].value
            if verdict != before:
                yield time, verdict
            before = verdict
        now = row.time
        sample = {signals[name]: value for name, value in row.values.items() if name in signals and name != "g"}
        assert monitors.step(now, sample, [f"/{name}" for name in row.values])
        verdict = VERDICTS[monitors.show(number)[0]].value
        if verdict != before:
            yield now, verdict
        before = verdict
