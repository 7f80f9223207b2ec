"""Simulation primitives: what can be said of an object's true state, and of a robot's own view of itself."""

from __future__ import annotations

from collections.abc import Callable

from ltlc.diagnostics import Label
from ltlc.language.names import Checker, ModelAttribute
from ltlc.language.signals import Place, Thing, Tracked, components, distance, named, norm, orientation
from ltlc.language.values import Orientation, Scalar, Value, Vector, call, difference
from ltlc.nearest import did_you_mean
from ltlc.specification.expressions import Expression, Function
from ltlc.syntax import tree as syntax

__all__ = ["PRIMITIVES", "ModelAttribute", "primitive"]

MODELLED = {"position": "vector", "velocity": "vector", "orientation": "orientation"}
"""The attributes of a model that primitives use, and the kind of value that each must be."""


def thing(checker: Checker, word: syntax.Word) -> Thing | None:
    """The object `word`: as it is declared, else after the pattern of `_simulator_`; None after an error."""
    name = word.text
    if name in checker.names.objects:
        return checker.names.objects[name]
    if name in checker.names.everywhere and name not in checker.names.models:
        defined = Label(checker.names.everywhere[name], "defined here")
        checker.report("LTL206", word.span, f"`{name}` is not an object of the simulation", defined)
        return None
    simulator = checker.names.simulator
    return Tracked(name, simulator.topic.replace("{name}", name), simulator.message)


def primitive(checker: Checker, node: syntax.Reference) -> Value | None:
    """The primitive that `node` (`robot.distance.stop_sign`) names."""
    steps = [step for step in node.steps if isinstance(step, syntax.Word)]
    if len(steps) < len(node.steps):
        checker.report("LTL212", node.span, f"`{checker.written(node)}` has no elements")
        return None
    if not steps:
        help = f"say what of it, as in `{node.name.text}.position`"
        checker.report("LTL206", node.span, f"`{node.name.text}` is an object, where a value is needed", help=help)
        return None
    if steps[0].text not in PRIMITIVES:
        _unknown(checker, node.name.text, steps[0])
        return None
    found = thing(checker, node.name)
    return None if found is None else PRIMITIVES[steps[0].text](checker, found, steps)


def _unknown(checker: Checker, name: str, step: syntax.Word) -> None:
    attributes = [a for a in checker.names.models.get(name, {}) if a not in MODELLED]
    known = [*PRIMITIVES, *attributes]
    help = did_you_mean(step.text, known) or "there are " + ", ".join(f"`{k}`" for k in known)
    checker.report("LTL105", step.span, f"`{name}` has no `{step.text}`", help=help)


def _quantity(checker: Checker, of: Thing, quantity: str, place: syntax.Word) -> tuple[Expression, ...] | None:
    """The components of a quantity, or an error at `place` that the object's source cannot give it."""
    found = components(of, quantity)
    if found is not None:
        return found
    what = "angular velocity" if quantity == "velocity.angular" else quantity
    source = "a fixed place" if isinstance(of, Place) else f"`{of.message}`"
    help = f"`object {of.name} TOPIC nav_msgs/Odometry` would tell it"
    checker.report("LTL208", place.span, f"the {what} of `{of.name}` is not known: its source is {source}", help=help)
    return None


def _axis(checker: Checker, vector: Vector, steps: list[syntax.Word]) -> Value | None:
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


def _end(checker: Checker, value: Value | None, steps: list[syntax.Word]) -> Value | None:
    """`value`, if no step follows."""
    if not steps or value is None:
        return value
    checker.report("LTL105", steps[0].span, f"a number has no `{steps[0].text}`")
    return None


def _position(checker: Checker, of: Thing, steps: list[syntax.Word]) -> Value | None:
    found = _quantity(checker, of, "position", steps[0])
    if found is None:
        return None
    x, y, z = found
    return _axis(checker, Vector((x, y, z), f"{of.name}.position"), steps[1:])


def _velocity(checker: Checker, of: Thing, steps: list[syntax.Word]) -> Value | None:
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


def _velocity_angular(checker: Checker, of: Thing, steps: list[syntax.Word]) -> Value | None:
    found = _quantity(checker, of, "velocity.angular", steps[0])
    return None if found is None else _end(checker, norm(f"{of.name}.velocity_angular", found), steps[1:])


def _true_orientation(checker: Checker, of: Thing, place: syntax.Word) -> Orientation | None:
    found = _quantity(checker, of, "orientation", place)
    if found is None:
        return None
    x, y, z, w = found
    return orientation(f"{of.name}.orientation", (x, y, z, w))


