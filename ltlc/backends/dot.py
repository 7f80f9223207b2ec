"""Monitors as graphs for Graphviz, one cluster for each property, coloured by verdict."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ltlc.backends.guards import Cube, TooManyCubesError, cubes
from ltlc.compiler import Compiled
from ltlc.semantics.monitor import Monitor, below
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.specification import Specification

_COLOURS = {
    Verdict.VIOLATED: "#f4a6a0",
    Verdict.PRESUMABLY_VIOLATED: "#fbe3b0",
    Verdict.PRESUMABLY_SATISFIED: "#dcefd6",
    Verdict.SATISFIED: "#9fd49a",
}


def emit(compiled: Sequence[Compiled], specification: Specification) -> str:
    """One graph; where the letters are too many to be listed, an edge says so with dots."""
    lines = [
        "digraph monitors {",
        "  rankdir=LR;",
        '  node [shape=box, style="rounded,filled", fontname="sans-serif"];',
        '  edge [fontname="sans-serif", fontsize=10];',
        f"  label={_quoted(specification.source.name)};",
    ]
    for number, each in enumerate(compiled):
        lines += ["", *_cluster(number, each)]
    return "".join(f"{line}\n" for line in [*lines, "}"])


def _cluster(number: int, compiled: Compiled) -> Iterator[str]:
    monitor, property_ = compiled.monitor, compiled.specification
    yield f"  subgraph cluster_{number} {{"
    yield f"    label={_quoted(f'{property_.label}: {property_.text}')};"
    yield f'    start_{number} [shape=point, label=""];'
    yield f"    start_{number} -> p{number}_0;"
    for state, verdict in enumerate(monitor.verdicts):
        label = _quoted(f"{state}\n{verdict.value.replace('_', ' ')}")
        yield f'    p{number}_{state} [label={label}, fillcolor="{_COLOURS[verdict]}"];'
    for state in range(len(monitor.verdicts)):
        for target, label in _edges(monitor, state):
            yield f"    p{number}_{state} -> p{number}_{target} [label={_quoted(label)}];"
    yield "  }"


def _edges(monitor: Monitor, state: int) -> Iterator[tuple[int, str]]:
    """The states that a step from `state` can lead to, and when."""
    try:
        found = cubes(monitor, state)
    except TooManyCubesError:
        for target in sorted(below(monitor.decisions, [monitor.edges[state]])):
            if target >= 0:
                yield target, "…"
        return
    for target, letters in found.items():
        yield target, "\nor ".join(_cube(monitor, cube) for cube in letters)


def _cube(monitor: Monitor, cube: Cube) -> str:
    literals = (monitor.atoms[atom] if value else f"not {monitor.atoms[atom]}" for atom, value in cube)
    return " and ".join(literals) or "always"


def _quoted(text: str) -> str:
    """A string of the DOT language; line breaks become its own, backslashes stand for themselves."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\r", "\\r")
    return f'"{escaped}"'
