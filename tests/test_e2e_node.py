"""The emitted node among other nodes: signals, parameters, clocks, quality of service, and what it tells of it all."""

from __future__ import annotations

import re
import signal
from hashlib import sha256
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from ros_support import Network, Node, Send, emitted

from ltlc import __version__
from ltlc.base.revision import commit_text

pytestmark = pytest.mark.ros
pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros]")

NAUGHTY = "\"\"\" + exit(7) # {0} %s '''"

PROPERTIES = """
decl x /x std_msgs/Float64.data
## It stays low.
[id "REQ-1", verifies "SYS-4" "H-7"]
low: never x > 5
reached: eventually x == 3
"""

TOPICS = """
decl effort /effort std_msgs/Float64.data
decl kept /kept std_msgs/Float64.data
decl typed /typed std_msgs/Float64.data
decl silent /silent std_msgs/Float64.data
decl hollow /hollow std_msgs/Float64.data
decl text /text std_msgs/String.data
decl level /levels diagnostic_msgs/DiagnosticArray.status[1].level
decl beams /scan sensor_msgs/LaserScan.ranges
decl parts /report diagnostic_msgs/DiagnosticArray.status[].name
decl states /report diagnostic_msgs/DiagnosticArray.status[].level
best_effort: never effort > 5
latched: never kept > 5
other_type: never typed > 5
unheard: never silent > 5
not_a_number: never hollow > 5
absent_entry: never level > 1
near: never min(beams) < 0.15
part: never any(parts in {"arm", "base"} and states == 2)
"""


@pytest.fixture(scope="module")
def script(folder: Path) -> Path:
    return emitted(PROPERTIES, folder)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_run_with_its_verdicts(
    script: Path, network: Network, send: Send, tmp_path: Path, number: signal.Signals
) -> None:
    with Node(script, tmp_path) as node:
        send(1.0)
        network.wait_until(lambda: len(node.changes) == 2, "first verdicts")
        assert node.end(number) == 3
    (run,) = node.runs
    assert {label: found["verdict"] for label, found in run.items()} == {
        "low": "presumably_satisfied",
        "reached": "presumably_violated",
    }
    assert "unmet since" in node.log
    suite = ElementTree.parse(node.junit).getroot()
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("2", "1", "0")


def test_all_that_a_node_reports_has_what_it_was_built_by_and_from(
    script: Path, network: Network, send: Send, tmp_path: Path
) -> None:
    with Node(script, tmp_path) as node:
        send(1.0)
        network.wait_until(lambda: "watch_monitor: low" in network.statuses, "a diagnosis")
        assert node.end() == 3
    digest = sha256(PROPERTIES.encode()).hexdigest()
    wanted = {"ltlc": __version__, "specification": f"watch.txt sha256:{digest}"}
    wanted |= {"commit": commit_text()} if commit_text() else {}
    assert node.lines[-1]["provenance"] == {
        "ltlc": __version__,
        "commit": commit_text() or None,
        "specifications": [{"name": "watch.txt", "sha256": digest}],
        "recordings": [],
    }
    suite = ElementTree.parse(node.junit).getroot()
    assert {each.get("name"): each.get("value") for each in suite.findall("properties/property")} == wanted
    told = {pair.key: pair.value for pair in network.statuses["watch_monitor: low"].values}
    assert wanted.items() <= told.items()


def test_the_timeout_ends_the_run(script: Path, send: Send, tmp_path: Path) -> None:
    with Node(script, tmp_path, timeout=0.3) as node:
        send(3.0)
        assert node.exit_code() == 0
    assert node.changes[-1] == ("reached", "satisfied")
    assert node.runs[0]["low"]["steps"] == 1


def test_a_violation_ends_the_run_where_that_was_asked_for(script: Path, send: Send, tmp_path: Path) -> None:
    with Node(script, tmp_path, on_violation="end") as node:
        send(6.0)
        assert node.exit_code() == 1
    assert node.runs[0]["low"]["decided_at"]["values"] == {"x": 6.0}
    assert "Error at line 5 of watch.txt (low):" in node.log


