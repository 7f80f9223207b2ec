"""What a run has shown, as JSON."""

from __future__ import annotations

import json
import math
from typing import Any

from ltlc.runtime.properties import Change, Condition, Constants, Failure, Moment
from ltlc.runtime.reports import (
    distance,
    not_measured,
    skips,
    time_left,
)
from ltlc.runtime.sampling import Value
from ltlc.runtime.session import Session
from ltlc.runtime.silence import lost, malformed, waiting_for
from ltlc.runtime.times import seconds
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict


def property_report(session: Session, track: Track) -> dict[str, Any]:
    """A property in the JSON document of `ltlc run`."""
    failure, zero = track.decided_at, session.beginning
    constants = track.property.constants
    decided = None if failure is None else failure_report(failure, zero, constants)
    report = {
        "label": track.property.label,
        "file": track.property.file,
        "line": track.property.line,
        "text": track.property.text,
        "verdict": track.verdict.value,
        "steps": track.steps,
        "episodes": track.episodes,
        "decided_at": decided,
        "open_since": _optional(track.open_since, zero),
        "invalid_steps": track.invalid,
        "never_triggered": track.never_triggered,
        **track.property.traced(),
    }
    if track.verdicts is not None:
        report["verdicts"] = [verdict.value for verdict in track.verdicts]
        report["times"] = [seconds(time) for time in track.times]
        report["times_ns"] = track.times
    if track.slices is not None:
        report["each"] = track.slices.document()
    return report


def failure_report(
    failure: Failure, zero: int | None, constants: Constants
) -> dict[str, Any]:
    """What decided a property, in the JSON document of `ltlc run`."""
    named = {
        name: constants[name][value]
        for name, value in failure.values
        if name in constants and value in constants[name]
    }
    return {
        **moment_report(failure, zero),
        "values": {name: json_value(value) for name, value in failure.values},
        "because": [_because(condition) for condition in failure.because],
        "open_since": _optional(failure.open_since, zero),
        "episode_opened": _optional(next(iter(failure.opened), None), zero),
        "episodes_opened": [
            {"scope": opening.scope, **moment_report(opening, zero)}
            for opening in failure.opened
        ],
        **({"constants": named} if named else {}),
    }


def _because(condition: Condition) -> dict[str, Any]:
    told: dict[str, Any] = {
        "condition": condition.text,
        "holds": condition.holds,
        "left": json_value(condition.left),
        "right": json_value(condition.right),
        "by": distance(condition),
    }
    if condition.age is not None:
        told["age"] = seconds(condition.age)
    if condition.lasted is not None:
        told["lasted"] = seconds(condition.lasted)
    if condition.ago is not None:
        told["ago"] = seconds(condition.ago)
    if condition.element is not None:
        index, values = condition.element
        found = {name: json_value(value) for name, value in values}
        told["element"] = {"index": index, "values": found}
    return told


def document(recording: str, session: Session) -> dict[str, Any]:
    """The JSON document of `ltlc run`."""
    properties, zero = [], session.beginning
    for track in session.tracks:
        report = property_report(session, track)
        left = time_left(session, track)
        report["left"] = None if left is None else seconds(left)
        report["left_ns"] = left
        if track.verdict is Verdict.NOT_STARTED:
            report["waiting_for"] = waiting_for(session, track)
        if track.began is not None and skips(session, track):
            report["began_at"] = seconds(track.began)
            report["began_at_ns"] = track.began
            report["not_judged"] = dict(sorted(track.skipped.items()))
        if track.delays:
            longest = seconds(track.longest_delay)
            report["told_late"] = {"times": track.delays, "longest": longest}
        if track.invalid:
            report["invalid_because"] = dict(track.invalid_because)
        if count := not_measured(session, track):
            report["elements_not_measured"] = count
        if missed := lost(session, track):
            report["lost_messages"] = {
                topic: loss.count if loss.is_all else None
                for topic, loss in missed.items()
            }
            report["lost_at_least"] = {t: loss.count for t, loss in missed.items()}
        if damaged := malformed(session, track):
            report["malformed_messages"] = damaged
        properties.append(report)
    return {
        "recording": recording,
        "beginning": None if zero is None else seconds(zero),
        "beginning_ns": zero,
        "steps": session.steps,
        "unseen_messages": {t: count for t, count in session.unseen.items() if count},
        "properties": properties,
    }


def json_line(change: Change) -> str:
    """A change of verdict as one line of JSON."""
    data = {
        "label": change.property.label,
        "file": change.property.file,
        "line": change.property.line,
        "previous": change.previous.value,
        "verdict": change.current.value,
        **change.property.traced(),
        **moment_report(change.moment, None),
    }
    return json.dumps(data)


def moment_report(moment: Moment, zero: int | None) -> dict[str, Any]:
    """A moment, in JSON; with its offset, if it is known when the recording began."""
    offset = {} if zero is None else {"offset": seconds(moment.time - zero)}
    return {
        "step": moment.step,
        "time": seconds(moment.time),
        "time_ns": moment.time,
        **offset,
        "by_time": moment.by_time,
    }


def _optional(moment: Moment | None, zero: int | None) -> dict[str, Any] | None:
    return None if moment is None else moment_report(moment, zero)


def json_value(value: Value) -> Any:
    """`value` as JSON has it, which knows no infinite numbers: these as strings."""
    if isinstance(value, tuple):
        return [json_value(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return repr(value)
    return value
