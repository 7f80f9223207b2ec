"""A comparison as one JSON document, and as rows of a table for a spreadsheet or a data frame."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from ltlc.analysis.comparison.reference import shown
from ltlc.analysis.comparison.results import (
    Answer,
    Comparison,
    Measured,
    Monitored,
    OtherBounds,
    Question,
    Recorded,
    Related,
    SeparatingRun,
    Values,
)
from ltlc.automata.queries import Size
from ltlc.base.limits import Exceeded
from ltlc.base.render.json import plain
from ltlc.runtime.documents import json_value
from ltlc.semantics.instants import Instant
from ltlc.semantics.words import Letter, Word


def document(answers: Sequence[Answer], recordings: Sequence[Sequence[Recorded]] = ()) -> dict[str, Any]:
    """The JSON document of `ltlc compare`; `recordings` has what each recording shows of each answer.

    What is unknown because of a limit is null, and `limits` beside it says why.
    """
    return {
        "properties": [
            _answer(answer, [recording[number] for recording in recordings]) for number, answer in enumerate(answers)
        ]
    }


def _answer(answer: Answer, recordings: Sequence[Recorded]) -> dict[str, Any]:
    question = answer.question
    found = {
        "label": question.label,
        "line": question.line,
        "text": question.text,
        "encodings": [_measured(question, measured) for measured in answer.measured],
        "undefined": [{"name": name, "reason": reason} for name, reason in question.undefined.items()],
        "comparisons": [_comparison(question, comparison) for comparison in answer.comparisons],
    }
    if recordings:
        found["recordings"] = [_recorded(recorded) for recorded in recordings]
    return found


def _measured(question: Question, measured: Measured) -> dict[str, Any]:
    kind = measured.temporal_class
    parts = {"class": kind, "deterministic": measured.deterministic, "nondeterministic": measured.nondeterministic}
    limits = {name: str(part) for name, part in parts.items() if isinstance(part, Exceeded)}
    found = {
        "name": measured.name,
        "formula": str(measured.formula),
        "size": measured.size,
        "class": None if isinstance(kind, Exceeded) else kind.value,
        **_monitored(question, measured.monitored),
        "spot_deterministic": _size(measured.deterministic),
        "spot_nondeterministic": _size(measured.nondeterministic),
    }
    if isinstance(measured.monitored, Exceeded):
        limits["monitor"] = str(measured.monitored)
    return found | ({"limits": limits} if limits else {})


def _monitored(question: Question, monitored: Monitored | Exceeded) -> dict[str, Any]:
    names = ("states", "edges", "seconds", "monitorable", "earliest_violation")
    if isinstance(monitored, Exceeded):
        return dict.fromkeys(names)
    run = monitored.earliest_violation
    values = (
        len(monitored.monitor.verdicts),
        monitored.edges,
        monitored.seconds,
        monitored.monitorability.value,
        None if run is None else {"steps": _steps(question, run, None), "loop": None},
    )
    return dict(zip(names, values, strict=True))


def _size(size: Size | Exceeded) -> dict[str, int] | None:
    return None if isinstance(size, Exceeded) else {"states": size.states, "edges": size.edges}


def _comparison(question: Question, comparison: Comparison) -> dict[str, Any]:
    found: dict[str, Any] = {"left": comparison.left, "right": comparison.right}
    for kind, related in comparison.related.items():
        found[kind.value] = _related(question, related)
    return found


def _related(question: Question, related: Related | Exceeded) -> dict[str, Any]:
    if isinstance(related, Exceeded):
        return {"relation": None, "left_only": None, "right_only": None, "limits": {"relation": related.reason}}
    confirmed = related.confirmation
    return {
        "relation": related.relation.value,
        "left_only": _run(question, related.left_only),
        "right_only": _run(question, related.right_only),
        "confirmed": {"length": confirmed.length, "runs": confirmed.runs, "all_letters": confirmed.all_letters},
    }


def _run(question: Question, run: SeparatingRun | None) -> dict[str, Any] | None:
    if run is None:
        return None
    steps = _steps(question, run.letters, run.loop)
    for step, left, right in zip(steps, run.left_verdicts, run.right_verdicts, strict=True):
        step["left"], step["right"] = left.value, right.value
    return {"steps": steps, "loop": run.loop, "shortest": run.is_shortest}


def _steps(question: Question, letters: Word, loop: int | None) -> list[dict[str, Any]]:
    """For each step the atoms that hold, in their order, values of the signals if some are known, and its time."""
    values: Sequence[Values | None] = question.values(letters, loop) or [None] * len(letters)
    return [
        {"atoms": [atom for atom in question.atoms if atom in letter], "values": plain(step), **_time(letter)}
        for letter, step in zip(letters, values, strict=True)
    ]


def _time(letter: Letter) -> dict[str, Any]:
    return {"time_ns": letter.time, "by_time": letter.by_time} if isinstance(letter, Instant) else {}


def _recorded(recorded: Recorded) -> dict[str, Any]:
    return {
        "recording": recorded.recording,
        "steps": recorded.steps,
        "verdicts": {name: verdict.value for name, verdict in recorded.verdicts.items()},
        "differences": [
            {
                "left": parting.left,
                "right": parting.right,
                "step": parting.step,
                "left_verdict": parting.left_verdict.value,
                "right_verdict": parting.right_verdict.value,
                "time_ns": parting.time,
                "by_time": parting.by_time,
                "values": json_values(parting.values),
            }
            for parting in recorded.partings
        ],
        "bounds": [_other_bounds(bounds) for bounds in recorded.bounds],
    }


def _other_bounds(bounds: OtherBounds) -> dict[str, Any]:
    found: dict[str, Any] = {
        "names": list(bounds.names),
        "text": bounds.text,
        "bound_ns": bounds.duration,
        "endings": [
            {
                "least_ns": ending.least,
                "most_ns": ending.most,
                "verdict": ending.verdict.value,
                "step": ending.step,
                "time_ns": ending.time,
                "values": json_values(ending.values),
            }
            for ending in bounds.endings
        ],
    }
    return found | ({"limits": {"endings": bounds.obstacle}} if bounds.obstacle else {})


def json_values(values: Values) -> dict[str, Any]:
    """`values` as JSON has them."""
    return {name: json_value(value) for name, value in values.items()}


def rows_of(answers: Sequence[Answer], recordings: Sequence[Sequence[Recorded]] = ()) -> Iterator[dict[str, Any]]:
    """A row for each property, pair of encodings and kind of runs, as a data frame or CSV has it.

    If there are `recordings`, the last column has those on which the two part, and the step.
    """
    for number, answer in enumerate(answers):
        recorded = [recording[number] for recording in recordings]
        measured = {each.name: each for each in answer.measured}
        for comparison in answer.comparisons:
            left, right = measured[comparison.left], measured[comparison.right]
            for kind, related in comparison.related.items():
                yield {
                    "property": answer.question.label,
                    "line": answer.question.line,
                    "runs": kind.value,
                    "left": comparison.left,
                    "right": comparison.right,
                    **_relation_row(related),
                    **_measured_row("left", left),
                    **_measured_row("right", right),
                    **({"recordings": _partings(comparison, recorded)} if recordings else {}),
                }


def _partings(comparison: Comparison, recordings: Sequence[Recorded]) -> str:
    """The recordings on which two encodings part, each with the step."""
    return "; ".join(
        f"{recorded.recording}: step {parting.step}"
        for recorded in recordings
        for parting in recorded.partings
        if (parting.left, parting.right) == (comparison.left, comparison.right)
    )


def _relation_row(related: Related | Exceeded) -> dict[str, Any]:
    names = ("relation", "left_only", "right_only", "confirmed_length", "confirmed_runs")
    if isinstance(related, Exceeded):
        return dict.fromkeys(names) | {"relation": str(related)}
    runs = (related.left_only, related.right_only)
    words = ("" if run is None else shown(run.word) for run in runs)
    confirmed = related.confirmation
    return dict(zip(names, (related.relation.value, *words, confirmed.length, confirmed.runs), strict=True))


def _measured_row(side: str, measured: Measured) -> dict[str, Any]:
    monitored = measured.monitored
    states, seconds = (
        (len(monitored.monitor.verdicts), monitored.seconds) if isinstance(monitored, Monitored) else (None, None)
    )
    kind = measured.temporal_class
    return {
        f"{side}_formula": str(measured.formula),
        f"{side}_size": measured.size,
        f"{side}_class": None if isinstance(kind, Exceeded) else kind.value,
        f"{side}_states": states,
        f"{side}_seconds": seconds,
    }
