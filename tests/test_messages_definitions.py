"""Message definitions: those that ship, and those of folders."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from language_support import SIGNALS, codes_of, compiled

from ltlc.files import compact_json
from ltlc.language import load
from ltlc.messages import definitions as messages
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
    stored = (Path(messages.__file__).parent / "jazzy.json").read_text()
    assert stored == compact_json(messages.jazzy_definitions()), "run `python -m ltlc.messages.generate`"


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
        "import sys; from ltlc.language import load_text; from ltlc.source import Source;"
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
