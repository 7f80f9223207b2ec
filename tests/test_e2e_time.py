"""The emitted node and time: deadlines, silence, order, lateness; and recordings of what it judged."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable, Iterator
from contextlib import redirect_stdout
from decimal import Decimal
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from ros_support import Network, Node, Program, by_label, emitted, own_domain, wait_until

from ltlc.cli import main

pytestmark = pytest.mark.ros
pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros]")

ROBOT = Path(__file__).parent / "bumper_robot.py"

ROBOT_PROPERTIES = """
decl bumper /bumper std_msgs/Bool.data
decl speed /speed std_msgs/Float64.data
decl commanded /commanded std_msgs/Float64.data
decl scan /scan sensor_msgs/LaserScan.ranges
stops: always (bumper implies eventually speed < 0.02 within 300 ms)
sees: after new scan, always age(scan) <= 600 ms
moves: never historically (commanded > 0 and speed < 0.02) for 2 s
arrives: eventually new bumper within 10 min
untouched: never bumper
"""

MS = 10**6

Recorded = list[tuple[int, dict[str, Any]]]


def recorded(path: Path) -> Recorded:
    """What stands in a recording, with times in ns, read without ltlc."""
    rows = []
    for line in path.read_text(encoding="utf-8").splitlines():
        row = json.loads(line)
        exact = json.loads(line, parse_float=Decimal)["time"] * 10**9
        del row["time"]
        rows.append((int(exact), row))
    return rows


def judged(properties: Path, recording: Path) -> dict[str, dict[str, Any]]:
    """What `ltlc run` says."""
    output = StringIO()
    with redirect_stdout(output):
        main(["run", str(properties), str(recording), "--format", "json"])
    return by_label(json.loads(output.getvalue()))


def told(report: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """A report without what only a node, or only `ltlc run`, knows."""
    left_out = ("told_late", "violations")
    return {label: {k: v for k, v in each.items() if k not in left_out} for label, each in report.items()}


class Drive:
    """A drive of the robot, as the node judged it, as it was recorded, and as `ltlc run` judges that."""

    def __init__(self, script: Path, folder: Path, options: tuple[str, ...]) -> None:
        recording = folder / "run.jsonl"
        with Node(script, folder, record=recording) as node, Program(ROBOT, *options, folder=folder) as robot:
            wait_until(lambda: robot.has_ended or "has driven" in robot.log, "the robot drives")
            assert not robot.has_ended, robot.log
            self.exit_code = node.end()
            self.log = robot.log
        (self.live,) = node.runs
        self.rows = recorded(recording)
        self.recorded = judged(script.with_name("watch.txt"), recording)

    def decided(self, label: str) -> int | None:
        """When a property was violated, in ns."""
        found = self.live[label]
        return int(found["decided_at"]["time_ns"]) if found["verdict"] == "violated" else None


DRIVES = {
    "stops": ("--seconds", "2", "--reaction", "0.1"),
    "stops late": ("--seconds", "2.2", "--reaction", "0.6"),
    "falls blind": ("--seconds", "2.4", "--reaction", "0.1", "--blind-after", "1"),
    "gets stuck": ("--seconds", "5.5"),
    "is held": ("--seconds", "2.2", "--lock", "/watch_monitor/violated/untouched"),
}


@pytest.fixture(scope="module")
def drives(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[[str], Drive]]:
    pytest.importorskip("mujoco", reason="needs MuJoCo: install ltlc[ros,simulation]")
    folder = tmp_path_factory.mktemp("drives")
    script = emitted(ROBOT_PROPERTIES, folder)

    @cache
    def drive(name: str) -> Drive:
        place = folder / name.replace(" ", "_")
        place.mkdir()
        return Drive(script, place, DRIVES[name])

    with own_domain(folder):
        yield drive


def stops_late(rows: Recorded) -> int | None:
    """When 300 ms have passed since a bumper was hit with nothing as slow as 0.02 m/s."""
    values: dict[str, Any] = {}
    hit = None
    for time, row in rows:
        if hit is not None and time > hit + 300 * MS:
            return hit + 300 * MS + 1
        values |= row
        if "bumper" not in values or "speed" not in values or not row.keys() & {"bumper", "speed"}:
            continue
        if values["speed"] < 0.02:
            hit = None
        elif values["bumper"] and hit is None:
            hit = time
    return None


def falls_silent(rows: Recorded) -> int | None:
    """When no scan has come for 600 ms, from the first scan on."""
    latest = None
    for time, row in rows:
        if latest is not None and time > latest + 600 * MS:
            return latest + 600 * MS + 1
        latest = time if "scan" in row else latest
    return None


def is_stuck(rows: Recorded) -> int | None:
    """When the robot was told to drive for 2 s, and did not."""
    values: dict[str, Any] = {}
    stuck = None
    for time, row in rows:
        if stuck is not None and time >= stuck + 2000 * MS:
            return stuck + 2000 * MS
        values |= row
        if "commanded" in values and "speed" in values:
            is_now = values["commanded"] > 0 and values["speed"] < 0.02
            stuck = (time if stuck is None else stuck) if is_now else None
    return None


@pytest.mark.parametrize("name", DRIVES)
def test_what_a_drive_violates_and_when_follows_from_what_was_received(
    drives: Callable[[str], Drive], name: str
) -> None:
    drive = drives(name)
    found = {label: drive.decided(label) for label in ("stops", "sees", "moves")}
    assert found == {"stops": stops_late(drive.rows), "sees": falls_silent(drive.rows), "moves": is_stuck(drive.rows)}
    assert drive.live["arrives"]["verdict"] == "satisfied"
    assert any(row.get("bumper") for _, row in drive.rows)


@pytest.mark.parametrize(("name", "label"), [("stops late", "stops"), ("falls blind", "sees"), ("gets stuck", "moves")])
def test_a_deadline_that_passes_is_a_violation_by_time(drives: Callable[[str], Drive], name: str, label: str) -> None:
    drive = drives(name)
    assert (drive.exit_code, drive.live[label]["verdict"]) == (1, "violated")
    assert drive.live[label]["decided_at"]["by_time"]


def test_a_lock_on_a_violation_holds_a_robot_that_would_not_stop(drives: Callable[[str], Drive]) -> None:
    held, stuck = (
        [row["commanded"] for _, row in drives(n).rows if "commanded" in row] for n in ("is held", "gets stuck")
    )
    assert (held[0] > 0, held[-1], stuck[-1] > 0) == (True, 0, True)
    assert "ms after it told of the hit" in drives("is held").log


@pytest.mark.parametrize("name", DRIVES)
def test_a_recording_of_what_was_judged_gets_the_same_report_to_the_nanosecond(
    drives: Callable[[str], Drive], name: str
) -> None:
    assert told(drives(name).live) == told(drives(name).recorded)


WATCHED = """
decl go /go std_msgs/Bool.data
decl done /done std_msgs/Bool.data
answered: always (go implies eventually done within 300 ms)
"""


Send = Callable[[str, bool], None]


@pytest.fixture
def send(network: Network) -> Send:
    """Publishes on `/go` or `/done`, once somebody listens to both."""
    from std_msgs.msg import Bool

    publishers = {name: network.publisher(Bool, f"/{name}") for name in ("go", "done")}

    def send(name: str, value: bool) -> None:
        network.matched(list(publishers.values()))
        publishers[name].publish(Bool(data=value))

    return send


def test_a_dead_topic_violates_its_watchdog(folder: Path, tmp_path: Path) -> None:
    text = "decl scan /scan sensor_msgs/LaserScan.ranges\nwatchdog: always age(scan) <= 200 ms"
    recording = tmp_path / "run.jsonl"
    with Node(emitted(text, folder, "dead"), tmp_path, on_violation="end", record=recording) as node:
        assert node.exit_code() == 1
    (began, _), *_ = recorded(recording)
    found = node.runs[0]["watchdog"]["decided_at"]
    assert (found["time_ns"], found["by_time"]) == (began + 200 * MS + 1, True)
    assert told(judged(folder / "dead.txt", recording)) == told(node.runs[0])


SLEEPER = """
import signal
import time


