"""What ltlc finds of a recording in each of its ways: by rows, by columns, `ltlc.monitor`, emitted code, files."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from random import Random
from typing import Any

from benchmarks.differential.reference import Property
from benchmarks.differential.samples import Look, Recording, Row, Run
from ltlc.assurance import c_library, rust_library
from ltlc.assurance.compiled_program import VERDICTS
from ltlc.assurance.library import Loaded
from ltlc.automata import Budget
from ltlc.backends.c import emit as emit_c
from ltlc.backends.python import emit as emit_python
from ltlc.backends.rust import file_of
from ltlc.backends.spelling import NotInTargetError
from ltlc.base.source import Source
from ltlc.compiler import Compiled, compile_specification
from ltlc.frontend.language import load_text
from ltlc.inputs.recordings.blocks import Block, blocks_of
from ltlc.inputs.recordings.reading import ReadOptions
from ltlc.inputs.recordings.rows import Column
from ltlc.inputs.recordings.rows import Row as Cells
from ltlc.interfaces.api.monitor import LiveRun
from ltlc.interfaces.api.prepare import Prepared
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.monitoring.judging.run import Judge
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.runtime.times import NEVER
from ltlc.runtime.tracking import Track
from ltlc.semantics.encodings import EPISODE
from ltlc.specification.expressions import Field, Signal
from ltlc.specification.specification import Specification, fields

BUDGET = Budget(20.0, 1024)

_COMPILED: Mapping[str, tuple[Callable[[], str | None], Callable[..., Any], Callable[[Any, str], Loaded]]] = {
    "C": (c_library.compiler, emit_c, c_library.Library),
    "Rust": (rust_library.compiler, file_of, rust_library.RustLibrary),
}


class UnusableError(Exception):
    """ltlc does not accept a specification, or a recording."""


@dataclass(frozen=True)
class Found:
    """What a way finds of a property: its changes of verdict with their times, None if it does not say, and the end.

    `at_steps` has the verdict after each step.
    """

    verdict: str
    changes: Sequence[tuple[int, str]] | None = None
    decided: int | None = None
    steps: int | None = None
    invalid: int | None = None
    at_steps: Sequence[str] | None = None
    shows_last: bool = False
    """Whether only the last of the changes of one time is seen."""


By = dict[str, Found]
"""What is found of each property, by its label."""


@dataclass
class Monitors:
    """A specification, compiled once for all recordings."""

    text: str
    specification: Specification
    compiled: Sequence[Compiled]

    @cached_property
    def judge(self) -> Judge:
        """What judges recordings in files."""
        return Judge(self.compiled, self.specification)

    @cached_property
    def signals(self) -> Mapping[str, Signal]:
        """The signals that come in with messages."""
        return {name: s for name, s in self.judge.signals.items() if isinstance(s.definition, Field)}

    @cached_property
    def columns(self) -> dict[str, Column]:
        """What the values of the signals are."""
        return {name: Column(s.type, s.numbers) for name, s in self.signals.items()}

    def cells(self, row: Row) -> dict[str, Any]:
        """What is read of the messages of a row."""
        return {n: v for values in row.messages.values() for n, v in values.items() if n in self.signals}

    @cached_property
    def classes(self) -> dict[str, Any]:
        """The emitted class of each property but for those that are refused, which latch values."""
        namespace: dict[str, Any] = {"__name__": "emitted"}
        kept = [c for c in self.compiled if all(i.signal.when is None for i in c.specification.inputs())]
        exec(compile(emit_python(kept, self.specification), "emitted", "exec"), namespace)
        found = [
            v for v in namespace.values() if inspect.isclass(v) and hasattr(v, "step") and v.__name__ != "Monitors"
        ]
        return {c.specification.label: of for c, of in zip(kept, found, strict=True)}

    @cached_property
    def libraries(self) -> dict[str, tuple[Loaded, Sequence[str]]]:
        """The emitted C and Rust, and of which properties; some are refused, by themselves or beside others."""
        found: dict[str, tuple[Loaded, Sequence[str]]] = {}
        for name, (compiler, emit, load) in _COMPILED.items():
            kept, path = self._emitted(emit), compiler()
            if kept and path is not None:
                found[name] = load(emit(kept, self.specification), path), [c.specification.label for c in kept]
        return found

    def _emitted(self, emit: Callable[[Sequence[Compiled], Specification], object]) -> Sequence[Compiled]:
        """The properties that `emit` takes together."""
        kept: list[Compiled] = []
        for each in self.compiled:
            try:
                emit([*kept, each], self.specification)
            except NotInTargetError:
                continue
            kept.append(each)
        return kept


def monitors(text: str) -> Monitors:
    """The monitors of a specification. Raises UnusableError."""
    specification, diagnostics = load_text(Source("props.txt", text))
    if specification is None:
        raise UnusableError("\n".join(f"{each.code} {each.message}" for each in diagnostics))
    compiled, problems = compile_specification(specification, EPISODE, BUDGET)
    if problems:
        raise UnusableError(str(problems[0].message))
    return Monitors(text, specification, compiled)


def of_track(track: Track, changes: Sequence[tuple[int, str]] | None = None) -> Found:
    """What a session knows at its end."""
    decided = None if track.decided_at is None else track.decided_at.time
    at_steps = None if track.verdicts is None else [verdict.value for verdict in track.verdicts]
    return Found(track.verdict.value, changes, decided, track.steps, track.invalid, at_steps)


def by_rows(of: Monitors, recording: Recording, _: Random) -> By:
    """The session, message by message."""
    session = Session(of.judge.plan(()), keep_verdicts=True)
    rows = ByRows(session)
    seen: dict[str, list[tuple[int, str]]] = {track.property.label: [] for track in session.tracks}

    def note(changes: Any) -> None:
        for change in changes:
            seen[change.property.label].append((change.moment.time, change.current.value))

    if not recording.rows or recording.begin < recording.rows[0].time:
        note(rows.begin(recording.begin))
    for row in recording.rows:
        cells = of.cells(row)
        note(rows.samples(row.time, tuple(cells), list(cells.values()), _heard(session, row)))
        if session.is_over:
            break
    note(rows.advance(max(recording.end, session.time or 0)))
    return {track.property.label: of_track(track, seen[track.property.label]) for track in session.tracks}


def _heard(session: Session, row: Row) -> list[str]:
    return [topic for topic in row.messages if topic in session.messages]


def by_columns(of: Monitors, recording: Recording, chance: Random) -> By:
    """The session, block by block, in parts of any size."""
    by_blocks = ByBlocks(Session(of.judge.plan(())), of.judge.prepared)
    if recording.begin < recording.rows[0].time:
        ByRows(by_blocks.session).begin(recording.begin)
    rows = [Cells(row.time, of.cells(row)) for row in recording.rows]
    ends = sorted(chance.randint(0, len(rows)) for _ in range(chance.choice([0, 0, 1, 3])))
    for a, b in zip([0, *ends], [*ends, len(rows)], strict=True):
        for block in _blocks(rows[a:b], of.columns):
            by_blocks.take(block)
    session = by_blocks.session  # only now, for slices go by rows from here on
    ByRows(session).advance(max(recording.end, session.time or 0))
    return {track.property.label: of_track(track) for track in session.tracks}


def _blocks(rows: Sequence[Cells], columns: Mapping[str, Column]) -> Iterator[Block]:
    return blocks_of(rows, columns) if rows else iter(())


def by_monitor(of: Monitors, recording: Recording, _: Random) -> By:
    """`ltlc.monitor`, a dictionary at a time."""
    live = LiveRun(Prepared(of.specification, of.compiled, (), BUDGET), of.signals)
    seen: dict[str, list[tuple[int, str]]] = {c.specification.label: [] for c in of.compiled}
    times = [(row.time, of.cells(row)) for row in recording.rows]
    if recording.begin < times[0][0]:
        times.insert(0, (recording.begin, {}))
    if recording.end > times[-1][0]:
        times.append((recording.end, {}))
    for time, cells in times:
        for change in live.step(cells, time_ns=time):
            seen[change.property.label].append((change.moment.time, change.current.value))
    final = live.finish()
    found: By = {}
    for label, result in final.items():
        last = seen[label][-1][1] if seen[label] else "not_started"
        changes = seen[label] if last == result.verdict.value else None
        decided = None if result.decided is None else result.decided.time
        found[label] = Found(result.verdict.value, changes, decided, result.steps)
    return found


def by_python(of: Monitors, recording: Recording, properties: Mapping[str, Property], runs: Mapping[str, Run]) -> By:
    """The emitted classes, of properties whose steps bring all that a class keeps by itself."""
    found: By = {}
    for label, each in properties.items():
        looks = _looks(each, runs[label])
        if looks:
            found[label] = _by_class(of.classes[label], looks, recording, each)
    return found


def _looks(of: Property, run: Run) -> list[Look]:
    """The calls of the class of a property; none if what it would have to know comes in other ways.

    It takes values of all signals at once, counts ages from its steps, and keeps a sample at each.
    """
    reads = of.reads
    names, kept = {name for name, _ in reads.keys}, {name for name, ago in reads.keys if ago}
    if reads.made or any("." in name for name in names) or (of.ages and reads.names.rate is not None):
        return []
    if any(not kept <= look.fresh for look in run.looks if kept):
        return []
    waited = {(name, 0) for unit in reads.waited for name, _ in unit}
    first = next((n for n, look in enumerate(run.looks) if look.samples.keys() >= waited), None)
    if first is None or (kept and first) or any(of.ages.keys() & look.news for look in run.looks[:first]):
        return []
    return run.looks[first:]


def _by_class(of: Any, looks: Sequence[Look], recording: Recording, property_: Property) -> Found:
    timed = "session" in inspect.signature(of.__init__).parameters
    monitor = of(recording.begin) if timed else of()
    names = [name for name in inspect.signature(of.step).parameters if name != "self"]
    signals = property_.names.signals
    changes: list[tuple[int, str]] = []

    def note(time: int) -> None:
        if monitor.verdict.value != (changes[-1][1] if changes else "not_started"):
            changes.append((time, monitor.verdict.value))

    def hold(until: int) -> None:
        while timed and until > monitor.due:
            due = monitor.due + 1
            monitor.expire()
            note(due)

    for look in looks:
        hold(look.time)
        values = {"time": look.time, **{name: value for (name, _), value in look.samples.items()}}
        values |= {f"new_{name.replace('.', '_')}": signal.topic in look.news for name, signal in signals.items()}
        monitor.step(*(values.get(name) for name in names))
        note(look.time)
    hold(recording.end)
    return Found(monitor.verdict.value, changes, invalid=monitor.invalid)


def by_compiled(of: Monitors, recording: Recording, target: str) -> By:
    """The emitted C or Rust, message by message, and all that is due in between."""
    if target not in of.libraries:
        return {}
    library, labels = of.libraries[target]
    run = library.monitors()
    known = {signal.name: signal for signal in library.numbers}
    topics = {field.topic for signal in library.numbers for _, field in fields(signal)} | {*library.heard}
    changes: dict[str, list[tuple[int, str]]] = {label: [] for label in labels}
    shown = ["not_started"] * len(labels)

    def note() -> None:
        for number, label in enumerate(labels):
            verdict, _, _, since = run.show(number)
            if (word := VERDICTS[verdict].value) != shown[number]:
                changes[label].append((since, word))
                shown[number] = word

    def advance(until: int) -> None:
        while (due := run.next_deadline()) < min(until, NEVER):
            run.advance(due)
            note()
            if run.next_deadline() == due:
                break

    first = recording.rows[0]
    if recording.begin < first.time or not topics & first.messages.keys():
        run.begin(recording.begin)
        note()
    for row in recording.rows:
        if not topics & row.messages.keys():
            continue
        advance(row.time)
        sample = {known[name]: value for name, value in of.cells(row).items() if name in known}
        run.step(row.time, sample, list(row.messages))
        note()
    advance(recording.end)
    run.advance(recording.end)
    note()
    found: By = {}
    for number, label in enumerate(labels):
        verdict, steps, invalid, _since = run.show(number)
        found[label] = Found(VERDICTS[verdict].value, changes[label], None, steps, invalid, shows_last=True)
    return found


def by_file(of: Monitors, path: Path, since: int | None, until: int | None) -> By:
    """`ltlc run` on a file."""
    return {track.property.label: of_track(track) for track in session_of_file(of, path, since, until).tracks}


def session_of_file(of: Monitors, path: Path, since: int | None, until: int | None) -> Session:
    """The session of `ltlc run` on a file. Raises UnusableError."""
    judge = replace(of.judge, reading=ReadOptions(since=since, until=until))
    vars(judge).update({name: getattr(of.judge, name) for name in ("signals", "_plans", "prepared")})
    report = judge.judge(path)
    if report.session is None or report.is_damaged:
        raise UnusableError("; ".join(f"{each.code} {each.message}" for each in report.diagnostics))
    return report.session


IN_MEMORY: Mapping[str, Callable[[Monitors, Recording, Random], By]] = {
    "rows": by_rows,
    "columns": by_columns,
    "ltlc.monitor": by_monitor,
    "C": lambda of, recording, _: by_compiled(of, recording, "C"),
    "Rust": lambda of, recording, _: by_compiled(of, recording, "Rust"),
}
