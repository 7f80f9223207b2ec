"""What a run has shown, as text, JSON and JUnit XML."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

from ltlc.runtime.properties import (
    Change,
    Condition,
    Failure,
    Moment,
    MonitoredProperty,
)
from ltlc.runtime.sampling import Value
from ltlc.runtime.session import Loss, Session
from ltlc.runtime.silence import beginning, lost, malformed, waiting_for
from ltlc.runtime.times import seconds, seconds_text
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict


def printable(text: str) -> str:
    """`text` with what a terminal would act on, or not show, written as escapes."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def topic_names(labels: Sequence[str]) -> list[str]:
    """Names of topics, all different, of letters, digits and single `_`."""
    found: list[str] = []
    for label in labels:
        words = re.findall(r"[A-Za-z0-9]+", label)
        name = "_".join(words if words and words[0][0].isalpha() else ["p", *words])
        unique, number = name, 1
        while unique in found:
            number += 1
            unique = f"{name}_{number}"
        found.append(unique)
    return found


LONGEST = 200
"""How many items of an array, or characters of a string, are shown to a reader."""


def value_text(value: Value) -> str:
    """A value as the property language writes it; a double exactly, an array cut."""
    if value is None:
        return "no value"
    if isinstance(value, bool):
        return "true" if value else "false"
    if not isinstance(value, (tuple, str)):
        return repr(value)
    shown = value[:LONGEST]
    text = repr(shown) if isinstance(shown, str) else f"[{', '.join(map(repr, shown))}]"
    return text if len(value) <= LONGEST else f"{text}... ({len(value)} in all)"


def figure(track: Track) -> str:
    """The error message for a violated property: its text, and the failing state."""
    if track.slices is not None:
        return track.slices.figure()
    assert track.decided_at is not None
    return failure_text(track.property, track.decided_at)


def failure_text(property_: MonitoredProperty, failure: Failure) -> str:
    """The error message for a property that is violated.

    The form of Figure 1 of Cordeiro, Fonseca and Timperley, *Formalization and Runtime
    Verification of Invariants for Robotic Systems*, with what led to it, and when.
    """
    lines = [f"Error at line {_place(property_)}:"]
    lines.append(f"  {property_.text}")
    lines.append("Failing state:")
    lines += [f"  {name}: {value_text(value)}" for name, value in failure.values]
    if failure.because:
        lines.append("Because:")
        lines += [f"  {_condition(condition)}" for condition in failure.because]
    if failure.open_since is not None:
        lines.append(f"Until then {_owed(property_, failure.open_since)}")
    lines.append(f"At {moment_text(failure)}.")
    for depth, opening in enumerate(failure.opened):
        within = f"Inside it, that of `{opening.scope}`" if depth else "The episode"
        lines.append(f"{within} opened at {moment_text(opening)}.")
    return "".join(f"{printable(line)}\n" for line in lines)


def _place(property_: MonitoredProperty) -> str:
    """Line, file and, where the author gave one, label of a property."""
    place = f"{property_.line} of {property_.file}"
    has_label = property_.label != f"line {property_.line}"
    return f"{place} ({property_.label})" if has_label else place


def _condition(condition: Condition) -> str:
    """What a condition was, and what it compared."""
    truth = f"{condition.text}: {value_text(condition.holds)}"
    if condition.left is None:
        return truth
    sides = (value_text(condition.left), value_text(condition.right))
    return f"{truth}, comparing {' with '.join(sides)}"


def moment_text(moment: Moment) -> str:
    """A step, or the clock step after it, and its time, to the nanosecond."""
    place = f"after step {moment.step}" if moment.by_time else f"step {moment.step}"
    return f"{seconds_text(moment.time)} s ({place})"


def summary(session: Session) -> str:
    """A line for each property, its verdict and what to know, and what was not seen."""
    lines = [sentence(session, track) for track in session.tracks]
    return "".join(f"{line}\n" for line in [*lines, *unseen(session)])


def unseen(session: Session) -> list[str]:
    """What there is to say about messages that came and went between two ticks."""
    return [
        f"no tick saw {count} of {_count(session.messages[topic], 'message')} "
        f"on {printable(topic)}"
        for topic, count in session.unseen.items()
        if count
    ]


def sentence(session: Session, track: Track) -> str:
    """What there is to say about a property, in one line."""
    verdict = track.verdict.value.replace("_", " ")
    parts = [f"{printable(track.property.label)}: {verdict}{_since(track)}"]
    parts += explanation(session, track)
    return "; ".join(parts)


def _since(track: Track) -> str:
    if track.slices is not None:
        return track.slices.since()
    if track.decided_at is not None:
        return f" at {moment_text(track.decided_at)}"
    return ""


