"""Arithmetic of the property language: IEEE doubles; nothing raises, no NaN is lost.

Angles are radians. An orientation is a quaternion (x, y, z, w); its length does not
matter, but that of length 0 is no orientation, and what is asked of it is NaN.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from operator import eq
from typing import Any


def number(value: float | Fraction) -> float:
    """`value` as a double; an integer beyond their range is infinite."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def divide(left: float, right: float) -> float:
    """`left / right`: infinite where only `right` is 0, NaN where both are."""
    if right != 0:
        return left / right
    if left == 0 or math.isnan(left):
        return math.nan
    return math.copysign(math.inf, left) * math.copysign(1.0, right)


def square_root(value: float) -> float:
    """The square root of `value`; NaN if it is negative."""
    return math.sqrt(value) if value >= 0 else math.nan


def gap(left: float, right: float) -> float:
    """`left - right`; 0 where they are equal, be they infinite."""
    return 0.0 if left == right else left - right


def rounded_down(value: float) -> float:
    """The largest integer that is not greater than `value`; never -0.0."""
    return float(math.floor(value)) if -math.inf < value < math.inf else value


def rounded_up(value: float) -> float:
    """The smallest integer that is not less than `value`; never -0.0."""
    return float(math.ceil(value)) if -math.inf < value < math.inf else value


def sign_of(value: float) -> float:
    """1 above 0, -1 below, 0.0 of 0; NaN if `value` is."""
    return 1.0 if value > 0 else -1.0 if value < 0 else value + 0.0


def modulo(dividend: float, divisor: float) -> float:
    """What is left of a division, with the sign of `divisor`; never -0.0.

    NaN by 0 and of what is infinite.
    """
    if divisor == 0 or not -math.inf < dividend < math.inf:
        return math.nan
    rest = math.fmod(dividend, divisor)
    return rest + divisor if rest and (rest < 0) != (divisor < 0) else rest + 0.0


def exp(value: float) -> float:
    """The exponential; infinite beyond the doubles."""
    try:
        return math.exp(value)
    except OverflowError:
        return math.inf


def log(value: float) -> float:
    """The natural logarithm; of 0 -infinity, of what is negative NaN."""
    return math.log(value) if value > 0 else -math.inf if value == 0 else math.nan


def sin(angle: float) -> float:
    """The sine; of what is infinite NaN."""
    return math.sin(angle) if -math.inf < angle < math.inf else math.nan


def cos(angle: float) -> float:
    """The cosine; of what is infinite NaN."""
    return math.cos(angle) if -math.inf < angle < math.inf else math.nan


def tan(angle: float) -> float:
    """The tangent; of what is infinite NaN."""
    return math.tan(angle) if -math.inf < angle < math.inf else math.nan


def asin(sine: float) -> float:
    """The angle, -pi/2 to pi/2, with this sine; NaN if there is none."""
    return math.asin(sine) if -1 <= sine <= 1 else math.nan


def acos(cosine: float) -> float:
    """The angle, 0 to pi, with this cosine; NaN if there is none."""
    return math.acos(cosine) if -1 <= cosine <= 1 else math.nan


def atan2(y: float, x: float) -> float:
    """The angle, -pi to pi, of the direction (x, y)."""
    return math.atan2(y, x)


def angle_between(left: float, right: float) -> float:
    """The angle, 0 to pi, between two directions; NaN if one is infinite."""
    turn = abs(left - right)
    if not turn < math.inf:
        return math.nan
    turn = math.fmod(turn, math.tau)
    return math.tau - turn if turn > math.pi else turn


def inside_of(x: float, y: float, *corners: float) -> float:
    """1 if the point lies in a polygon or on its border, decided exactly; else 0.

    NaN if a coordinate is. `corners` are x and y of one corner after the other.
    """
    if not -math.inf < x < math.inf or not -math.inf < y < math.inf:
        return math.nan if math.isnan(x) or math.isnan(y) else 0.0
    is_inside = False
    for ax, ay, bx, by in _edges(corners):
        if not (ay <= y <= by or by <= y <= ay):
            continue
        turn = _turn(ax, ay, bx, by, x, y)
        if turn == 0 and (ax <= x <= bx or bx <= x <= ax):
            return 1.0
        if (ay <= y) != (by <= y) and (turn > 0) == (by > ay):
            is_inside = not is_inside
    return 1.0 if is_inside else 0.0


def distance_of(x: float, y: float, *corners: float) -> float:
    """How far the point is from a polygon, 0 inside; NaN if a coordinate is."""
    found = inside_of(x, y, *corners)
    if found != 0:
        return 0.0 if found == 1 else found
    nearest = math.inf
    for ax, ay, bx, by in _edges(corners):
        along, across = bx - ax, by - ay
        east, north = x - ax, y - ay
        if 0 < east * along + north * across < along * along + across * across:
            apart = abs(along * north - across * east) / norm(along, across)
        else:
            apart = least(norm(east, north), norm(x - bx, y - by))
        nearest = min(nearest, apart)
    return nearest


def _edges(corners: Sequence[float]) -> Iterator[tuple[float, float, float, float]]:
    """The edges of a polygon, each from one corner to the next, back to the first."""
    ax, ay = corners[-2:]
    for bx, by in zip(corners[::2], corners[1::2], strict=True):
        yield ax, ay, bx, by
        ax, ay = bx, by


def _turn(ax: float, ay: float, bx: float, by: float, x: float, y: float) -> float:
    """Above 0 if the point is to the left of the way from a to b, below to the right.

    0 on the line, exactly; doubles decide where their errors cannot matter.
    """
    left, right = (ax - x) * (by - y), (ay - y) * (bx - x)
    bound = 4e-16 * (abs(left) + abs(right))
    if bound > 1e-280 and abs(left - right) > bound:
        return left - right
    east, north = Fraction(x), Fraction(y)
    one, other = (
        (Fraction(ax) - east, Fraction(ay) - north),
        (Fraction(bx) - east, Fraction(by) - north),
    )
    area = one[0] * other[1] - one[1] * other[0]
    return float((area > 0) - (area < 0))