def sleep(*_: object) -> None:
    print("asleep", flush=True)
    time.sleep({seconds})


signal.signal(signal.SIGUSR1, sleep)
"""


def sleeper(folder: Path, text: str, seconds: float) -> Path:
    """A node that at SIGUSR1 does nothing for so long, while its messages are received."""
    script = emitted(text, folder)
    code = script.read_text(encoding="utf-8")
    head = "from __future__ import annotations\n"
    script.write_text(code.replace(head, head + SLEEPER.format(seconds=seconds), 1), encoding="utf-8")
    return script


def owed(node: Node) -> bool:
    return ("answered", "presumably_violated") in node.changes


def test_a_node_that_wakes_late_says_so(folder: Path, network: Network, send: Send, tmp_path: Path) -> None:
    script = sleeper(folder, WATCHED.replace("300 ms", "3 s"), 4)
    recording = tmp_path / "run.jsonl"
    with Node(script, tmp_path, record=recording) as node:
        send("done", False)
        send("go", True)
        network.wait_until(lambda: owed(node), "something is owed")
        os.kill(node.child, signal.SIGUSR1)
        network.wait_until(lambda: ("answered", "violated") in node.changes, "the violation")
        network.wait_until(
            lambda: "reported late 1 time" in getattr(network.statuses.get("watch_monitor: answered"), "message", ""),
            "a status",
        )
        assert node.end() == 1
    found = node.runs[0]["answered"]
    begun = max(time for time, row in recorded(recording) if row)  # of two topics, either may have been heard first
    assert found["decided_at"]["time_ns"] == begun + 3000 * MS + 1
    assert (found["told_late"]["times"], found["told_late"]["longest"] > 0.02) == (1, True)
    assert "reported late 1 time, by " in node.log
    assert "reported late 1 time, by " in node.junit.read_text(encoding="utf-8")


def test_what_was_received_in_time_settles_what_a_late_node_looks_at_later(
    folder: Path, network: Network, send: Send, tmp_path: Path
) -> None:
    script = sleeper(folder, WATCHED.replace("300 ms", "3 s"), 4)
    recording = tmp_path / "run.jsonl"
    with Node(script, tmp_path, record=recording) as node:
        send("done", False)
        send("go", True)
        network.wait_until(lambda: owed(node), "something is owed")
        os.kill(node.child, signal.SIGUSR1)
        network.wait_until(lambda: "asleep" in node.log, "the node sleeps")
        send("done", True)
        network.wait_until(lambda: node.changes[-1][1] != "presumably_violated", "another verdict")
        node.end()
    _, begun, answered = (time for time, row in recorded(recording) if row)
    assert (node.changes[-1][1] == "violated") == (answered > begun + 3000 * MS)
    assert told(judged(folder / "watch.txt", recording)) == told(node.runs[0])


@pytest.mark.parametrize("executor", ["rclpy.experimental", "rclpy.none"])
def test_messages_that_wait_are_judged_in_the_order_of_their_receipt(
    folder: Path, network: Network, send: Send, tmp_path: Path, executor: str
) -> None:
    script = sleeper(folder, "decl go /go std_msgs/Bool.data\ndecl done /done std_msgs/Bool.data\nnever go and done", 4)
    script.write_text(script.read_text(encoding="utf-8").replace("rclpy.experimental", executor), encoding="utf-8")
    recording = tmp_path / "run.jsonl"
    with Node(script, tmp_path, record=recording) as node:
        send("go", False)
        send("done", False)
        network.wait_until(lambda: node.changes, "the first step")
        os.kill(node.child, signal.SIGUSR1)
        network.wait_until(lambda: "asleep" in node.log, "the node sleeps")
        for _ in range(20):
            for name in ("go", "done"):
                send(name, True)
                send(name, False)
        network.wait_until(lambda: heard(network) == 82, "all messages")
        assert node.end() == 0
    rows = [row for _, row in recorded(recording) if row]
    assert rows[2:] == [{name: value} for _ in range(20) for name in ("go", "done") for value in (True, False)]


def heard(network: Network) -> int:
    """How many messages a status tells of."""
    return sum(
        int(pair.value)
        for status in network.statuses.values()
        for pair in status.values
        if pair.key.startswith("messages on")
    )


def test_under_simulated_time_only_the_clock_passes_deadlines(
    folder: Path, network: Network, send: Send, tmp_path: Path
) -> None:
    recording = tmp_path / "run.jsonl"
    with Node(emitted(WATCHED, folder), tmp_path, use_sim_time="true", record=recording) as node:
        network.tell_time(5)
        send("done", False)
        send("go", True)
        network.wait_until(lambda: owed(node), "something is owed")
        network.tell_time(6)
        network.wait_until(lambda: ("answered", "violated") in node.changes, "the violation")
        network.tell_time(2)
        network.wait_until(lambda: len(node.runs) == 1, "the end of the run")
        send("go", False)
        network.wait_until(lambda: heard(network) == 1, "a message of the second run")
        assert node.end() == 1
    first, second = node.runs
    assert first["answered"]["decided_at"]["time_ns"] == 5300 * MS + 1
    assert "told_late" not in first["answered"]
    assert told(judged(folder / "watch.txt", recording)) == told(first)
    assert recorded(tmp_path / "run_2.jsonl")[0] == (2000 * MS, {"go": False})
    assert second["answered"]["verdict"] == "not_started"


def test_a_recording_that_was_cut_off_can_be_told_from_one_that_ended(
    folder: Path, network: Network, send: Send, tmp_path: Path
) -> None:
    recording = tmp_path / "run.jsonl"
    with Node(emitted(WATCHED, folder), tmp_path, record=recording) as node:
        send("go", False)
        unfinished = tmp_path / "run.jsonl.part"
        network.wait_until(lambda: unfinished.exists() and unfinished.read_text(), "a line is written")
        node.end(signal.SIGKILL)
    assert not recording.exists()
    assert recorded(unfinished)[0][1] == {"go": False}


def test_a_recording_that_cannot_be_written_is_told(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "run.jsonl.part").mkdir()
    with Node(emitted(WATCHED, folder), tmp_path, record=tmp_path / "run.jsonl") as node:
        assert node.exit_code() == 2
    assert "record is" in node.log


def test_without_times_of_receipt_those_of_the_callbacks_count_and_that_is_told_once(
    folder: Path, network: Network, send: Send, tmp_path: Path
) -> None:
    script = emitted(WATCHED, folder)
    code = script.read_text(encoding="utf-8").replace('info["received_timestamp"]', "0")
    script.write_text(code, encoding="utf-8")
    with Node(script, tmp_path) as node:
        send("done", False)
        send("go", True)
        network.wait_until(lambda: ("answered", "violated") in node.changes, "the violation")
        assert node.end() == 1
    assert node.log.count("the middleware reports no times of receipt") == 1
