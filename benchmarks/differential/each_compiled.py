"""What emitted C and Rust find of a property of each id or of each message."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from benchmarks.differential import targets
from benchmarks.differential.reference import Judged
from benchmarks.differential.samples import Recording
from benchmarks.differential.targets import Found, Monitors
from ltlc.assurance.c_table import Table
from ltlc.assurance.compiled_program import VERDICTS
from ltlc.assurance.library import Loaded
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.specification import Slicing, topics

LIMIT = 255


def load(text: str) -> Mapping[str, Loaded]:
    """The table of the only property of `text`, which has no limit, in each language that has it, and a compiler."""
    head, _, property_ = text.rpartition("p: each ")
    of, _, body = property_.partition(": ")
    limited = targets.monitors(f"{head}p: each {of} limit {LIMIT}: {body}")
    return {name: library for name, (library, _) in limited.libraries.items()}


def found_by(
    library: Loaded, of: Monitors, recording: Recording, expected: Mapping[Any, Judged]
) -> dict[Any, Found] | None:
    """What is found of each id, or of all messages; None where a row has messages with and without an id at once."""
    slicing = of.compiled[0].specification.slicing
    monitors = Table(library) if isinstance(slicing, Slicing) else library.monitors()
    known, read = {signal.name: signal for signal in library.numbers}, topics(of.compiled[0].specification)
    if not set(read).intersection(recording.rows[0].messages) and not isinstance(monitors, Table):
        monitors.begin(recording.rows[0].time)
    for row in recording.rows:
        sample = {known[name]: value for name, value in of.cells(row).items() if name in known}
        heard = [topic for topic in row.messages if topic in read]
        if not isinstance(monitors, Table) or "/part" not in row.messages:
            assert not heard or monitors.step(row.time, sample, heard)
        elif set(heard) - {"/part"}:
            return None
        else:
            assert monitors.step_of(row.time, row.messages["/part"]["key"], sample, "/part")
    monitors.advance(recording.end)
    if isinstance(monitors, Table):
        return {id_: _shown(monitors.show_of(id_), wanted.verdict) for id_, wanted in expected.items()}
    verdict, since = VERDICTS[monitors.show(0)[0]], monitors.show(2)[3]
    return {None: Found(verdict.value, None, since if verdict is Verdict.VIOLATED else None)}


def _shown(of: tuple[Verdict, int] | None, expected: str) -> Found:
    """What is found of an id; one that is not kept is as new, and nothing is known of it when a NaN comes."""
    if of is None or (of[0] is Verdict.NOT_STARTED and expected == Verdict.PRESUMABLY_SATISFIED.value):
        return Found(Verdict.PRESUMABLY_SATISFIED.value)
    return Found(of[0].value, None, of[1] if of[0].is_permanent else None)
