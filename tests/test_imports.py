"""Imports of ltlc go one way: from what is told later in the chain to what is told earlier."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable, Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[1]

ORDER = {
    "dataclass": ["dataclass"],
    "semantics": ["semantics"],
    "base": [
        "base",
        "base.source",
        "base.diagnostics",
        "base.codes",
        "base.nearest",
        "base.fixes",
        "base.files",
        "base.limits",
        "base.render",
        "base.errors",
    ],
    "specification": ["specification"],
    "runtime": ["runtime"],
    "inputs": ["inputs", "inputs.messages", "inputs.recordings"],
    "frontend": ["frontend", "frontend.syntax", "frontend.language", "frontend.layout", "frontend.starter"],
    "rules": ["rules"],
    "automata": ["automata"],
    "program": ["program"],
    "compiler": ["compiler"],
    "backends": ["backends"],
    "assurance": ["assurance"],
    "monitoring": [
        "monitoring",
        "monitoring.columns",
        "monitoring.judging",
        "monitoring.campaigns",
        "monitoring.matrix",
        "monitoring.mining",
        "monitoring.measuring",
    ],
    "analysis": ["analysis", "analysis.comparison"],
    "importing": ["importing"],
    "falsification": ["falsification"],
    "interfaces": [
        "interfaces",
        *(
            "interfaces.building",
            "interfaces.pages",
            "interfaces.api",
            "interfaces.editor",
            "interfaces.serve",
            "interfaces.commands",
            "cli",
            "pytest_plugin",
        ),
        *("__init__", "__main__"),
    ],
}
"""The rooms of ltlc, folders and modules, in groups: each imports rooms of its own group and of those before it.

The runtime stands below whatever emits it, and recordings below the language, which asks bags for their messages.
"""

ROOMS = [room for rooms in ORDER.values() for room in rooms]

Arrow = tuple[str, str]
"""A room, and one that it imports."""


def imported(tree: ast.AST) -> Iterator[str]:
    """The modules that a file imports anywhere in it, and names of other modules; the version is everybody's."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names if alias.name != "__version__")


def room_of(module: str) -> str:
    """The room that a module of ltlc is in, or a name in one; `__init__` is the front door."""
    parts = module.split(".")[1:]
    prefixes = (".".join(parts[:end]) for end in range(len(parts), 0, -1))
    return next((prefix for prefix in prefixes if prefix in ROOMS), "__init__")


@cache
def arrows() -> dict[Arrow, list[str]]:
    """Which rooms import which others, with the files in which they do."""
    found: dict[Arrow, list[str]] = {}
    for path in sorted((PROJECT / "ltlc").rglob("*.py")):
        name = path.relative_to(PROJECT)
        importer = room_of(".".join(name.with_suffix("").parts))
        for module in imported(ast.parse(path.read_bytes())):
            if module.split(".")[0] == "ltlc" and (other := room_of(module)) != importer:
                found.setdefault((importer, other), []).append(str(name))
    return found


def upward(found: Iterable[Arrow]) -> list[Arrow]:
    """Those arrows that lead to a later group."""
    groups = {room: number for number, rooms in enumerate(ORDER.values()) for room in rooms}
    return [(room, other) for room, other in found if groups[room] < groups[other]]


def circle(found: Collection[Arrow]) -> list[str]:
    """Rooms each of which imports the next, and the last the first; empty if there are none."""
    graph = TopologicalSorter({room: [b for a, b in found if a == room] for room, _ in found})
    try:
        graph.prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_every_room_has_its_place_in_the_order() -> None:
    files = (each.relative_to(PROJECT).with_suffix("") for each in (PROJECT / "ltlc").rglob("*.py"))
    modules = {".".join(each.parts) for each in files}
    assert {module for module in modules if room_of(module) == "__init__"} == {"ltlc.__init__"}
    assert {room_of(module) for module in modules} == set(ROOMS)


def test_imports_go_one_way() -> None:
    assert {arrow: arrows()[arrow] for arrow in upward(arrows())} == {}


def test_no_rooms_import_one_another_in_a_circle() -> None:
    assert circle(arrows()) == []


@pytest.mark.parametrize(
    ("text", "modules"),
    [
        ("from ltlc.cli import main, other", ["ltlc.cli.main", "ltlc.cli.other"]),
        ("from ltlc import cli", ["ltlc.cli"]),
        ("def f():\n    import ltlc.cli", ["ltlc.cli"]),
        ("from ltlc import __version__, cli", ["ltlc.cli"]),
    ],
)
def test_an_import_is_seen_wherever_it_stands(text: str, modules: list[str]) -> None:
    assert list(imported(ast.parse(text))) == modules


def test_an_arrow_up_and_a_circle_are_noticed() -> None:
    assert upward([("cli", "semantics"), ("semantics", "cli"), ("cli", "pytest_plugin")]) == [("semantics", "cli")]
    assert set(circle([("one", "two"), ("two", "three"), ("three", "one")])) == {"one", "two", "three"}
