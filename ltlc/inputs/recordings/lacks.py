"""What a specification reads and a recording lacks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.nearest import did_you_mean
from ltlc.base.source import Source
from ltlc.inputs.recordings import Recording, RecordingError, open_recording
from ltlc.inputs.recordings.reading import ReadOptions
from ltlc.specification.arrivals import waited_for
from ltlc.specification.expressions import Field, Signal
from ltlc.specification.specification import PropertySpecification, Specification, fields

GUARDED = "`--guard` judges what the guards of the file would have let through of recorded commands"


def signals_of(properties: Iterable[PropertySpecification]) -> dict[str, Signal]:
    """What `properties` read, and what that is computed from."""
    wanted = (signal for each in properties for signal in each.signals())
    return {part.name: part for signal in wanted for part in _with_parts(signal)}


def _with_parts(signal: Signal) -> Iterator[Signal]:
    """`signal` and all that it is computed from."""
    yield signal
    for part in signal.inputs:
        yield from _with_parts(part.signal)


def lacks(specification: Specification | None, path: Path, reading: ReadOptions) -> list[Diagnostic]:
    """What of a specification the recording at `path` does not give, or why it cannot be read."""
    properties = specification.properties if specification else ()
    try:
        recording = open_recording(path, signals_of(properties), reading)
    except RecordingError as error:
        return [error.diagnostic]
    if specification is None:
        return []
    return [*remarks(properties, specification, path, recording), *recording.remarks()]


def remarks(
    properties: Sequence[PropertySpecification],
    specification: Specification,
    path: Path,
    recording: Recording,
    *,
    is_guarded: bool = False,
) -> Iterator[Diagnostic]:
    """Columns of the recording at `path` that none of `properties` reads, and signals that nothing in it gives.

    Unless it `is_guarded`, those that guards send are found by guards only.
    """
    columns, signals = set(recording.columns), signals_of(properties)
    asked = {} if is_guarded else {each.out: each for each in specification.guards}
    used = {name for each in properties for signal in each.signals() for name in _used(signal, columns)}
    for name in recording.columns:
        if name not in used:
            reason = ": the signal it is a part of has a column of its own" if name in signals else ""
            message = f"no property reads the column `{name}`{reason}"
            is_asked = any(name == signal.name for guard in asked.values() for signal in guard.asked)
            help = GUARDED if is_asked else "" if reason else did_you_mean(name, signals)
            yield diagnostic("LTL805", Source(str(path), ""), None, message, help=help)
    for each in properties:
        missing = _missing(each, columns)
        # Of a topic that is missing, the same is said of every signal.
        found = (_missing_column(each, specification, n, signals[n], recording) for n in missing)
        sent = [any(of.topic in asked for _, of in fields(signals[n])) for n in missing]
        yield from dict.fromkeys(
            replace(told, help=GUARDED) if is_sent else told for told, is_sent in zip(found, sent, strict=True)
        )


def _missing(specification: PropertySpecification, columns: set[str]) -> list[str]:
    """The signals of a property that the recording neither gives nor gives all parts of; of the same parts, one."""
    found: dict[frozenset[str], str] = {}
    for signal in specification.signals():
        if not _given(signal, columns):
            parts = frozenset(part.name for part, _ in fields(signal) if part.name not in columns)
            if parts not in found or isinstance(signal.definition, Field):
                found[parts] = signal.name
    return list(found.values())


def _used(signal: Signal, columns: set[str]) -> Iterator[str]:
    """The columns that `signal` is read or computed from."""
    if signal.name in columns:
        yield signal.name
    else:
        for part in signal.inputs:
            yield from _used(part.signal, columns)


def _given(signal: Signal, columns: set[str]) -> bool:
    if signal.name in columns:
        return True
    if isinstance(signal.definition, Field):
        return False
    return all(_given(part.signal, columns) for part in signal.inputs)


def _missing_column(
    property_: PropertySpecification, specification: Specification, name: str, signal: Signal, recording: Recording
) -> Diagnostic:
    read_otherwise = {i.signal.name for i in property_.inputs()} - {i.signal.name for i in waited_for(property_)}
    is_waited_for = name not in read_otherwise
    consequence = f"`{property_.label}` cannot start" if is_waited_for else f"`{property_.label}` treats it as silent"
    message = f"{recording.absence(name)}, so {consequence}"
    parts = [part.name for part, _ in fields(signal) if part.name != name]
    help = recording.remedy(name)
    if parts and not help:
        help = f"add `{name}`, or its parts: {', '.join(f'`{part}`' for part in dict.fromkeys(parts))}"
    return diagnostic("LTL806", specification.source, property_.span, message, label="reads it", help=help)
