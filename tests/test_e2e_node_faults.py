"""The emitted node when things go wrong around it: it says so, and is never content with less than it was to judge."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from ros_support import Network, Node, Program, Send, emitted, wait_until

pytestmark = pytest.mark.ros
pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros]")

LOW = "low: never x > 5\n"
PROPERTIES = f"decl x /x std_msgs/Float64.data\n{LOW}"


@pytest.fixture(scope="module")
def script(folder: Path) -> Path:
    return emitted(PROPERTIES, folder)


def heard(network: Network, name: str = "watch_monitor: low") -> int:
    """How many messages on /x the status called `name` tells of."""
    if name not in network.statuses:
        return 0
    return int({pair.key: pair.value for pair in network.statuses[name].values}["messages on /x"])


def message(network: Network) -> str:
    """The latest message of the status of `low`."""
    return network.message("watch_monitor: low")


def lost(network: Network) -> int:
    """How many messages on /x the status of `low` says were lost."""
    found = re.search(r"(\d+) messages on /x were lost", message(network))
    return int(found[1]) if found else 0


def test_a_burst_that_overflows_the_queue_is_counted_and_never_well(
    script: Path, network: Network, send: Send, tmp_path: Path
) -> None:
    with Node(script, tmp_path) as node:
        send(1.0)
        network.wait_until(lambda: node.changes, "the first step")
        node.pause()
        send(*[1.0] * 5000)
        node.resume()
        network.wait_until(lambda: heard(network) + lost(network) == 5001, "a diagnosis of the loss")
        assert network.statuses["watch_monitor: low"].level == b"\x01"
        assert node.end() == 3
    (run,) = node.runs
    missing = run["low"]["lost_messages"]["/x"]
    assert missing > 0
    assert run["low"]["steps"] + missing == 5001
    assert f"{missing} messages on /x were lost" in node.log
    suite = ElementTree.parse(node.junit).getroot()
    assert (suite.get("failures"), suite.get("errors")) == ("0", "1")
    case = suite.find("testcase")
    assert case is not None
    assert f"{missing} messages on /x were lost" in str(case[0].get("message"))


def test_what_fits_in_the_queue_is_all_judged(script: Path, network: Network, send: Send, tmp_path: Path) -> None:
    with Node(script, tmp_path) as node:
        send(1.0)
        network.wait_until(lambda: node.changes, "the first step")
        node.pause()
        send(*[1.0] * 900)
        node.resume()
        network.wait_until(lambda: heard(network) == 901, "all messages")
        assert node.end() == 0
    assert "lost_messages" not in node.runs[0]["low"]


def test_a_violation_long_before_there_is_a_time_is_found(
    script: Path, network: Network, send: Send, tmp_path: Path
) -> None:
    with Node(script, tmp_path, use_sim_time="true") as node:
        send(1.0, 1.0, 6.0)
        for count in range(503, 2504, 500):
            send(*[1.0] * 500)
            network.wait_until(lambda count=count: heard(network) == count, "the messages are there")  # type: ignore[misc]
        assert "2503 messages on /x before there was a time" in message(network)
        assert "no time has arrived on /clock" in message(network)
        network.tell_time(7)
        network.wait_until(lambda: ("low", "violated") in node.changes, "the violation")
        assert node.end() == 1
    assert node.runs[0]["low"]["decided_at"]["step"] == 2


def test_a_simulation_that_is_reset_and_paused_ends_the_run(
    script: Path, network: Network, send: Send, tmp_path: Path
) -> None:
    with Node(script, tmp_path, use_sim_time="true") as node:
        network.tell_time(7)
        send(1.0)
        network.wait_until(lambda: node.changes, "the first step")
        network.tell_time(0)
        network.wait_until(lambda: node.runs, "the end of the run")
        send(6.0)
        network.wait_until(lambda: heard(network) == 1, "a message of the second run")
        network.tell_time(1)
        network.wait_until(lambda: ("low", "violated") in node.changes, "a verdict of the second run")
        assert node.end() == 1
    assert [run["low"]["verdict"] for run in node.runs] == ["presumably_satisfied", "violated"]


def test_a_time_that_is_none_breaks_the_node_but_not_its_report(
    script: Path, network: Network, send: Send, tmp_path: Path
) -> None:
    with Node(script, tmp_path, use_sim_time="true") as node:
        network.tell_time(7)
        send(1.0)
        network.wait_until(lambda: node.changes, "the first step")
        network.tell_time(-1)
        assert node.exit_code() == 2
    assert "because the node failed" in node.log
    assert node.runs[0]["low"]["verdict"] == "presumably_satisfied"
    assert ElementTree.parse(node.junit).getroot().get("tests") == "1"


def test_a_signal_while_the_node_still_imports_ends_it_with_its_verdicts(script: Path, tmp_path: Path) -> None:
    before, after = script.read_text(encoding="utf-8").split("import argparse\n", 1)
    slow = tmp_path / "slow.py"
    pause = "import time\nprint('begun', flush=True)\ntime.sleep(1)\nimport argparse\n"
    slow.write_text(f"{before}{pause}{after}", encoding="utf-8")
    for number in (signal.SIGINT, signal.SIGTERM):
        place = tmp_path / number.name
        place.mkdir()
        with Node(slow, place) as node:
            wait_until(lambda node=node: "begun" in node.log, "its first line")  # type: ignore[misc]
            assert node.end(number) == 3
        assert node.runs[0]["low"]["verdict"] == "not_started"


PUBLISHER = """
import sys, time
import rclpy
from std_msgs.msg import Float64

