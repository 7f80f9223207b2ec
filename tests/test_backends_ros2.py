"""The text of emitted nodes; what they do among other nodes is in the end-to-end tests."""

from __future__ import annotations

import ast
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ros_support import emitted_text

from ltlc.assurance.programs import load
from ltlc.backends.ros2 import node_name

EXAMPLES = Path(__file__).parent.parent / "examples" / "stop_sign"

VARIED = """
_rate_ = 10
_timeout_ = 60
object cone /tf TFMessage
object pillar_at_the_far_end_of_the_long_corridor /tf TFMessage
object robot /gazebo/model_states ModelStates
decl scan /scan LaserScan.ranges
decl first /scan LaserScan.ranges[0]
decl third /plan nav_msgs/Path.poses[2].pose.position.x
decl text ~/text std_msgs/String.data
decl flag flag std_msgs/Bool.data
never min(scan) < 0.3 or first > 3
a: flag implies third > 1
b: always cone.distance.robot > 0.1
c: always pillar_at_the_far_end_of_the_long_corridor.distance.robot > @{third, -3}
d: never text == "\\"\\"\\" + exit() # {{ 1 }} {% for %} %s {0} \\\\ \\n '''"
"""


def texts() -> list[str]:
    return [VARIED, *(path.read_text(encoding="utf-8") for path in sorted(EXAMPLES.glob("*.txt")))]


@pytest.mark.parametrize("text", texts())
@pytest.mark.parametrize("command", [["format", "--diff"], ["check"]])
def test_a_node_is_formatted_as_ruff_would(text: str, command: list[str]) -> None:
    ruff = shutil.which("ruff", path=Path(sys.executable).parent) or pytest.skip("needs ruff")
    run = subprocess.run(
        [ruff, *command, "--isolated", "--stdin-filename", "node.py", "-"],
        input=emitted_text(text),
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr


@pytest.mark.parametrize("text", texts())
def test_a_node_imports_the_standard_library_and_ros_only(text: str) -> None:
    modules: set[str] = set()
    for node in ast.walk(ast.parse(emitted_text(text))):
        if isinstance(node, ast.Import):
            modules.update(alias.name.split(".")[0] for alias in node.names)
        if isinstance(node, ast.ImportFrom):
            modules.add(str(node.module).split(".")[0])
    assert modules - sys.stdlib_module_names == {"rclpy", "rcl_interfaces", "diagnostic_msgs", "std_msgs"}


def test_the_same_file_gives_the_same_bytes() -> None:
    assert emitted_text(VARIED) == emitted_text(VARIED)


def test_a_node_without_ros_says_what_is_missing(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "rclpy", None)
    assert load(emitted_text(VARIED), "node")["main"]() == 2
    assert "ROS 2 is not available" in capfd.readouterr().err


def test_the_settings_of_the_file_are_those_of_the_node() -> None:
    plan = load(emitted_text(VARIED), "node")["plan"]()
    assert (plan.rate, plan.timeout) == (10.0, 60 * 10**9)


@given(st.text(st.characters(exclude_characters='"\\', exclude_categories=["Cc", "Cs"]), max_size=30))
@settings(max_examples=12)
def test_text_of_the_property_file_is_never_code(text: str) -> None:
    emitted = emitted_text(f'decl t /t std_msgs/String.data\nnever t == "{text}"')
    (property_,) = load(emitted, "node")["plan"]().properties
    monitor = property_.monitor()
    assert " ".join(text.split()) in property_.text
    assert [monitor.step(value).value for value in (text + "x", text)] == ["presumably_satisfied", "violated"]
    assert emitted.isascii()


def read(topic: str, message: Any) -> list[Any]:
    topics = {t.name: t.read for t in load(emitted_text(VARIED), "node")["topics_to_read"]()}
    return list(topics[topic](message))


def transform(name: str, x: float) -> SimpleNamespace:
    place = SimpleNamespace(x=x, y=0.0, z=0.0)
    return SimpleNamespace(child_frame_id=name, transform=SimpleNamespace(translation=place))


def test_an_entry_is_found_by_its_name() -> None:
    message = SimpleNamespace(transforms=[transform("other", 1.0), transform("cone", 2.0), transform("cone", 3.0)])
    assert read("/tf", message) == [2.0, 0.0, None, None]


def test_lists_that_belong_together_are_read_together() -> None:
    places = [SimpleNamespace(position=SimpleNamespace(x=x, y=-x, z=0.0)) for x in (1.0, 2.0)]
    assert read("/gazebo/model_states", SimpleNamespace(name=["wall", "robot"], pose=places)) == [2.0, -2.0]
    assert read("/gazebo/model_states", SimpleNamespace(name=["wall"], pose=places)) == [None, None]


def test_an_array_that_is_too_short_has_no_such_element() -> None:
    assert read("/scan", SimpleNamespace(ranges=[0.5, 1.0])) == [[0.5, 1.0], 0.5]
    assert read("/scan", SimpleNamespace(ranges=[])) == [[], None]
    assert read("/plan", SimpleNamespace(poses=[])) == [None]


@pytest.mark.parametrize(
    ("stem", "name"),
    [("stop_sign", "stop_sign_monitor"), ("2 robots--äh", "node_2_robots_h_monitor"), ("äöü", "monitor")],
)
def test_the_name_of_a_node_is_one_that_ros_allows(stem: str, name: str) -> None:
    assert node_name(stem) == name