def test_a_full_disk_is_reported_and_changes_no_verdict(script: Path, send: Send, tmp_path: Path) -> None:
    with Node(script, tmp_path, on_violation="end", jsonl="/dev/full") as node:
        send(6.0)
        assert node.exit_code() == 1
    assert "a report cannot be written" in node.log
    assert "Traceback" not in node.log


def test_names_of_locks_are_names_of_topics_and_all_different() -> None:
    from ltlc.runtime.reports import topic_names

    assert topic_names(["line 3", "line_3", "3 m!", "ä", "", "line 3 2"]) == [
        *("line_3", "line_3_2", "p_3_m", "p", "p_2", "line_3_2_2")
    ]


def test_whether_something_is_violated_is_published_for_locks(
    script: Path, network: Network, send: Send, tmp_path: Path
) -> None:
    from std_msgs.msg import Bool

    heard: dict[str, list[bool]] = {name: [] for name in ("violated", "violated/low", "violated/reached")}
    for name, values in heard.items():
        network.listen(Bool, f"/watch_monitor/{name}", lambda m, values=values: values.append(m.data))  # type: ignore[misc]
    with Node(script, tmp_path):
        network.wait_until(lambda: all(heard.values()), "what is not violated")
        assert not any(value for values in heard.values() for value in values)
        send(6.0)
        network.wait_until(lambda: heard["violated"].count(True) > 1 and heard["violated/low"][-1], "a violation")
    assert (heard["violated/low"], heard["violated/reached"]) == ([False, True], [False])


def test_verdicts_are_published_for_those_who_come_late_too(
    script: Path, network: Network, send: Send, tmp_path: Path
) -> None:
    with Node(script, tmp_path, "-r", "__node:=guard", "-r", "__ns:=/site") as node:
        send(6.0)
        network.wait_until(lambda: ("low", "violated") in node.changes, "a violation")
        network.hear_verdicts("/site/guard/verdicts")
        network.wait_until(lambda: len(network.verdicts) == 2, "the verdicts so far")
        assert {v["label"]: v["verdict"] for v in network.verdicts} == {
            "low": "violated",
            "reached": "presumably_violated",
        }
        node.process.send_signal(signal.SIGINT)
        network.wait_until(lambda: network.verdicts[-1].get("final"), "the final verdicts")
        assert node.exit_code() == 1


def test_with_a_rate_time_makes_the_steps(script: Path, network: Network, send: Send, tmp_path: Path) -> None:
    with Node(script, tmp_path, rate=50, timeout=0.5) as node:
        send(1.0)
        assert node.exit_code() == 3
    assert node.runs[0]["low"]["steps"] == 26


def test_simulated_time_rules_and_a_jump_back_begins_a_new_run(
    script: Path, network: Network, send: Send, tmp_path: Path
) -> None:
    with Node(script, tmp_path, use_sim_time="true") as node:
        send(6.0)
        network.wait_until(lambda: messages(network, "watch_monitor: low", "/x") is not None, "a diagnosis")
        assert node.changes == []
        network.tell_time(100)
        network.wait_until(lambda: ("low", "violated") in node.changes, "the early message is judged")
        network.tell_time(20)
        network.wait_until(lambda: len(node.runs) == 1, "the end of the first run")
        send(3.0)
        network.wait_until(lambda: ("reached", "satisfied") in node.changes, "a verdict of the second run")
        assert node.end() == 1
    first, second = node.runs
    assert (first["low"]["verdict"], first["low"]["decided_at"]["time"]) == ("violated", 100.0)
    assert (second["low"]["verdict"], second["reached"]["decided_at"]["time"]) == ("presumably_satisfied", 20.0)
    assert "the clock went back from 100 s to 20 s" in node.log
    assert [suite.get("errors") for suite in ElementTree.parse(node.junit).getroot()] == ["0", "0"]


