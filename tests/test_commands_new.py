"""`ltlc new`: a specification to start with, of which nothing is to be said, for any topics."""

from __future__ import annotations

import io
import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from bag_support import LEVEL, Sent, made, mcap, odometry, ros1, rosbag2
from hypothesis import given, settings
from hypothesis import strategies as st
from language_support import compiled

from ltlc.analysis.analyse import analyse
from ltlc.automata import Budget
from ltlc.base.source import Source
from ltlc.cli import main
from ltlc.frontend.language import load, load_text
from ltlc.frontend.layout import layout
from ltlc.frontend.starter import starter
from ltlc.frontend.starter.topics import listed
from ltlc.inputs.messages.definitions import MessageTypes, shipped
from ltlc.semantics.encodings import EPISODE

BAGS = Path(__file__).parents[2] / "shared" / "data" / "bags"
TYPES = sorted(MessageTypes(shipped()).messages)
ROBOT = """/odom [nav_msgs/msg/Odometry]
/scan [sensor_msgs/msg/LaserScan]
/cmd_vel [geometry_msgs/msg/Twist]
/rosout [rcl_interfaces/msg/Log]

/mission [my_msgs/msg/Mission]
"""

Run = Callable[..., int]


@pytest.fixture
def new(monkeypatch: pytest.MonkeyPatch) -> Run:
    def run(topics: str, *arguments: str) -> int:
        monkeypatch.setattr(sys, "stdin", io.StringIO(topics))
        return main(["new", *arguments])

    return run


def with_all_that_is_offered(text: str) -> str:
    """A starter without the `#` before properties and declarations."""
    return re.sub(r"^# (?=decl |\w+: )", "", text, flags=re.MULTILINE)


