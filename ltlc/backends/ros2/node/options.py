"""The parameters of the node, checked when it starts."""

from __future__ import annotations

import difflib
import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node

from ltlc.backends.ros2.node.files import UnusableError
from ltlc.runtime.session import Plan
from ltlc.runtime.times import seconds


@dataclass(frozen=True, slots=True)
class Options:
    """What the node was asked to do; `rate` in Hz and `timeout` in s, None for none."""

    rate: float | None
    timeout: float | None
    ends_on_violation: bool
    jsonl: Path | None
    junit: Path | None
    record: Path | None


DESCRIPTIONS = {
    "rate": "steps per second; 0: a step at each message",
    "timeout": "the run ends this many seconds after its first step; 0: it does not",
    "on_violation": "'continue' or 'end'",
    "jsonl": "a file to append changes of verdict to, one JSON object per line",
    "junit": "a file to write the final verdicts to, as JUnit XML",
    "record": "a file to record the judged messages in, for `ltlc run`",
}
"""The parameters; all are read when the node starts, and only then."""

STANDARD = {"use_sim_time", "start_type_description_service"}
"""Parameters that every node has."""


def read_options(node: Node, plan: Plan) -> Options:
    """The parameters of `node`; what is not given is as the property file says."""
    _refuse_unknown(node)
    defaults: dict[str, float | str] = {
        "rate": plan.rate or 0.0,
        "timeout": seconds(plan.timeout or 0),
        "on_violation": "continue",
        "jsonl": "",
        "junit": "",
        "record": "",
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
    )


def _refuse_unknown(node: Node) -> None:
    """One that is misspelt is refused; a file for all nodes may set others, too."""
    given = node.get_parameters_by_prefix("")
    known = STANDARD | DESCRIPTIONS.keys()
    for name in given:
        if name in known or name.startswith("qos_overrides"):
            continue
        complaint = (
            f"no parameter is called {name}; there are {', '.join(DESCRIPTIONS)}"
        )
        if difflib.get_close_matches(name, DESCRIPTIONS, cutoff=0.8):
            raise UnusableError(complaint)
        node.get_logger().warning(f"{complaint}; it is assumed to be for another node")
    if not isinstance(given["use_sim_time"].value, bool):
        value = given["use_sim_time"].value
        raise UnusableError(f"use_sim_time is {value!r}: it must be true or false")


def _declared(node: Node, name: str, default: float | str) -> Any:
    """The value of a parameter, which nobody can change from now on."""
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
