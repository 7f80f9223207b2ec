"""Pictures of monitors (SVG) and formulas (LaTeX), for notebooks; nothing but the standard library is needed."""

from __future__ import annotations

import math
import re
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from html import escape

from ltlc.comparison.measure import successors
from ltlc.semantics.ltl import TRUE, Atom, Formula, Not, conjunction, disjunction
from ltlc.semantics.monitor import Monitor, Target
from ltlc.semantics.verdicts import Verdict

COLUMN, ROW, RADIUS, MARGIN = 190, 130, 24, 60
"""Distances in the picture, in pixels."""

LONGEST_LABEL = 26
"""A longer guard is cut off; the whole is shown where the mouse rests."""

COLOURS = {
    Verdict.VIOLATED: "#e6675f",
    Verdict.PRESUMABLY_VIOLATED: "#f5c6a5",
    Verdict.PRESUMABLY_SATISFIED: "#cfe8c6",
    Verdict.SATISFIED: "#7dbb6e",
}


@dataclass(frozen=True, slots=True)
class _Point:
    x: float
    y: float


def monitor_svg(monitor: Monitor) -> str:
    """`monitor` as a picture: states in columns by their distance from the first, coloured by verdict."""
    places = _places(monitor)
    width = max(place.x for place in places) + MARGIN + RADIUS
    height = max(place.y for place in places) + MARGIN + 30
    edges = [_edge(monitor, places, q, r) for q in range(len(places)) for r in successors(monitor, q)]
    states = [_state(q, places[q], verdict) for q, verdict in enumerate(monitor.verdicts)]
    size = f'width="{width:.0f}" height="{height:.0f}" viewBox="0 0 {width:.0f} {height:.0f}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif" font-size="11">{_ARROW}' + (
        "".join([_START, *edges, *states]) + "</svg>"
    )


_ARROW = (
    '<defs><marker id="arrow" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" markerHeight="8" orient="auto">'
    '<path d="M0,0 L8,4 L0,8 z"/></marker></defs>'
)
_START = (
    f'<line x1="{MARGIN - RADIUS - 28}" y1="{MARGIN + 20}" x2="{MARGIN - RADIUS}" y2="{MARGIN + 20}" '
    'stroke="black" marker-end="url(#arrow)"/>'
)


def _places(monitor: Monitor) -> list[_Point]:
    """Where each state stands."""
    distance = {0: 0}
    waiting = deque([0])
    while waiting:
        state = waiting.popleft()
        for successor in successors(monitor, state):
            if successor not in distance:
                distance[successor] = distance[state] + 1
                waiting.append(successor)
    filled: dict[int, int] = {}
    places = []
    for state in range(len(monitor.verdicts)):
        column = distance.get(state, 0)
        row = filled.get(column, 0)
        filled[column] = row + 1
        places.append(_Point(MARGIN + column * COLUMN, MARGIN + 20 + row * ROW))
    return places


def _state(number: int, place: _Point, verdict: Verdict) -> str:
    colour = COLOURS.get(verdict, "white")
    name = verdict.value.replace("_", " ")
    width = 3 if verdict.is_permanent else 1
    return (
        f'<g><title>{name}</title><circle cx="{place.x:.0f}" cy="{place.y:.0f}" r="{RADIUS}" fill="{colour}" '
        f'stroke="black" stroke-width="{width}"/><text x="{place.x:.0f}" y="{place.y + 4:.0f}" '
        f'text-anchor="middle">{number}</text><text x="{place.x:.0f}" y="{place.y + RADIUS + 13:.0f}" '
        f'text-anchor="middle" font-size="9">{name}</text></g>'
    )


