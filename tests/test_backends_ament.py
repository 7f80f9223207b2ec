"""Packages that colcon builds: what is in them, what is kept, and that they are built, tested and run from clean."""

from __future__ import annotations

import json
import math
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from quick_gate import quick_gate
from ros_support import PATIENCE, own_domain, wait_until

from ltlc.cli import main

PROPERTIES = """decl scan /scan LaserScan.ranges
object robot /odom Odometry
object stop_sign at (10, 0, 0)
always (min(scan) < 0.3 implies eventually robot.velocity == 0 within 200 ms)
sign: after_until robot.distance.stop_sign < 1, robot.distance.stop_sign > 1, eventually robot.velocity == 0
mode: never new scan and robot.velocity - @{robot.velocity, -1} > 5
"""

MESSAGES = {"diagnostic_msgs", "nav_msgs", "rcl_interfaces", "rclpy", "sensor_msgs", "std_msgs", "launch_ros"}


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("workspace")
    (folder / "watch.txt").write_text(PROPERTIES, encoding="utf-8")
    place = folder / "src" / "watch_monitor"
    place.parent.mkdir()
    with quick_gate():
        assert main(["build", str(folder / "watch.txt"), "--target", "ament", "-o", str(place)]) == 0
    return place


def files(package: Path) -> dict[str, bytes]:
    return {str(path.relative_to(package)): path.read_bytes() for path in package.rglob("*") if path.is_file()}


def build(folder: Path, text: str) -> int:
    (folder / "watch.txt").write_text(text, encoding="utf-8")
    with quick_gate():
        return main(["build", str(folder / "watch.txt"), "--target", "ament", "-o", str(folder / "package")])


def test_a_package_needs_the_packages_of_the_messages_that_it_reads(package: Path) -> None:
    needs = ElementTree.parse(package / "package.xml").getroot().findall("exec_depend")
    assert {each.text for each in needs} == MESSAGES
    assert len(needs) == len(MESSAGES)


def test_what_the_properties_say_is_one_short_file(package: Path) -> None:
    path = package / "watch_monitor" / "properties.py"
    text = path.read_text(encoding="utf-8")
    assert "class Sign" in text
    assert "class Session" not in text
    assert len(text.splitlines()) < 420
    ruff = shutil.which("ruff", path=Path(sys.executable).parent) or pytest.skip("needs ruff")
    for command in (["format", "--diff"], ["check"]):
        run = subprocess.run([ruff, *command, "--isolated", path], capture_output=True, text=True, check=False)
        assert run.returncode == 0, run.stdout


def test_a_second_build_gives_the_same_bytes_but_what_a_person_has_filled_in_and_added(tmp_path: Path) -> None:
    text, package = "decl v /v Float64.data\nslow: never v > 3\n", tmp_path / "package"
    assert build(tmp_path, text) == 0
    before = files(package)
    filled_in = before["package.xml"].decode().replace("TODO: maintainer", "R &amp; D")
    filled_in = filled_in.replace("<version>0.1.0", "<version>1.2.3").replace("TODO: licence", "MIT")
    (package / "package.xml").write_text(filled_in, encoding="utf-8")
    (package / "test" / "recordings" / "mine.csv").write_text("time\n", encoding="utf-8")
    (package / "setup.py").write_text("", encoding="utf-8")
    assert build(tmp_path, text) == 0
    found = files(package)
    assert found.pop("test/recordings/mine.csv") == b"time\n"
    assert found == before | {"package.xml": filled_in.encode()}


@pytest.mark.usefixtures("quickly")
def test_a_name_with_two_hyphens_leaves_every_file_of_xml_well_formed(tmp_path: Path) -> None:
    (tmp_path / "safe--new-.txt").write_text("decl v /v Float64.data\nnever v > 3\n", encoding="utf-8")
    package = tmp_path / "package"
    assert main(["build", str(tmp_path / "safe--new-.txt"), "--target", "ament", "-o", str(package)]) == 0
    documents = [ElementTree.parse(path).getroot() for path in package.rglob("*.xml")]
    assert {root.tag for root in documents} == {"package", "launch"}


@pytest.mark.parametrize(
    ("name", "text"), [("notes.txt", "mine"), ("package.xml", "<package/>"), ("package.xml", "<!-- Made by ltlc -->")]
)
def test_a_folder_with_something_else_is_left_alone(
    package: Path, tmp_path: Path, name: str, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / name).write_text(text, encoding="utf-8")
    assert main(["build", str(package.parents[1] / "watch.txt"), "--target", "ament", "-o", str(folder)]) == 2
    assert "cannot be written" in capsys.readouterr().err
    assert [path.name for path in folder.iterdir()] == [name]


def remaps(launch: Path) -> dict[str, str]:
    return {str(r.get("from")): str(r.get("to")) for r in ElementTree.parse(launch).getroot().iter("remap")}


