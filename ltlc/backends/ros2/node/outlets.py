"""Verdicts go out: on a topic, as lines of JSON, as a JUnit report."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from ltlc.backends.ros2.node.deeds import Deeds
from ltlc.backends.ros2.node.files import Lines, test_suites, write_text
from ltlc.backends.ros2.node.options import Options
from ltlc.backends.ros2.node.recorder import Recorder
from ltlc.runtime.documents import document, json_line
from ltlc.runtime.guarding import Deed
from ltlc.runtime.junit import guard_case, junit, provenance_pairs
from ltlc.runtime.properties import Change
from ltlc.runtime.reports import summary
from ltlc.runtime.sampling import Value
from ltlc.runtime.session import Session


class Outlets:
    """Where changes of verdict and the ends of runs are reported."""

    KEPT = 1000

    def __init__(
        self,
        node: Node,
        options: Options,
        provenance: Mapping[str, Any],
        deeds: Deeds,
    ) -> None:
        self._node, self._deeds = node, deeds
        self._provenance = provenance
        self._suites: list[str] = []
        self._options = options
        self._lines = None if options.jsonl is None else Lines(options.jsonl)
        self._recorder = None if options.record is None else Recorder(options.record)
        self.have_failed = False
        profile = QoSProfile(
            depth=self.KEPT, durability=DurabilityPolicy.TRANSIENT_LOCAL
        )
        self._publisher = node.create_publisher(String, "~/verdicts", profile)

    @property
    def are_recording(self) -> bool:
        """Whether anyone listens to what is judged."""
        return self._recorder is not None

    def record(self, time: int, samples: Iterable[tuple[str, Value]] = ()) -> None:
        """Samples of `time` are judged; what cannot be recorded ends the recording."""
        if self._recorder and not self._try(self._recorder.write, time, samples):
            self._recorder = None

    def save(self) -> None:
        """Let others see what has been recorded so far."""
        if self._recorder and not self._try(self._recorder.save):
            self._recorder = None

    def tell(self, change: Change) -> None:
        """A verdict has changed."""
        self.line(json_line(change))

    def deed(self, deed: Deed, session: Session) -> None:
        """A guard did something."""
        line = self._deeds.add(deed, session)
        if line is not None and self._lines is not None:
            self._try(self._lines.write, line)

    def end(self, session: Session) -> None:
        """A run has ended; `session` has its final verdicts."""
        final, suites = self._final(session), self._with(session)
        self.line(json.dumps(final))
        self._suites = suites
        if self._options.junit is not None:
            self._try(write_text, self._options.junit, test_suites(suites))
        if self._recorder is not None:
            self._try(self._recorder.end, session.time)

    def words(self, session: Session) -> dict[str, Any]:
        """What the watchdog reports if the node cannot, as data."""
        jsonl, junit = self._options.jsonl, self._options.junit
        return {
            "jsonl": None if jsonl is None else str(jsonl),
            "junit": None if junit is None else str(junit),
            "final": self._final(session),
            "suites": test_suites(self._with(session)),
            "summary": summary(session) + self._deeds.text,
        }

    def _final(self, session: Session) -> dict[str, Any]:
        """The end of a run, as data."""
        name = self._node.get_fully_qualified_name()
        data = document(name, session)
        run = len(self._suites) + 1
        head = {"run": run, "final": True, "node": data.pop("recording")}
        guards = self._deeds.document(session)
        return {**head, **data, **guards, "provenance": self._provenance}

    def _with(self, session: Session) -> list[str]:
        """A JUnit report of each run that has ended, and of `session`."""
        name = self._node.get_fully_qualified_name()
        run = len(self._suites) + 1
        suite = name if run == 1 else f"{name} run {run}"
        made_of = provenance_pairs(self._provenance)
        guards = [*map(guard_case, self._deeds.document(session).get("guard", ()))]
        return [*self._suites, junit(suite, session, guards, properties=made_of)]

    def close(self) -> None:
        """Wait until all listeners have received the last verdict."""
        self._publisher.wait_for_all_acked(Duration(seconds=1))

    def line(self, line: str) -> None:
        """Something is to be known at once, as a line of JSON."""
        self._publisher.publish(String(data=line))
        if self._lines is not None:
            self._try(self._lines.write, line)

    def _try(self, write: Any, *arguments: Any) -> bool:
        """A full disk does not end the run: it is reported, also by the exit code."""
        try:
            write(*arguments)
        except OSError as error:
            self.have_failed = True
            self._node.get_logger().error(f"a report cannot be written: {error}")
            return False
        return True
