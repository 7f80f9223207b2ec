"""`ltlc run --report`: what recordings have shown, as one page: verdicts over the signals that the properties read."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from importlib.resources import files
from pathlib import PurePath
from typing import Any

import numpy as np

from ltlc import __version__
from ltlc.analysis.explanation import Explanation
from ltlc.backends.templates import template
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.render.table import example_lines
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.trails import Trail
from ltlc.interfaces.pages.data import Data, timeline
from ltlc.interfaces.pages.machines import machine_picture
from ltlc.interfaces.pages.maps import Course, courses, map_of
from ltlc.interfaces.pages.panels import Panel, panels
from ltlc.interfaces.pages.series import Collector, Series
from ltlc.monitoring.columns.curves import Curve
from ltlc.monitoring.judging.run import RunReport
from ltlc.monitoring.judging.violations import only_first, violation_text
from ltlc.monitoring.later import all_violations
from ltlc.runtime import reports
from ltlc.runtime.properties import stated
from ltlc.runtime.reports import counted, printable
from ltlc.runtime.session import Session
from ltlc.runtime.times import seconds_text, span_text
from ltlc.runtime.tracking import Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import Expression
from ltlc.specification.specification import Specification

MOST_SAMPLES, LEAST_SAMPLES, ALL_SAMPLES = 60_000, 1_000, 400_000
"""Of one series at most so many samples are kept; at least so many; and of all series about so many."""

MOST_CARDS = 200
"""So many properties are drawn, over all recordings; after that, only the violated ones, up to twice as many."""

MOST_CHANGES, MOST_MARKS = 200, 20_000
"""Of the changes of one verdict, the first so many are listed; so many, and episodes and deadlines, are drawn."""


_SCRIPTS = ("numbers.js", "lanes.js", "signals.js", "timeline.js", "page.js", "theme.js")
"""The script of the page, in this order."""


@dataclass(frozen=True, slots=True)
class _Run:
    """A run that began, and what there is to know of it."""

    id: str
    report: RunReport
    session: Session
    began: Nanoseconds
    ended: Nanoseconds
    collected: Collector


class PageReport:
    """A page about the runs of `compiled`, so many as there are `recordings`; runs are added as they come."""

    def __init__(self, compiled: Sequence[Compiled], specification: Specification, recordings: int = 1) -> None:
        self._compiled = compiled
        self._specification = specification
        self._panels = [panels(each.specification, specification.source) for each in compiled]
        self._courses = [courses(each.specification) for each in compiled]
        self._wanted = _wanted(self._panels, self._courses)
        share = ALL_SAMPLES // max(1, recordings * len(self._wanted))
        self._most = max(LEAST_SAMPLES, min(MOST_SAMPLES, share))
        self._data = Data()
        self._recordings: list[dict[str, Any]] = []
        self._cards = self._figures = 0
        self._explanations: Sequence[Explanation] = ()

    def explain(self, explanations: Sequence[Explanation]) -> None:
        """Explain the properties with these; to be called before any run is added."""
        self._explanations = explanations

    def collector(self) -> Collector:
        """What takes the blocks of the next recording."""
        return Collector(self._wanted, self._most)

    def add(self, report: RunReport, collected: Collector) -> None:
        """Add a run, whose report has trails, with what was collected from it."""
        id_ = f"recording-{len(self._recordings)}"
        session = report.session
        shown: dict[str, Any] = {"facts": "No part of it could be judged.", "cells": [], "cards": [], "left_out": ""}
        remarks = [_remark(each) for each in report.diagnostics]
        if session is not None and session.began is not None and session.time is not None:
            shown = self._judged(_Run(id_, report, session, session.began, session.time, collected))
            guarded = (
                [] if report.guard is None else report.guard.text(session, with_all=False, whole=True).splitlines()
            )
            said = [*reports.unseen(session), *(printable(line.strip()) for line in guarded)]
            remarks += [{"severity": "note", "code": "", "message": s, "help": ""} for s in said]
        self._recordings.append({"id": id_, "name": printable(report.recording), "remarks": remarks, **shown})

    def _judged(self, run: _Run) -> dict[str, Any]:
        """What is shown of a run that began."""
        cells, cards = [], []
        for place, track in enumerate(run.session.tracks):
            link = run.id
            if self._cards < (2 * MOST_CARDS if track.verdict is Verdict.VIOLATED else MOST_CARDS):
                self._cards += 1
                link = f"{run.id}-property-{place}"
                cards.append(self._card(run, place, link))
            decided = track.decided_at
            at = "" if decided is None else run.session.scale.text(decided.time)
            cells.append({**_said(run.session, track), "link": link, "at": at})
        missing = len(cells) - len(cards)
        left_out = f"{missing} of its {len(cells)} properties are not drawn, to keep the page small." if missing else ""
        return {"facts": _facts(run), "cells": cells, "cards": cards, "left_out": left_out}

    def html(self, *, is_framed: bool = False) -> str:
        """The page; if it `is_framed`, for the `srcdoc` of an `iframe`: links stay in it, and it reports its height."""
        here = files(__package__)
        cells = [cell for recording in self._recordings for cell in recording["cells"]]
        counts = Counter(cell["verdict"] for cell in cells)
        name = printable(PurePath(self._specification.source.name).name)
        count = len(self._recordings)
        scripts = (*_SCRIPTS, "frame.js") if is_framed else _SCRIPTS
        about = PurePath(self._recordings[0]["name"]).name if count == 1 else f"{count} recordings"
        return template(__package__, "template.html.jinja", escape=True).render(
            version=__version__,
            is_framed=is_framed,
            title=f"{name} on {about}",
            facts=", ".join([counted(len(self._compiled), "property", "properties"), counted(count, "recording")]),
            labels=[printable(each.specification.label) for each in self._compiled],
            counts=[(verdict.value, counts[verdict.value]) for verdict in _WORST_FIRST if counts[verdict.value]],
            recordings=self._recordings,
            data=self._data.as_json(),
            style=(here / "page.css").read_text(encoding="utf-8"),
            script="\n".join((here / name).read_text(encoding="utf-8") for name in scripts),
        )

    def _card(self, run: _Run, place: int, link: str) -> dict[str, Any]:
        """What is shown of one property in one recording."""
        track, trail = run.session.tracks[place], run.report.trails[place]
        compiled, drawn = self._compiled[place], self._panels[place]
        is_violated = track.verdict is Verdict.VIOLATED
        self._figures += is_violated
        marks, series, violations = _first_marks(trail), run.collected.series, all_violations(track) or []
        robustness = self._robustness(run.report.robustness.get(track.property.label))
        self._data.timelines.append(timeline(self._data, run.session, marks, violations, drawn, series, robustness))
        scale = run.session.scale
        listed = [violation_text(scale, each, run.ended) for each in violations]
        told = [{"text": reports.moment_text(c.moment, scale), "verdict": c.current.value} for c in trail.changes]
        return {
            **_said(run.session, track),
            "id": link,
            "text": printable(track.property.text),
            "english": self._english(place),
            "requirement": [(name, printable(value)) for name, value in stated(track.property.requirement)],
            "timeline": len(self._data.timelines) - 1,
            "described": _described(track, trail, drawn),
            "notes": [*_notes(drawn, run.collected), *_left_out(trail), *filter(None, [only_first(track)])],
            "maps": [map_of(course, series, scale, track) for course in self._courses[place]],
            "figure": reports.figure(run.session, track) if is_violated else "",
            "figure_number": self._figures,
            "machine": machine_picture(compiled, trail, scale, link),
            "machine_described": machine_described(compiled, trail),
            "is_open": is_violated,
            "violations": listed,
            "examples": self._examples(place),
            "changes": told[:MOST_CHANGES],
            "changes_left_out": len(told[MOST_CHANGES:]),
        }

    def _robustness(self, curve: Curve | None) -> Series | None:
        """What is drawn of a curve, if it has numbers."""
        if curve is None or not np.isfinite(curve.margins).any():
            return None
        series = Series(self._most, [0.0])
        series.add(curve.times, curve.margins)
        return series

    def _english(self, place: int) -> str:
        return printable(self._explanations[place].english) if self._explanations else ""

    def _examples(self, place: int) -> list[str]:
        found = self._explanations[place].examples if self._explanations else ()
        return ["\n".join(map(printable, example_lines(example.as_json()))) for example in found]


_WORST_FIRST = (
    Verdict.VIOLATED,
    Verdict.PRESUMABLY_VIOLATED,
    Verdict.NOT_STARTED,
    Verdict.PRESUMABLY_SATISFIED,
    Verdict.SATISFIED,
)


def _wanted(drawn: Sequence[Sequence[Panel]], mapped: Sequence[Sequence[Course]]) -> dict[Expression, set[float]]:
    """All that is drawn, with the levels at which something changes, zones aside."""
    wanted: dict[Expression, set[float]] = {}
    for panel in (panel for of_one in drawn for panel in of_one):
        for expression in panel.drawn:
            levels = wanted.setdefault(expression, set())
            if expression == panel.expression:
                levels |= {limit.value + sign * limit.reach for limit in panel.limits for sign in (-1, 0, 1)}
    for course in (course for of_one in mapped for course in of_one):
        for coordinate in (course.x, course.y):
            wanted.setdefault(coordinate, set())
    return wanted


def _remark(each: Diagnostic) -> dict[str, str]:
    texts = {"message": printable(each.message), "help": printable(each.help or "")}
    return {"severity": each.severity.value, "code": each.code, **texts}


def _said(session: Session, track: Track) -> dict[str, str]:
    sentence = reports.sentence(session, track)
    remarks = "; ".join(reports.explanation(session, track))
    decided = track.decided_at
    at = "" if decided is None else f"{track.verdict.value} at {reports.moment_text(decided, session.scale)}; "
    label = printable(track.property.label)
    return {"label": label, "verdict": track.verdict.value, "sentence": sentence, "remarks": f"{at}{remarks}"}


def _facts(run: _Run) -> str:
    began, ended, scale = run.began, run.ended, run.session.scale
    span = f"From {scale.text(began)} to {scale.text(ended)} ({span_text(ended - began)})"
    if scale.zero is not None:
        span += f"; +0 s is {seconds_text(scale.zero)} s"
    rate = "" if run.session.plan.rate is None else f", sampled {run.session.plan.rate:g} times a second"
    damage = "; it is damaged, and was judged up to there" if run.report.is_damaged else ""
    return f"{span}, {counted(run.session.steps, 'step')}{rate}{damage}."


def _described(track: Track, trail: Trail, drawn: Sequence[Panel]) -> str:
    """The timeline in words, for those who cannot see it."""
    shown = ", ".join(printable(panel.title) for panel in drawn)
    parts = [f"Timeline of {printable(track.property.label)}: {counted(len(trail.changes), 'change')} of verdict"]
    if track.property.scopes:
        parts.append(counted(len(trail.spans), "episode"))
    return f"{', '.join(parts)}, over {shown}. The changes are listed below."


def machine_described(compiled: Compiled, trail: Trail) -> str:
    """The picture of a monitor in words, for those who cannot see it."""
    states = counted(len(compiled.machine.states), "state")
    edges = counted(len(trail.edges), "edge")
    return f"The monitor has {states}; this run took {edges} and ended in state {trail.state}."


def _notes(drawn: Sequence[Panel], collected: Collector) -> Iterator[str]:
    """What of the signals is not as it was recorded."""
    for panel in drawn:
        for expression in dict.fromkeys(panel.drawn):
            series = collected.series[expression]
            if not series.count:
                yield f"{printable(panel.title)}: no value was recorded."
            elif series.bucket > 1:
                samples = f"{series.count:,} samples. Of every {series.bucket:,} consecutive ones"
                kept = "the first, the least, the greatest and the last, and those where a limit is crossed"
                yield f"{printable(panel.title)}: {samples} the page has {kept}."
        yield from map(printable, panel.remarks)


def _first_marks(trail: Trail) -> Trail:
    """As much of a trail as is drawn."""
    return Trail(trail.changes[:MOST_MARKS], trail.spans[:MOST_MARKS], trail.deadlines[:MOST_MARKS])


def _left_out(trail: Trail) -> Iterator[str]:
    counts = (len(trail.changes), len(trail.spans), len(trail.deadlines))
    for count, what in zip(counts, ("changes of verdict", "episodes", "deadlines"), strict=True):
        if count > MOST_MARKS:
            yield f"The first {MOST_MARKS:,} of {count:,} {what} are drawn."
