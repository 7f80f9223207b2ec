"""Simulation primitives: an object's true state, and a robot's own estimate of its state."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ltlc.base.fixes import respell
from ltlc.frontend.language.names import Checker
from ltlc.frontend.language.signals import Landmark, Thing, components, distance, named, norm, orientation
from ltlc.frontend.language.values import Orientation, Scalar, Value, Vector, call, difference
from ltlc.frontend.syntax import tree as syntax
from ltlc.specification.expressions import Expression
from ltlc.specification.functions import Function

MODELLED = {"position": "vector", "velocity": "vector", "orientation": "orientation"}
"""The attributes of a model that primitives use, and the kind of value that each must be."""


def _quantity(checker: Checker, of: Thing, quantity: str, place: syntax.Word) -> tuple[Expression, ...] | None:
    """The components of a quantity, or an error at `place` that the object's source cannot give it."""
    found = components(of, quantity)
    if found is not None:
        return found
    what = "angular velocity" if quantity == "velocity.angular" else quantity
    source = "a fixed place" if isinstance(of, Landmark) else f"`{of.message}`"
    help = f"`object {of.name} TOPIC nav_msgs/Odometry` would provide it"
    checker.report("LTL208", place.span, f"the {what} of `{of.name}` is unknown: its source is {source}", help=help)
    return None


def _axis(checker: Checker, vector: Vector, steps: Sequence[syntax.Word]) -> Value | None:
    """The vector itself or, if a step follows, one of its components."""
    if not steps:
        return vector
    if len(steps) == 1 and steps[0].text in ("x", "y", "z"):
        return Scalar(vector.components["xyz".index(steps[0].text)])
    wrong = steps[1] if steps[0].text in ("x", "y", "z") else steps[0]
    checker.report(
        "LTL105", wrong.span, f"`{vector.text}` has no `{wrong.text}`", help="a vector has `.x`, `.y` and `.z`"
    )
    return None


def _end(checker: Checker, value: Value | None, steps: Sequence[syntax.Word]) -> Value | None:
    """`value`, if no step follows."""
    if not steps or value is None:
        return value
    checker.report("LTL105", steps[0].span, f"a number has no `{steps[0].text}`")
    return None


def _position(checker: Checker, of: Thing, steps: Sequence[syntax.Word]) -> Value | None:
    found = _quantity(checker, of, "position", steps[0])
    if found is None:
        return None
    x, y, z = found
    return _axis(checker, Vector((x, y, z), f"{of.name}.position"), steps[1:])


def _velocity(checker: Checker, of: Thing, steps: Sequence[syntax.Word]) -> Value | None:
    """`X.velocity`, `X.velocity.x`, `X.velocity.linear.x`, `X.velocity.angular.x`."""
    kind = steps[1].text if len(steps) > 1 else ""
    found = _quantity(checker, of, "velocity.angular" if kind == "angular" else "velocity", steps[0])
    if found is None:
        return None
    name = f"{of.name}.velocity"
    if len(steps) == 1:
        return norm(name, found)
    x, y, z = found
    if kind == "linear":
        x, y, z = (named(f"{name}.linear.{axis}", part) for axis, part in zip("xyz", found, strict=True))
    if kind in ("linear", "angular"):
        return _axis(checker, Vector((x, y, z), f"{name}.{kind}"), steps[2:])
    return _axis(checker, Vector((x, y, z), name), steps[1:])


def _velocity_angular(checker: Checker, of: Thing, steps: Sequence[syntax.Word]) -> Value | None:
    found = _quantity(checker, of, "velocity.angular", steps[0])
    return None if found is None else _end(checker, norm(f"{of.name}.velocity_angular", found), steps[1:])


def _true_orientation(checker: Checker, of: Thing, place: syntax.Word) -> Orientation | None:
    found = _quantity(checker, of, "orientation", place)
    if found is None:
        return None
    x, y, z, w = found
    return orientation(f"{of.name}.orientation", (x, y, z, w))


