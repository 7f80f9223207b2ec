"""The summary of a campaign as one page of HTML."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from ltlc import __version__
from ltlc.monitoring.campaigns.forms import remarks
from ltlc.monitoring.campaigns.places import Found, is_address
from ltlc.monitoring.campaigns.tally import Failing, PropertyTally, Result, Tally
from ltlc.monitoring.documents import document
from ltlc.runtime.reports import value_text
from ltlc.runtime.times import SECOND, Scale, seconds_text, span_text

SIDE_BY_SIDE = 4
"""How many violations of a property are shown side by side."""

TIMELINE = 200
"""How wide a timeline is, in the units of its drawing."""

TREND = 24
"""How high the line of margins is."""


def summary_page(specification: str, tally: Tally, found: Found, english: Mapping[str, str], folder: Path) -> str:
    """The page: which properties fail where, first violations side by side, and what was never triggered.

    `english` says in words what each property means, by its label. The page links to recordings of this machine and
    to extracts of them, as seen from the `folder` that it is written to.
    """
    properties = list(tally.properties.values())
    return document(
        __package__,
        "page.html.jinja",
        link=lambda name: _link(name, folder),
        specification=specification,
        version=__version__,
        summary="; ".join([tally.sentence(), *remarks(found), *tally.guard_sentences()]),
        kinds=[kind.value for kind in Result],
        rows=[_row(each) for each in properties],
        failing=[_failures(each) for each in properties if each.failing],
        closest=[_closest(each) for each in tally.measured],
        idle=[each for each in properties if each.is_idle],
        errors=tally.errors,
        english=english,
        width=TIMELINE,
        height=TREND,
    )


def _link(name: str, folder: Path) -> str:
    """The relative address of a recording, empty if it is not on this machine."""
    return "" if is_address(name) else quote(os.fsencode(os.path.relpath(name, folder)))


def _row(of_one: PropertyTally) -> dict[str, Any]:
    cells = [(kind.name.lower(), of_one.counts[kind]) for kind in Result]
    return {"label": of_one.label, "text": of_one.text, "cells": cells}


def _closest(of_one: PropertyTally) -> dict[str, Any]:
    """The least margin of a property and its recording; and all margins, one after the other, as a line to draw."""
    least, recording = min(of_one.margins)
    return {
        "label": of_one.label,
        "text": of_one.text,
        "least": f"{least:.6g}",
        "median": f"{of_one.median:.6g}",
        "recording": recording,
        "trend": _trend([each.number for each in of_one.margins]),
    }


def _trend(margins: Sequence[float]) -> dict[str, Any] | None:
    """A line over the recordings, and at which height 0 is; None of a single one."""
    if len(margins) < 2:
        return None
    low, high = min(0.0, *margins), max(0.0, *margins)
    scale = (TREND - 4) / ((high - low) or 1.0)
    heights = [round(TREND - 2 - scale * (margin - low), 2) for margin in [0.0, *margins]]
    places = (round(TIMELINE * number / (len(margins) - 1), 2) for number in range(len(margins)))
    return {"zero": heights[0], "points": " ".join(f"{x},{y}" for x, y in zip(places, heights[1:], strict=True))}


def _failures(of_one: PropertyTally) -> dict[str, Any]:
    """Where a property is violated, and the first violations as columns of a table."""
    first = of_one.failing[:SIDE_BY_SIDE]
    return {
        "label": of_one.label,
        "text": of_one.text,
        "count": of_one.counts[Result.VIOLATED],
        "places": [
            (each.recording, _moment(each.found.report["decided_at"]), _extracts(each)) for each in of_one.failing
        ],
        "first": [each.recording for each in first],
        "extracts": [_extracts(each) for each in first],
        "timelines": [_timeline(each) for each in first],
        "lines": _side_by_side(first),
    }


def _extracts(failing: Failing) -> list[str]:
    """The files with what was recorded around the violations of the property."""
    return [str(each["file"]) for each in failing.found.report.get("extracts", ())]


def _timeline(failing: Failing) -> dict[str, Any] | None:
    """What is drawn of a recording: where the property is violated, or only where it first is if no more is known.

    None if the recording has no length.
    """
    if failing.beginning is None or failing.end is None or failing.end <= failing.beginning:
        return None
    length = failing.end - failing.beginning
    first = failing.found.report["decided_at"]
    parts = []
    for each in failing.found.report.get("violations") or [first]:
        width = max(TIMELINE * each.get("lasted_ns", 0) / length, 2)
        start = TIMELINE * (each["time_ns"] - failing.beginning) / length
        parts.append((round(min(start, TIMELINE - width), 2), round(width, 2)))
    return {"length": span_text(length), "parts": parts}


def _side_by_side(failing: list[Failing]) -> list[tuple[str, list[str]]]:
    """Lines of a table: a head, and a cell for each of the violations."""
    decided = [each.found.report["decided_at"] for each in failing]
    lines = [("violated at", [_moment(each) for each in decided])]
    if any(each["episode_opened"] for each in decided):
        lines.append(("episode opened", [_moment(each["episode_opened"]) for each in decided]))
    if any(each["open_since"] for each in decided):
        lines.append(("open since", [_moment(each["open_since"]) for each in decided]))
    names = dict.fromkeys(name for each in decided for name in each["values"])
    lines += [(name, [_value(each["values"], name) for each in decided]) for name in names]
    because = dict.fromkeys(each["condition"] for one in decided for each in one["because"])
    lines += [(condition, [_truth(one["because"], condition) for one in decided]) for condition in because]
    return lines


def _moment(moment: dict[str, Any] | None) -> str:
    if moment is None:
        return ""
    step = f"after step {moment['step']}" if moment["by_time"] else f"step {moment['step']}"
    offset = moment.get("offset")  # a table of results may be older
    time = f"{seconds_text(moment['time_ns'])} s" if offset is None else Scale(0).text(round(offset * SECOND))
    return f"{time} ({step})"


def _value(values: dict[str, Any], name: str) -> str:
    return _text(values[name]) if name in values else ""


def _text(value: Any) -> str:
    return value_text(tuple(value) if isinstance(value, list) else value)


def _truth(because: list[dict[str, Any]], condition: str) -> str:
    """Whether the condition held, and what it compared."""
    told = next((each for each in because if each["condition"] == condition), None)
    if told is None:
        return ""
    truth = "true" if told["holds"] else "false"
    return truth if told["left"] is None else f"{truth}: {_text(told['left'])}, {_text(told['right'])}"
