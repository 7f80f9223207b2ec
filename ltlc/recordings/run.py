"""`ltlc run`: a recorded run, judged by the monitors that a node would have."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ltlc.backends.python.load import load_plan
from ltlc.codes import diagnostic
from ltlc.compiler import Compiled
from ltlc.diagnostics import Diagnostic
from ltlc.nearest import did_you_mean
from ltlc.recordings import Column, Recording, RecordingError, open_recording
from ltlc.recordings.rows import Row, failure
from ltlc.runtime import reports
from ltlc.runtime.session import Session
from ltlc.runtime.times import seconds, seconds_text
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict
from ltlc.source import Source
from ltlc.specification.expressions import Current, Field, Signal, inputs
from ltlc.specification.signs import never_negative
from ltlc.specification.specification import PropertySpecification, Specification, fields


@dataclass(frozen=True)
class RunReport:
    """What a recording has shown: the state of the session at its end, or None if the recording cannot be used."""

    recording: str
    session: Session | None
    diagnostics: tuple[Diagnostic, ...]

    @property
    def exit_code(self) -> int:
        """0 all hold; 1 one is violated; 2 unusable; 3 none violated, but one is owed or never started."""
        if self.session is None:
            return 2
        return reports.exit_code([track.verdict for track in self.session.tracks])

    def text(self) -> str:
        """The errors, each with its failing state, and a line for each property."""
        if self.session is None:
            return ""
        figures = [reports.figure(t) for t in self.session.tracks if t.verdict is Verdict.VIOLATED]
        return "".join(f"{figure}\n" for figure in figures) + reports.summary(self.session)

    def json(self) -> str:
        """The JSON document of `ltlc run`; one with `properties` null if the recording cannot be used."""
        document: dict[str, object] = {"recording": self.recording, "steps": 0, "properties": None}
        if self.session is not None:
            document = reports.document(self.recording, self.session)
        document["diagnostics"] = [
            {"code": d.code, "name": d.name, "severity": d.severity.value, "message": d.message, "help": d.help}
            for d in self.diagnostics
        ]
        return json.dumps(document, indent=2, allow_nan=False) + "\n"

    def junit(self) -> str:
        """A JUnit XML report."""
        return "" if self.session is None else reports.junit(self.recording, self.session)


def run(
    compiled: Sequence[Compiled],
    specification: Specification,
    path: Path,
    keep_verdicts: bool = False,
    until: Nanoseconds | None = None,
) -> RunReport:
    """Judge the recording at `path`, up to its last row or to the time `until`.

    With `keep_verdicts` the report has the verdict after each step.
    """
    signals = {s.name: s for c in compiled for i in c.specification.inputs() for s in _with_parts(i.signal)}
    try:
        recording = open_recording(path, {name: Column(s.type, s.numbers) for name, s in signals.items()})
        remarks = tuple(_remarks(compiled, specification, path, recording, signals))
        session = _judged(compiled, specification, path, recording, signals, keep_verdicts, until)
    except RecordingError as error:
        return RunReport(str(path), None, (error.diagnostic,))
    return RunReport(str(path), session, remarks)


def _judged(
    compiled: Sequence[Compiled],
    specification: Specification,
    path: Path,
    recording: Recording,
    signals: Mapping[str, Signal],
    keep_verdicts: bool,
    until: Nanoseconds | None,
) -> Session:
    """The session at the end of the recording."""
    columns = set(recording.columns)
    read = {name for name, signal in signals.items() if name in columns or isinstance(signal.definition, Field)}
    session = Session(load_plan(compiled, specification, read), keep_verdicts)
    wanted = set().union(*(session.fields(topic) for topic in session.messages))
    computed = {name for name in wanted & columns if not isinstance(signals[name].definition, Field)}
    unsigned = {name for name in computed if never_negative(Current(signals[name]))}
    lists = _side_by_side([signals[name] for name in wanted & columns])
    first: Nanoseconds | None = None
    for row in _rows(recording, path, until):
        first = row.time if first is None else first
        if keep_verdicts:
            _check_steps(session, row.time - first, path)
        _check_signs(row, unsigned, path)
        _check_lengths(row, lists, path)
        names = tuple(name for name in row.values if name in wanted)
        session.samples(row.time, names, [row.values[name] for name in names])
        if session.is_over:
            return session
    end = session.time if until is None else until
    if end is not None:
        session.advance(end)
    return session


def _rows(recording: Recording, path: Path, until: Nanoseconds | None) -> Iterator[Row]:
    """The rows up to and including `until`. Raises RecordingError if there are others, but none of these."""
    for number, row in enumerate(recording.rows()):
        if until is not None and row.time > until:
            if number == 0:
                message = f"the recording begins at {seconds_text(row.time)} s, after the time of `--until`"
                raise failure("LTL804", path, message, "give a time of the recording's clock")
            return
        yield row


MOST_VERDICTS = 10_000_000
"""Verdicts of single steps that are kept: a gigabyte of them."""


def _check_steps(session: Session, time: Nanoseconds, path: Path) -> None:
    """Raise RecordingError if a run so long has more steps than can be listed."""
    rate, timeout = session.plan.rate or 0, session.plan.timeout
    verdicts = seconds(min(time, timeout or time)) * rate * len(session.tracks)
    if verdicts > MOST_VERDICTS:
        message = f"a run at this `_rate_` has more than {MOST_VERDICTS} verdicts, too many to list"
        raise failure("LTL804", path, message, "leave out --verdicts, or look whether all times are of one clock")


def _check_signs(row: Row, unsigned: set[str], path: Path) -> None:
    """Raise RecordingError for a negative distance or speed: monitors are made for letters that exist."""
    for name in unsigned & row.values.keys():
        if row.values[name] < 0:
            what = f"`{name}` is {row.values[name]!r}, but what it measures is never negative"
            message = f"at {seconds_text(row.time)} s {what}"
            help = "for a speed with a sign, record and write a component, such as `.velocity.x`"
            raise failure("LTL803", path, message, help)


def _side_by_side(signals: Iterable[Signal]) -> list[list[str]]:
    """The names of those arrays that are fields of the messages of one array."""
    by_list: dict[Field, list[str]] = {}
    for signal in signals:
        if isinstance(signal.definition, Field) and signal.type.element is not None:
            by_list.setdefault(signal.definition.list, []).append(signal.name)
    return [sorted(names) for names in by_list.values()]


def _check_lengths(row: Row, lists: Sequence[Sequence[str]], path: Path) -> None:
    """Raise RecordingError for fields of the messages of one array that have not as many elements each."""
    for names in lists:
        lengths = {name: len(row.values[name]) for name in names if name in row.values}
        if lengths and (len(lengths) < len(names) or len(set(lengths.values())) > 1):
            told = [f"`{name}` has {lengths.get(name, 'no sample')}" for name in names]
            message = f"at {seconds_text(row.time)} s {', '.join(told)}: they are fields of the messages of one array"
            raise failure("LTL803", path, message, "give each as many elements, or none of them a sample")


def _with_parts(signal: Signal) -> Iterator[Signal]:
    """`signal` and all that it is computed from."""
    yield signal
    if not isinstance(signal.definition, Field):
        for part in inputs(signal.definition):
            yield from _with_parts(part.signal)


def _remarks(
    compiled: Sequence[Compiled],
    specification: Specification,
    path: Path,
    recording: Recording,
    signals: Mapping[str, Signal],
) -> Iterator[Diagnostic]:
    """Columns that nothing reads, and signals that nothing gives."""
    columns = set(recording.columns)
    used = {name for c in compiled for i in c.specification.inputs() for name in _used(i.signal, columns)}
    for name in recording.columns:
        if name not in used:
            reason = ": what it is a part of has a column itself" if name in signals else ""
            message = f"no property reads the column `{name}`{reason}"
            help = "" if reason else did_you_mean(name, signals)
            yield diagnostic("LTL805", Source(str(path), ""), None, message, help=help)
    for c in compiled:
        for name in _missing(c.specification, columns):
            yield _missing_column(c.specification, specification, name, signals[name], recording)


def _missing(specification: PropertySpecification, columns: set[str]) -> list[str]:
    """The signals of a property that the recording neither gives nor gives all parts of."""
    return list(dict.fromkeys(i.signal.name for i in specification.inputs() if not _given(i.signal, columns)))


def _used(signal: Signal, columns: set[str]) -> Iterator[str]:
    """The columns that `signal` is read or computed from."""
    if signal.name in columns:
        yield signal.name
    elif not isinstance(signal.definition, Field):
        for part in inputs(signal.definition):
            yield from _used(part.signal, columns)


def _given(signal: Signal, columns: set[str]) -> bool:
    if signal.name in columns:
        return True
    if isinstance(signal.definition, Field):
        return False
    return all(_given(part.signal, columns) for part in inputs(signal.definition))


def _missing_column(
    property_: PropertySpecification, specification: Specification, name: str, signal: Signal, recording: Recording
) -> Diagnostic:
    message = f"the recording has no column `{name}`, so `{property_.label}` cannot start"
    parts = [part.name for part, _ in fields(signal) if part.name != name]
    help = did_you_mean(name, recording.columns)
    if parts and not help:
        help = f"give `{name}`, or what it is computed from: {', '.join(f'`{part}`' for part in dict.fromkeys(parts))}"
    return diagnostic("LTL806", specification.source, property_.span, message, label="reads it", help=help)
