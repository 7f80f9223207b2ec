"""Where the values of signals come from: fields of messages, and the ground truth of the objects of a simulation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ltlc.dataclass import dataclass
from ltlc.frontend.language.values import (
    Array,
    Orientation,
    Scalar,
    Text,
    Truth,
    Value,
    Vector,
    call,
    difference,
)
from ltlc.specification.expressions import (
    Current,
    Expression,
    Field,
    Match,
    Number,
    Parallel,
    PathStep,
    Signal,
    Slope,
    ValueType,
)
from ltlc.specification.functions import Function

ANGLES = {"roll": Function.ROLL, "pitch": Function.PITCH, "yaw": Function.YAW}
"""The parts of an orientation that are numbers."""


def signal(
    name: str, definition: Field | Expression, type_: ValueType = ValueType.NUMBER, whole: str = ""
) -> Expression:
    """The latest sample of the signal `name`."""
    return Current(Signal(name, type_, definition, whole=whole))


def from_field(name: str, kind: str, field: Field) -> Value:
    """The value called `name` that `field` holds; `kind` is that of a `types.TypePath`, not `message`."""
    match kind:
        case "number":
            return Scalar(signal(name, field))
        case "boolean":
            return Truth(signal(name, field, ValueType.BOOLEAN))
        case "string":
            return Text(signal(name, field, ValueType.STRING))
        case "numbers" | "booleans" | "strings":
            type_ = ValueType(f"array of {kind}")
            assert type_.element is not None
            return Array(signal(name, field, type_), type_.element)
        case "vector":
            x, y, z = (signal(f"{name}.{axis}", _inside(field, axis), whole=name) for axis in "xyz")
            return Vector((x, y, z), name)
        case "orientation":
            x, y, z, w = (signal(f"{name}.{axis}", _inside(field, axis), whole=name) for axis in "xyzw")
            return orientation(name, (x, y, z, w))
        case _:
            raise ValueError(f"not a kind of value: {kind}")


def _inside(field: Field, *steps: PathStep) -> Field:
    return replace(field, path=(*field.path, *steps))


def orientation(name: str, components: tuple[Expression, Expression, Expression, Expression]) -> Orientation:
    """The orientation called `name`, with its angles as signals of their own."""
    angles = {angle: signal(f"{name}.{angle}", call(function, components)) for angle, function in ANGLES.items()}
    return Orientation(components, signal(name, angles["yaw"]), tuple(angles.items()))


@dataclass(frozen=True, slots=True)
class Landmark:
    """A thing that does not move; its velocity is 0 and it has no orientation."""

    name: str
    coordinates: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Tracked:
    """A thing whose ground truth is published on `topic` in messages of type `message`, one of `SOURCES`."""

    name: str
    topic: str
    message: str


Thing = Landmark | Tracked
"""An object of the simulation, by where its ground truth comes from."""

_POSE = {"position": ("position",), "orientation": ("orientation",)}

SOURCES: dict[str, Callable[[str], dict[str, tuple[PathStep, ...]]]] = {
    "nav_msgs/msg/Odometry": lambda _: {
        "position": ("pose", "pose", "position"),
        "orientation": ("pose", "pose", "orientation"),
        "velocity": ("twist", "twist", "linear"),
        "velocity.angular": ("twist", "twist", "angular"),
    },
    "geometry_msgs/msg/PoseStamped": lambda _: {q: ("pose", *path) for q, path in _POSE.items()},
    "geometry_msgs/msg/Pose": lambda _: dict(_POSE),
    "tf2_msgs/msg/TFMessage": lambda name: {
        "position": ("transforms", Match("child_frame_id", name), "transform", "translation"),
        "orientation": ("transforms", Match("child_frame_id", name), "transform", "rotation"),
    },
    "gazebo_msgs/msg/ModelStates": lambda name: {
        "position": ("pose", Parallel("name", name), "position"),
        "orientation": ("pose", Parallel("name", name), "orientation"),
        "velocity": ("twist", Parallel("name", name), "linear"),
        "velocity.angular": ("twist", Parallel("name", name), "angular"),
    },
}
"""The message types that give the ground truth of an object, and where in them each quantity of `name` is.

A velocity that a source does not give is the slope of the position.
"""

SIMULATORS = {
    "odometry": ("/model/{name}/odometry", "nav_msgs/msg/Odometry"),
    "tf": ("/tf", "tf2_msgs/msg/TFMessage"),
    "model_states": ("/gazebo/model_states", "gazebo_msgs/msg/ModelStates"),
}
"""The values of `_simulator_` and the topic and message type they give to an object that is not declared."""


def components(thing: Thing, quantity: str) -> tuple[Expression, ...] | None:
    """The components of a quantity of `thing`, such as `velocity.angular`; None if its source cannot give it."""
    axes = "xyzw" if quantity == "orientation" else "xyz"
    if isinstance(thing, Landmark):
        return _of_place(thing, quantity)
    path = SOURCES[thing.message](thing.name).get(quantity)
    if path is not None:
        field = Field(thing.topic, thing.message, path)
        whole = f"{thing.name}.{quantity}"
        return tuple(signal(f"{whole}.{axis}", _inside(field, axis), whole=whole) for axis in axes)
    if quantity != "velocity":
        return None
    position = components(thing, "position") or ()
    slopes = (Slope(p.signal) for p in position if isinstance(p, Current))
    return tuple(signal(f"{thing.name}.velocity.{axis}", slope) for axis, slope in zip(axes, slopes, strict=True))


def _of_place(place: Landmark, quantity: str) -> tuple[Expression, ...] | None:
    if quantity == "position":
        return tuple(Number(c) for c in place.coordinates)
    return None if quantity == "orientation" else (Number(0.0), Number(0.0), Number(0.0))


def named(name: str, expression: Expression) -> Expression:
    """`expression` as a signal called `name`; a constant needs none."""
    return expression if isinstance(expression, Number) else signal(name, expression)


def norm(name: str, parts: tuple[Expression, ...]) -> Scalar:
    """The signal `name` that is the Euclidean norm of `parts`."""
    return Scalar(named(name, call(Function.NORM, parts)))


def distance(name: str, one: tuple[Expression, ...], other: tuple[Expression, ...]) -> Scalar:
    """The signal `name` that is the Euclidean distance of two points."""
    return norm(name, difference(one, other))
