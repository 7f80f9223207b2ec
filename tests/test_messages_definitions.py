"""Message definitions: those that ship, and those of folders."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
from language_support import SIGNALS, codes_of, compiled

import ltlc.inputs.messages
from ltlc.backends.ros2.node.classes import class_of
from ltlc.base.files import compact_json
from ltlc.cli import main
from ltlc.frontend.language import load
from ltlc.inputs.messages.generate import jazzy_definitions
from ltlc.specification.expressions import Field, ValueType
from ltlc.specification.specification import fields


def package(folder: Path, name: str, **definitions: str) -> Path:
    """A ROS package with message definitions, as a source tree has it."""
    (folder / name / "msg").mkdir(parents=True)
    (folder / name / "package.xml").write_text("<package/>")
    for message, text in definitions.items():
        (folder / name / "msg" / f"{message}.msg").write_text(text)
    return folder / name


def field_of(text: str, name: str, folder: Path) -> Field:
    """The field that the one declared signal of a specification reads."""
    path = folder / "props.txt"
    path.write_text(text)
    specification, diagnostics = load(path, [str(folder)])
    assert specification is not None, diagnostics
    (part,) = specification.properties[0].inputs()
    ((signal, field),) = fields(part.signal)
    assert signal.name == name
    return field


def test_the_shipped_definitions_are_those_of_rosbags() -> None:
    stored = (Path(ltlc.inputs.messages.__file__).parent / "jazzy.json").read_text()
    assert stored == compact_json(jazzy_definitions()), "run `python -m ltlc.inputs.messages.generate`"


def test_a_package_is_found_in_a_folder_of_packages(tmp_path: Path) -> None:
    package(tmp_path, "wheel_msgs", Wheel="float32 speed\ngeometry_msgs/Vector3[2] ends\nuint8 FAST=7\n")
    text = "decl s /wheel Wheel.ends[1]\nnever s.x > Wheel.FAST"
    field = field_of(text, "s.x", tmp_path)
    assert (field.message, field.path) == ("wheel_msgs/msg/Wheel", ("ends", 1, "x"))


def test_a_package_itself_can_be_given(tmp_path: Path) -> None:
    home = package(tmp_path, "wheel_msgs", Wheel="float32 speed\n")
    assert field_of("decl s /w Wheel.speed never s > 1", "s", home).message == "wheel_msgs/msg/Wheel"


def test_loose_files_belong_to_a_package_called_as_their_folder(tmp_path: Path) -> None:
    folder = tmp_path / "loose_msgs"
    folder.mkdir()
    (folder / "Wheel.msg").write_text("float32 speed\n")
    assert field_of("decl s /w loose_msgs/Wheel.speed never s > 1", "s", folder).message == "loose_msgs/msg/Wheel"


def test_messages_of_a_folder_can_use_one_another(tmp_path: Path) -> None:
    package(tmp_path, "car_msgs", Car="Wheel front\n", Wheel="float32 speed\n")
    field = field_of("decl s /car Car.front.speed never s > 1", "s", tmp_path)
    assert field.path == ("front", "speed")


def test_a_second_package_makes_a_short_name_ambiguous(tmp_path: Path) -> None:
    package(tmp_path, "my_msgs", Odometry="float32 speed\n")
    path = tmp_path / "props.txt"
    path.write_text("decl s /o Odometry.speed\nnever s > 1")
    _, diagnostics = load(path, [str(tmp_path)])
    assert diagnostics[0].code == "LTL202"
    assert "my_msgs/msg/Odometry" in diagnostics[0].message


NAVIGATE = """# Goal
geometry_msgs/PoseStamped pose
---
uint16 NONE=0
uint16 TIMED_OUT=3
uint16 error_code
---
float32 distance_remaining
"""


@pytest.fixture
def interfaces(tmp_path: Path) -> Path:
    """A package with an action and a service."""
    for kind, name, text in (("action", "Navigate", NAVIGATE), ("srv", "Lift", "float32 height\n---\nbool done\n")):
        folder = tmp_path / "robot_msgs" / kind
        folder.mkdir(parents=True)
        (folder / f"{name}.{kind}").write_text(text)
    return tmp_path


@pytest.mark.parametrize(
    ("type_", "message", "path"),
    [
        ("Navigate_FeedbackMessage.feedback.distance_remaining", "action/Navigate_FeedbackMessage", ("feedback",)),
        ("robot_msgs/Navigate_FeedbackMessage.goal_id.uuid[3]", "action/Navigate_FeedbackMessage", ("goal_id",)),
        ("robot_msgs/action/Navigate_SendGoal_Event.info.event_type", "action/Navigate_SendGoal_Event", ("info",)),
        ("Navigate_GetResult_Event.response[0].status", "action/Navigate_GetResult_Event", ("response", 0)),
        ("Navigate_GetResult_Event.response[0].result.error_code", "action/Navigate_GetResult_Event", ("response", 0)),
        (
            "Navigate_SendGoal_Event.request[0].goal.pose.pose.position.x",
            "action/Navigate_SendGoal_Event",
            ("request",),
        ),
        ("robot_msgs/srv/Lift_Event.request[0].height", "srv/Lift_Event", ("request", 0)),
        ("Lift_Event.info.sequence_number", "srv/Lift_Event", ("info",)),
    ],
)
def test_the_events_of_actions_and_services_are_messages(
    interfaces: Path, type_: str, message: str, path: tuple[str | int, ...]
) -> None:
    field = field_of(f"decl x /go/_action/feedback {type_} never x > 1", "x", interfaces)
    assert field.message == f"robot_msgs/{message}"
    assert field.path[: len(path)] == path


def test_constants_of_actions_are_those_of_their_sections(interfaces: Path) -> None:
    text = "decl code /x Navigate_GetResult_Event.response[0].result.error_code never code == Navigate_Result.TIMED_OUT"
    assert field_of(text, "code", interfaces).numbers.most == 65535


@pytest.mark.parametrize(
    ("name", "offered"), [("Navigate", "Navigate_FeedbackMessage"), ("robot_msgs/Lift", "robot_msgs/Lift_Event")]
)
def test_an_action_or_service_itself_is_no_message(interfaces: Path, name: str, offered: str) -> None:
    path = interfaces / "props.txt"
    path.write_text(f"decl x /x {name}.x never x > 1")
    _, diagnostics = load(path, [str(interfaces)])
    assert diagnostics[0].code == "LTL201"
    assert offered in diagnostics[0].help


@pytest.mark.parametrize(
    ("kind", "text"), [("srv", "bool a\n"), ("srv", "---\n---\n"), ("action", "bool a\n---\nbool b\n")]
)
def test_a_definition_with_another_number_of_sections_is_refused(tmp_path: Path, kind: str, text: str) -> None:
    folder = tmp_path / "robot_msgs" / kind
    folder.mkdir(parents=True)
    (folder / f"Bad.{kind}").write_text(text)
    path = tmp_path / "props.txt"
    path.write_text("decl v /v Float64.data never v > 1")
    _, diagnostics = load(path, [str(tmp_path)])
    assert [d.code for d in diagnostics] == ["LTL906"]
    assert "sections" in diagnostics[0].message


def test_a_node_reads_the_feedback_of_an_action(interfaces: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The classes are where rosidl puts them: the package names the action, and its module has the rest."""
    package, module = ModuleType("robot_msgs.action"), ModuleType("robot_msgs.action._navigate")
    found = type("Navigate_FeedbackMessage", (), {})
    vars(module)["Navigate_FeedbackMessage"] = found
    vars(package)["Navigate"] = type("Navigate", (), {"__module__": module.__name__})
    for each in (ModuleType("robot_msgs"), package, module):
        monkeypatch.setitem(sys.modules, each.__name__, each)
    assert class_of("robot_msgs/action/Navigate_FeedbackMessage") is found


