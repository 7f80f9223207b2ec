"""ROS 2 packages for `colcon build` and `colcon test`, with the node of the `ros2` target split into modules.

What the properties say is one module that a person can review; the runtime and the part that speaks ROS are modules
beside it, the same in every package of one version of ltlc.
"""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Sequence
from pathlib import PurePath
from typing import Any

from ltlc.backends.ament.metadata import Metadata
from ltlc.backends.names import Names, variable
from ltlc.backends.ros2 import context, node, node_name
from ltlc.backends.ros2.inline import Import, import_lines, module_text
from ltlc.backends.ros2.readers import read_topics
from ltlc.backends.templates import template
from ltlc.compiler import Compiled
from ltlc.program.guards import GuardProgram
from ltlc.runtime import MODULES
from ltlc.specification.guards import Guard
from ltlc.specification.specification import Specification

OWN_NAMES = frozenset({"INFINITY", "PROVENANCE", "topics_to_guard", "topics_to_read"})
"""Names of the module of the properties; those made from a specification must not hide them."""

ROS_PACKAGES = ("diagnostic_msgs", "rcl_interfaces", "rclpy", "std_msgs")
"""What the node needs, whatever it reads."""


def package_name(stem: str) -> str:
    """The name of the package for the file `STEM.txt`: lower case, as ROS wants it."""
    return node_name(stem).lower()


def emit(
    compiled: Sequence[Compiled],
    specification: Specification,
    runs: Sequence[Any],
    metadata: Metadata,
    guards: Sequence[GuardProgram] = (),
) -> dict[str, str]:
    """The files of the package, by their paths in it.

    `runs` are those on which the gate judged each property, as data of JSON; `metadata` is what the package says of
    itself. Raises NotInTargetError.
    """
    stem = PurePath(specification.source.name).stem
    package = package_name(stem)
    topics = read_topics(compiled)
    guarded = _guarded(specification.guards)
    namespaced = {t.name for t in topics if t.name.startswith("/")}.difference(topic for _, topic, _ in guarded)
    messages = sorted({topic.message.split("/")[0] for topic in topics})
    told = context(compiled, specification, OWN_NAMES, guards)
    has_numbers = "INFINITY" in told["plan"]
    code = "\n".join(
        [told["plan"], *told["readers"], told["topics_to_read"], told["topics_to_guard"], "Any", "math" * has_numbers]
    )
    about = told | {
        "package": package,
        "node": node_name(stem),
        "topics": [topic.name for topic in topics if topic.name in namespaced],
        "guarded": guarded,
        "packages": sorted({*ROS_PACKAGES, *messages}),
        "metadata": metadata,
        "has_numbers": has_numbers,
        "imports": _imports(code, package),
    }
    files = {target: template(__name__, name).render(about) for name, target in _templates(package).items()}
    files |= {f"{package}/{room}/__init__.py": f'"""{title}"""\n' for room, title in _ROOMS.items()}
    files |= {
        f"{package}/{'/'.join(_place(module))}.py": _module(module, package) for module in (*MODULES, *node.MODULES)
    }
    return files | {
        f"resource/{package}": "",
        "properties.txt": specification.source.text,
        "test/runs.json": _lines_of(runs),
    }


_ROOMS = {"runtime": "Stepping monitors over samples.", "ros": "The ROS 2 side of the node."}


def _templates(package: str) -> dict[str, str]:
    """The templates, and what is made of each."""
    return {
        "package.xml.jinja": "package.xml",
        "setup.py.jinja": "setup.py",
        "setup.cfg.jinja": "setup.cfg",
        "README.md.jinja": "README.md",
        "init.py.jinja": f"{package}/__init__.py",
        "node.py.jinja": f"{package}/node.py",
        "properties.py.jinja": f"{package}/properties.py",
        "launch.xml.jinja": f"launch/{package}.launch.xml",
        "two_robots.launch.xml.jinja": "launch/two_robots.launch.xml",
        "parameters.yaml.jinja": f"config/{package}.yaml",
        "test.py.jinja": f"test/test_{package}.py",
        "recordings.md.jinja": "test/recordings/README.md",
    }


def _guarded(guards: Sequence[Guard]) -> list[tuple[str, str, str]]:
    """The arguments of a launch file for the topics of guards: a name, the topic, and what it is."""
    names = Names(frozenset({"robot", "parameters", "use_sim_time"}))
    topics = [pair for guard in guards for pair in ((guard.raw, "come in"), (guard.out, "leave"))]
    return [(names.unique(variable(topic)), topic, what) for topic, what in topics]


def _lines_of(runs: Sequence[Sequence[Any]]) -> str:
    """The runs of each property as JSON, a run a line."""
    of_each = (",\n".join(json.dumps(run, allow_nan=False) for run in of_one) for of_one in runs)
    return "[\n" + ",\n".join(f"[\n{lines}\n]" for lines in of_each) + "\n]\n"


def _imports(code: str, package: str) -> list[list[str]]:
    """What `code` uses of the standard library, and of the package, as import statements."""
    used = {node.id for node in ast.walk(ast.parse(code)) if isinstance(node, ast.Name)}
    standard = {wanted for wanted in _STANDARD if wanted.bound in used}
    own = {Import(_dotted(m, package), name) for m in (*MODULES, TOPICS) for name in used & _defined(m)}
    return [import_lines(standard), import_lines(own)]


_STANDARD = (
    Import("math"),
    Import("collections.abc", "Iterable"),
    Import("collections.abc", "Sequence"),
    Import("typing", "Any"),
)
"""What generated code may use of the standard library."""

TOPICS = "ltlc.backends.ros2.node.topics"
"""The module of the node that generated code needs."""


def _defined(module: str) -> set[str]:
    """The names that a module gives its own functions, classes and constants."""
    found: set[str] = set()
    for statement in ast.parse(module_text(module)).body:
        match statement:
            case ast.FunctionDef(name) | ast.ClassDef(name):
                found.add(name)
            case ast.Assign(targets):
                found |= {target.id for target in targets if isinstance(target, ast.Name)}
            case _:
                pass
    return found


def _place(module: str) -> tuple[str, str]:
    """The room of the package that a module of ltlc goes to, and its name there."""
    return "ros" if module in node.MODULES else "runtime", module.rpartition(".")[2]


def _dotted(module: str, package: str) -> str:
    """What a module of ltlc is called in the package."""
    return ".".join((package, *_place(module)))


def _module(module: str, package: str) -> str:
    """The text of a module of ltlc, as one of the package."""
    return re.sub(
        r"(?m)^from (ltlc[\w.]+) import", lambda m: f"from {_dotted(m[1], package)} import", module_text(module)
    )