def messages(network: Network, name: str, topic: str) -> int | None:
    """How many messages on `topic` the status called `name` tells of."""
    if name not in network.statuses:
        return None
    values = {pair.key: pair.value for pair in network.statuses[name].values}
    return int(values[f"messages on {topic}"])


def test_a_diagnosis_has_the_requirement(script: Path, network: Network, send: Send, tmp_path: Path) -> None:
    with Node(script, tmp_path) as node:
        send(1.0)
        network.wait_until(lambda: {"watch_monitor: low", "watch_monitor: reached"} <= {*network.statuses}, "diagnoses")
        node.end()
    low, reached = (network.statuses[f"watch_monitor: {label}"].values for label in ("low", "reached"))
    found = {pair.key: pair.value for pair in low if pair.key.startswith("requirement")}
    assert found == {"requirement": "It stays low.", "requirement id": "REQ-1", "requirement verifies": "SYS-4, H-7"}
    assert not [pair for pair in reached if pair.key.startswith("requirement")]
    (case, other) = ElementTree.parse(node.junit).getroot().findall("testcase")
    assert [each.get("value") for each in case.findall("properties/property")][1:] == ["REQ-1", "SYS-4", "H-7"]
    assert other.find("properties") is None


def test_without_clock_the_report_says_so(script: Path, network: Network, tmp_path: Path) -> None:
    with Node(script, tmp_path, use_sim_time="true") as node:
        network.wait_until(
            lambda: "no time has arrived on /clock" in network.message("watch_monitor: low"), "a diagnosis"
        )
        assert node.end() == 3
    assert "no time has arrived on /clock" in node.log


