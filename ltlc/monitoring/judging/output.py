"""Verdicts as topics in an MCAP file, with the times of the recording that they are about.

| topic | type | |
|---|---|---|
| `/ltlc/PROPERTY/verdict` | std_msgs/String | `violated`, `presumably_violated` and so on |
| `/ltlc/PROPERTY/code` | std_msgs/Int8 | the same as a number, to be plotted: -2 violated up to 2 satisfied |
| `/ltlc/PROPERTY/violated` | std_msgs/Bool | |
| `/ltlc/PROPERTY/episode` | std_msgs/Bool | whether an episode is open, of a property that has scopes |
| `/diagnostics` | diagnostic_msgs/DiagnosticArray | the state in words, as a node has it; the failing state |

There is a message at the beginning and at each change, and one at the end. `PROPERTY` is the label, with `_` for what
cannot stand in the name of a topic.

If guards were tried, there is for each that sends on `OUT`, at each thing that it did:

| topic | type | |
|---|---|---|
| `OUT` | that of `OUT` | what left: commands that passed, as they were recorded, and fallbacks |
| `/ltlc/guard/OUT/not_passed` | that of `OUT` | the commands that were changed or held back |
| `/ltlc/guard/OUT/action` | std_msgs/String | `passed`, `changed`, `held_back`, `sent` or `lost` |
| `/diagnostics` | diagnostic_msgs/DiagnosticArray | the same in words, with the reason |
"""

from __future__ import annotations

import io
import json
from collections.abc import Iterable, Iterator, Mapping
from functools import cache, partial
from typing import Any, NamedTuple

from mcap.writer import Writer

from ltlc import __version__
from ltlc.inputs.messages.definitions import shipped
from ltlc.inputs.messages.texts import text_of
from ltlc.inputs.recordings.bags.fallbacks import data_of
from ltlc.inputs.recordings.bags.written import written
from ltlc.inputs.recordings.trails import Trail
from ltlc.monitoring.guarding.report import GuardReport
from ltlc.monitoring.judging.run import RunReport
from ltlc.runtime.guard_reports import deed_text
from ltlc.runtime.guarding import Action
from ltlc.runtime.reports import explanation, moment_text, printable, topic_names, value_text
from ltlc.runtime.session import Session
from ltlc.runtime.times import SECOND
from ltlc.runtime.tracking import Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.guards import Guard

CODES = {
    Verdict.VIOLATED: -2,
    Verdict.PRESUMABLY_VIOLATED: -1,
    Verdict.NOT_STARTED: 0,
    Verdict.PRESUMABLY_SATISFIED: 1,
    Verdict.SATISFIED: 2,
}
"""Verdicts as numbers: what is good is up."""

_LEVELS = {Verdict.VIOLATED: 2, Verdict.NOT_STARTED: 3, Verdict.PRESUMABLY_VIOLATED: 1}
"""Those of diagnostic_msgs/DiagnosticStatus: an error, stale, a warning; otherwise 0, all is well."""


class NotWritableError(Exception):
    """Nothing was judged, or a time of the recording is before 1970 or too late for the seconds of a header."""


class Whole(NamedTuple):
    """A message in CDR, and a text that defines its type, in the form `ros2msg`."""

    data: bytes
    definition: str


class _Message(NamedTuple):
    time: Nanoseconds
    topic: str
    type: str
    fields: Mapping[str, Any] | Whole


def verdicts_mcap(report: RunReport) -> bytes:
    """The file for `report`, which has trails. Raises NotWritableError."""
    session = report.session
    if session is None or session.began is None:
        raise NotWritableError("nothing of the recording could be judged")
    names = [f"/ltlc/{name}" for name in topic_names([track.property.label for track in session.tracks])]
    messages: list[_Message] = []
    for track, trail, name in zip(session.tracks, report.trails, names, strict=True):
        messages += _verdicts(session, track, trail, name)
        if track.property.scopes:
            messages += _episodes(session, trail, name)
    if report.guard is not None:
        for guard, name in zip(report.guard.guards, topic_names([g.out for g in report.guard.guards]), strict=True):
            messages += _guarded(report.guard, guard, f"/ltlc/guard/{name}")
    messages.sort(key=lambda message: message.time)
    for time in (each.time for each in messages):
        if not 0 <= time < 2**31 * SECOND:
            raise NotWritableError(f"times of messages must be between 1970 and 2038, but one is {time} ns")
    return _written(messages, report.provenance())


def _verdicts(session: Session, track: Track, trail: Trail, name: str) -> Iterator[_Message]:
    """The verdict at the beginning, at each change, and at the end."""
    began, end = _ends(session)
    if not trail.changes or trail.changes[0].moment.time > began:
        yield from _verdict(began, track, name, Verdict.NOT_STARTED, [])
    for change in trail.changes:
        said = [f"since {moment_text(change.moment, session.scale)}"]
        yield from _verdict(change.moment.time, track, name, change.current, said)
    yield from _verdict(end, track, name, track.verdict, explanation(session, track))


