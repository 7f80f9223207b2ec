"""What is computed of robots and objects, from the numbers of their odometers: distances, speeds, angles."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

Value = Callable[[Any], Any]
"""A value, of what is known at a step."""


def derived(name: str, words: Sequence[str], part: Callable[[str], Value]) -> Value:
    """`name.words` as a function; `part` gives that of a component, such as `robot.position.x`."""

    def components(of: str, axes: str, thing: str = name) -> list[Value]:
        return [part(f"{thing}.{of}.{axis}") for axis in axes]

    match words:
        case ["position", axis]:
            return part(f"{name}.position.{axis}")
        case ["velocity", "angular", axis]:
            return part(f"{name}.velocity.angular.{axis}")
        case ["velocity", axis] | ["velocity", "linear", axis]:
            return part(f"{name}.velocity.{axis}")
        case ["velocity"]:
            return _norm(components("velocity", "xyz"))
        case ["velocity_angular"]:
            return _norm(components("velocity.angular", "xyz"))
        case ["distance" | "distanceZ" as which, other]:
            axes = "xy" if which == "distance" else "xyz"
            return _apart(components("position", axes), components("position", axes, other))
        case ["orientation"]:
            return _angle("yaw", components("orientation", "xyzw"))
        case ["orientation", which]:
            return _angle(which, components("orientation", "xyzw"))
        case _:
            raise AssertionError((name, words))


def _norm(of: list[Value]) -> Value:
    return lambda f: math.hypot(*(each(f) for each in of))


def _apart(of: list[Value], other: list[Value]) -> Value:
    pairs = list(zip(of, other, strict=True))
    return lambda f: math.hypot(*(a(f) - b(f) for a, b in pairs))


def _angle(which: str, of: list[Value]) -> Value:
    """A rotation by its axis; the textbook's formulas for a unit quaternion."""

    def angle(f: Any) -> float:
        x, y, z, w = (each(f) for each in of)
        if which == "roll":
            return math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
        if which == "pitch":
            return math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x))))
        return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))

    return angle