rclpy.init()
publisher = rclpy.create_node("other").create_publisher(Float64, "/x", 1000)
while True:
    publisher.publish(Float64(data=1.0))
    time.sleep(0.25)
"""


def test_a_topic_that_has_fallen_silent_and_a_clock_that_stands_are_no_longer_well(
    script: Path, network: Network, tmp_path: Path
) -> None:
    other = tmp_path / "other.py"
    other.write_text(PUBLISHER)

    with Node(script, tmp_path, use_sim_time="true") as node, Program(other, folder=tmp_path) as publisher:
        network.tell_time(1)
        network.wait_until(lambda: heard(network), "messages")
        first = heard(network)
        network.wait_until(lambda: heard(network) > first, "messages some time after others")
        network.tell_time(2)
        publisher.process.kill()
        publisher.process.wait()
        network.wait_until(lambda: "no message on /x for" in message(network), "the silence is told")
        network.wait_until(
            lambda: "/clock has stood still for" in message(network), "the clock's standing still is told"
        )
        assert network.statuses["watch_monitor: low"].level == b"\x01"
        assert node.end() == 0
    assert "no message on /x for" in node.log


def test_a_topic_whose_publisher_has_gone_is_no_longer_well(
    script: Path, network: Network, send: Send, tmp_path: Path
) -> None:
    with Node(script, tmp_path) as node:
        send(1.0)
        network.wait_until(lambda: heard(network) == 1, "a message")
        assert network.statuses["watch_monitor: low"].level == b"\x00"
        network.withdraw("/x")
        network.wait_until(lambda: "/x no longer has a publisher" in message(network), "that is told")
        assert node.end() == 0


def test_nodes_of_one_name_in_two_namespaces_are_told_apart(script: Path, network: Network, tmp_path: Path) -> None:
    with Node(script, tmp_path, "-r", "__ns:=/east") as node:
        network.wait_until(lambda: "east/watch_monitor: low" in network.statuses, "a diagnosis")
        assert node.end() == 3


def test_a_report_that_cannot_be_written_is_never_well(
    script: Path, network: Network, send: Send, tmp_path: Path
) -> None:
    with Node(script, tmp_path, jsonl="/dev/full") as node:
        send(1.0)
        network.wait_until(lambda: heard(network) == 1, "a message")
        assert node.end() == 2
    assert "a report cannot be written" in node.log


def test_a_line_that_a_full_disk_cuts_spoils_no_other(tmp_path: Path) -> None:
    code = (
        "import sys, resource\nfrom pathlib import Path\nfrom ltlc.backends.ros2.node.files import Lines\n"
        "lines = Lines(Path(sys.argv[1]))\nlines.write('{\"a\": 1}')\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (12, resource.RLIM_INFINITY))\n"
        "try:\n    lines.write('{\"b\": 2}')\nexcept OSError as error:\n    print('cut')\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)\nlines.write('{\"c\": 3}')\n"
    )
    path = tmp_path / "lines.jsonl"
    run = subprocess.run([sys.executable, "-c", code, str(path)], capture_output=True, text=True, check=True)
    assert run.stdout == "cut\n"
    assert path.read_text().split("\n") == ['{"a": 1}', '{"b', '{"c": 3}', ""]


def test_a_pipe_that_nobody_reads_is_refused(script: Path, tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with Node(script, tmp_path, jsonl=pipe) as node:
        assert node.exit_code() == 2
    assert "no process reads this pipe" in node.log


def test_a_parameter_file_for_all_nodes_may_have_what_others_need(script: Path, tmp_path: Path) -> None:
    parameters = tmp_path / "all.yaml"
    parameters.write_text("/**:\n  ros__parameters:\n    max_speed: 3.0\n    timeout: 0.5\n")
    with Node(script, tmp_path, "--params-file", str(parameters), use_sim_time="false") as node:
        wait_until(lambda: "no parameter is called max_speed" in node.log, "a warning")
        assert node.end() == 3
