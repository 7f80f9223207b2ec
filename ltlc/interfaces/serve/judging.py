"""A run that is edited on the page, judged as `ltlc run` judges a recording, and the way that it took in a monitor."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ltlc.base.errors import UnusableInput
from ltlc.base.limits import Budget
from ltlc.base.render.json import documents
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.given import GivenTable
from ltlc.inputs.recordings.reading import ReadOptions
from ltlc.inputs.recordings.signals import FromTable
from ltlc.inputs.recordings.trails import Trail
from ltlc.interfaces.api.prepare import Prepared, prepare
from ltlc.interfaces.pages.machines import machine_picture
from ltlc.interfaces.pages.maps import courses, map_of
from ltlc.interfaces.pages.report import MOST_SAMPLES, machine_described
from ltlc.interfaces.pages.series import Collector
from ltlc.interfaces.serve.questions import Question
from ltlc.monitoring.judging.run import Judge, RunReport
from ltlc.runtime import reports
from ltlc.runtime.properties import Change
from ltlc.runtime.session import Session
from ltlc.runtime.times import Scale
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Signal
from ltlc.specification.specification import PropertySpecification

OF_A_TRANSLATION = Budget(8, 512)
"""What the translation of one property may use."""

RUN = Path("run")
"""What a run is called that is in no file."""

Row = Mapping[str, Any]
"""The samples of a step by signal, and its `time` in s."""


@dataclass(frozen=True, slots=True)
class _Judged:
    """What a run has shown, when the rows were that could be judged, and what was collected from them for maps."""

    report: RunReport
    times: tuple[Nanoseconds, ...]
    collected: Collector


def judge(question: Question) -> dict[str, Any]:
    """What the run shows of each property, step by step, and the monitor of one with the way up to some step."""
    source = question.specification.source
    try:
        prepared = prepare(source, question.message_paths, question.encoding, OF_A_TRANSLATION)
    except UnusableInput as error:
        return {"diagnostics": documents(error.diagnostics), "properties": None, "picture": None, "maps": []}
    rows = question.steps
    chosen = prepared.compiled[question.number].specification
    whole = _judged(prepared, rows, chosen)
    near = whole if question.at >= len(rows) - 1 else _judged(prepared, rows[: question.at + 1], chosen)
    return {
        "diagnostics": documents(whole.report.diagnostics),
        "properties": _properties(whole, len(rows)),
        "picture": _picture(prepared, near.report, question.number),
        "maps": _maps(near, chosen, question.number),
    }


def _judged(prepared: Prepared, rows: Sequence[Row], mapped: PropertySpecification) -> _Judged:
    def opened(path: Path, signals: Mapping[str, Signal], _: ReadOptions) -> FromTable:
        return FromTable(path, GivenTable(path, rows), signals)

    times: list[Nanoseconds] = []
    judging = Judge(prepared.compiled, prepared.specification, keep_trails=True, open=opened, remarks=prepared.late)
    coordinates = {side: () for course in courses(mapped) for side in (course.x, course.y)}
    collector = Collector(coordinates, MOST_SAMPLES)
    report = judging.judge(RUN, [lambda block: times.extend(block.times.tolist()), collector.take])
    return _Judged(report, tuple(times), collector)


def _properties(judged: _Judged, count: int) -> list[dict[str, Any]] | None:
    """The properties with the verdict of each after each of `count` rows; None if nothing could be judged."""
    session, unjudged = judged.report.session, [None] * (count - len(judged.times))
    if session is None:
        return None
    return [
        {
            "label": reports.printable(track.property.label),
            "verdict": track.verdict.value,
            "told": reports.sentence(session, track),
            "figure": reports.figure(session, track) if track.verdict is Verdict.VIOLATED else "",
            "rows": [*_verdicts(trail, judged.times), *unjudged],
            "changes": [_change(session, change) for change in trail.changes],
        }
        for track, trail in zip(session.tracks, judged.report.trails, strict=True)
    ]


def _verdicts(trail: Trail, times: Sequence[Nanoseconds]) -> list[str]:
    """The verdict at each of `times`, after all that comes at that time."""
    changed = [change.moment.time for change in trail.changes]
    verdicts = [Verdict.NOT_STARTED, *(change.current for change in trail.changes)]
    return [verdicts[bisect_right(changed, time)].value for time in times]


def _change(session: Session, change: Change) -> dict[str, Any]:
    text = reports.moment_text(change.moment, session.scale)
    return {"time_ns": change.moment.time, "verdict": change.current.value, "text": text}


def _picture(prepared: Prepared, report: RunReport, number: int) -> dict[str, Any]:
    """The monitor of a property with the way that the run took; without a way if nothing could be judged."""
    compiled, trail = prepared.compiled[number], Trail()
    scale = Scale()
    if report.session is not None and report.session.began is not None:
        trail, scale = report.trails[number], report.session.scale
    drawn = machine_picture(compiled, trail, scale, "monitor")
    return {
        "svg": drawn.svg,
        "letters": list(drawn.letters),
        "remark": drawn.remark,
        "described": machine_described(compiled, trail),
    }


def _maps(judged: _Judged, property_: PropertySpecification, number: int) -> list[dict[str, Any]]:
    """The zones of a property, and the path among them; none if nothing could be judged."""
    session = judged.report.session
    if session is None or session.began is None:
        return []
    track, series = session.tracks[number], judged.collected.series
    return [asdict(map_of(course, series, session.scale, track)) for course in courses(property_)]