def test_nothing_is_to_be_said_of_what_is_written_for_all_types(new: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert new("".join(f"/n{number}/topic [{type_}]\n" for number, type_ in enumerate(TYPES))) == 0
    text = capsys.readouterr().out
    specification, diagnostics = load_text(Source("props.txt", text))
    assert diagnostics == []
    assert specification is not None
    assert analyse(specification, EPISODE, Budget(120.0, 1024)).diagnostics == ()
    assert len(specification.properties) > len(TYPES)
    assert layout(Source("props.txt", text)) == text
    assert len(compiled(with_all_that_is_offered(text)).properties) > 2 * len(TYPES)


@pytest.mark.parametrize("type_", [type_ for type_ in TYPES if type_.partition("/")[0] in ("std_msgs", "sensor_msgs")])
def test_the_front_end_finds_nothing_in_what_is_written_for_one_type(
    new: Run, type_: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new(f"/a [{type_}]\n") == 0
    assert load_text(Source("props.txt", capsys.readouterr().out))[1] == []


def test_the_page_shows_what_is_written(new: Run, capsys: pytest.CaptureFixture[str]) -> None:
    page = (Path(__file__).parents[1] / "docs" / "new.md").read_text(encoding="utf-8")
    (shown,) = re.findall(r"^```\n(.*?)^```", page.partition("\n## Layout\n")[0], re.DOTALL | re.MULTILINE)
    assert new("/odom [nav_msgs/msg/Odometry]") == 0
    assert capsys.readouterr().out.endswith(f"\n\n{shown}")


def test_what_is_left_out_is_said(new: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert new(ROBOT) == 0
    text = capsys.readouterr().out
    assert "# /rosout [rcl_interfaces/msg/Log]: it is about ROS, not about the robot\n" in text
    assert "# /mission [my_msgs/msg/Mission]: the type is unknown" in text


def test_a_scanner_and_odometry_of_one_robot_make_a_stop(new: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert new(ROBOT.replace("/scan ", "/other/scan ")) == 0
    assert "stops: " not in capsys.readouterr().out
    assert new(ROBOT) == 0
    found = compiled(with_all_that_is_offered(capsys.readouterr().out))
    assert "stops" in [each.label for each in found.properties]


def test_a_message_path_makes_types_known(new: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "my_msgs" / "msg" / "Mission.msg").write_text("bool done\n")
    assert new("/mission [my_msgs/msg/Mission]", "--msg-path", str(tmp_path)) == 0
    written = capsys.readouterr().out
    assert "decl mission /mission Mission.done\n" in written
    assert "from the bag" not in written


FROM_THE_BAG = "are known from the bag alone"


def start_of(path: Path) -> str:
    """The comment at the beginning of a file, as running text."""
    return " ".join(path.read_text().partition("\n\n")[0].split("\n# "))


def test_a_file_made_of_a_bag_with_types_of_its_own_says_how_other_commands_know_them(tmp_path: Path) -> None:
    bag = mcap(tmp_path / "drive.mcap", [Sent("/level", LEVEL, 0, made(LEVEL))])
    assert main(["new", str(bag), "-o", str(tmp_path / "props.txt")]) == 0
    assert f"{FROM_THE_BAG}: `ltlc check --recording {bag}`" in start_of(tmp_path / "props.txt")


def test_a_file_made_of_a_bag_with_types_that_ros_brings_does_not(tmp_path: Path) -> None:
    bag = mcap(tmp_path / "drive.mcap", [odometry(0)])
    assert main(["new", str(bag), "-o", str(tmp_path / "props.txt")]) == 0
    assert FROM_THE_BAG not in start_of(tmp_path / "props.txt")


NAMES = (
    "/never",
    "/s",
    "/new",
    "/min",
    "/F",
    "/AND",
    "/opening",
    "/a_b",
    "/a/b",
    "/a__b",
    "/a",
    "/a/b_2",
    "/_rate_",
    "/_1",
)
ODD_NAMES = (
    "/2j",
    "/a/",
    "/ä",
    "/a#b",
    "/x/_action/status",
    "/odom",
    "/odom/speed",
    "/odom/speed_limit",
    "/scan",
    "~/x",
)


@settings(max_examples=40)
@given(
    st.lists(st.tuples(st.sampled_from(NAMES + ODD_NAMES), st.sampled_from([*TYPES, "a/msg/B, c/msg/D"])), max_size=9)
)
def test_any_names_of_topics_make_names_of_signals_and_properties(topics: list[tuple[str, str]]) -> None:
    text = starter(listed("".join(f"{name} [{type_}]\n" for name, type_ in topics)), MessageTypes(shipped()), "a list")
    if text is not None:
        assert load_text(Source("props.txt", text))[1] == []
        assert compiled(with_all_that_is_offered(text))


@pytest.mark.parametrize("line", ["/scan", "/scan sensor_msgs/msg/LaserScan", "scan []", "WARNING: no daemon"])
def test_a_line_that_is_no_topic_is_said_with_its_number(
    new: Run, line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new(f"/odom [nav_msgs/msg/Odometry]\n{line}\n") == 2
    found = capsys.readouterr()
    assert found.out == ""
    assert f"line 2 of the topics is {line!r}" in found.err


def test_types_are_known_by_their_names_in_ros_1_too(new: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert new("\ufeff/odom [nav_msgs/Odometry]\r\n") == 0
    assert "# /odom [nav_msgs/msg/Odometry]\n" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("topics", "said"), [("", "no topics"), ("/a [b/msg/C]", "/a [b/msg/C]: add message definitions with `--msg-path`")]
)
def test_without_a_topic_to_speak_of_nothing_is_written(
    new: Run, topics: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new(topics, "-o", str(tmp_path / "props.txt")) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "props.txt").exists()


def test_nothing_is_written_over_a_file(new: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "props.txt"
    assert new(ROBOT, "-o", str(path)) == 0
    text = path.read_text()
    assert text.startswith("# What the robot must do")
    assert new("/a [std_msgs/msg/Bool]", "-o", str(path)) == 2
    assert path.read_text() == text
    assert "already exists and is not overwritten" in capsys.readouterr().err


def test_a_file_that_cannot_be_written_is_said(new: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new(ROBOT, "-o", str(tmp_path / "none" / "props.txt")) == 2
    assert "cannot be written" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["none.mcap", "drive.csv", "damaged.mcap"])
def test_what_is_no_bag_is_said(tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "drive.csv").write_text("time,x\n0,1\n")
    (tmp_path / "damaged.mcap").write_text("no bag")
    assert main(["new", str(tmp_path / name)]) == 2
    assert "LTL" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("write", "name"), [(rosbag2, "drive"), (mcap, "drive.mcap"), (ros1, "drive.bag")], ids=["rosbag2", "mcap", "ros1"]
)
def test_the_bag_that_it_was_made_of_is_judged_by_it(
    write: Callable[[Path, Sequence[Sent]], Path], name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sent = [odometry(time * 10**8) for time in range(10)]
    sent += [Sent("/go", "std_msgs/msg/Bool", 5, made("std_msgs/msg/Bool"))]
    bag = write(tmp_path / name, sorted(sent, key=lambda each: each.time))
    path = tmp_path / "props.txt"
    assert main(["new", str(bag), "-o", str(path)]) == 0
    assert f"from the topics of {bag}" in " ".join(path.read_text().split("\n# "))
    capsys.readouterr()
    assert main(["run", str(path), str(bag)]) == 0
    judged = [line.partition(":")[0] for line in capsys.readouterr().out.splitlines() if "satisfied" in line]
    assert judged == ["go_comes", "odom_fresh", "odom_speed_limit", "odom_turn_limit", "odom_in_area"]


@pytest.mark.skipif(not BAGS.is_dir(), reason="needs recordings made by others, in ../shared/data/bags")
@pytest.mark.parametrize(
    ("bag", "late"),
    [
        ("mobrob_odom", []),
        ("tb3_kf", ["odom_fresh", "odom_kf_fresh", "odom_noisy_fresh"]),  # begin 3.5 s after the bag does
        ("rosbag2/sqlite3_talker", []),
        ("rosbag2/mcap_wbag", []),
    ],
)
def test_the_bags_of_others_are_judged_by_what_is_made_of_them(
    bag: str, late: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "props.txt"
    assert main(["new", str(BAGS / bag), "-o", str(path)]) == 0
    assert load(path)[1] == []
    capsys.readouterr()
    assert main(["run", str(path), str(BAGS / bag)]) == (1 if late else 0)
    lines = capsys.readouterr().out.splitlines()
    assert [line.partition(":")[0] for line in lines if ": violated at" in line] == late


def test_of_several_values_of_a_message_the_first_is_called_as_its_topic_and_the_others_by_their_fields(
    new: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new("/pressure [sensor_msgs/msg/FluidPressure]\n") == 0
    written = with_all_that_is_offered(capsys.readouterr().out)
    assert "decl pressure /pressure FluidPressure.fluid_pressure\n" in written
    assert "decl pressure_variance /pressure FluidPressure.variance\n" in written
    assert "pressure_in_range: never pressure > 100" in written
    assert "pressure_variance_in_range: never pressure_variance > 100" in written


def test_nothing_is_said_of_stamps_beside_other_values(new: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert new("/goal [action_msgs/msg/GoalStatus]\n") == 0
    assert "stamp" not in capsys.readouterr().out
