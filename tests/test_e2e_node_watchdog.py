"""The emitted node that hangs, dies or is held: it is ended, with its verdicts, only where nothing else helps."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from xml.etree import ElementTree

import pytest
from ros_support import Network, Node, Send, emitted, emitted_text, wait_until

pytestmark = pytest.mark.ros
pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros]")

PROPERTIES = "decl x /x std_msgs/Float64.data\nlow: never x > 5\n"

HANG = """
def hang() -> None:
    import ctypes
    if Path(TRIGGER).exists():
        lock, library = ctypes.create_string_buffer(64), ctypes.PyDLL(None)
        library.pthread_mutex_lock(lock)
        library.pthread_mutex_lock(lock)


"""
"""Hangs as rclpy does in a deadlock of the middleware: the interpreter is held, and no signal is heard."""

IN_THE_LOOP = "        is_time = time.monotonic() >= self._next_housekeeping\n"
AT_THE_END = "        node.destroy_node()"


@pytest.fixture(scope="module")
def script(folder: Path) -> Path:
    return emitted(PROPERTIES, folder)


def hanging(folder: Path, where: str) -> Path:
    """A node that hangs at the line `where` of its text, as soon as there is a file `hang` in `folder`."""
    text, node = emitted_text(PROPERTIES), folder / "hanging.py"
    assert text.count(where) == 1
    trigger = f"TRIGGER = {str(folder / 'hang')!r}\n{HANG}"
    text = text.replace(where, f"        hang()\n{where}").replace("def main()", f"{trigger}def main()")
    node.write_text(text, encoding="utf-8")
    return node


def has_left_words(network: Network, said: str) -> None:
    """Wait until what its guard would report of the node is what a diagnosis said: the next one comes after that."""
    network.wait_until(lambda: said in network.message("watch_monitor: low"), f"a diagnosis with {said}")
    latest = network.latest_diagnosis
    network.wait_until(lambda: network.latest_diagnosis != latest, "another diagnosis")


def test_a_node_that_hangs_is_ended_with_its_verdicts(network: Network, send: Send, tmp_path: Path) -> None:
    with Node(hanging(tmp_path, IN_THE_LOOP), tmp_path) as node:
        send(1.0)
        has_left_words(network, "1 step")
        (tmp_path / "hang").touch()
        node.process.send_signal(signal.SIGINT)
        assert node.exit_code() == 2
    (run,) = node.runs
    assert (run["low"]["verdict"], run["low"]["steps"]) == ("presumably_satisfied", 1)
    assert node.lines[-1]["failed"] == "the node hung: its loop did not respond for 5 s"
    assert "low: presumably satisfied; 1 step" in node.log
    assert ElementTree.parse(node.junit).getroot().get("tests") == "1"


def test_a_violation_before_a_node_hangs_is_its_exit_code(network: Network, send: Send, tmp_path: Path) -> None:
    with Node(hanging(tmp_path, IN_THE_LOOP), tmp_path) as node:
        send(6.0)
        has_left_words(network, "violated")
        (tmp_path / "hang").touch()
        assert node.exit_code() == 1
    assert node.runs[0]["low"]["decided_at"]["values"] == {"x": 6.0}


def test_what_hangs_after_its_verdicts_has_their_exit_code(send: Send, tmp_path: Path) -> None:
    (tmp_path / "hang").touch()
    with Node(hanging(tmp_path, AT_THE_END), tmp_path, timeout=0.3) as node:
        send(1.0)
        assert node.exit_code() == 0
    assert len(node.runs) == 1


def test_a_node_that_dies_leaves_its_verdicts(script: Path, network: Network, send: Send, tmp_path: Path) -> None:
    with Node(script, tmp_path) as node:
        send(1.0)
        has_left_words(network, "1 step")
        os.kill(node.child, signal.SIGSEGV)
        assert node.exit_code() == 2
    assert node.lines[-1]["failed"] == "the node died with signal 11"
    assert node.runs[0]["low"]["steps"] == 1


def test_a_node_that_dies_before_its_loop_turns_is_never_well(script: Path, tmp_path: Path) -> None:
    text = script.read_text(encoding="utf-8").replace("        import_ros()\n", "        os._exit(1)\n")
    dying = tmp_path / "dying.py"
    dying.write_text(text, encoding="utf-8")
    with Node(dying, tmp_path) as node:
        assert node.exit_code() == 2
    assert "the node died with exit code 1" in node.log


def test_a_node_that_is_stopped_for_long_goes_on(script: Path, network: Network, send: Send, tmp_path: Path) -> None:
    with Node(script, tmp_path) as node:
        send(1.0)
        network.wait_until(lambda: node.changes, "the first step")
        node.pause()
        time.sleep(7)
        node.resume()
        os.kill(node.child, signal.SIGSTOP)  # as a debugger does
        time.sleep(7)
        os.kill(node.child, signal.SIGCONT)
        time.sleep(1)
        assert node.end() == 0


def test_a_node_that_is_killed_leaves_no_process(script: Path, tmp_path: Path) -> None:
    with Node(script, tmp_path) as node:
        wait_until(node.jsonl.exists, "the node is up")
        child = Path(f"/proc/{node.child}")
        node.end(signal.SIGKILL)
        wait_until(lambda: not child.exists(), "its process is gone")