@pytest.fixture(scope="module")
def topics(folder: Path) -> dict[str, Any]:
    """The statuses of a node whose topics are published in every awkward way, once all have been looked at."""
    from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
    from sensor_msgs.msg import LaserScan
    from std_msgs.msg import Float64, Int64, String

    place = folder / "topics"
    place.mkdir()
    text = TOPICS + f'injected: never text == "{quoted(NAUGHTY)}"\n'
    network = Network()
    kept = network.publisher(Float64, "/kept", QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
    kept.publish(Float64(data=1.0))
    effort = network.publisher(Float64, "/effort", QoSProfile(depth=9, reliability=ReliabilityPolicy.BEST_EFFORT))
    network.publisher(Int64, "/typed")
    hollow = network.publisher(Float64, "/hollow")
    injected = network.publisher(String, "/text")
    levels = network.publisher(DiagnosticArray, "/levels")
    report = network.publisher(DiagnosticArray, "/report")
    scan = network.publisher(LaserScan, "/scan")
    with Node(emitted(text, folder, "topics"), place) as node:
        network.matched([effort, hollow, injected, levels, scan, report])
        scan.publish(LaserScan(ranges=[float("nan"), 0.125, 3.0]))
        states = [("camera", b"\x02"), ("base", b"\x01"), ("arm", b"\x02")]
        report.publish(DiagnosticArray(status=[DiagnosticStatus(name=name, level=level) for name, level in states]))
        hollow.publish(Float64(data=float("nan")))
        levels.publish(DiagnosticArray())
        injected.publish(String(data=NAUGHTY))

        def everything_came() -> bool:
            effort.publish(Float64(data=1.0))  # again and again: nobody sends it again when it is lost
            found = {name: status.message for name, status in network.statuses.items()}
            wanted = {
                "best_effort": "presumably satisfied",
                "latched": "1 step",
                "other_type": "published as",
                "not_a_number": "NaN",
                "absent_entry": "1 message",
                "injected": "violated",
                "near": "violated",
                "part": "violated",
            }
            return all(part in found.get(f"topics_monitor: {label}", "") for label, part in wanted.items())

        network.wait_until(everything_came, "a diagnosis of every topic")
        assert node.end() == 1
    network.close()
    return {name.removeprefix("topics_monitor: "): status for name, status in network.statuses.items()} | {
        "log": node.log,
        "final": node.runs[0],
    }


def quoted(text: str) -> str:
    """`text` as it stands in a string of the language."""
    return text.replace("\\", "\\\\").replace('"', '\\"')


def test_a_publisher_that_makes_its_best_effort_is_heard(topics: dict[str, Any]) -> None:
    assert topics["final"]["best_effort"]["verdict"] == "presumably_satisfied"
    assert "/effort is published without delivery guarantee" in topics["best_effort"].message


def test_a_message_kept_for_newcomers_is_heard(topics: dict[str, Any]) -> None:
    assert topics["final"]["latched"]["steps"] == 1


def test_another_type_on_a_topic_is_reported(topics: dict[str, Any]) -> None:
    told = "/typed is published as std_msgs/msg/Int64, not as "
    assert topics["other_type"].message.count(told) == 1
    assert "no message on /typed" not in topics["other_type"].message


def test_a_silent_topic_is_reported(topics: dict[str, Any]) -> None:
    assert "no message on /silent" in topics["unheard"].message
    assert "unheard: not started; no message on /silent" in topics["log"]


def test_a_message_without_the_wanted_entry_is_reported(topics: dict[str, Any]) -> None:
    assert "1 message on /levels, but none with a value of level" in topics["absent_entry"].message


def test_steps_left_out_because_of_nan_are_reported(topics: dict[str, Any]) -> None:
    assert topics["final"]["not_a_number"]["invalid_steps"] == 1
    assert {pair.key: pair.value for pair in topics["not_a_number"].values}["invalid steps"] == "1"


def test_a_beam_without_an_echo_hides_no_collision(topics: dict[str, Any]) -> None:
    assert topics["final"]["near"]["decided_at"]["because"][0]["left"] == 0.125
    assert "1 element of beams was NaN, no measurement" in topics["near"].message


def test_fields_of_the_messages_of_an_array_are_read_together(topics: dict[str, Any]) -> None:
    values = topics["final"]["part"]["decided_at"]["values"]
    assert values == {"parts": ["camera", "base", "arm"], "states": [2.0, 1.0, 2.0]}


def test_strings_of_the_property_file_are_only_strings(topics: dict[str, Any]) -> None:
    assert topics["final"]["injected"]["decided_at"]["values"] == {"text": NAUGHTY}


def test_the_level_of_a_status_tells_how_bad_it_is(topics: dict[str, Any]) -> None:
    levels = {label: topics[label].level for label in ("injected", "best_effort", "latched", "unheard")}
    assert levels == {"injected": b"\x02", "best_effort": b"\x01", "latched": b"\x00", "unheard": b"\x03"}
    assert topics["latched"].hardware_id == "/topics_monitor"


@pytest.mark.parametrize(
    ("parameters", "complaint"),
    [
        ({"rate": -1}, "rate is -1: it must be a number that is not negative"),
        ({"on_violation": "stop"}, "on_violation is 'stop': it must be 'continue' or 'end'"),
        ({"tiemout": 3}, "no parameter is called tiemout; did you mean timeout? there are rate,"),
        ({"junit": "/proc/none/report.xml"}, "its folder is not writable"),
    ],
)
def test_unusable_parameters_are_refused(
    script: Path, tmp_path: Path, parameters: dict[str, object], complaint: str
) -> None:
    with Node(script, tmp_path, **parameters) as node:
        assert node.exit_code() == 2
    assert complaint in node.log


def test_a_package_that_is_not_there_is_named(folder: Path, tmp_path: Path) -> None:
    with Node(emitted("never robot.velocity > 1\n_simulator_ = model_states", folder, "classic"), tmp_path) as node:
        assert node.exit_code() == 2
    assert "install the ROS 2 package gazebo_msgs" in node.log


def test_a_node_logs_what_it_watches(topics: dict[str, Any]) -> None:
    assert re.search(r"watching \d+ properties on \d+ topics", topics["log"])


def test_an_error_in_the_log_has_its_time_by_the_clock_too(topics: dict[str, Any]) -> None:
    assert re.search(r"^At \+\d+(\.\d+)? s \(step \d+\), 1\d{9}\.\d+ by the clock\.$", topics["log"], flags=re.M)
