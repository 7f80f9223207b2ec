"""Primitives, models, objects and history: which fields of which topics they are computed from, and how."""

from __future__ import annotations

import pytest
from language_support import codes_of, compiled, findings, marked, only_comparison, only_property

from ltlc.specification.expressions import (
    Call,
    Current,
    Expression,
    Field,
    Match,
    Number,
    Parallel,
    Past,
    Slope,
    ValueType,
)
from ltlc.specification.functions import Function
from ltlc.specification.specification import fields, topics

ODOMETRY = "/model/robot/odometry"


def left_of(text: str) -> Expression:
    return only_comparison(text).left


def sources(text: str) -> dict[str, tuple[str, tuple[object, ...]]]:
    """The signals of a property that are read from messages, with topic and path."""
    found = only_property(text)
    read = {s.name: (f.topic, f.path) for i in found.inputs() for s, f in fields(i.signal)}
    return dict(read)


def definition(expression: Expression) -> object:
    assert isinstance(expression, Current)
    return expression.signal.definition


@pytest.mark.parametrize(
    ("primitive", "names"),
    [
        ("position.x", ["robot.position.x"]),
        ("velocity", ["robot.velocity.x", "robot.velocity.y", "robot.velocity.z"]),
        ("velocity.y", ["robot.velocity.y"]),
        ("velocity.linear.y", ["robot.velocity.y"]),
        ("velocity.angular.z", ["robot.velocity.angular.z"]),
        ("velocity_angular", [f"robot.velocity.angular.{axis}" for axis in "xyz"]),
        ("orientation", [f"robot.orientation.{axis}" for axis in "xyzw"]),
        ("orientation.roll", [f"robot.orientation.{axis}" for axis in "xyzw"]),
    ],
)
def test_primitives_of_an_undeclared_object_are_read_from_its_odometry(primitive: str, names: list[str]) -> None:
    found = sources(f"never robot.{primitive} > 1")
    assert list(found) == names
    assert {topic for topic, _ in found.values()} == {ODOMETRY}


def test_a_signal_is_named_as_the_author_writes_it() -> None:
    for name in ("position.x", "velocity", "velocity.linear.x", "distance.sign", "orientation", "orientation.yaw"):
        found = left_of(f"never robot.{name} > 1")
        assert isinstance(found, Current)
        assert found.signal.name == f"robot.{name}"


def test_speed_is_the_norm_of_the_velocity() -> None:
    found = definition(left_of("never robot.velocity > 1"))
    assert isinstance(found, Call)
    assert found.function is Function.NORM
    assert len(found.arguments) == 3


@pytest.mark.parametrize(("primitive", "axes"), [("distance", "xy"), ("distanceZ", "xyz")])
def test_distance_is_in_the_plane_and_distance_z_in_space(primitive: str, axes: str) -> None:
    found = sources(f"never robot.{primitive}.box > 1")
    assert list(found) == [f"{thing}.position.{axis}" for axis in axes for thing in ("robot", "box")]


def test_a_place_is_made_of_constants() -> None:
    text = "object sign at (1, -2, 3) never robot.distance.sign > 1"
    assert list(sources(text)) == ["robot.position.x", "robot.position.y"]


def test_what_is_constant_is_computed() -> None:
    text = "object a at (0, 0, 0) object b at (3, 4, 12) never a.distance.b > v or a.distanceZ.b > v or a.velocity > v"
    assert [atom.name for atom in only_property(text).atoms] == ["v < 5", "v < 13", "v < 0"]


SOURCES = [
    ("object robot /truth Odometry", "/truth", ("pose", "pose", "position", "x")),
    ("object robot /truth PoseStamped", "/truth", ("pose", "position", "x")),
    ("object robot truth geometry_msgs/Pose", "/truth", ("position", "x")),
    (
        "object robot /tf TFMessage",
        "/tf",
        ("transforms", Match("child_frame_id", "robot"), "transform", "translation", "x"),
    ),
    ("object robot /states ModelStates", "/states", ("pose", Parallel("name", "robot"), "position", "x")),
    ("_simulator_ = odometry", ODOMETRY, ("pose", "pose", "position", "x")),
    ("_simulator_ = tf", "/tf", ("transforms", Match("child_frame_id", "robot"), "transform", "translation", "x")),
    ("_simulator_ = model_states", "/gazebo/model_states", ("pose", Parallel("name", "robot"), "position", "x")),
    ("_simulator_ = /truth/{name}/odom", "/truth/robot/odom", ("pose", "pose", "position", "x")),
]


