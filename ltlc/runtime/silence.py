"""Why a property has not started: which of its signals never came, and from where."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TypeVar

from ltlc.runtime.sampling import Input, New, Reading, Sampler, Wanted
from ltlc.runtime.session import Loss, Session
from ltlc.runtime.tracking import Track

T = TypeVar("T")


def waiting_for(session: Session, track: Track) -> list[str]:
    """What a property waits for: remarks on its inputs without a value, each once."""
    sampler = session.sampler_of(track)
    inputs = track.property.inputs
    missing: list[Wanted]
    if track.slices is None:
        values = sampler.window(inputs).values(sampler.known)
        waited = zip(inputs, values, track.property.waits, strict=True)
        missing = [i for i, value, waits in waited if waits and value is None]
    else:
        keys = track.slices.cut.keys
        missing = [
            Input(i.signal)
            for i, waits in zip(inputs, track.property.waits, strict=True)
            if (waits and not isinstance(i, New))
            or any(r.topic in keys for r in _readings(session, i.signal))
            if absent(session, i.signal)
        ]
    return list(
        dict.fromkeys(r for i in missing for r in _remarks(session, sampler, i))
    )


def beginning(session: Session, track: Track) -> str:
    """When a property began, after the session, and what it had waited for."""
    assert track.began is not None
    pairs = zip(track.property.inputs, track.property.waits, strict=True)
    waited = (i for i, waits in pairs if waits and not isinstance(i, New))
    read = (r.topic for i in waited for r in _readings(session, i.signal))
    last = [topic for topic in dict.fromkeys(read) if topic not in track.skipped]
    messages = f"message{'s' if len(last) > 1 else ''} on {' and '.join(last)}"
    after = f", after the first {messages}" if last else ""
    return f"began at {session.scale.text(track.began)}{after}"


def absent(session: Session, name: str) -> list[Reading]:
    """The readings without a sample that the signal `name` is computed from."""
    return _absent(session, session.sampler, name)


def _absent(session: Session, sampler: Sampler, name: str) -> list[Reading]:
    return [r for r in _readings(session, name) if not sampler.values(r.name)]


def topics(session: Session, track: Track) -> set[str]:
    """The topics that a property reads."""
    if track.slices is not None:
        return set(track.slices.topics())
    of = session.sampler.topics
    return {topic for wanted in track.property.inputs for topic in of[wanted.signal]}


def news(session: Session, track: Track) -> set[str]:
    """The topics of which a property wants to know that a message came."""
    if track.slices is not None:
        return set(track.slices.news())
    of, inputs = session.sampler.topics, track.property.inputs
    return {t for i in inputs if isinstance(i, New) for t in of[i.signal]}


def lost(session: Session, track: Track) -> dict[str, Loss]:
    """What a property has missed on each topic, if it has."""
    return _read_from(session, track, session.lost)


def malformed(session: Session, track: Track) -> dict[str, int]:
    """How many messages on each topic that a property reads were malformed."""
    return _read_from(session, track, session.malformed)


def _read_from(
    session: Session, track: Track, by_topic: Mapping[str, T]
) -> dict[str, T]:
    """What there is `by_topic` of those that a property reads."""
    if not by_topic:
        return {}
    read = topics(session, track)
    return {topic: found for topic, found in by_topic.items() if topic in read}


def _readings(session: Session, name: str) -> Iterator[Reading]:
    signal = next((s for s in session.plan.signals if s.name == name), None)
    if signal is None:  # the id of a slice comes with its topic
        return
    if isinstance(signal, Reading):
        yield signal
        return
    for part in signal.inputs:
        yield from _readings(session, part.signal)


def _remarks(session: Session, sampler: Sampler, wanted: Wanted) -> list[str]:
    missing = _absent(session, sampler, wanted.signal)
    if not missing:
        return [f"too few samples for {wanted}"]
    return [_absence(session, reading) for reading in missing]


def _absence(session: Session, reading: Reading) -> str:
    for name in (reading.name, reading.topic):
        if name in session.absences:
            return session.absences[name]
    if reading.topic == reading.name:
        return f"no value of {reading.name}"
    messages = session.messages[reading.topic]
    if messages == 0:
        return f"no message on {reading.topic}"
    count = f"{messages} message{'s' if messages > 1 else ''} on {reading.topic}"
    if session.time is None:
        return f"{count} before there was a time"
    if reading.entry is not None:
        return f"{count}, but none with an entry {reading.entry!r}"
    return f"{count}, but none with a value of {reading.name}"
