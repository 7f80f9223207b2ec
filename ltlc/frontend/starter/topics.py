"""The topics of a robot with their types: as `ros2 topic list -t` lists them, or as a recording has them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import field
from pathlib import Path

from ltlc.dataclass import dataclass
from ltlc.inputs.messages.texts import comments_in
from ltlc.inputs.recordings import open_recording
from ltlc.inputs.recordings.bags import BagRecording
from ltlc.inputs.recordings.bags.plan import absolute

SILENT = "no message on it was recorded"

_LINE = re.compile(r"(\S+) \[([\w/]+(?:, [\w/]+)*)\]", re.ASCII)


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic, and the full name of its type; of several types all names, with commas.

    If nothing can be said of it, `omitted` is the reason. A column of a table that is omitted has no type.
    In a table, only some `fields` of a message may be there; of none, all are. `comments` are those of a definition, by
    message and field.
    """

    name: str
    type: str
    omitted: str = ""
    fields: frozenset[str] = frozenset()
    comments: Mapping[tuple[str, str], str] = field(default_factory=dict, hash=False, compare=False)

    def __str__(self) -> str:
        return f"{self.name} [{self.type}]" if self.type else f"column `{self.name}`"


class MalformedLineError(Exception):
    """A line of a list of topics is not a topic with a type."""

    def __init__(self, number: int, line: str) -> None:
        form = "`/scan [sensor_msgs/msg/LaserScan]`, as `ros2 topic list -t` writes it"
        super().__init__(f"line {number} of the topics is {line!r}, not of the form {form}")


def listed(text: str) -> list[Topic]:
    """The topics in what `ros2 topic list -t` printed; `nav_msgs/Odometry` is `nav_msgs/msg/Odometry`.

    Raises MalformedLineError.
    """
    found = []
    for number, line in enumerate(text.removeprefix("\ufeff").splitlines(), 1):
        match = _LINE.fullmatch(line.strip())
        if match is None and line.strip():
            raise MalformedLineError(number, line.strip())
        found += [Topic(match[1], _full(match[2]))] if match else []
    return list(dict.fromkeys(found))


def _full(name: str) -> str:
    """The name of a message type, as ROS 2 has it; in ROS 1 it has two parts."""
    return name.replace("/", "/msg/") if name.count("/") == 1 else name


def recorded(path: Path) -> list[Topic]:
    """The topics of the bag at `path`, in the order of their names. Raises RecordingError."""
    recording = open_recording(path, {})
    assert isinstance(recording, BagRecording), path
    return [
        Topic(
            absolute(name),
            of.type,
            SILENT if of.count == 0 else "",
            comments=comments_in(of.type, of.form, of.definition),
        )
        for name, of in sorted(recording.topics.items())
    ]
