"""The zones in a property, and the path of a point among them, as a picture of the plane."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from itertools import pairwise

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.interfaces.pages.series import Numbers, Series, Times
from ltlc.runtime.functions import inside_of
from ltlc.runtime.reports import printable
from ltlc.runtime.times import Scale
from ltlc.runtime.tracking import Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.evaluation import Point, corners_of, number
from ltlc.specification.expressions import Call, Element, Expression, Opening, operands, reads, subexpressions
from ltlc.specification.specification import PropertySpecification

WIDTH, HEIGHT, MARGIN = 560, 360, 28
"""The picture is at most so large, in pixels, and leaves so much free around what it shows."""

MOST_POINTS, MOST_CROSSINGS = 10_000, 200
"""Of a path at most so many points are drawn, and so many of the places where it enters or leaves a zone."""

FARTHEST = 1e100
"""What is not nearer than that to 0, or is not a number, is not drawn."""

LISTED = 6
"""At most so many of these are described in words."""


@dataclass(frozen=True, slots=True)
class Course:
    """A point, whose coordinates are `x` and `y`, and the corners of the zones that it is asked of, by name."""

    x: Expression
    y: Expression
    zones: Mapping[str, Sequence[Point]]


@dataclass(frozen=True, slots=True)
class Map:
    """A picture as SVG; `described` says what it shows in words, `remark` what was left out, if any."""

    svg: str
    described: str
    remark: str = ""


@dataclass(frozen=True, slots=True)
class _Visit:
    """Where the point is from `time` on, until the next one, and the names of the zones that it is in."""

    time: Nanoseconds
    x: float
    y: float
    zones: frozenset[str]


def courses(specification: PropertySpecification) -> list[Course]:
    """The points that a property locates in zones, without elements of arrays and values at openings."""
    found: dict[tuple[Expression, Expression], dict[str, Sequence[Point]]] = {}
    sides = (side for atom in specification.atoms for side in operands(atom.condition))
    for part in (part for side in sides for part in subexpressions(side)):
        if isinstance(part, Call) and part.zone and _is_recorded(part):
            x, y, *_ = part.arguments
            corners = corners_of([number(each, {}) if n > 1 else math.nan for n, each in enumerate(part.arguments)])
            found.setdefault((x, y), {})[part.zone] = corners
    return [Course(x, y, zones) for (x, y), zones in found.items()]


def _is_recorded(call: Call) -> bool:
    """Whether the point is known from recorded values alone, and is not the same at all times."""
    point = call.arguments[:2]
    has_elements = any(isinstance(part, Element) for side in point for part in subexpressions(side))
    read = [each for side in point for each in reads(side)]
    return bool(read) and not has_elements and not any(isinstance(each, Opening) for each in read)


def map_of(course: Course, series: Mapping[Expression, Series], scale: Scale, track: Track) -> Map:
    """The zones of a course of the property of `track`, and where the point went in a recording that `began` then."""
    violated_at = track.decided_at.time if track.decided_at and track.verdict is Verdict.VIOLATED else None
    visits, left_out = _visits(course, series)
    crossings = [(before, after) for before, after in pairwise(visits) if before.zones != after.zones]
    points = [*((visit.x, visit.y) for visit in visits), *(point for zone in course.zones.values() for point in zone)]
    frame = _Frame.around(points)
    drawn = [
        *_corner_texts(frame),
        *(_zone(frame, name, corners) for name, corners in course.zones.items()),
        *_path(frame, visits),
        *(_crossing(frame, before, after, scale) for before, after in crossings[:MOST_CROSSINGS]),
        *_end_marks(frame, visits, violated_at, scale),
    ]
    size = f'width="{frame.width:.0f}" height="{frame.height:.0f}" viewBox="0 0 {frame.width:.0f} {frame.height:.0f}"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {size} class="map" font-family="sans-serif" font-size="11">'
    remarks = []
    if left_out:
        remarks.append(f"{len(visits):,} of {left_out + len(visits):,} points of the path are drawn.")
    if len(crossings) > MOST_CROSSINGS:
        remarks.append(f"{MOST_CROSSINGS} of {len(crossings):,} places where it enters or leaves a zone are marked.")
    return Map("".join([head, *drawn, "</svg>"]), _described(course, visits, crossings, scale), " ".join(remarks))


def _visits(course: Course, series: Mapping[Expression, Series]) -> tuple[list[_Visit], int]:
    """The path, as far as it can be seen in the picture; and how many points were left out nevertheless."""
    (x_times, xs), (y_times, ys) = _samples(course.x, series), _samples(course.y, series)
    if not len(xs) or not len(ys):
        return [], 0
    times = np.unique(np.concatenate([x_times, y_times]))
    times = times[times >= max(x_times[0], y_times[0])]
    x = xs[np.searchsorted(x_times, times, "right") - 1]
    y = ys[np.searchsorted(y_times, times, "right") - 1]
    can_be_drawn = (np.abs(x) < FARTHEST) & (np.abs(y) < FARTHEST)
    times, x, y = times[can_be_drawn], x[can_be_drawn], y[can_be_drawn]
    if not len(times):
        return [], 0
    pixel = max(float(np.ptp(x)), float(np.ptp(y))) / (2 * WIDTH) or 1.0
    cells = np.round(np.stack([x, y]) / pixel)
    moves = np.flatnonzero((cells[:, 1:] != cells[:, :-1]).any(axis=0)) + 1
    places = np.unique([0, *moves, len(times) - 1])
    drawn = places[:: -(-len(places) // MOST_POINTS)]
    rows = zip(times[drawn].tolist(), x[drawn].tolist(), y[drawn].tolist(), strict=True)
    return [_Visit(time, x, y, _zones_at(course, x, y)) for time, x, y in rows], len(places) - len(drawn)


def _samples(coordinate: Expression, series: Mapping[Expression, Series]) -> tuple[Times, Numbers]:
    """The times and values of a coordinate; one that reads nothing has its value from the first time that there is."""
    if any(True for _ in reads(coordinate)):
        return series[coordinate].samples()
    return np.array([np.iinfo(np.int64).min]), np.array([number(coordinate, {})])


def _zones_at(course: Course, x: float, y: float) -> frozenset[str]:
    within = (
        name for name, corners in course.zones.items() if inside_of(x, y, *(c for point in corners for c in point))
    )
    return frozenset(within)


@dataclass(frozen=True, slots=True)
class _Frame:
    """Where points of the plane are in the picture, in which x goes to the right and y up, to one scale."""

    left: float
    right: float
    bottom: float
    top: float

    @staticmethod
    def around(points: Sequence[Point]) -> _Frame:
        xs, ys = [x for x, _ in points], [y for _, y in points]
        return _Frame(min(xs), max(xs), min(ys), max(ys))

    @property
    def scale(self) -> float:
        """Pixels for each unit of length."""
        across, up = (WIDTH - 2 * MARGIN) / (self.right - self.left), (HEIGHT - 2 * MARGIN) / (self.top - self.bottom)
        return min(across, up)

    @property
    def width(self) -> float:
        return (self.right - self.left) * self.scale + 2 * MARGIN

    @property
    def height(self) -> float:
        return (self.top - self.bottom) * self.scale + 2 * MARGIN

    def at(self, x: float, y: float) -> str:
        return f"{MARGIN + (x - self.left) * self.scale:.1f},{MARGIN + (self.top - y) * self.scale:.1f}"


def _corner_texts(frame: _Frame) -> Iterator[str]:
    """The coordinates of the lower left and the upper right end of what is shown."""
    for x, y, down, anchor in ((frame.left, frame.bottom, 18, "start"), (frame.right, frame.top, -14, "end")):
        across, up = frame.at(x, y).split(",")
        place = f'x="{across}" y="{float(up) + down:.1f}" text-anchor="{anchor}"'
        yield f'<text class="scale" {place}>{x:.6g}, {y:.6g}</text>'


def _zone(frame: _Frame, name: str, corners: Sequence[Point]) -> str:
    shown = escape(printable(name))
    points = " ".join(frame.at(x, y) for x, y in corners)
    x, y = frame.at(min(x for x, _ in corners), max(y for _, y in corners)).split(",")
    return (
        f'<g class="zone"><title>zone {shown}</title><polygon points="{points}" fill="lightgray" stroke="gray"/>'
        f'<text x="{x}" y="{float(y) - 4:.1f}">{shown}</text></g>'
    )


def _path(frame: _Frame, visits: Sequence[_Visit]) -> Iterator[str]:
    """The way, each stretch by whether it is in some zone."""
    start = 0
    for place in range(1, len(visits) + 1):
        if place == len(visits) or bool(visits[place].zones) != bool(visits[start].zones):
            stretch = visits[start : place + 1]
            points = " ".join(frame.at(visit.x, visit.y) for visit in stretch)
            within = " inside" if visits[start].zones else ""
            yield f'<polyline class="path{within}" points="{points}" fill="none" stroke="black"/>'
            start = place


def _dot(at: str, classes: str, title: str) -> str:
    x, y = at.split(",")
    return f'<circle class="{classes}" cx="{x}" cy="{y}" r="4"><title>{escape(title)}</title></circle>'


def _crossing(frame: _Frame, before: _Visit, after: _Visit, scale: Scale) -> str:
    classes = "crossing inside" if after.zones else "crossing"
    return _dot(frame.at(after.x, after.y), classes, f"{_change(before, after)} at {scale.text(after.time)}")


def _change(before: _Visit, after: _Visit) -> str:
    """The zones that the point has entered and left."""
    entered, left = sorted(after.zones - before.zones), sorted(before.zones - after.zones)
    said = [*(f"enters {name}" for name in entered), *(f"leaves {name}" for name in left)]
    return printable(", ".join(said))


def _end_marks(frame: _Frame, visits: Sequence[_Visit], violated_at: Nanoseconds | None, scale: Scale) -> Iterator[str]:
    """Where the path begins, and where the point was when the property was violated."""
    if visits:
        first = visits[0]
        yield _dot(frame.at(first.x, first.y), "start", f"starts at {scale.text(first.time)}")
    known = [visit for visit in visits if violated_at is not None and visit.time <= violated_at]
    if known and violated_at is not None:
        yield _dot(frame.at(known[-1].x, known[-1].y), "violated", f"violated at {scale.text(violated_at)}")


def _described(
    course: Course, visits: Sequence[_Visit], crossings: Sequence[tuple[_Visit, _Visit]], scale: Scale
) -> str:
    """The picture in words."""
    names = printable(" and ".join(course.zones))
    if not visits:
        return f"{names}: no position was recorded."
    start = printable(", ".join(sorted(visits[0].zones)))
    place = f"in {start}" if start else f"outside {names}"
    if not crossings:
        return f"The path stays {place}."
    said = [f"The path starts {place}."]
    for before, after in crossings[:LISTED]:
        said.append(f"At {scale.text(after.time)} it {_change(before, after)}.")
    if len(crossings) > LISTED:
        said.append(f"It enters or leaves {len(crossings) - LISTED:,} more times.")
    return " ".join(said)