def explanation(session: Session, track: Track) -> list[str]:
    """Remarks on a verdict: what is owed, what never came, what was invalid."""
    remarks = []
    if track.verdict is Verdict.NOT_STARTED and not track.invalid:
        remarks += waiting_for(session, track)
    if _skips(session, track):
        remarks += [beginning(session, track), _skipped(track)]
    if track.slices is not None:
        remarks += track.slices.remarks()
    elif track.open_since is not None:
        remarks.append(_owed(track.property, track.open_since))
        left = time_left(session, track)
        if left is not None:
            remarks.append(f"{seconds_text(left)} s left")
    if track.never_triggered:
        remarks.append("holds, but never triggered: no episode opened")
    elif track.episodes is not None:
        remarks.append(_count(track.episodes, "episode"))
    if track.slices is None:
        remarks.append(_count(track.steps, "step"))
    for reason, count in track.invalid_because.items():
        remarks.append(f"{_count(count, 'step')} left out: {reason}")
    for name, count in not_measured(session, track).items():
        were = "was NaN, no measurement" if count == 1 else "were NaN, no measurements"
        remarks.append(f"{_count(count, 'element')} of {name} {were}")
    if track.delays:
        remarks.append(_delay(track))
    remarks += [_loss(topic, loss) for topic, loss in lost(session, track).items()]
    for topic, count in malformed(session, track).items():
        were = "was" if count == 1 else "were"
        remarks.append(f"{_count(count, 'message')} on {topic} {were} malformed")
    return [printable(remark) for remark in remarks]


def _skips(session: Session, track: Track) -> bool:
    """Whether messages were not judged before a property began, later than the run."""
    return bool(track.skipped) and track.began not in (None, session.began)


def _skipped(track: Track) -> str:
    counts = sorted(track.skipped.items())
    said = [f"{_count(n, 'message')} on {topic}" for topic, n in counts]
    were = "was" if [n for _, n in counts] == [1] else "were"
    return f"{' and '.join(said)} before that {were} not judged"


def not_measured(session: Session, track: Track) -> dict[str, int]:
    """How many elements of the arrays that a property reads were NaN, if some were."""
    counts = session.sampler.not_measured
    names = dict.fromkeys(wanted.signal for wanted in track.property.inputs)
    return {name: counts[name] for name in names if counts.get(name)}


def time_left(session: Session, track: Track) -> int | None:
    """For how long what is still open can wait; None if nothing is, or for ever."""
    if track.slices or track.open_since is None or session.time is None:
        return None
    deadline = track.deadline()
    return None if deadline is None else deadline - 1 - session.time


def _owed(property_: MonitoredProperty, since: Moment) -> str:
    owed = " or ".join(property_.obligations) or property_.text
    return f"still open since {moment_text(since)}: {owed}"


def _loss(topic: str, loss: Loss) -> str:
    if not loss.count:
        return f"some messages on {topic} may have been lost"
    were = "was" if loss.count == 1 else "were"
    text = f"{_count(loss.count, 'message')} on {topic} {were} lost"
    return text if loss.is_all else f"{text}, and more may have been"


def _delay(track: Track) -> str:
    longest = seconds_text(track.longest_delay)
    return f"told {_count(track.delays, 'time')} late, by {longest} s at most"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def property_report(track: Track) -> dict[str, Any]:
    """A property in the JSON document of `ltlc run`."""
    failure = track.decided_at
    decided = None if failure is None else failure_report(failure)
    report = {
        "label": track.property.label,
        "file": track.property.file,
        "line": track.property.line,
        "text": track.property.text,
        "verdict": track.verdict.value,
        "steps": track.steps,
        "episodes": track.episodes,
        "decided_at": decided,
        "open_since": _optional(track.open_since),
        "invalid_steps": track.invalid,
        "never_triggered": track.never_triggered,
    }
    if track.verdicts is not None:
        report["verdicts"] = [verdict.value for verdict in track.verdicts]
        report["times"] = [seconds(time) for time in track.times]
        report["times_ns"] = track.times
    if track.slices is not None:
        report["each"] = track.slices.document()
    return report


def failure_report(failure: Failure) -> dict[str, Any]:
    """What decided a property, in the JSON document of `ltlc run`."""
    return {
        **moment_report(failure),
        "values": {name: json_value(value) for name, value in failure.values},
        "because": [_because(condition) for condition in failure.because],
        "open_since": _optional(failure.open_since),
        "episode_opened": _optional(next(iter(failure.opened), None)),
        "episodes_opened": [
            {"scope": opening.scope, **moment_report(opening)}
            for opening in failure.opened
        ],
    }


