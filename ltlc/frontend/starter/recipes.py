"""What is usually said of topics of a type: which fields, and which properties of them, with numbers to be changed."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from ltlc.frontend.language.types import values_of
from ltlc.inputs.messages.definitions import MessageTypes


@dataclass(frozen=True, slots=True)
class Rule:
    """A property: what its label ends in, English, and its text with the signals in braces, `{any}` one of the topic.

    One that is `only_offered` depends so much on the robot that it is written as a comment.
    """

    label: str
    english: str
    text: str
    only_offered: bool = False


@dataclass(frozen=True, slots=True)
class Recipe:
    """The paths of signals with a remark, by what their names end in, none for messages alone; and rules about them."""

    signals: Mapping[str, tuple[str, str]]
    rules: tuple[Rule, ...]


FRESH = Rule("fresh", "A message comes at least once a second.", "always age({any}) <= 1 s")
FRESH_IF = Rule(FRESH.label, FRESH.english, FRESH.text, only_offered=True)
COMES = Rule("comes", "A message comes within 10 s of the start.", "eventually new {any} within 10 s")

_SPEED = ("m/s, forwards", "rad/s, to the left")
_LIMITS = (
    Rule("speed_limit", "It is never faster than 1.5 m/s, forwards or backwards.", "never abs({speed}) > 1.5"),
    Rule("turn_limit", "It never turns faster than 2 rad/s.", "never abs({turn}) > 2"),
)
_AREA = "always (abs({position}.x) < 100 and abs({position}.y) < 100)"
_IN_AREA = Rule("in_area", "It stays in the 200 m by 200 m around the origin.", _AREA)
_ORIENTATION = "never (abs({orientation}.roll) > 0.5 or abs({orientation}.pitch) > 0.5)"
_UPRIGHT = Rule("upright", "It never tilts by more than 0.5 rad, sideways or forwards.", _ORIENTATION)


def _twist(path: str, **more: tuple[str, str]) -> dict[str, tuple[str, str]]:
    speed, turn = _SPEED
    return {"speed": (f"{path}linear.x", speed), "turn": (f"{path}angular.z", turn), **more}


def _pose(path: str) -> Recipe:
    signals = {"position": (f"{path}position", "m"), "orientation": (f"{path}orientation", "")}
    return Recipe(signals, (FRESH_IF, _IN_AREA, _UPRIGHT))


_STREAM = Recipe({"": ("", "")}, (FRESH,))


RECIPES: dict[str, Recipe] = {
    "nav_msgs/msg/Odometry": Recipe(
        _twist("twist.twist.", position=("pose.pose.position", "m")), (FRESH, *_LIMITS, _IN_AREA)
    ),
    "geometry_msgs/msg/Twist": Recipe(_twist(""), (FRESH_IF, *_LIMITS)),
    "geometry_msgs/msg/TwistStamped": Recipe(_twist("twist."), (FRESH_IF, *_LIMITS)),
    "geometry_msgs/msg/PoseStamped": _pose("pose."),
    "geometry_msgs/msg/PoseWithCovarianceStamped": _pose("pose.pose."),
    "sensor_msgs/msg/LaserScan": Recipe(
        {"": ("ranges", "m")},
        (FRESH, Rule("clear", "Nothing is nearer than 0.2 m.", "never min({any}) < 0.2")),
    ),
    "sensor_msgs/msg/Range": Recipe(
        {"": ("range", "m")}, (FRESH, Rule("clear", "Nothing is nearer than 0.2 m.", "never {any} < 0.2"))
    ),
    "sensor_msgs/msg/Imu": Recipe(
        {
            "orientation": ("orientation", ""),
            "turn": ("angular_velocity.z", "rad/s"),
            "acceleration": ("linear_acceleration", "m/s²"),
        },
        (
            FRESH,
            _UPRIGHT,
            _LIMITS[1],
            Rule(
                "no_shock", "It is never jolted along its way by more than 20 m/s².", "never abs({acceleration}.x) > 20"
            ),
        ),
    ),
    "sensor_msgs/msg/BatteryState": Recipe(
        {"": ("percentage", "0 to 1; NaN if it is not measured"), "voltage": ("voltage", "V")},
        (
            Rule("fresh", "A message comes at least every 10 s.", "always age({any}) <= 10 s"),
            Rule("charged", "The battery is never below a tenth.", "never {any} < 0.1"),
            Rule("voltage_kept", "The voltage is never below 10 V.", "never {voltage} < 10"),
        ),
    ),
    "sensor_msgs/msg/JointState": Recipe(
        {"": ("position", "rad or m"), "velocity": ("velocity", "rad/s or m/s")},
        (
            FRESH,
            Rule("in_reach", "No joint goes beyond 3.2, either way.", "never any(abs({any}) > 3.2)"),
            Rule("speed_limit", "No joint moves faster than 3.", "never any(abs({velocity}) > 3)"),
        ),
    ),
    "sensor_msgs/msg/NavSatFix": Recipe(
        {"status": ("status.status", "")},
        (FRESH, Rule("fix", "The receiver knows where it is.", "never {status} < NavSatStatus.STATUS_FIX")),
    ),
    "diagnostic_msgs/msg/DiagnosticArray": Recipe(
        {"levels": ("status[].level", "")},
        (FRESH_IF, Rule("no_error", "Nothing reports an error.", "never any({levels} == DiagnosticStatus.ERROR)")),
    ),
    "action_msgs/msg/GoalStatusArray": Recipe(
        {"": ("status_list[].status", "")},
        (Rule("no_abort", "No goal is given up.", "never any({any} == GoalStatus.STATUS_ABORTED)"),),
    ),
    "tf2_msgs/msg/TFMessage": Recipe({"": ("transforms[].child_frame_id", "")}, (COMES, FRESH_IF)),
    "sensor_msgs/msg/Image": _STREAM,
    "sensor_msgs/msg/CompressedImage": _STREAM,
    "sensor_msgs/msg/CameraInfo": _STREAM,
    "sensor_msgs/msg/PointCloud2": _STREAM,
}
"""By the full name of the type; others get what `recipe_for` makes of their fields."""

_MOST = 3
"""So many fields are offered of a type that has no recipe."""

_OF_KIND = {
    "number": ("in_range", "It is never greater than 100.", "never {value} > 100"),
    "boolean": ("off", "It is never true.", "never {value}"),
    "string": ("fine", "It never says ERROR.", 'never {value} == "ERROR"'),
    "numbers": ("in_range", "None is greater than 100.", "never any({value} > 100)"),
    "booleans": ("off", "None is true.", "never any({value})"),
    "strings": ("fine", "None says ERROR.", 'never any({value} == "ERROR")'),
    "vector": ("in_range", "It is never beyond 100 along x.", "never abs({value}.x) > 100"),
    "orientation": (_UPRIGHT.label, _UPRIGHT.english, _ORIENTATION.replace("orientation", "value")),
}


def recipe_for(message: str, types: MessageTypes) -> Recipe:
    """What is said of topics of this type; of one without values, of its messages alone."""
    if message in RECIPES:
        return RECIPES[message]
    every = values_of(message, types)
    values = [value for value in every if not value[0].endswith("sec")][:_MOST] or every[:1]
    if not values:
        return Recipe(_STREAM.signals, (COMES, FRESH_IF))
    names = ["" if number == 0 else re.sub(r"\W+", "_", path) for number, (path, _) in enumerate(values)]
    rules = [_offered(name, kind) for name, (_, kind) in zip(names, values, strict=True)]
    return Recipe({name: (path, "") for name, (path, _) in zip(names, values, strict=True)}, (COMES, FRESH_IF, *rules))


def _offered(name: str, kind: str) -> Rule:
    label, english, text = _OF_KIND[kind]
    return Rule(f"{name}_{label}".lstrip("_"), english, text.replace("value", name or "any"), only_offered=True)
