"""Verdicts go out: on a topic, as lines of JSON, as a JUnit report."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TextIO

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from ltlc.backends.ros2.node.options import Options, UnusableError
from ltlc.runtime.reports import document, json_line, junit
from ltlc.runtime.session import Session
from ltlc.runtime.tracking import Change


class Outlets:
    """Where changes of verdict and the ends of runs are told."""

    KEPT = 1000

    def __init__(self, node: Node, options: Options) -> None:
        self._node = node
        self._suites: list[str] = []
        self._junit = options.junit
        self._lines = _opened(options.jsonl)
        profile = QoSProfile(
            depth=self.KEPT, durability=DurabilityPolicy.TRANSIENT_LOCAL
        )
        self._publisher = node.create_publisher(String, "~/verdicts", profile)

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

    def close(self) -> None:
        """Wait until those who listen have heard the last verdict."""
        self._publisher.wait_for_all_acked(Duration(seconds=1))
        if self._lines is not None:
            self._guard(self._lines.close)

    def _line(self, line: str) -> None:
        self._publisher.publish(String(data=line))
        if self._lines is not None:
            self._guard(self._lines.write, f"{line}\n")
            self._guard(self._lines.flush)

    def _guard(self, write: Any, *arguments: Any) -> None:
        """A full disk is reported; it does not end the run."""
        try:
            write(*arguments)
        except OSError as error:
            self._node.get_logger().error(f"a report cannot be written: {error}")


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


def _opened(path: Path | None) -> TextIO | None:
    """The file at `path`, to be appended to."""
    try:
        return None if path is None else path.open("a", encoding="utf-8")
    except OSError as error:
        raise UnusableError(f"jsonl is {str(path)!r}: {error.strerror}") from error
