"""Monitors as pictures (SVG): states in columns by their distance from the first, and the way that a run took."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape

from ltlc.dataclass import dataclass
from ltlc.semantics.verdicts import Verdict

ROW, RADIUS, MARGIN, GAP = 170, 24, 70, 170
"""Distances in the picture, in pixels: GAP is between two columns, more where labels are long."""

LETTER, LINE = 6, 14
"""About the width of a character of a label, and the height of its lines."""

LONGEST_LINE, MOST_LINES = 34, 3
"""A longer label is cut off; the whole is shown where the mouse rests."""

NAME = 110
"""About the width of the longest name of a verdict."""

PARTS = 16
"""A label may stand beside so many places along an edge."""

BOW, MOST_BOWS = 15, 12
"""An edge bows by so much more, and so often at most, until it passes no state and no name of one."""

CROSSED = 30
"""What it costs a label to cover a point of another edge, where covering a state or a label costs its area."""

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


@dataclass(frozen=True, slots=True)
class _Box:
    """What a text or a state covers, `middle` being its middle."""

    middle: _Point
    width: float
    height: float

    def shared(self, other: _Box) -> float:
        """The area that both cover."""
        across = (self.width + other.width) / 2 - abs(self.middle.x - other.middle.x)
        down = (self.height + other.height) / 2 - abs(self.middle.y - other.middle.y)
        return max(0.0, across) * max(0.0, down)

    def covers(self, point: _Point) -> bool:
        """Whether `point` is inside."""
        across, down = abs(self.middle.x - point.x), abs(self.middle.y - point.y)
        return across <= self.width / 2 and down <= self.height / 2


@dataclass(frozen=True, slots=True)
class _Way:
    """How an edge runs: its path in SVG, points along it, and where its label may stand, the best place first."""

    path: str
    points: tuple[_Point, ...]
    labels: tuple[_Box, ...]


def graph_svg(
    verdicts: Sequence[Verdict], edges: Sequence[Edge], last: int | None = None, name: str = "monitor"
) -> str:
    """States with these verdicts, numbered from 0, the first one the initial; `last` is where a run ended.

    States that no edge leads to are left out. What can be styled has classes. Pictures on one page need different
    names, of letters, digits and `-`: a browser that hides one hides what others have in common with it.
    """
    places = _places(len(verdicts), edges)
    ways = {edge: _loop(places, edge) if edge.source == edge.target else _arc(places, edge) for edge in edges}
    labels = _labels(places, ways)
    boxes = [*labels.values(), *(box for place in places.values() for box in _covered(place))]
    width = max(box.middle.x + box.width / 2 for box in boxes) + 10
    height = max(box.middle.y + box.height / 2 for box in boxes) + 10
    tip = f'marker-end="url(#{name}-tip)"'
    drawn = [_edge(e, ways[e].path, labels[e], tip) for e in sorted(edges, key=lambda edge: bool(edge.taken))]
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
_HALO = 'paint-order="stroke" stroke="white" stroke-width="4"'


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


def _covered(place: _Point) -> list[_Box]:
    """What a state and its name cover."""
    name = _Box(_Point(place.x, place.y + RADIUS + 14), NAME, LINE)
    return [_Box(place, 2 * RADIUS + 10, 2 * RADIUS + 10), name]


def _labels(places: Mapping[int, _Point], ways: Mapping[Edge, _Way]) -> dict[Edge, _Box]:
    """Where the label of each edge stands: where it covers least of states, other labels and other edges."""
    covered = [box for place in places.values() for box in _covered(place)]
    found: dict[Edge, _Box] = {}
    for edge in sorted(ways, key=lambda edge: len(ways[edge].labels)):
        others = [point for other, way in ways.items() if other != edge for point in way.points]

        def cost(box: _Box, others: Sequence[_Point] = others) -> float:
            outside = max(0.0, box.width / 2 - box.middle.x) + max(0.0, box.height / 2 - box.middle.y)
            crossed = sum(box.covers(point) for point in others)
            return sum(map(box.shared, covered)) + CROSSED * crossed + 1000 * outside

        found[edge] = min(ways[edge].labels, key=cost)
        covered.append(found[edge])
    return found


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
        f'text-anchor="middle" font-size="10" {_HALO}>{name}</text></g>'
    )


def _circle(place: _Point, radius: int) -> str:
    return (
        f"M{place.x - radius:.0f},{place.y:.0f} a{radius},{radius} 0 1 0 {2 * radius},0 "
        f"a{radius},{radius} 0 1 0 {-2 * radius},0"
    )


def _edge(edge: Edge, path: str, label: _Box, tip: str) -> str:
    classes = f"edge{' by-time' if edge.by_time else ''}{' taken' if edge.taken else ''}"
    dashes = ' stroke-dasharray="5 4"' if edge.by_time else ""
    width = ' stroke-width="2.5"' if edge.taken else ""
    first = label.middle.y - label.height / 2 + LINE - 3
    spans = "".join(
        f'<tspan x="{label.middle.x:.0f}" y="{first + LINE * n:.0f}">{escape(line)}</tspan>'
        for n, line in enumerate(_lines(edge))
    )
    whole = " or ".join(edge.label) + (f" ({edge.taken})" if edge.taken else "")
    return (
        f'<g class="{classes}"><title>{edge.source} → {edge.target}: {escape(whole)}</title>'
        f'<path d="{path}" {_STROKE} {tip}{dashes}{width}/>'
        f'<text text-anchor="middle" {_HALO}>{spans}</text></g>'
    )


def _lines(edge: Edge) -> list[str]:
    """The label as it is shown."""
    shown = [line if len(line) <= LONGEST_LINE else line[: LONGEST_LINE - 1] + "…" for line in edge.label[:MOST_LINES]]
    joined = [*(f"{line} or" for line in shown[:-1]), *shown[-1:]]
    more = [f"or {len(edge.label) - MOST_LINES} more ways"] if len(edge.label) > MOST_LINES else []
    return [*joined, *more, *([edge.taken] if edge.taken else [])]


def _box(edge: Edge, middle: _Point) -> _Box:
    """What its label covers there."""
    lines = _lines(edge)
    return _Box(middle, LETTER * max(map(len, lines)), LINE * len(lines))


def _loop(places: Mapping[int, _Point], edge: Edge) -> _Way:
    """An arc over a state, its label above it."""
    x, top = places[edge.source].x, places[edge.source].y - RADIUS
    path = (
        f"M{x - 9:.0f},{top + 3:.0f} C{x - 26:.0f},{top - 30:.0f} {x + 26:.0f},{top - 30:.0f} {x + 9:.0f},{top + 3:.0f}"
    )
    return _Way(path, (_Point(x, top - 10),), (_box(edge, _Point(x, top - 24 - LINE * len(_lines(edge)) / 2)),))


def _arc(places: Mapping[int, _Point], edge: Edge) -> _Way:
    """A bow to the left of the straight way, so that ways there and back do not meet; its label stands beside it."""
    start, end = places[edge.source], places[edge.target]
    length = math.hypot(end.x - start.x, end.y - start.y)
    along = _Point((end.x - start.x) / length, (end.y - start.y) / length)
    others = [box for q, place in places.items() if q not in (edge.source, edge.target) for box in _covered(place)]
    least = 18 + 0.12 * length + (50 if edge.by_time else 0)
    for bow in (least + BOW * n for n in range(MOST_BOWS)):
        middle = _Point((start.x + end.x) / 2 + along.y * bow, (start.y + end.y) / 2 - along.x * bow)
        first, last = _rim(start, middle), _rim(end, middle)
        points = tuple(_on(first, middle, last, n / PARTS) for n in range(1, PARTS))
        if not any(box.covers(point) for box in others for point in points):
            break
    path = f"M{first.x:.1f},{first.y:.1f} Q{middle.x:.1f},{middle.y:.1f} {last.x:.1f},{last.y:.1f}"
    label = _box(edge, middle)
    away = (abs(along.y) * label.width + abs(along.x) * label.height) / 2 + 3
    beside = [
        _box(edge, _Point(point.x + side * along.y * away, point.y - side * along.x * away))
        for point in sorted(points, key=lambda each: abs(points.index(each) - PARTS // 2 + 1))
        for side in (1, -1)
    ]
    return _Way(path, points, tuple(beside))


def _on(first: _Point, middle: _Point, last: _Point, part: float) -> _Point:
    """The point on a quadratic curve that comes after `part` of it."""
    a, b, c = (1 - part) ** 2, 2 * part * (1 - part), part**2
    return _Point(a * first.x + b * middle.x + c * last.x, a * first.y + b * middle.y + c * last.y)


def _rim(place: _Point, towards: _Point) -> _Point:
    """The point of a state's circle that looks at `towards`."""
    length = math.hypot(towards.x - place.x, towards.y - place.y)
    return _Point(
        place.x + RADIUS * (towards.x - place.x) / length,
        place.y + RADIUS * (towards.y - place.y) / length,
    )