def _edge(monitor: Monitor, places: list[_Point], source: int, target: int) -> str:
    letters = guard(monitor, source, target)
    label = "any" if letters == TRUE else str(letters)
    start, end = places[source], places[target]
    path, at = _loop(start) if source == target else _arc(start, end)
    return (
        f'<g><title>{source} → {target}: {escape(label)}</title><path d="{path}" fill="none" stroke="black" '
        f'marker-end="url(#arrow)"/><text x="{at.x:.0f}" y="{at.y:.0f}" text-anchor="middle" '
        f'paint-order="stroke" stroke="white" stroke-width="3">{escape(_cut(label))}</text></g>'
    )


def _loop(place: _Point) -> tuple[str, _Point]:
    """An arc over a state, and where its label stands."""
    x, top = place.x, place.y - RADIUS
    path = (
        f"M{x - 9:.0f},{top + 3:.0f} C{x - 26:.0f},{top - 30:.0f} {x + 26:.0f},{top - 30:.0f} {x + 9:.0f},{top + 3:.0f}"
    )
    return path, _Point(x, top - 26)


def _arc(start: _Point, end: _Point) -> tuple[str, _Point]:
    """A bow to the left of the straight way, so that ways there and back do not meet, and where its label stands."""
    length = math.hypot(end.x - start.x, end.y - start.y)
    along = _Point((end.x - start.x) / length, (end.y - start.y) / length)
    bow = 18 + 0.12 * length
    middle = _Point((start.x + end.x) / 2 + along.y * bow, (start.y + end.y) / 2 - along.x * bow)
    first, last = _rim(start, middle), _rim(end, middle)
    path = f"M{first.x:.1f},{first.y:.1f} Q{middle.x:.1f},{middle.y:.1f} {last.x:.1f},{last.y:.1f}"
    return path, _Point((start.x + 2 * middle.x + end.x) / 4, (start.y + 2 * middle.y + end.y) / 4 - 5)


def _rim(place: _Point, towards: _Point) -> _Point:
    """The point of a state's circle that looks at `towards`."""
    length = math.hypot(towards.x - place.x, towards.y - place.y)
    return _Point(
        place.x + RADIUS * (towards.x - place.x) / length,
        place.y + RADIUS * (towards.y - place.y) / length,
    )


def _cut(label: str) -> str:
    return label if len(label) <= LONGEST_LABEL else label[: LONGEST_LABEL - 1] + "…"


def guard(monitor: Monitor, source: int, target: int) -> Formula:
    """The letters that lead from `source` to `target`, as a disjunction of the ways there."""
    return disjunction(_ways(monitor, monitor.edges[source], target, ()))


def _ways(monitor: Monitor, at: Target, target: int, answers: tuple[Formula, ...]) -> Iterator[Formula]:
    if at >= 0:
        if at == target:
            yield conjunction(answers)
        return
    decision = monitor.decisions[~at]
    atom = Atom(monitor.atoms[decision.atom])
    yield from _ways(monitor, decision.high, target, (*answers, atom))
    yield from _ways(monitor, decision.low, target, (*answers, Not(atom)))


_LATEX = {
    "&": r"\wedge ",
    "|": r"\vee ",
    "->": r"\rightarrow ",
    "!": r"\neg ",
    "1": r"\top ",
    "0": r"\bot ",
    "X[!]": r"\mathsf{X}^{!}\,",
    **{operator: rf"\mathbin{{\mathsf{{{operator}}}}}" for operator in "UWRM"},
    **{operator: rf"\mathsf{{{operator}}}\," for operator in "GFX"},
}

_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|X\[!\]|->|[a-z_][a-z0-9_]*|\S')


def formula_latex(formula: Formula) -> str:
    """`formula` for a page that shows LaTeX."""
    return "$" + "".join(map(_latex, _TOKEN.findall(str(formula)))) + "$"


def _latex(token: str) -> str:
    if token in _LATEX:
        return _LATEX[token]
    if token in "()":
        return token
    name = re.sub(r"([\\{}_^#&$%~])", lambda match: _ESCAPES.get(match[0], "\\" + match[0]), token.strip('"'))
    return rf"\text{{{name}}}"


_ESCAPES = {"\\": r"\backslash ", "^": r"\^{}", "~": r"\~{}"}