def _guarded(report: GuardReport, guard: Guard, name: str) -> Iterator[_Message]:
    """What a guard did: what left it, what did not pass, and why."""
    definition = report.definitions[guard.out]
    fallbacks = {each.name: data_of(each, guard, definition) for each in guard.fallbacks}
    for done in report.of(guard):
        deed = done.deed
        if deed.action is not Action.PASSED and done.message is not None:
            yield _Message(deed.time, f"{name}/not_passed", guard.message, Whole(done.message, definition))
        left = done.message if deed.message is None else fallbacks[deed.message]
        if deed.values is not None and left is not None:
            yield _Message(deed.time, guard.out, guard.message, Whole(left, definition))
        yield _Message(deed.time, f"{name}/action", "std_msgs/msg/String", {"data": deed.action.value})
        level = {Action.PASSED: 0, Action.LOST: 2}.get(deed.action, 1)
        said = f"{deed_text(deed)}{f': {reason}' if (reason := done.reason(whole=True)) else ''}"
        yield _status(deed.time, level, f"guard of {guard.out}", said, ())


def _status(time: Nanoseconds, level: int, name: str, message: str, values: Iterable[tuple[str, str]]) -> _Message:
    status = {
        "level": level,
        "name": f"ltlc: {printable(name)}",
        "message": printable(message),
        "hardware_id": "ltlc",
        "values": [{"key": key, "value": value} for key, value in values],
    }
    stamp = {"sec": time // SECOND, "nanosec": time % SECOND}
    said = {"header": {"stamp": stamp}, "status": [status]}
    return _Message(time, "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", said)


def _verdict(time: Nanoseconds, track: Track, name: str, verdict: Verdict, remarks: list[str]) -> Iterator[_Message]:
    yield _Message(time, f"{name}/verdict", "std_msgs/msg/String", {"data": verdict.value})
    yield _Message(time, f"{name}/code", "std_msgs/msg/Int8", {"data": CODES[verdict]})
    yield _Message(time, f"{name}/violated", "std_msgs/msg/Bool", {"data": verdict is Verdict.VIOLATED})
    said = "; ".join([verdict.value.replace("_", " "), *remarks])
    yield _status(time, _LEVELS.get(verdict, 0), track.property.label, said, _known(track, verdict))


def _known(track: Track, verdict: Verdict) -> Iterator[tuple[str, str]]:
    """What there is to know of a property; of one that is violated, the failing state."""
    yield "property", printable(track.property.text)
    if track.decided_at is not None and verdict is Verdict.VIOLATED:
        for signal, value in track.decided_at.values:
            yield printable(signal), printable(value_text(value))


def _episodes(session: Session, trail: Trail, name: str) -> Iterator[_Message]:
    """Whether an episode is open: at the beginning, where that changes, and at the end."""
    began, end = _ends(session)
    outermost = [span for span in trail.spans if span.depth == 0]
    steps = [(span.opening.time, 1) for span in outermost]
    steps += [(span.closed.time, -1) for span in outermost if span.closed is not None]
    is_open = 0
    for time, step in [(began, 0), *sorted(steps), (end, 0)]:
        is_open += step
        yield _Message(time, f"{name}/episode", "std_msgs/msg/Bool", {"data": is_open > 0})


def _ends(session: Session) -> tuple[Nanoseconds, Nanoseconds]:
    assert session.began is not None
    assert session.time is not None
    return session.began, session.time


def _written(messages: list[_Message], provenance: Mapping[str, Any]) -> bytes:
    """`messages`, in CDR, with the definitions of their types, and what they were made of."""
    types = shipped()
    definition = cache(partial(text_of, types=types))

    def whole(type_: str, fields: Mapping[str, Any] | Whole) -> Whole:
        return fields if isinstance(fields, Whole) else Whole(written(type_, types, fields), definition(type_))

    return mcap_of(((time, topic, of, whole(of, fields)) for time, topic, of, fields in messages), provenance)


def mcap_of(messages: Iterable[tuple[Nanoseconds, str, str, Whole]], provenance: Mapping[str, Any]) -> bytes:
    """A file of messages, each with its time, topic and type."""
    file = io.BytesIO()
    writer = Writer(file)
    writer.start(profile="ros2", library=f"ltlc {__version__}")
    schemas: dict[tuple[str, str], int] = {}
    channels: dict[str, int] = {}
    for sequence, (time, topic, type_, (data, definition)) in enumerate(messages):
        if (type_, definition) not in schemas:
            schemas[type_, definition] = writer.register_schema(type_, "ros2msg", definition.encode())
        if topic not in channels:
            channels[topic] = writer.register_channel(topic, "cdr", schemas[type_, definition])
        writer.add_message(channels[topic], time, data, time, sequence)
    writer.add_metadata("ltlc", {"provenance": json.dumps(provenance)})
    writer.finish()
    return file.getvalue()
