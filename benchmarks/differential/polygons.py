"""Points and polygons, by the definition in `docs/language.md`, 'Zones': a border belongs to what it is around."""

from __future__ import annotations

import math
from fractions import Fraction

Point = tuple[float, float]
Polygon = list[Point]


def is_within(point: Point, polygon: Polygon) -> bool:
    """Whether a border goes through the point, or goes around it once: by its winding, exactly."""
    if not all(map(math.isfinite, point)):
        return False
    x, y = map(Fraction, point)
    shifted = [(Fraction(a) - x, Fraction(b) - y) for a, b in polygon]
    winding = 0
    for (a, b), (c, d) in zip(shifted, shifted[1:] + shifted[:1], strict=True):
        area = a * d - b * c
        if area == 0 and a * c <= 0 and b * d <= 0:
            return True
        winding += (b <= 0 < d and area > 0) - (d <= 0 < b and area < 0)
    return winding != 0


def away(point: Point, polygon: Polygon) -> float:
    """How far the point is from the polygon."""
    if is_within(point, polygon):
        return 0.0
    return min(_from_edge(point, one, other) for one, other in zip(polygon, polygon[1:] + polygon[:1], strict=True))


def _from_edge(point: Point, one: Point, other: Point) -> float:
    if not all(map(math.isfinite, point)):
        return math.inf
    (x, y), (a, b), (c, d) = (tuple(map(Fraction, each)) for each in (point, one, other))
    share = ((x - a) * (c - a) + (y - b) * (d - b)) / ((c - a) ** 2 + (d - b) ** 2)
    share = min(max(share, Fraction(0)), Fraction(1))
    try:
        return math.hypot(x - a - share * (c - a), y - b - share * (d - b))
    except OverflowError:
        return math.inf
