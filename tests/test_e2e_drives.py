"""From a property file to a node that judges a simulated robot over ROS 2, live and from its recording."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from bag_support import Sent, made, rosbag2
from ros_support import PATIENCE, Node, Program, by_label, emitted, own_domain, wait_until

from ltlc.cli import main
from ltlc.frontend.language import load
from ltlc.runtime.times import nanoseconds
from ltlc.specification.specification import fields

pytestmark = pytest.mark.ros
pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros,simulation]")
pytest.importorskip("mujoco", reason="needs MuJoCo: install ltlc[ros,simulation]")

EXAMPLE = Path(__file__).parent.parent / "examples" / "stop_sign"
FASTER_THAN_REAL = 8
STARTS_GENTLY = "starts_gently: never robot.velocity - @{robot.velocity, -5} > 0.1"
"""Every drive violates this: the robot speeds up by 0.2 m/s within five samples."""

WRONG = ("runs", "--speed", "2.5", "--drift", "0.1")
"""A robot that is too fast and does not know where it is."""


@dataclass(frozen=True)
class Drive:
    """A drive, as the node judged it and as `ltlc run` judges what the node recorded, and a bag of that."""

    exit_code: int
    log: str
    live: dict[str, dict[str, Any]]
    recorded: dict[str, dict[str, Any]]
    in_bag: dict[str, dict[str, Any]]


Drives = Callable[..., Drive]


@pytest.fixture(scope="module")
def drives(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Drives]:
    folder = tmp_path_factory.mktemp("drives")
    text = (EXAMPLE / "properties.txt").read_text(encoding="utf-8")
    node = emitted(f"{text}\n{STARTS_GENTLY}\n", folder, "properties")

    @cache
    def drive(*options: str) -> Drive:
        place = folder / "_".join(options).replace("-", "")
        place.mkdir()
        return watched_drive(node, place, options)

    with own_domain(folder):
        yield drive


def watched_drive(script: Path, folder: Path, options: tuple[str, ...]) -> Drive:
    """Let the robot drive while the node watches; end the node when the robot has arrived."""
    recording = folder / "run.jsonl"
    topics = ["/cmd_vel", "/odom", "/model/robot/odometry", "/model/stop_sign/odometry"]
    how = ["--real-time-factor", str(FASTER_THAN_REAL), "--patience", str(PATIENCE)]
    with (
        Node(script, folder, record=recording) as node,
        Program(EXAMPLE / "robot.py", "--drive", *options, *how, "--wait-for", *topics, folder=folder) as robot,
    ):
        wait_until(lambda: robot.has_ended or node.has_ended, "the robot arrives")
        assert robot.exit_code() == 0, robot.log
        code = node.end()
    (live,) = node.runs
    properties = script.with_name("properties.txt")
    bag = rosbag2(folder / "bag", as_sent(properties, recording), "mcap")
    return Drive(code, node.log, live, judged_recording(properties, recording), judged_recording(properties, bag))


def as_sent(properties: Path, recording: Path) -> list[Sent]:
    """The messages of a drive, from lines of JSON with the fields that are read of them."""
    specification, _ = load(properties)
    assert specification is not None
    inputs = [read.signal for each in specification.properties for read in each.inputs()]
    read = {signal.name: field for each in inputs for signal, field in fields(each)}
    sent = []
    for line in recording.read_text(encoding="utf-8").splitlines():
        row = json.loads(line, parse_float=str)
        messages: dict[tuple[str, str], dict[str, float]] = {}
        for name, field in read.items():
            if name in row:
                values = messages.setdefault((field.topic, field.message), {})
                values["__".join(map(str, field.path))] = float(row[name])
        time = nanoseconds(row["time"])
        sent += [Sent(topic, type_, time, made(type_, **values)) for (topic, type_), values in messages.items()]
    return sent


def judged_recording(properties: Path, recording: Path) -> dict[str, dict[str, Any]]:
    output = StringIO()
    with redirect_stdout(output):
        main(["run", str(properties), str(recording), "--format", "json"])
    return by_label(json.loads(output.getvalue()))


def test_running_the_sign_is_a_violation_with_its_failing_state(drives: Drives) -> None:
    drive = drives("runs")
    found = drive.live["stop_at_sign"]
    assert (drive.exit_code, found["verdict"], found["episodes"]) == (1, "violated", 1)
    values = found["decided_at"]["values"]
    assert 1 < values["robot.distance.stop_sign"] < 1.1
    assert 0.8 < values["robot.velocity"] < 1.1
    assert found["decided_at"]["episode_opened"]["step"] < found["decided_at"]["step"]


def test_a_violation_is_printed_as_in_the_paper(drives: Drives) -> None:
    found = drives("runs").live["stop_at_sign"]
    velocity = found["decided_at"]["values"]["robot.velocity"]
    for line in (
        f"Error at line {found['line']} of properties.txt (stop_at_sign):",
        "robot.distance.stop_sign > 1: true, ",
        "Unmet since +",
        "Failing state:",
        f"robot.velocity: {velocity}",
        "The episode opened",
    ):
        assert line in drives("runs").log


def test_stopping_in_the_zone_and_driving_on_within_it_is_no_violation(drives: Drives) -> None:
    found = drives("stops").live["stop_at_sign"]
    assert (found["verdict"], found["episodes"]) == ("presumably_satisfied", 1)


def test_a_sign_that_is_run_on_the_way_back_is_a_violation_in_the_second_episode(drives: Drives) -> None:
    found = drives("stops-then-runs").live["stop_at_sign"]
    assert (found["verdict"], found["episodes"]) == ("violated", 2)
    stopped = drives("stops").live["stop_at_sign"]
    assert found["decided_at"]["episode_opened"]["step"] > stopped["steps"] / 2


@pytest.mark.parametrize("options", [("runs",), ("stops",), ("stops-then-runs",)])
def test_a_slow_robot_never_speeds(drives: Drives, options: tuple[str, ...]) -> None:
    live = drives(*options).live
    assert live["no_speeding"]["verdict"] == live["no_hasty_commands"]["verdict"] == "presumably_satisfied"


def test_a_fast_robot_violates_what_is_said_of_its_speed_and_of_its_commands(drives: Drives) -> None:
    live = drives(*WRONG).live
    assert live["no_speeding"]["decided_at"]["values"]["robot.velocity"] > 2
    assert live["no_hasty_commands"]["decided_at"]["values"]["commanded_speed"] > 1.5


def test_a_robot_whose_odometry_drifts_loses_its_way(drives: Drives) -> None:
    assert drives("runs").live["knows_where_it_is"]["verdict"] == "presumably_satisfied"
    lost = drives(*WRONG).live["knows_where_it_is"]
    assert lost["verdict"] == "violated"
    assert 0.5 < lost["decided_at"]["values"]["robot.localization_error"] < 0.55


def test_history_compares_samples_of_one_signal(drives: Drives) -> None:
    live = drives("runs").live
    assert live["no_hard_braking"]["verdict"] == "presumably_satisfied"
    values = live["starts_gently"]["decided_at"]["values"]
    assert values["robot.velocity"] - values["@{robot.velocity, -5}"] > 0.1


@pytest.mark.parametrize("options", [("runs",), ("stops",), ("stops-then-runs",), WRONG])
def test_a_recording_of_a_drive_gets_the_verdicts_of_the_drive(drives: Drives, options: tuple[str, ...]) -> None:
    drive = drives(*options)
    assert {label: outcome(found) for label, found in drive.live.items()} == {
        label: outcome(found) for label, found in drive.recorded.items()
    }


@pytest.mark.parametrize("options", [("runs",), WRONG])
def test_a_bag_of_a_drive_gets_the_verdicts_of_the_drive(drives: Drives, options: tuple[str, ...]) -> None:
    drive = drives(*options)
    assert {label: outcome(found) for label, found in drive.live.items()} == {
        label: outcome(found) for label, found in drive.in_bag.items()
    }


def outcome(found: dict[str, Any]) -> tuple[Any, ...]:
    """What does not depend on when the drive took place."""
    decided = found["decided_at"]
    return (found["verdict"], found["steps"], found["episodes"], decided and (decided["step"], decided["values"]))


def test_the_demonstration_shows_the_violation_of_the_sentence_of_the_paper(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with Program(EXAMPLE / "demo.py", "--real-time-factor", "8", folder=tmp_path) as demo:
        assert demo.exit_code() == 0, demo.log
    assert "Error at line 2 of stop_sign.txt:" in demo.log
    assert "the node found a violation (exit code 1), as expected" in demo.log
