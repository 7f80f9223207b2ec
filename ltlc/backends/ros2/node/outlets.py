"""Verdicts go out: on a topic, as lines of JSON, as a JUnit report."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from errno import ENXIO
from pathlib import Path
from typing import Any

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from ltlc.backends.ros2.node.options import Options, UnusableError
from ltlc.backends.ros2.node.recorder import Recorder
from ltlc.runtime.reports import document, json_line, junit
from ltlc.runtime.sampling import Value
from ltlc.runtime.session import Session
from ltlc.runtime.tracking import Change


class Outlets:
    """Where changes of verdict and the ends of runs are told."""

    KEPT = 1000

    def __init__(self, node: Node, options: Options) -> None:
        self._node = node
        self._suites: list[str] = []
        self._junit = options.junit
        self._lines = None if options.jsonl is None else Lines(options.jsonl)
        self._recorder = None if options.record is None else Recorder(options.record)
        self.have_failed = False
        profile = QoSProfile(
            depth=self.KEPT, durability=DurabilityPolicy.TRANSIENT_LOCAL
        )
        self._publisher = node.create_publisher(String, "~/verdicts", profile)

    @property
    def are_recording(self) -> bool:
        """Whether somebody wants to know what is judged."""
        return self._recorder is not None

    def record(self, time: int, samples: Iterable[tuple[str, Value]] = ()) -> None:
        """Samples of `time` are judged; what cannot be recorded ends the recording."""
        if self._recorder and not self._guard(self._recorder.write, time, samples):
            self._recorder = None

    def save(self) -> None:
        """Let others see what has been recorded so far."""
        if self._recorder and not self._guard(self._recorder.save):
            self._recorder = None

    def tell(self, change: Change) -> None:
        """A verdict has changed."""
        self._line(json_line(change))

    def end(self, session: Session) -> None:
        """A run has ended; `session` has its final verdicts."""
        name = self._node.get_fully_qualified_name()
        run = len(self._suites) + 1
        suite = name if run == 1 else f"{name} run {run}"
        self._suites.append(junit(suite, session))
        self._line(json.dumps({"run": run, **final_verdicts(name, session)}))
        if self._junit is not None:
            self._guard(write_text, self._junit, test_suites(self._suites))
        if self._recorder is not None:
            self._guard(self._recorder.end, session.time)

    def close(self) -> None:
        """Wait until those who listen have heard the last verdict."""
        self._publisher.wait_for_all_acked(Duration(seconds=1))

    def _line(self, line: str) -> None:
        self._publisher.publish(String(data=line))
        if self._lines is not None:
            self._guard(self._lines.write, line)

    def _guard(self, write: Any, *arguments: Any) -> bool:
        """A full disk does not end the run: it is reported, also by the exit code."""
        try:
            write(*arguments)
        except OSError as error:
            self.have_failed = True
            self._node.get_logger().error(f"a report cannot be written: {error}")
            return False
        return True


class Lines:
    """A file that lines are appended to, each whole or, if the disk is full, cut off.

    A pipe is not waited for: neither for somebody to read it, nor for room.
    """

    FLAGS = os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_NONBLOCK | os.O_CLOEXEC

    def __init__(self, path: Path) -> None:
        self._is_cut = False
        try:
            self._file = os.open(path, self.FLAGS, 0o666)
        except OSError as error:
            why = error.strerror
            if error.errno == ENXIO:
                why = "nobody reads this pipe"
            raise UnusableError(f"jsonl is {str(path)!r}: {why}") from error

    def write(self, line: str) -> None:
        """Append `line`; what there is of one that was cut off keeps its own line."""
        start = "\n" if self._is_cut else ""
        rest = f"{start}{line}\n".encode()
        while rest:
            written = os.write(self._file, rest)
            self._is_cut = True
            rest = rest[written:]
        self._is_cut = False


def final_verdicts(name: str, session: Session) -> dict[str, Any]:
    """The end of a run, as data."""
    data = document(name, session)
    return {"final": True, "node": data.pop("recording"), **data}


def test_suites(suites: Sequence[str]) -> str:
    """One JUnit document with all `suites`, each of which is one itself."""
    if len(suites) == 1:
        return suites[0]
    head, _ = suites[0].split("\n", 1)
    bodies = "".join(suite.split("\n", 1)[1] for suite in suites)
    return f"{head}\n<testsuites>\n{bodies}</testsuites>\n"


def write_text(path: Path, text: str) -> None:
    """Write a file that others see either as it was or complete."""
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        unfinished.write_text(text, encoding="utf-8")
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)