def test_a_launch_file_moves_the_topics_of_a_guard_to_where_its_arguments_say(tmp_path: Path) -> None:
    text = "guard /raw to out\ndecl speed out Float64.data\ndecl near /near Bool.data\nnever new speed and near\n"
    (tmp_path / "watch.txt").write_text(text, encoding="utf-8")
    package = tmp_path / "package"
    with quick_gate():
        assert main(["build", str(tmp_path / "watch.txt"), "--target", "ament", "-o", str(package)]) == 0
    launch = package / "launch" / "watch_monitor.launch.xml"
    assert remaps(launch) == {
        "/raw": "$(var robot)$(var raw)",
        "/out": "$(var robot)$(var out)",
        "/near": "$(var robot)/near",
    }
    given = {each.get("name"): each.get("default") for each in ElementTree.parse(launch).getroot().iter("arg")}
    assert given.items() >= {"raw": "/raw", "out": "/out"}.items()
    assert (
        "`raw:=TOPIC` is where commands come in, `out:=TOPIC` is where commands leave"
        in (package / "README.md").read_text()
    )


def test_a_launch_file_moves_the_topics_into_the_namespace_of_the_robot(package: Path) -> None:
    launch = package / "launch" / "watch_monitor.launch.xml"
    assert remaps(launch) == {topic: f"$(var robot){topic}" for topic in ("/scan", "/odom")}
    robots = ElementTree.parse(package / "launch" / "two_robots.launch.xml").getroot()
    assert [each.get("name") for each in robots.findall("include/arg")] == ["robot", "robot"]


@pytest.fixture(scope="module")
def installed(package: Path) -> Path:
    """The workspace, built by colcon, its tests run."""
    pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros]")
    colcon = shutil.which("colcon", path=Path(sys.executable).parent) or pytest.skip("needs colcon")
    recordings = package / "test" / "recordings"
    still = {f"robot.velocity.{axis}": 0 for axis in "xyz"} | {f"robot.position.{axis}": 0 for axis in "xy"}
    for name, speed in (("good", 0), ("bad", 1)):
        first = {"time": 0, "scan": [0.1, math.nan], **still, "robot.velocity.x": speed}
        lines = [json.dumps(row) for row in (first, {**first, "time": 0.1}, {"time": 0.3})]
        (recordings / f"{name}.jsonl").write_text("\n".join(lines), encoding="utf-8")
    (recordings / "drive.csv").write_text("time,scan[0]\n", encoding="utf-8")
    workspace = package.parents[1]
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    for command in (["build"], ["test", "--return-code-on-test-failure"]):
        run = subprocess.run(
            [colcon, "--log-base", str(workspace / "log"), *command],
            cwd=workspace,
            env=os.environ | {"PATH": path, "PYTHONDONTWRITEBYTECODE": ""},
            capture_output=True,
            text=True,
            check=False,
        )
        (workspace / f"{command[0]}.log").write_text(f"{run.returncode}\n{run.stdout}{run.stderr}", encoding="utf-8")
    return workspace


@pytest.mark.ros
def test_colcon_builds_it_and_its_tests_replay_the_runs_and_judge_recordings(installed: Path) -> None:
    assert (installed / "build.log").read_text(encoding="utf-8").startswith("0\n")
    [report] = (installed / "build").rglob("pytest.xml")
    cases = list(ElementTree.parse(report).getroot().iter("testcase"))
    failed = {str(case.get("name")): str(f.text) for case in cases for f in case.findall("failure")}
    bad, drive = (f"test_recordings_satisfy_the_properties[{name}]" for name in ("bad.jsonl", "drive.csv"))
    assert set(failed) <= {bad, drive}  # where there is no ltlc, what only ltlc can read is skipped
    assert "At +0.2 s (after step 1)" in failed[bad]
    runs = json.loads((installed / "src" / "watch_monitor" / "test" / "runs.json").read_text(encoding="utf-8"))
    assert len(runs) == 3
    assert sum(map(len, runs)) == sum("as_those_that_were_judged" in str(case.get("name")) for case in cases) > 10


@pytest.mark.ros
def test_what_is_installed_runs_and_ends(installed: Path, tmp_path: Path) -> None:
    place = installed / "install" / "watch_monitor"
    command = [str(place / "lib" / "watch_monitor" / "watch_monitor"), "--ros-args", "-r", "__ns:=/robot1"]
    command += ["--params-file", str(place / "share" / "watch_monitor" / "config" / "watch_monitor.yaml")]
    packages = [str(path) for path in place.glob("lib/python*/site-packages")]
    with own_domain(tmp_path), (tmp_path / "log").open("w") as log:
        command += ["-p", f"jsonl:={tmp_path / 'verdicts.jsonl'}"]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(packages)}
        node = subprocess.Popen(command, env=environment, stdout=log, stderr=subprocess.STDOUT)
        try:
            wait_until(lambda: (tmp_path / "verdicts.jsonl").exists() or node.poll() is not None, "the node")
            node.send_signal(signal.SIGINT)
            assert node.wait(PATIENCE) == 3, (tmp_path / "log").read_text()
        finally:
            if node.poll() is None:
                node.kill()
                node.wait()
    assert "robot1.watch_monitor" in (tmp_path / "log").read_text()
    assert '"final": true' in (tmp_path / "verdicts.jsonl").read_text()