def _orientation(checker: Checker, of: Thing, steps: list[syntax.Word]) -> Value | None:
    found = _true_orientation(checker, of, steps[0])
    if found is None or len(steps) == 1:
        return found
    angles = dict(found.angles)
    if steps[1].text not in angles:
        help = did_you_mean(steps[1].text, angles) or "an orientation has `.roll`, `.pitch` and `.yaw`"
        checker.report("LTL105", steps[1].span, f"an orientation has no `{steps[1].text}`", help=help)
        return None
    return _end(checker, Scalar(angles[steps[1].text]), steps[2:])


def _other(checker: Checker, of: Thing, steps: list[syntax.Word]) -> Thing | None:
    """The object after `.distance.`, `.distanceZ.` or `.orientation_between.`."""
    if len(steps) == 1:
        help = f"name it, as in `{of.name}.{steps[0].text}.stop_sign`"
        checker.report("LTL105", steps[0].span, f"`{steps[0].text}` needs a second object", help=help)
        return None
    if len(steps) > 2:
        checker.report("LTL105", steps[2].span, f"a number has no `{steps[2].text}`")
        return None
    return thing(checker, steps[1])


def _distance(checker: Checker, of: Thing, steps: list[syntax.Word]) -> Value | None:
    """In the x, y plane for `distance`, in space for `distanceZ`."""
    other = _other(checker, of, steps)
    if other is None:
        return None
    one, two = _quantity(checker, of, "position", steps[0]), _quantity(checker, other, "position", steps[1])
    if one is None or two is None:
        return None
    axes = 3 if steps[0].text == "distanceZ" else 2
    return distance(f"{of.name}.{steps[0].text}.{other.name}", one[:axes], two[:axes])


def _orientation_between(checker: Checker, of: Thing, steps: list[syntax.Word]) -> Value | None:
    other = _other(checker, of, steps)
    if other is None:
        return None
    one, two = _true_orientation(checker, of, steps[0]), _true_orientation(checker, other, steps[1])
    if one is None or two is None:
        return None
    angle = call(Function.ANGLE, (*one.components, *two.components))
    return Scalar(named(f"{of.name}.orientation_between.{other.name}", angle))


def _perceived(checker: Checker, of: Thing, attribute: str, place: syntax.Word) -> Value | None:
    """What the robot believes of itself: an attribute of its model."""
    model = checker.names.models.get(of.name, {})
    if attribute in model:
        return model[attribute].value
    help = f"`model {of.name}: {attribute} TOPIC TYPE.FIELD ;` says where it is published"
    message = f"`{place.text}` needs the {attribute} that `{of.name}` itself believes to have"
    if of.name not in checker.lost:
        checker.report("LTL209", place.span, message, help=help)
    return None


def _vector_error(attribute: str) -> Callable[[Checker, Thing, list[syntax.Word]], Value | None]:
    def error(checker: Checker, of: Thing, steps: list[syntax.Word]) -> Value | None:
        """The norm of perceived minus true."""
        perceived, true = _perceived(checker, of, attribute, steps[0]), _quantity(checker, of, attribute, steps[0])
        if not isinstance(perceived, Vector) or true is None:
            return None
        found = norm(f"{of.name}.{steps[0].text}", difference(perceived.components, true))
        return _end(checker, found, steps[1:])

    return error


def _orientation_error(checker: Checker, of: Thing, steps: list[syntax.Word]) -> Value | None:
    perceived, true = _perceived(checker, of, "orientation", steps[0]), _true_orientation(checker, of, steps[0])
    if not isinstance(perceived, Orientation) or true is None:
        return None
    angle = call(Function.ANGLE, (*perceived.components, *true.components))
    return _end(checker, Scalar(named(f"{of.name}.orientation_error", angle)), steps[1:])


PRIMITIVES: dict[str, Callable[[Checker, Thing, list[syntax.Word]], Value | None]] = {
    "position": _position,
    "distance": _distance,
    "distanceZ": _distance,
    "velocity": _velocity,
    "velocity_angular": _velocity_angular,
    "orientation": _orientation,
    "orientation_between": _orientation_between,
    "localization_error": _vector_error("position"),
    "velocity_error": _vector_error("velocity"),
    "orientation_error": _orientation_error,
}
"""What follows the name of an object: each function gets the object and the steps, the primitive's name first."""
