"""Monitors as pictures (SVG): states in columns by their distance from the first, and the way that a run took."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from ltlc.semantics.verdicts import Verdict

ROW, RADIUS, MARGIN, GAP = 150, 24, 70, 170
"""Distances in the picture, in pixels: GAP is between two columns, more where labels are long."""

LETTER, LINE = 6, 14
"""About the width of a character of a label, and the height of its lines."""

LONGEST_LINE, MOST_LINES = 34, 3
"""A longer label is cut off; the whole is shown where the mouse rests."""

COLOURS = {
    Verdict.VIOLATED: "#e6675f",
    Verdict.PRESUMABLY_VIOLATED: "#f5c6a5",
    Verdict.PRESUMABLY_SATISFIED: "#cfe8c6",
    Verdict.SATISFIED: "#7dbb6e",
}


@dataclass(frozen=True, slots=True)
class Edge:
    """An edge between states, by their numbers; one that is taken `by_time` is not a step.

    `label` has a line for each way; `taken` says when a run went along it, empty if none did.
    """

    source: int
    target: int
    label: tuple[str, ...]
    by_time: bool = False
    taken: str = ""


@dataclass(frozen=True, slots=True)
class _Point:
    x: float
    y: float


def graph_svg(
    verdicts: Sequence[Verdict], edges: Sequence[Edge], last: int | None = None, name: str = "monitor"
) -> str:
    """States with these verdicts, numbered from 0, the first one the initial; `last` is where a run ended.

    States that no edge leads to are left out. What can be styled has classes. Pictures on one page need different
    names, of letters, digits and `-`: a browser that hides one hides what others have in common with it.
    """
    places = _places(len(verdicts), edges)
    width = max(place.x for place in places.values()) + MARGIN + RADIUS
    height = max(place.y for place in places.values()) + RADIUS + 30
    tip = f'marker-end="url(#{name}-tip)"'
    drawn = [_edge(edge, places, tip) for edge in sorted(edges, key=lambda edge: bool(edge.taken))]
    passed = {state for edge in edges if edge.taken for state in (edge.source, edge.target)}
    states = [_state(q, places[q], verdicts[q], q in passed, q == last) for q in places]
    size = f'width="{width:.0f}" height="{height:.0f}" viewBox="0 0 {width:.0f} {height:.0f}"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {size} class="monitor" font-family="sans-serif" font-size="11">'
    start = places[0]
    arrow = f'<path class="edge" d="M{start.x - RADIUS - 30:.0f},{start.y:.0f} h30" {_STROKE} {tip}/>'
    return "".join([head, _TIP.format(name=name), arrow, *drawn, *states, "</svg>"])


_TIP = (
    '<defs><marker id="{name}-tip" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" markerHeight="8" '
    'markerUnits="userSpaceOnUse" orient="auto"><path class="tip" d="M0,0 L8,4 L0,8 z" fill="context-stroke"/>'
    "</marker></defs>"
)
_STROKE = 'fill="none" stroke="black"'


def _places(count: int, edges: Sequence[Edge]) -> dict[int, _Point]:
    """Where each state that can be reached stands: columns by distance, each in the middle of the height."""
    columns = [[0]]
    seen = {0}
    while columns[-1]:
        near = [edge.target for q in columns[-1] for edge in edges if edge.source == q]
        columns.append([q for q in dict.fromkeys(near) if q not in seen])
        seen |= set(columns[-1])
    highest = max(map(len, columns))
    places, x = {}, MARGIN + LETTER * max(len(line) for edge in edges if edge.source == 0 for line in _lines(edge)) / 4
    for column in columns[:-1]:
        for row, state in enumerate(column):
            places[state] = _Point(x, MARGIN + 20 + ROW * (row + (highest - len(column)) / 2))
        leaving = [edge for edge in edges if edge.source in column or edge.target in column]
        longest = max((len(line) for edge in leaving for line in _lines(edge)), default=0)
        x += max(GAP, 2 * LETTER * longest + 30)
    return places


def _state(number: int, place: _Point, verdict: Verdict, is_passed: bool, is_last: bool) -> str:
    name = verdict.value.replace("_", " ")
    at = f'cx="{place.x:.0f}" cy="{place.y:.0f}"'
    classes = f"state {verdict.value}{' passed' if is_passed else ''}"
    ring = f'<path class="ring" d="{_circle(place, RADIUS + 5)}" fill="none" stroke="black"/>' if is_last else ""
    colour = COLOURS.get(verdict, "white")
    width = 3 if verdict.is_permanent else 1
    below = place.y + RADIUS + (19 if is_last else 14)
    return (
        f'<g class="{classes}"><title>state {number}: {name}</title>{ring}<circle {at} r="{RADIUS}" fill="{colour}" '
        f'stroke="black" stroke-width="{width}"/><text class="number" x="{place.x:.0f}" y="{place.y + 4:.0f}" '
        f'text-anchor="middle">{number}</text><text class="name" x="{place.x:.0f}" y="{below:.0f}" '
        f'text-anchor="middle" font-size="10">{name}</text></g>'
    )


def _circle(place: _Point, radius: int) -> str:
    return (
        f"M{place.x - radius:.0f},{place.y:.0f} a{radius},{radius} 0 1 0 {2 * radius},0 "
        f"a{radius},{radius} 0 1 0 {-2 * radius},0"
    )


def _edge(edge: Edge, places: dict[int, _Point], tip: str) -> str:
    start, end = places[edge.source], places[edge.target]
    path, at = _loop(start) if edge.source == edge.target else _arc(start, end, edge.by_time)
    is_below = end.x < start.x
    classes = f"edge{' by-time' if edge.by_time else ''}{' taken' if edge.taken else ''}"
    dashes = ' stroke-dasharray="5 4"' if edge.by_time else ""
    width = ' stroke-width="2.5"' if edge.taken else ""
    lines = _lines(edge)
    top = at.y if is_below else at.y - LINE * (len(lines) - 1)
    spans = "".join(
        f'<tspan x="{at.x:.0f}" y="{top + LINE * n:.0f}">{escape(line)}</tspan>' for n, line in enumerate(lines)
    )
    whole = " or ".join(edge.label) + (f" ({edge.taken})" if edge.taken else "")
    return (
        f'<g class="{classes}"><title>{edge.source} → {edge.target}: {escape(whole)}</title>'
        f'<path d="{path}" {_STROKE} {tip}{dashes}{width}/>'
        f'<text text-anchor="middle" paint-order="stroke" stroke="white" stroke-width="4">{spans}</text></g>'
    )


def _lines(edge: Edge) -> list[str]:
    """The label as it is shown."""
    shown = [line if len(line) <= LONGEST_LINE else line[: LONGEST_LINE - 1] + "…" for line in edge.label[:MOST_LINES]]
    joined = [*(f"{line} or" for line in shown[:-1]), *shown[-1:]]
    more = [f"or {len(edge.label) - MOST_LINES} more ways"] if len(edge.label) > MOST_LINES else []
    return [*joined, *more, *([edge.taken] if edge.taken else [])]


def _loop(place: _Point) -> tuple[str, _Point]:
    """An arc over a state, and where its label stands."""
    x, top = place.x, place.y - RADIUS
    path = (
        f"M{x - 9:.0f},{top + 3:.0f} C{x - 26:.0f},{top - 30:.0f} {x + 26:.0f},{top - 30:.0f} {x + 9:.0f},{top + 3:.0f}"
    )
    return path, _Point(x, top - 27)


def _arc(start: _Point, end: _Point, by_time: bool) -> tuple[str, _Point]:
    """A bow to the left of the straight way, so that ways there and back do not meet, and where its label stands."""
    length = math.hypot(end.x - start.x, end.y - start.y)
    along = _Point((end.x - start.x) / length, (end.y - start.y) / length)
    bow = 18 + 0.12 * length + (50 if by_time else 0)
    middle = _Point((start.x + end.x) / 2 + along.y * bow, (start.y + end.y) / 2 - along.x * bow)
    first, last = _rim(start, middle), _rim(end, middle)
    path = f"M{first.x:.1f},{first.y:.1f} Q{middle.x:.1f},{middle.y:.1f} {last.x:.1f},{last.y:.1f}"
    is_below = along.x < 0
    at = _Point((start.x + 2 * middle.x + end.x) / 4, (start.y + 2 * middle.y + end.y) / 4 + (16 if is_below else -8))
    return path, at


def _rim(place: _Point, towards: _Point) -> _Point:
    """The point of a state's circle that looks at `towards`."""
    length = math.hypot(towards.x - place.x, towards.y - place.y)
    return _Point(
        place.x + RADIUS * (towards.x - place.x) / length,
        place.y + RADIUS * (towards.y - place.y) / length,
    )
