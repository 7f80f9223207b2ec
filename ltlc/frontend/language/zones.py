"""Zones: simple polygons in the plane, checked exactly."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations

from ltlc.base.diagnostics import Label
from ltlc.frontend.language.evaluate import literal
from ltlc.frontend.language.names import Checker
from ltlc.frontend.language.values import Zone
from ltlc.frontend.syntax import tree as syntax

MOST_CORNERS = 200
"""Of one zone: all of them are asked at each step."""

Point = tuple[Fraction, Fraction]


def zone(checker: Checker, command: syntax.Zone) -> Zone | None:
    """The polygon that a command names; None if an error was reported."""
    found = [(literal(checker, corner.x), literal(checker, corner.y)) for corner in command.corners]
    corners = [(x, y) for x, y in found if x is not None and y is not None]
    if len(corners) < len(found):
        return None
    if not 3 <= len(corners) <= MOST_CORNERS:
        message = f"a zone has 3 to {MOST_CORNERS} corners, but `{command.name.text}` has {len(corners)}"
        checker.report("LTL240", command.name.span, message)
        return None
    for node, corner in zip(command.corners, corners, strict=True):
        if not all(map(math.isfinite, corner)):
            checker.report("LTL240", node.span, f"the corner `{checker.written(node)}` is infinite")
            return None
    crossing = next(_crossings([(Fraction(x), Fraction(y)) for x, y in corners]), None)
    if crossing is not None:
        _report_crossing(checker, command, *crossing)
        return None
    return Zone(command.name.text, tuple(corners))


def _report_crossing(checker: Checker, command: syntax.Zone, one: int, other: int) -> None:
    def written(number: int) -> str:
        ends = command.corners[number], command.corners[(number + 1) % len(command.corners)]
        return " to ".join(f"`{checker.written(end)}`" for end in ends)

    message = (
        f"the border of `{command.name.text}` meets itself: see the edges from {written(one)} and {written(other)}"
    )
    first = Label(command.corners[one].span, "one edge begins here")
    help = "list the corners in order along the border, each once"
    checker.report("LTL240", command.corners[other].span, message, first, help=help)


def _crossings(corners: list[Point]) -> Iterator[tuple[int, int]]:
    """The numbers of two edges that have a point in common, but for the corner at which one follows the other."""
    edges = list(zip(corners, [*corners[1:], corners[0]], strict=True))
    for (number, (a, b)), (later, (c, d)) in combinations(enumerate(edges), 2):
        if later == number + 1:
            meets = a == b or c == d or _is_on(d, a, b) or _is_on(a, c, d)
        elif number == 0 and later == len(edges) - 1:
            meets = _is_on(c, a, b) or _is_on(b, c, d)
        else:
            meets = _meet(a, b, c, d)
        if meets:
            yield number, later


def _meet(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Whether two edges have a point in common."""
    if any((_is_on(c, a, b), _is_on(d, a, b), _is_on(a, c, d), _is_on(b, c, d))):
        return True
    return _turn(a, b, c) * _turn(a, b, d) < 0 and _turn(c, d, a) * _turn(c, d, b) < 0


def _is_on(point: Point, a: Point, b: Point) -> bool:
    """Whether a point lies on the edge from a to b."""
    within = all(min(p, q) <= each <= max(p, q) for each, p, q in zip(point, a, b, strict=True))
    return within and _turn(a, b, point) == 0


def _turn(a: Point, b: Point, c: Point) -> int:
    """The sign of the angle at which the way from a to b turns towards c."""
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return (area > 0) - (area < 0)