def _because(condition: Condition) -> dict[str, Any]:
    return {
        "condition": condition.text,
        "holds": condition.holds,
        "left": json_value(condition.left),
        "right": json_value(condition.right),
    }


def document(recording: str, session: Session) -> dict[str, Any]:
    """The JSON document of `ltlc run`."""
    properties = []
    for track in session.tracks:
        report = property_report(track)
        left = time_left(session, track)
        report["left"] = None if left is None else seconds(left)
        report["left_ns"] = left
        if track.verdict is Verdict.NOT_STARTED:
            report["waiting_for"] = waiting_for(session, track)
        if track.began is not None and _skips(session, track):
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
        **moment_report(change.moment),
    }
    return json.dumps(data)


def junit(
    name: str,
    session: Session,
    more: Sequence[Case] = (),
    remarks: Sequence[str] = (),
) -> str:
    """A JUnit XML report: a test suite `name` with one test case for each property.

    After these come `more`, and then `remarks` on all of it.

    What is violated or still owed at the end fails; what never started is an error, and
    so is what would hold if no message had been lost.
    """
    cases = [*(_case(session, track) for track in session.tracks), *more]
    return f"{XML_HEAD}{suite_text(name, cases, [*unseen(session), *remarks])}"


XML_HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'


@dataclass(frozen=True, slots=True)
class Case:
    """A test case: what there is to say about it in a line, and if it failed in full.

    `element` is what a case has that did not pass: `failure`, `error`, or None.
    """

    name: str
    element: str | None
    kind: str
    message: str
    details: str


def suite_text(name: str, cases: Sequence[Case], remarks: Sequence[str]) -> str:
    """A JUnit test suite as an element of XML."""
    elements = [case.element for case in cases]
    failures, errors = elements.count("failure"), elements.count("error")
    told = "".join(f"{escape(remark, quote=False)}\n" for remark in remarks)
    output = f"  <system-out>{told}</system-out>\n" if told else ""
    return (
        f'<testsuite name={_attribute(name)} tests="{len(cases)}" '
        f'failures="{failures}" errors="{errors}">\n'
        f"{''.join(_case_text(name, case) for case in cases)}{output}</testsuite>\n"
    )


def _case_text(suite: str, case: Case) -> str:
    head = f"classname={_attribute(suite)} name={_attribute(case.name)}"
    message = escape(printable(case.message), quote=False)
    body = f"<system-out>{message}</system-out>"
    if case.element is not None:
        kind = f'message={_attribute(case.message)} type="{case.kind}"'
        details = escape(case.details, quote=False)
        body = f"<{case.element} {kind}>{details}</{case.element}>"
    return f"  <testcase {head}>{body}</testcase>\n"


_FAILURES = (Verdict.VIOLATED, Verdict.PRESUMABLY_VIOLATED)


def _case(session: Session, track: Track) -> Case:
    message = sentence(session, track)
    is_violated = track.verdict is Verdict.VIOLATED
    details = figure(track) if is_violated else f"{printable(message)}\n"
    element = case_element(track.verdict, has_lost=_misses(session, track))
    name = track.property.label
    return Case(name, element, track.verdict.value, message, details)


def _misses(session: Session, track: Track) -> bool:
    """Whether something that a property reads could not be judged."""
    left_out = track.slices is not None and track.slices.left_out > 0
    return bool(lost(session, track) or malformed(session, track)) or left_out


def case_element(verdict: Verdict, has_lost: bool = False) -> str | None:
    """What a test case has that did not pass."""
    if verdict in _FAILURES:
        return "failure"
    return None if verdict.holds and not has_lost else "error"


def _attribute(text: str) -> str:
    return f'"{escape(printable(text))}"'


def exit_code(verdicts: Sequence[Verdict], has_lost: bool = False) -> int:
    """1 if a property is violated; 3 if one is owed or never started; else 0.

    Nothing is well where messages have been lost, or were malformed.
    """
    if Verdict.VIOLATED in verdicts:
        return 1
    return 0 if not has_lost and all(verdict.holds for verdict in verdicts) else 3


def moment_report(moment: Moment) -> dict[str, Any]:
    """A moment, in JSON."""
    return {
        "step": moment.step,
        "time": seconds(moment.time),
        "time_ns": moment.time,
        "by_time": moment.by_time,
    }


def _optional(moment: Moment | None) -> dict[str, Any] | None:
    return None if moment is None else moment_report(moment)


def json_value(value: Value) -> Any:
    """`value` as JSON has it, which knows no infinite numbers: these as strings."""
    if isinstance(value, tuple):
        return [json_value(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return repr(value)
    return value