def _orientation(checker: Checker, of: Thing, steps: Sequence[syntax.Word]) -> Value | None:
    found = _true_orientation(checker, of, steps[0])
    if found is None or len(steps) == 1:
        return found
    angles = dict(found.angles)
    if steps[1].text not in angles:
        known = "an orientation has `.roll`, `.pitch` and `.yaw`"
        help = respell(steps[1].span, steps[1].text, angles, is_closed=True) or known
        checker.report("LTL105", steps[1].span, f"an orientation has no `{steps[1].text}`", help=help)
        return None
    return _end(checker, Scalar(angles[steps[1].text]), steps[2:])


def _distance(checker: Checker, of: Thing, other: Thing, steps: Sequence[syntax.Word]) -> Value | None:
    """In the x, y plane for `distance`, in space for `distanceZ`."""
    one, two = _quantity(checker, of, "position", steps[0]), _quantity(checker, other, "position", steps[1])
    if one is None or two is None:
        return None
    axes = 3 if steps[0].text == "distanceZ" else 2
    return distance(f"{of.name}.{steps[0].text}.{other.name}", one[:axes], two[:axes])


def _orientation_between(checker: Checker, of: Thing, other: Thing, steps: Sequence[syntax.Word]) -> Value | None:
    one, two = _true_orientation(checker, of, steps[0]), _true_orientation(checker, other, steps[1])
    if one is None or two is None:
        return None
    angle = call(Function.ANGLE, (*one.components, *two.components))
    return Scalar(named(f"{of.name}.orientation_between.{other.name}", angle))


def _vector_error(checker: Checker, of: Thing, believed: Value | None, steps: Sequence[syntax.Word]) -> Value | None:
    """The norm of believed minus true."""
    true = _quantity(checker, of, ERRORS[steps[0].text][0], steps[0])
    if not isinstance(believed, Vector) or true is None:
        return None
    found = norm(f"{of.name}.{steps[0].text}", difference(believed.components, true))
    return _end(checker, found, steps[1:])


def _orientation_error(
    checker: Checker, of: Thing, believed: Value | None, steps: Sequence[syntax.Word]
) -> Value | None:
    true = _true_orientation(checker, of, steps[0])
    if not isinstance(believed, Orientation) or true is None:
        return None
    angle = call(Function.ANGLE, (*believed.components, *true.components))
    return _end(checker, Scalar(named(f"{of.name}.orientation_error", angle)), steps[1:])


QUANTITIES: dict[str, Callable[[Checker, Thing, Sequence[syntax.Word]], Value | None]] = {
    "position": _position,
    "velocity": _velocity,
    "velocity_angular": _velocity_angular,
    "orientation": _orientation,
}
"""Primitives of one object; here and below, functions get the steps, the primitive's name first."""

RELATIONS: dict[str, Callable[[Checker, Thing, Thing, Sequence[syntax.Word]], Value | None]] = {
    "distance": _distance,
    "distanceZ": _distance,
    "orientation_between": _orientation_between,
}
"""Primitives of two objects; the name of the other is the second step."""

ERRORS: dict[str, tuple[str, Callable[[Checker, Thing, Value | None, Sequence[syntax.Word]], Value | None]]] = {
    "localization_error": ("position", _vector_error),
    "velocity_error": ("velocity", _vector_error),
    "orientation_error": ("orientation", _orientation_error),
}
"""Errors of a robot's estimate of itself, and the attribute of its model that has the estimate."""

PRIMITIVES = (*QUANTITIES, *RELATIONS, *ERRORS)
"""What may follow the name of an object."""

_UNITS = {
    "position": "m",
    "velocity": "m/s",
    "velocity_angular": "rad/s",
    "orientation": "rad",
    "distance": "m",
    "distanceZ": "m",
    "orientation_between": "rad",
    "localization_error": "m",
    "velocity_error": "m/s",
    "orientation_error": "rad",
}


def unit(steps: Sequence[str]) -> str:
    """The unit of the primitive whose name is the first of `steps`; empty if it is not a primitive."""
    return "rad/s" if list(steps[:2]) == ["velocity", "angular"] else _UNITS.get(steps[0] if steps else "", "")