@pytest.mark.parametrize(("command", "topic", "path"), SOURCES)
def test_an_objects_source_tells_where_its_position_is(command: str, topic: str, path: tuple[object, ...]) -> None:
    assert sources(f"{command}\nnever robot.position.x > 1") == {"robot.position.x": (topic, path)}


def test_objects_models_and_settings_hold_wherever_they_stand() -> None:
    text = "never robot.localization_error > 1\nobject robot /truth Odometry _simulator_ = tf\n"
    text += "model robot: position /odom Odometry.pose.pose.position ;"
    assert topics(only_property(text)) == ("/odom", "/truth")


@pytest.mark.parametrize("type_", ["PoseStamped", "Pose", "TFMessage"])
def test_a_velocity_that_is_not_told_is_the_slope_of_the_position(type_: str) -> None:
    found = definition(left_of(f"object robot /p {type_} never robot.velocity.x > 1"))
    assert isinstance(found, Slope)
    assert found.signal.name == "robot.position.x"


def test_errors_compare_what_the_robot_believes_with_the_truth() -> None:
    text = "model robot: position /odom Odometry.pose.pose.position ; never robot.localization_error > 1"
    assert [(s, t) for s, (t, _) in sources(text).items()] == [
        (name, topic)
        for axis in "xyz"
        for name, topic in ((f"robot.model.position.{axis}", "/odom"), (f"robot.position.{axis}", ODOMETRY))
    ]


def test_an_orientation_error_is_an_angle() -> None:
    text = "model robot: orientation /odom Odometry.pose.pose.orientation ; never robot.orientation_error > 1"
    found = definition(left_of(text))
    assert isinstance(found, Call)
    assert (found.function, len(found.arguments)) == (Function.ANGLE, 8)


def test_a_free_attribute_of_a_model_is_a_signal() -> None:
    text = "model robot: battery /battery BatteryState.percentage ; never robot.battery < 0.1"
    assert sources(text) == {"robot.battery": ("/battery", ("percentage",))}


def test_history_is_of_a_signal_and_counts_its_samples() -> None:
    found = left_of("never @{robot.velocity, -3} > 1")
    assert isinstance(found, Past)
    assert (found.signal.name, found.samples) == ("robot.velocity", 3)


def test_history_of_no_samples_ago_is_the_signal() -> None:
    for offset in ("0", "-0"):
        assert isinstance(left_of(f"never @{{v, {offset}}} > 1"), Current)


def test_history_of_a_vector_is_that_of_its_components() -> None:
    text = "decl goal /goal PoseStamped.pose.position never (goal - @{goal, -2}).x > 1"
    assert only_property(text).atoms[0].name == "goal.x - @{goal.x, -2} > 1"


def test_history_of_what_is_computed_is_that_of_a_signal_that_is_computed_so() -> None:
    declared = "decl a /a Float64.data\ndecl b /b Float64.data\n"
    found = only_property(declared + "never @{a - 2 * b, -3} > 1")
    (read,) = found.inputs()
    assert isinstance(read, Past)
    assert read.samples == 3
    assert read.signal.name == "a - 2 * b"
    assert topics(found) == ("/a", "/b")


def test_history_of_a_predicate_is_that_of_a_boolean_that_has_samples_where_nothing_in_it_is_nan() -> None:
    declared = "decl a /a Float64.data\ndecl n /n Int64.data\n"
    for predicate, is_measured in (("a > 1 and not n == 3", True), ("n == 3", False)):
        (read,) = only_property(f"{declared}always @{{{predicate}, -2}}").inputs()
        assert isinstance(read, Past)
        assert (read.signal.name, read.signal.type, read.samples) == (predicate, ValueType.BOOLEAN, 2)
        assert (read.signal.when is not None) == is_measured


@pytest.mark.parametrize("predicate", ["once a > 1", "a > @{a, opening}", "age(a) < 1 s"])
def test_history_is_of_a_predicate_at_one_step(predicate: str) -> None:
    assert codes_of(f"decl a /a Float64.data\nnever @{{{predicate}, -1}}") == ["LTL231"]


