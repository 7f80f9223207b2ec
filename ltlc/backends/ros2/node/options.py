"""The parameters of the node, checked when it starts."""

from __future__ import annotations

import difflib
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node

from ltlc.backends.ros2.node.files import UnusableError
from ltlc.runtime.session import Plan
from ltlc.runtime.times import duration, seconds


@dataclass(frozen=True, slots=True)
class CutOptions:
    """What is written of each violation: topics, if named, and times around it in ns.

    What is kept for that takes at most so many bytes.
    """

    folder: Path
    topics: tuple[str, ...]
    before: int
    after: int
    most: int


@dataclass(frozen=True, slots=True)
class Options:
    """What the node was asked to do; `rate` in Hz and `timeout` in s, None for none."""

    rate: float | None
    timeout: float | None
    ends_on_violation: bool
    jsonl: Path | None
    junit: Path | None
    record: Path | None
    cut: CutOptions | None
    snapshot: str


DESCRIPTIONS = {
    "rate": "steps per second; 0: a step at each message",
    "timeout": "the run ends this many seconds after its first step; 0: it does not",
    "on_violation": "'continue' or 'end'",
    "jsonl": "a file to append changes of verdict to, one JSON object per line",
    "junit": "a file to write the final verdicts to, as JUnit XML",
    "record": "a file to record the judged messages in, for `ltlc run`",
    "cut": "a folder to write what came around each violation to, as MCAP",
    "cut_topics": "the topics to write; none: those that the properties read",
    "cut_before": "how many seconds before the violation to write",
    "cut_after": "how many seconds after the violation to write",
    "cut_mb": "how many megabytes of messages to keep in memory for that",
    "snapshot": "a service of rosbag2 to call at each violation",
}
"""The parameters; all are read when the node starts, and only then."""

STANDARD = {"use_sim_time", "start_type_description_service"}
"""Parameters that every node has."""


def read_options(node: Node, plan: Plan) -> Options:
    """The parameters of `node`; what is not given is as the property file says."""
    _refuse_unknown(node)
    defaults: dict[str, float | str | list[str]] = {
        "rate": plan.rate or 0.0,
        "timeout": seconds(plan.timeout or 0),
        "on_violation": "continue",
        "jsonl": "",
        "junit": "",
        "record": "",
        "cut": "",
        "cut_topics": [""],
        "cut_before": 5.0,
        "cut_after": 2.0,
        "cut_mb": 100.0,
        "snapshot": "",
    }
    values = {n: _declared(node, n, default) for n, default in defaults.items()}
    if values["on_violation"] not in ("continue", "end"):
        value = values["on_violation"]
        raise UnusableError(
            f"on_violation is {value!r}: it must be 'continue' or 'end'"
        )
    return Options(
        rate=_number("rate", values["rate"]),
        timeout=_number("timeout", values["timeout"]),
        ends_on_violation=values["on_violation"] == "end",
        jsonl=_path("jsonl", values["jsonl"]),
        junit=_path("junit", values["junit"]),
        record=_path("record", values["record"]),
        cut=_cut(values),
        snapshot=_name_in("snapshot", values["snapshot"]),
    )


def _cut(values: Mapping[str, Any]) -> CutOptions | None:
    before, after, megabytes = (
        _number(name, values[name]) or 0.0
        for name in ("cut_before", "cut_after", "cut_mb")
    )
    topics = values["cut_topics"]
    given = topics if isinstance(topics, list) else [topics]
    names = tuple(_name_in("cut_topics", name) for name in given if name != "")
    folder = _folder("cut", values["cut"])
    if folder is None:
        return None
    most = int(megabytes * 1e6)
    return CutOptions(folder, names, duration(before), duration(after), most)


def _refuse_unknown(node: Node) -> None:
    """One that is misspelt is refused; a file for all nodes may set others, too."""
    given = node.get_parameters_by_prefix("")
    known = STANDARD | DESCRIPTIONS.keys()
    for name in given:
        if name in known or name.startswith("qos_overrides"):
            continue
        unknown = f"no parameter is called {name}"
        there_are = f"there are {', '.join(DESCRIPTIONS)}"
        near = difflib.get_close_matches(name, DESCRIPTIONS, n=1, cutoff=0.8)
        if near:
            raise UnusableError(f"{unknown}; did you mean {near[0]}? {there_are}")
        node.get_logger().warning(
            f"{unknown}; {there_are}; it is assumed to be for another node"
        )
    if not isinstance(given["use_sim_time"].value, bool):
        value = given["use_sim_time"].value
        raise UnusableError(f"use_sim_time is {value!r}: it must be true or false")


def _declared(node: Node, name: str, default: float | str | list[str]) -> Any:
    """The value of a parameter, which cannot be changed from now on."""
    descriptor = ParameterDescriptor(
        description=DESCRIPTIONS[name], read_only=True, dynamic_typing=True
    )
    if node.has_parameter(name):
        node.set_descriptor(name, descriptor)
        return node.get_parameter(name).value
    return node.declare_parameter(name, default, descriptor).value


def _number(name: str, value: Any) -> float | None:
    """A finite number that is not negative; None for 0."""
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not is_number or not math.isfinite(value) or value < 0:
        raise UnusableError(
            f"{name} is {value!r}: it must be a number that is not negative"
        )
    return float(value) or None


def _name_in(name: str, value: Any) -> str:
    """A name, or nothing."""
    if not isinstance(value, str):
        raise UnusableError(f"{name} is {value!r}: it must be a name")
    return value


def _folder(name: str, value: Any) -> Path | None:
    """A folder that files can be written to, once it is made; None for none."""
    if not _name_in(name, value):
        return None
    path = Path(value).expanduser().absolute()
    there = next(each for each in (path, *path.parents) if each.exists())
    if not there.is_dir():
        raise UnusableError(f"{name} is {value!r}: {there} is not a folder")
    if not os.access(there, os.W_OK):
        raise UnusableError(f"{name} is {value!r}: {there} is not writable")
    return path


def _path(name: str, value: Any) -> Path | None:
    """A file that can be written; None for no file."""
    if not isinstance(value, str):
        raise UnusableError(f"{name} is {value!r}: it must be the name of a file")
    if not value:
        return None
    path = Path(value).expanduser().absolute()
    if path.is_dir():
        raise UnusableError(f"{name} is {value!r}, which is a folder")
    if not os.access(path.parent, os.W_OK):
        raise UnusableError(f"{name} is {value!r}: its folder is not writable")
    return path