def test_what_reads_feedback_and_events_passes_the_gate(interfaces: Path) -> None:
    path, node = interfaces / "props.txt", interfaces / "node.py"
    path.write_text(
        "decl left /go/_action/feedback Navigate_FeedbackMessage.feedback.distance_remaining\n"
        "decl done /lift/_service_event Lift_Event.response[0].done\n"
        "always (left < 0.3 implies eventually done)\n"
    )
    assert main(["build", str(path), "--msg-path", str(interfaces), "--target", "ros2", "-o", str(node)]) == 0
    assert '"robot_msgs/action/Navigate_FeedbackMessage"' in node.read_text()


@pytest.mark.parametrize("content", [b"float32 = = 2\n", b"\xff\xfe", b"float32 a\nnonsense\n"])
def test_a_definition_that_cannot_be_read_is_named(tmp_path: Path, content: bytes) -> None:
    home = package(tmp_path, "bad_msgs", Good="float32 a\n")
    (home / "msg" / "Bad.msg").write_bytes(content)
    path = tmp_path / "props.txt"
    path.write_text("decl a /a Good.a\nnever a > 1")
    _, diagnostics = load(path, [str(tmp_path)])
    assert [d.code for d in diagnostics] == ["LTL906"]
    assert "Bad.msg" in diagnostics[0].message


