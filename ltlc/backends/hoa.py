"""Monitors in the Hanoi omega-automata format, version 1 (Babiak and others 2015), one automaton for each property.

An automaton accepts the infinite runs without a violation: every state accepts but that of the verdict `violated`. The
verdict of each state is its label; the conditions behind the atomic propositions are their names.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ltlc.backends.guards import Cube, TooManyCubesError, cubes
from ltlc.base.revision import version_text
from ltlc.compiler import Compiled
from ltlc.semantics.monitor import Monitor, Target
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.specification import Specification


def emit(compiled: Sequence[Compiled], specification: Specification) -> str:
    """The automata, one after the other."""
    return "".join(f"{line}\n" for c in compiled for line in _automaton(c, specification))


def _automaton(compiled: Compiled, specification: Specification) -> Iterator[str]:
    monitor, property_ = compiled.monitor, compiled.specification
    yield "HOA: v1"
    yield f"name: {_quoted(f'{property_.label}: {property_.text}')}"
    yield f"tool: {_quoted('ltlc')} {_quoted(version_text())}"
    yield f"ltlc-source: {_quoted(f'{specification.source.name}:{property_.line}')}"
    yield f"ltlc-sha256: {_quoted(specification.source.sha256)}"
    yield f"ltlc-encoding: {_quoted(compiled.encoding.name)}"
    yield f"States: {len(monitor.verdicts)}"
    yield "Start: 0"
    yield " ".join([f"AP: {len(monitor.atoms)}", *map(_quoted, monitor.atoms)])
    labels, aliases = _labels(monitor)
    yield from aliases
    yield "acc-name: Buchi"
    yield "Acceptance: 1 Inf(0)"
    yield "properties: trans-labels explicit-labels state-acc complete deterministic"
    yield "--BODY--"
    for state, verdict in enumerate(monitor.verdicts):
        mark = "" if verdict is Verdict.VIOLATED else " {0}"
        yield f"State: {state} {_quoted(verdict.value)}{mark}"
        for target, label in labels[state].items():
            yield f"[{label}] {target}"
    yield "--END--"


def _labels(monitor: Monitor) -> tuple[list[dict[int, str]], list[str]]:
    """For each state, where a step leads and at which letters; and the aliases that these labels are written with."""
    states = range(len(monitor.verdicts))
    try:
        found = [cubes(monitor, state) for state in states]
    except TooManyCubesError:
        return _aliased(monitor)
    return [{target: " | ".join(map(_cube, letters)) for target, letters in edges.items()} for edges in found], []


def _aliased(monitor: Monitor) -> tuple[list[dict[int, str]], list[str]]:
    """Labels in which each decision is an alias for each state that it can lead to: no longer than the monitor."""
    leads: dict[Target, dict[int, str]] = {state: {state: "t"} for state in range(len(monitor.verdicts))}
    aliases = []
    for number, (atom, low, high) in sorted(enumerate(monitor.decisions), key=lambda item: -item[1].atom):
        leads[~number] = {}
        for target in sorted({*leads[low], *leads[high]}):
            otherwise, then = leads[low].get(target, "f"), leads[high].get(target, "f")
            name = f"@d{number}q{target}"
            aliases.append(f"Alias: {name} !{atom} & {otherwise} | {atom} & {then}")
            leads[~number][target] = name
    return [leads[edge] for edge in monitor.edges], aliases


def _cube(cube: Cube) -> str:
    """The conjunction of the literals."""
    return " & ".join(f"{'' if value else '!'}{atom}" for atom, value in cube) or "t"


def _quoted(text: str) -> str:
    """A string of the format: in double quotes, which a backslash escapes; anything else stands for itself."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