@pytest.mark.parametrize("predicate", ["new a and a > 1", "a > @{a, -1}"])
def test_history_is_of_a_predicate_over_what_signals_are_now(predicate: str) -> None:
    assert codes_of(f"decl a /a Float64.data\nnever @{{{predicate}, -1}}") == ["LTL210"]


@pytest.mark.parametrize("computed", ["1 + 1", "@{a, -1} + a", "@{a, opening} + a", "scan[2:]"])
def test_what_has_no_samples_has_no_history(computed: str) -> None:
    declared = "decl a /a Float64.data\ndecl scan /scan LaserScan.ranges\n"
    assert codes_of(declared + f"never a > 5 and @{{{computed}, -1}} == 0") == ["LTL210"]


@pytest.mark.parametrize(
    ("earlier", "help"), [("new a", "once new"), ("@{a, -1}", "look back once"), ("age(a)", ""), ("scan[2:]", "")]
)
def test_what_has_no_samples_is_answered_by_what_it_reads(earlier: str, help: str) -> None:
    declared = "decl a /a Float64.data\ndecl scan /scan LaserScan.ranges\n"
    [found] = [each for each in findings(f"{declared}never @{{{earlier}, -1}}") if each.code == "LTL210"]
    assert help in found.help
    assert bool(help) == bool(found.help)


def test_history_of_an_association_is_that_of_the_signal_it_names() -> None:
    assert only_property("yaw = robot.orientation before = @{yaw, -1} never yaw - before > 1").atoms[0].name == (
        "robot.orientation - @{robot.orientation, -1} > 1"
    )


def test_an_element_of_an_array_is_a_signal_and_min_and_max_fold_one() -> None:
    header = "decl scan /scan LaserScan.ranges "
    found = only_property(header + "never scan[3] > 1 or min(scan) < 0.3 or max(scan) - @{scan[3], -1} > 2")
    assert [a.name for a in found.atoms] == ["scan[3] > 1", "min(scan) < 0.3", "max(scan) - @{scan[3], -1} > 2"]
    first = found.inputs()[0].signal.definition
    assert isinstance(first, Field)
    assert first.path == ("ranges", 3)


def test_the_same_condition_is_one_atom_however_it_is_written() -> None:
    text = "never (v > 2 or 2 < v or v > 1 + 1 or v > 2.0 or not not v >{0} 2)"
    assert [atom.name for atom in only_property(text).atoms] == ["v > 2"]


def test_a_message_constant_is_a_number() -> None:
    comparison = only_comparison("never v == DiagnosticStatus.ERROR")
    assert comparison.right == Number(2.0)


def test_a_declared_name_is_not_an_object() -> None:
    text = "decl goal /goal PoseStamped.pose.position never robot.distance.goal > 1"
    (found,) = [d for d in findings(text) if d.code != "LTL104"]
    assert (found.code, marked(found)) == ("LTL206", "goal")


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("1 / 0", "1e999"),
        ("-1 / 0", "-1e999"),
        ("0.1 + 0.2", "0.30000000000000004"),
        ("7 / 2", "3.5"),
        ("-(2 * 3)", "-6"),
    ],
)
def test_constants_are_computed_as_ieee_doubles(expression: str, value: str) -> None:
    assert only_property(f"never v > {expression}").atoms[0].name == f"v > {value}"


@pytest.mark.parametrize("expression", ["0 / 0", "sqrt(-1)", "1 / 0 - 1 / 0", "0 * (1 / 0)", "mod(robot.velocity, 0)"])
def test_what_never_has_a_value_is_refused(expression: str) -> None:
    assert "LTL213" in codes_of(f"never robot.velocity > {expression}")


def test_comparisons_of_constants_are_true_or_false() -> None:
    found = only_property("always (1 < 2 or v > 1) and eventually (0.1 + 0.2 == 0.3 and v < 1)")
    assert [atom.name for atom in found.atoms] == ["v > 1", "v < 1"]


def test_names_that_no_property_uses_are_told() -> None:
    specification = compiled("decl v /v Float64.data a = v b = a c = 1 object o at (0, 0, 0) never b > 1")
    assert {d.name: d.used for d in specification.definitions} == {
        "v": True,
        "a": True,
        "b": True,
        "c": False,
        "o": False,
    }