@pytest.mark.parametrize("folder", ["none", "empty", "file"])
def test_a_message_path_without_messages_is_reported(tmp_path: Path, folder: str) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "file").write_text("")
    path = tmp_path / "props.txt"
    path.write_text("never robot.velocity > 1")
    _, diagnostics = load(path, [str(tmp_path / folder)])
    assert [d.code for d in diagnostics] == ["LTL906"]


def test_neither_lark_nor_rosbags_is_imported_to_compile() -> None:
    code = (
        "import sys; from ltlc.frontend.language import load_text; from ltlc.base.source import Source;"
        "s, _ = load_text(Source('x', 'decl v /v Float64.data never v > 1')); assert s;"
        "print(sorted({'lark', 'rosbags', 'numpy', 'spot', 'z3', 'jinja2', 'hypothesis'} & set(sys.modules)))"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("type_", "value"),
    [
        ("Float64.data", ValueType.NUMBER),
        ("Int8.data", ValueType.NUMBER),
        ("Byte.data", ValueType.NUMBER),
        ("Bool.data", ValueType.BOOLEAN),
        ("String.data", ValueType.STRING),
        ("LaserScan.ranges", ValueType.NUMBERS),
        ("Odometry.pose.covariance", ValueType.NUMBERS),
        ("Odometry.header.frame_id", ValueType.STRING),
        ("Odometry.header.stamp.sec", ValueType.NUMBER),
        ("JointState.name[2]", ValueType.STRING),
    ],
)
def test_the_type_of_a_field_is_that_of_its_definition(type_: str, value: ValueType) -> None:
    use = {
        ValueType.NUMBER: "x > 1",
        ValueType.BOOLEAN: "x",
        ValueType.STRING: 'x == "a"',
        ValueType.NUMBERS: "max(x) > 1",
    }[value]
    (found,) = compiled(f"decl x /x {type_} never {use}").properties
    assert found.inputs()[0].signal.type is value


@pytest.mark.parametrize("type_", ["nav_msgs/msg/Odometry", "nav_msgs/Odometry", "Odometry"])
def test_a_message_type_can_be_written_with_and_without_its_package(type_: str) -> None:
    (found,) = compiled(f"decl x /x {type_}.twist.twist.linear.x never x > 1").properties
    definition = found.inputs()[0].signal.definition
    assert isinstance(definition, Field)
    assert definition.message == "nav_msgs/msg/Odometry"


@pytest.mark.parametrize(
    ("topic", "absolute"),
    [
        ("cmd_vel", "/cmd_vel"),
        ("/cmd_vel", "/cmd_vel"),
        ("~/x", "~/x"),
        ("a/b_1/c", "/a/b_1/c"),
        ("/always", "/always"),
    ],
)
def test_topics_are_absolute_or_private(topic: str, absolute: str) -> None:
    (found,) = compiled(f"decl x {topic} Float64.data never x > 1").properties
    definition = found.inputs()[0].signal.definition
    assert isinstance(definition, Field)
    assert definition.topic == absolute


TOPICS = ["/", "/a//b", "/a/", "/1a", "/a-b", "/a.b", "/ä", '/a"b', "/a'b", "/{x}", "/a$b", "/" + "a" * 247]
TOPICS += ["/a__b", "/_a", "/a_", "/a/b/c", "/A1", "/" + "a" * 246]


@pytest.mark.ros
@pytest.mark.parametrize("topic", TOPICS)
def test_a_topic_is_taken_exactly_if_ros_2_takes_it(topic: str) -> None:
    validation = pytest.importorskip("rclpy.validate_full_topic_name")
    exceptions = pytest.importorskip("rclpy.exceptions")
    expected = []
    try:
        validation.validate_full_topic_name(topic)
    except exceptions.InvalidTopicNameException:
        expected = ["LTL108"]
    assert codes_of(f"decl x {topic} Float64.data never x > 1") == expected


@pytest.mark.parametrize("topic", ["/a//b", "~x", "/1a", "/{x}", "~"])
def test_what_is_not_the_name_of_a_topic_is_refused(topic: str) -> None:
    assert "LTL108" in codes_of(f"decl x {topic} Float64.data never x > 1")


def test_strings_keep_quotes_backslashes_and_line_breaks_as_data() -> None:
    (found,) = compiled(SIGNALS + 'never mode == "a\\"b\\\\n\\n\\t{%\'"').properties
    assert found.atoms[0].condition.right.value == "a\"b\\n\n\t{%'"  # type: ignore[union-attr]
    assert found.atoms[0].name == 'mode == "a\\"b\\\\n\\n\\t{%\'"'
