"""The state of each property, for /diagnostics."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node
from rclpy.serialization import serialize_message

from ltlc.backends.ros2.node.deeds import Deeds
from ltlc.backends.ros2.node.intake import Listener
from ltlc.runtime.junit import provenance_pairs
from ltlc.runtime.reports import explanation, printable
from ltlc.runtime.session import Session
from ltlc.runtime.silence import lost, malformed, topics
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict


class Diagnosis:
    """Publishes the state of the properties on /diagnostics."""

    def __init__(self, node: Node, provenance: Mapping[str, Any], deeds: Deeds) -> None:
        self._node, self._deeds = node, deeds
        self._made_of = [
            KeyValue(key=name, value=printable(value))
            for name, value in provenance_pairs(provenance)
        ]
        self._publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._echoes: list[deque[bytes]] = []

    @property
    def full_name(self) -> str:
        """The topic's name as the network knows it."""
        name: str = self._publisher.topic_name
        return name

    def echo(self) -> deque[bytes]:
        """What is published from now on: a listener on this topic must pass it over.

        rclpy does not say who sent a message. Nobody else sends the same bytes: they
        have the time to the nanosecond, and the name of the node.
        """
        echo: deque[bytes] = deque(maxlen=Listener.DEPTH)
        self._echoes.append(echo)
        return echo

    def publish(
        self,
        session: Session,
        listeners: Sequence[Listener],
        remarks: Sequence[str],
        of_guards: Sequence[str],
    ) -> None:
        """One status, `node: property`, for each property; `remarks` go to all.

        Also one for each guard, with the remarks `of_guards`.
        """
        by_topic = {one.topic.name: one for one in listeners}
        array = DiagnosticArray()
        array.header.stamp = self._node.get_clock().now().to_msg()
        array.status = [
            self._status(session, track, by_topic, remarks) for track in session.tracks
        ]
        name = self._node.get_fully_qualified_name()
        array.status += self._deeds.statuses(name, [*remarks, *of_guards])
        data = serialize_message(array)
        for echo in self._echoes:
            echo.append(data)
        self._publisher.publish(data)

    def _status(
        self,
        session: Session,
        track: Track,
        listeners: Mapping[str, Listener],
        general: Sequence[str],
    ) -> DiagnosticStatus:
        read = topics(session, track)
        heard = [listeners[topic] for topic in sorted(read & listeners.keys())]
        remarks = [*general, *(remark for one in heard for remark in one.remarks)]
        verdict = track.verdict.value.replace("_", " ")
        ids: dict[str, str] = {}
        if track.slices is not None:
            verdict, ids = f"{verdict}{track.slices.since()}", track.slices.listed()
        name = self._node.get_fully_qualified_name()
        words = [verdict, *explanation(session, track), *remarks]
        return DiagnosticStatus(
            level=level(
                track, [*remarks, *lost(session, track), *malformed(session, track)]
            ),
            name=f"{name.removeprefix('/')}: {printable(track.property.label)}",
            message="; ".join(dict.fromkeys(words)),
            hardware_id=name,
            values=[
                KeyValue(key="verdict", value=track.verdict.value),
                KeyValue(key="property", value=printable(track.property.text)),
                *_requirement(track),
                KeyValue(key="steps", value=str(track.steps)),
                KeyValue(key="episodes", value=str(track.episodes or 0)),
                KeyValue(key="invalid steps", value=str(track.invalid)),
                *(KeyValue(key=key, value=value) for key, value in ids.items()),
                *(_messages(session, one) for one in heard),
                *self._made_of,
            ],
        )


def _requirement(track: Track) -> Iterable[KeyValue]:
    """The requirement that a property states: its text and its attributes."""
    stated = track.property.requirement
    if not stated:
        return
    if stated["text"]:
        yield KeyValue(key="requirement", value=printable(stated["text"]))
    for key, values in stated["attributes"].items():
        value = printable(", ".join(values))
        yield KeyValue(key=f"requirement {key}", value=value)


def _messages(session: Session, listener: Listener) -> KeyValue:
    count = session.messages[listener.topic.name]
    return KeyValue(key=f"messages on {listener.full_name}", value=str(count))


def level(track: Track, remarks: Sequence[str]) -> bytes:
    """The level: an error if violated, a warning if something is open or amiss."""
    amiss = remarks or track.invalid or track.delays
    amiss = amiss or track.verdict is Verdict.PRESUMABLY_VIOLATED
    levels: dict[Verdict, bytes] = {
        Verdict.VIOLATED: DiagnosticStatus.ERROR,
        Verdict.NOT_STARTED: DiagnosticStatus.STALE,
    }
    otherwise: bytes = DiagnosticStatus.WARN if amiss else DiagnosticStatus.OK
    return levels.get(track.verdict, otherwise)