def least(*values: float) -> float:
    """The smallest of `values`; NaN if one of them is."""
    return min(values) if _are_numbers(values) else math.nan


def greatest(*values: float) -> float:
    """The largest of `values`; NaN if one of them is."""
    return max(values) if _are_numbers(values) else math.nan


def _are_numbers(values: Sequence[float]) -> bool:
    return all(map(eq, values, values))


def elements_of(values: Any) -> Sequence[Any]:
    """The elements of an array as Python's own values, which compare as doubles."""
    elements: Sequence[Any] = values.tolist() if hasattr(values, "tolist") else values
    return elements


def doubles_of(values: Any) -> Sequence[float]:
    """The elements of an array as doubles."""
    elements = elements_of(values)
    try:
        return tuple(map(float, elements))
    except OverflowError:
        return tuple(map(number, elements))


def smallest(values: Sequence[float]) -> float:
    """The smallest number of an array; NaN, which is no measurement, if it has none."""
    return min(_measured(values), default=math.nan)


def largest(values: Sequence[float]) -> float:
    """The largest number of an array; NaN, which is no measurement, if it has none."""
    return max(_measured(values), default=math.nan)


def _measured(values: Sequence[float]) -> Sequence[float]:
    """The elements that are not NaN; where one is, so is the sum of all."""
    if sum(values) <= math.inf:
        return values
    return [value for value in values if value <= math.inf]


def nearest_of(sought: float, values: Sequence[float]) -> float:
    """The first of those numbers of an array that differ least from `sought`.

    NaN, which is no measurement, is left out; without any other, the result is NaN.
    """
    found, least_apart = math.nan, math.nan
    for value in values:
        apart = abs(gap(value, sought))
        if not math.isnan(apart) and (math.isnan(least_apart) or apart < least_apart):
            found, least_apart = float(value), apart
    return found


def sum_of(values: Sequence[float]) -> float:
    """The double nearest to the sum of an array; NaN if an element is."""
    try:
        return math.fsum(values)
    except ValueError:  # inf - inf
        return math.nan
    except OverflowError:  # on the way, be it not so in the end
        infinite = [value for value in values if not -math.inf < value < math.inf]
        if infinite:
            return sum(infinite)
        return number(sum(Fraction(value) for value in values))


def complete(values: Sequence[float]) -> float:
    """How many numbers an array has; NaN if one of them is."""
    if sum(values) <= math.inf or not any(map(math.isnan, values)):
        return float(len(values))
    return math.nan


def mean_of(values: Sequence[float]) -> float:
    """The sum of the numbers of an array, rounded, divided by how many they are.

    NaN is no measurement; if there is none, so is the mean.
    """
    measured = _measured(values)
    return sum_of(measured) / len(measured) if len(measured) else math.nan


def median_of(values: Sequence[float]) -> float:
    """The middle number of an array by size, of an even number the mean of two.

    NaN is no measurement; if there is none, so is the median. It is never -0.0.
    """
    ascending = sorted(_measured(values))
    if not ascending:
        return math.nan
    low, high = ascending[(len(ascending) - 1) // 2], ascending[len(ascending) // 2]
    total = low + high
    return total / 2 + 0.0 if -math.inf < total < math.inf else low / 2 + high / 2


def length_of(values: Sequence[Any]) -> float:
    """How many elements an array has."""
    return float(len(values))


def norm(*components: float) -> float:
    """The Euclidean norm of a vector; NaN if one of `components` is."""
    length = math.hypot(*components)  # infinite if one is, be another one NaN
    return length if length < math.inf or _are_numbers(components) else math.nan


def roll(x: float, y: float, z: float, w: float) -> float:
    """The rotation about x, -pi to pi, of an orientation as yaw, pitch, then roll."""
    x, y, z, w = _unit(x, y, z, w)
    return math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))


def pitch(x: float, y: float, z: float, w: float) -> float:
    """The rotation about y, -pi/2 to pi/2, of an orientation as yaw, pitch, roll."""
    x, y, z, w = _unit(x, y, z, w)
    sine = 2 * (w * y - z * x)
    return math.nan if math.isnan(sine) else math.asin(max(-1.0, min(1.0, sine)))


def yaw(x: float, y: float, z: float, w: float) -> float:
    """The rotation about z, -pi to pi, of an orientation as yaw, pitch, then roll."""
    x, y, z, w = _unit(x, y, z, w)
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def angle(
    x1: float,
    y1: float,
    z1: float,
    w1: float,
    x2: float,
    y2: float,
    z2: float,
    w2: float,
) -> float:
    """The angle, 0 to pi, of the rotation that takes one orientation to the other.

    q and -q are the same orientation: the tangent of a quarter of the angle is
    |p - q| / |p + q|, or the other way round if that is less.
    """
    p, q = _unit(x1, y1, z1, w1), _unit(x2, y2, z2, w2)
    apart = norm(*(a - b for a, b in zip(p, q, strict=True)))
    together = norm(*(a + b for a, b in zip(p, q, strict=True)))
    return 4 * math.atan2(min(apart, together), max(apart, together))


def _unit(x: float, y: float, z: float, w: float) -> tuple[float, float, float, float]:
    """The quaternion of length 1 in the same direction; NaN if there is none."""
    length = norm(x, y, z, w)
    if length == 0 or length == math.inf:
        length = math.nan
    return x / length, y / length, z / length, w / length
