"""ROS 2 nodes: one Python file that needs rclpy, the messages it reads and the standard library, nothing of ltlc."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import PurePath
from typing import Any

from ltlc import __version__
from ltlc.backends.inputs import require_topics
from ltlc.backends.python import overview
from ltlc.backends.python.code import literal
from ltlc.backends.python.plan import plan_code
from ltlc.backends.ros2 import node
from ltlc.backends.ros2.guarded import guarded_code
from ltlc.backends.ros2.inline import Import, inline
from ltlc.backends.ros2.readers import read_topics, topics_code
from ltlc.backends.templates import template
from ltlc.backends.trees import prose
from ltlc.base.provenance import provenance
from ltlc.compiler import Compiled
from ltlc.program.guards import GuardProgram
from ltlc.runtime import MODULES
from ltlc.specification.specification import MOST_IDS, Specification

OWN_NAMES = frozenset({"INFINITY", "PROVENANCE", "main", "monitor", "import_ros", "topics_to_guard", "topics_to_read"})
"""Names of the template; those made from a specification must not hide them."""


def emit(compiled: Sequence[Compiled], specification: Specification, guards: Sequence[GuardProgram] = ()) -> str:
    """A ROS 2 node that monitors the properties `compiled` of `specification`, of which `guards` keep some.

    What it is made of, in the order of the file: the monitors and signals, functions that read the messages of each
    topic, and what is the same in every node: the runtime, and the part that speaks ROS. Raises NotInTargetError.
    """
    require_topics(compiled)
    program = inline([*MODULES, *node.MODULES], [Import("sys"), Import("math")])
    name = literal(node_name(PurePath(specification.source.name).stem))
    told = context(compiled, specification, program.names | OWN_NAMES, guards)
    return template(__name__, "template.py.jinja").render(told, name=name, program=program)


def context(
    compiled: Sequence[Compiled],
    specification: Specification,
    taken: frozenset[str],
    guards: Sequence[GuardProgram] = (),
) -> dict[str, Any]:
    """The parts of a node about its properties: monitors, and readers of messages, with no name in `taken`."""
    readers, topics = topics_code(read_topics(compiled), taken)
    source = replace(specification.source, name=PurePath(specification.source.name).name)
    return {
        "source": prose(source.name),
        "version": __version__,
        "overview": [line for c in compiled for line in overview(c)],
        "usage": template(__name__, "usage.txt.jinja").render(guards=guards),
        "plan": plan_code(compiled, specification, taken=taken, most_ids=MOST_IDS, guards=guards).rstrip("\n"),
        "readers": readers,
        "topics_to_read": "\n".join(topics),
        "topics_to_guard": "\n".join(guarded_code([guard for each in guards for guard in each.guards])),
        "provenance": _literal(provenance([source])),
    }


def _literal(value: Any, indent: str = "") -> str:
    """A value of JSON as a literal of Python, an item a line."""
    inner = f"{indent}    "
    match value:
        case dict():
            items = [f"{literal(key)}: {_literal(each, inner)}" for key, each in value.items()]
            brackets = "{}"
        case list():
            items, brackets = [_literal(each, inner) for each in value], "[]"
        case str():
            return literal(value)
        case _:
            return repr(value)
    lines = "".join(f"{inner}{item},\n" for item in items)
    return f"{brackets[0]}\n{lines}{indent}{brackets[1]}" if lines else brackets


def node_name(stem: str) -> str:
    """The name of a node for the file `STEM.txt`, as ROS 2 allows it: letters, digits and single underscores."""
    words = re.findall(r"[A-Za-z0-9]+", stem)
    name = "_".join([*words, "monitor"])
    return name if name[0].isalpha() else f"node_{name}"
