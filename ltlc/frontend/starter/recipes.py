"""Usual properties of topics of a type: which fields, and which properties of them, with numbers to be changed."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace

from ltlc.dataclass import dataclass
from ltlc.frontend.language.types import values_of
from ltlc.frontend.starter.measured import Probe
from ltlc.inputs.messages.definitions import FieldType, MessageTypes
from ltlc.specification.wire import PRIMITIVES, Kind


@dataclass(frozen=True, slots=True)
class Rule:
    """A property: what its label ends in, English, and its text with the signals in braces, `{any}` one of the topic.

    A `?` in both is a number that is measured in recordings. A rule that is `only_offered` where nothing was measured
    depends so much on the robot that it is written as a comment. A limit of `beyond` or more says nothing.
    """

    label: str
    english: str
    text: str
    only_offered: bool = False
    beyond: float = math.inf

    def probe(self, names: Mapping[str, str]) -> Probe:
        """What to measure in a recording to know whether the rule holds, and with which number."""
        text = self.text.format(**names)
        if limited := _LIMITED.fullmatch(text):
            return Probe(limited[1], "number")
        keyword, _, predicate = text.partition(" ")
        return Probe(predicate if keyword == "never" else f"not ({predicate})", "predicate")

    @property
    def is_upper(self) -> bool:
        """Whether its `?` is an upper limit."""
        return "> ?" in self.text


@dataclass(frozen=True, slots=True)
class Recipe:
    """The paths of signals with a remark, by what their names end in, none for messages alone; and rules about them.

    Messages of a type that `is_stream` come again and again.
    """

    signals: Mapping[str, tuple[str, str]]
    rules: tuple[Rule, ...] = ()
    is_stream: bool = True


_LIMITED = re.compile(r"never (.+) [<>] \?")

_SPEED = ("m/s, forwards", "rad/s, to the left")
_LIMITS = (
    Rule("speed_limit", "It is never faster than ? m/s, forwards or backwards.", "never abs({speed}) > ?"),
    Rule("turn_limit", "It never turns faster than ? rad/s.", "never abs({turn}) > ?"),
)
_IN_AREA = Rule("in_area", "It stays within ? m of the origin.", "never hypot({position}.x, {position}.y) > ?")
_ORIENTATION = "never max(abs({orientation}.roll), abs({orientation}.pitch)) > ?"
_UPRIGHT = Rule("upright", "It never tilts by more than ? rad, sideways or forwards.", _ORIENTATION, beyond=math.pi)
_CLEAR = Rule("clear", "Nothing is nearer than ? m.", "never min({any}) < ?")


def _twist(path: str, **more: tuple[str, str]) -> dict[str, tuple[str, str]]:
    speed, turn = _SPEED
    return {"speed": (f"{path}linear.x", speed), "turn": (f"{path}angular.z", turn), **more}


def _pose(path: str) -> Recipe:
    signals = {"position": (f"{path}position", "m"), "orientation": (f"{path}orientation", "")}
    return Recipe(signals, (_IN_AREA, _UPRIGHT), is_stream=False)


_STREAM = Recipe({"": ("", "")})


RECIPES: dict[str, Recipe] = {
    "nav_msgs/msg/Odometry": Recipe(_twist("twist.twist.", position=("pose.pose.position", "m")), (*_LIMITS, _IN_AREA)),
    "geometry_msgs/msg/Twist": Recipe(_twist(""), _LIMITS, is_stream=False),
    "geometry_msgs/msg/TwistStamped": Recipe(_twist("twist."), _LIMITS, is_stream=False),
    "geometry_msgs/msg/PoseStamped": _pose("pose."),
    "geometry_msgs/msg/PoseWithCovarianceStamped": _pose("pose.pose."),
    "sensor_msgs/msg/LaserScan": Recipe({"": ("ranges", "m")}, (_CLEAR,)),
    "sensor_msgs/msg/Range": Recipe({"": ("range", "m")}, (replace(_CLEAR, text="never {any} < ?"),)),
    "sensor_msgs/msg/Imu": Recipe(
        {
            "orientation": ("orientation", ""),
            "turn": ("angular_velocity.z", "rad/s"),
            "acceleration": ("linear_acceleration", "m/s²"),
        },
        (
            _UPRIGHT,
            _LIMITS[1],
            Rule(
                "no_shock", "It is never jolted along its way by more than ? m/s².", "never abs({acceleration}.x) > ?"
            ),
        ),
    ),
    "sensor_msgs/msg/BatteryState": Recipe(
        {"": ("percentage", "0 to 1; NaN if it is not measured"), "voltage": ("voltage", "V")},
        (
            Rule("charged", "The charge is never below ?.", "never {any} < ?"),
            Rule("voltage_kept", "The voltage is never below ? V.", "never {voltage} < ?"),
        ),
    ),
    "sensor_msgs/msg/JointState": Recipe(
        {"": ("position", "rad or m"), "velocity": ("velocity", "rad/s or m/s")},
        (
            Rule("most", "No joint goes beyond ?.", "never max({any}) > ?"),
            Rule("least", "No joint goes below ?.", "never min({any}) < ?"),
            Rule("velocity_most", "No joint moves faster than ?, forwards.", "never max({velocity}) > ?"),
            Rule("velocity_least", "No joint moves faster than ?, backwards.", "never min({velocity}) < ?"),
        ),
    ),
    "sensor_msgs/msg/NavSatFix": Recipe(
        {"status": ("status.status", "")},
        (Rule("fix", "The receiver knows where it is.", "never {status} < NavSatStatus.STATUS_FIX"),),
    ),
    "diagnostic_msgs/msg/DiagnosticArray": Recipe(
        {"levels": ("status[].level", "")},
        (Rule("no_error", "Nothing reports an error.", "never any({levels} == DiagnosticStatus.ERROR)"),),
        is_stream=False,
    ),
    "action_msgs/msg/GoalStatusArray": Recipe(
        {"": ("status_list[].status", "")},
        (Rule("no_abort", "No goal is aborted.", "never any({any} == GoalStatus.STATUS_ABORTED)"),),
        is_stream=False,
    ),
    "tf2_msgs/msg/TFMessage": Recipe({"": ("transforms[].child_frame_id", "")}, is_stream=False),
    "sensor_msgs/msg/Image": _STREAM,
    "sensor_msgs/msg/CompressedImage": _STREAM,
    "sensor_msgs/msg/CameraInfo": _STREAM,
    "sensor_msgs/msg/PointCloud2": _STREAM,
}
"""By the full name of the type; others get what `recipe_for` makes of their fields."""

_MOST = 3
"""So many fields are offered of a type that has no recipe."""

_OF_KIND: dict[str, tuple[Rule, ...]] = {
    "number": (
        Rule("most", "It is never more than ?.", "never {value} > ?"),
        Rule("least", "It is never less than ?.", "never {value} < ?"),
    ),
    "numbers": (
        Rule("most", "None is ever more than ?.", "never max({value}) > ?"),
        Rule("least", "None is ever less than ?.", "never min({value}) < ?"),
    ),
    "vector": (Rule("length", "Its length is never more than ?.", "never norm({value}) > ?"),),
    "orientation": (replace(_UPRIGHT, text=_ORIENTATION.replace("orientation", "value")),),
    "boolean": (Rule("off", "It is never true.", "never {value}"),),
    "booleans": (Rule("off", "None is ever true.", "never any({value})"),),
    "string": (),
    "strings": (),
}
"""Rules for values of a kind."""


def recipe_for(message: str, types: MessageTypes) -> Recipe:
    """The recipe for topics of this type; for one without values, about its messages alone."""
    recipe = RECIPES.get(message) or _of_fields(message, types)
    named = [rule for name, (path, _) in recipe.signals.items() for rule in _named(name, message, path, types)]
    return replace(recipe, rules=(*recipe.rules, *named))


def _of_fields(message: str, types: MessageTypes) -> Recipe:
    every = values_of(message, types)
    others = [(path, kind) for path, kind in every if not _is_aside(path) and not _are_bytes(message, path, types)]
    values = others[:_MOST] or every[:1]
    if not values:
        return Recipe(_STREAM.signals, is_stream=False)
    names = ["" if number == 0 else re.sub(r"\W+", "_", path) for number, (path, _) in enumerate(values)]
    rules = [
        replace(
            rule,
            label=f"{name}_{rule.label}".lstrip("_"),
            text=rule.text.replace("value", name or "any"),
            only_offered=True,
        )
        for name, (_, kind) in zip(names, values, strict=True)
        for rule in _OF_KIND[kind]
    ]
    signals = {name: (path, "") for name, (path, _) in zip(names, values, strict=True)}
    return Recipe(signals, tuple(rules), is_stream=False)


def _is_aside(path: str) -> bool:
    """Whether a field is a time, or the shape of a `Float64MultiArray` and the like."""
    return path.endswith("sec") or path.startswith("layout.")


def _are_bytes(message: str, path: str, types: MessageTypes) -> bool:
    """Whether a field is an id, a sum or a picture."""
    type_ = field_at(message, path, types)[2]
    return type_.is_list and type_.base in ("uint8", "byte", "char", "octet")


def _named(name: str, message: str, path: str, types: MessageTypes) -> Iterator[Rule]:
    """That a field has one of the values which its message names."""
    constants = constants_of(message, path, types)
    if constants:
        owner, values = constants
        is_in = f"in {{{{{', '.join(f'{owner}.{constant}' for constant in values)}}}}}"
        text = f"always all({{{name or 'any'}}} {is_in})" if "[]" in path else f"always {{{name or 'any'}}} {is_in}"
        english = "It has one of the values that its message names."
        yield Rule(f"{name}_named".lstrip("_"), english, text, only_offered=True)


def constants_of(message: str, path: str, types: MessageTypes) -> tuple[str, dict[str, float]] | None:
    """The message with the field at the end of `path`, in short, and its constants that are values of this field.

    Those are the ones called as the field, `STATUS_FIX` of `status`, or all where no other field is an integer.
    """
    owner, name, field = field_at(message, path, types)
    if not _is_integer(field):
        return None
    of = types.messages[owner]
    numbers = {constant: value for constant, value in of.constants.items() if isinstance(value, float | int)}
    called = {constant: value for constant, value in numbers.items() if constant.startswith(f"{name.upper()}_")}
    is_only = sum(map(_is_integer, of.fields.values())) == 1
    found = called or (numbers if is_only else {})
    return (owner.rpartition("/")[2], found) if len(found) > 1 else None


def field_at(message: str, path: str, types: MessageTypes) -> tuple[str, str, FieldType]:
    """The message with the last field of `path`, the name of that and its type; without a path, the message itself."""
    steps = [step if step != "[]" else 0 for step in re.findall(r"\w+|\[\]", path)]
    along = types.along(message, steps)
    *_, last = [0, *(place for place, step in enumerate(steps) if step != 0)]
    return along[last].base, str(steps[last]) if steps else "", along[last + 1] if steps else along[0]


def _is_integer(type_: FieldType) -> bool:
    numbers = PRIMITIVES.get(type_.base)
    return numbers is not None and numbers.kind is Kind.INTEGER and not type_.is_list
