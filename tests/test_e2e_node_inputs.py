"""The emitted node and messages that are not like others: malformed ones, and those that it sends itself."""

from __future__ import annotations

from pathlib import Path

import pytest
from ros_support import Network, Node, emitted

pytestmark = pytest.mark.ros
pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros]")

MALFORMED = """
decl text /text std_msgs/String.data
decl level /levels diagnostic_msgs/DiagnosticArray.status[0].level
decl x /x std_msgs/Float64.data
bytes: never text == "stop"
made: never level == 2
fresh: always age(x) <= 1 h
"""


def test_malformed_messages_are_counted_and_reported_and_end_nothing(network: Network, tmp_path: Path) -> None:
    from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
    from std_msgs.msg import Float64, String

    text, levels = network.publisher(String, "/text"), network.publisher(DiagnosticArray, "/levels")
    x = network.publisher(Float64, "/x")
    with Node(emitted(MALFORMED, tmp_path), tmp_path) as node:

        def have_begun() -> bool:
            """Whether all has been heard: the node may not yet hear those who know of it."""
            text.publish(String(data="go"))
            levels.publish(DiagnosticArray(status=[DiagnosticStatus(level=b"\0")]))
            x.publish(Float64(data=1.0))
            return len(node.changes) >= 3

        network.wait_until(have_begun, "first steps")
        for bad in (
            b"\0\1\0\0",
            b"\7\7\0\0\1\0\0\0",
            b"\0\1\0\0\5\0\0\0ab",
            b"\0\1\0\0\3\0\0\0\xff\xfe\0",
            b"\0\1\0\0\xff\xff\xff\xff",
        ):
            text.publish(bad)
            levels.publish(bad)
        x.publish(b"\0\1\0\0\1\2")
        levels.publish(DiagnosticArray(status=[DiagnosticStatus(level=b"\2")]))
        network.wait_until(lambda: ("made", "violated") in node.changes, "the violation")
        network.wait_until(
            lambda: all(
                f"{count} malformed" in network.message(f"watch_monitor: {label}")
                for label, count in [("bytes", "5 messages on /text were"), ("fresh", "1 message on /x was")]
            ),
            "a diagnosis",
        )
        assert network.statuses["watch_monitor: bytes"].level == b"\x01"
        assert node.end() == 1
    (run,) = node.runs
    assert [run[label].get("malformed_messages") for label in ("bytes", "made", "fresh")] == [
        {"/text": 5},
        {"/levels": 5},
        {"/x": 1},
    ]
    assert "malformed message on" in node.log
    assert "Traceback" not in node.log


OWN = """
decl x /x std_msgs/Float64.data
decl levels /diagnostics diagnostic_msgs/DiagnosticArray.status[].level
low: never x > 5
calm: never any(levels == 2)
"""

OTHER = """
decl levels /diagnostics diagnostic_msgs/DiagnosticArray.status[].level
calm: never any(levels == 2)
"""


def test_what_a_node_says_on_diagnostics_is_news_to_other_nodes_only(network: Network, tmp_path: Path) -> None:
    from std_msgs.msg import Float64

    places = [tmp_path / "own", tmp_path / "other"]
    for place in places:
        place.mkdir()
    x = network.publisher(Float64, "/x")
    with Node(emitted(OWN, tmp_path, "own"), places[0]) as own:
        network.matched([x])
        x.publish(Float64(data=6.0))
        network.wait_until(lambda: ("low", "violated") in own.changes, "the violation")
        network.wait_until(lambda: "own_monitor: low" in network.statuses, "a diagnosis")
        stamps = set()

        def diagnosed() -> bool:
            stamps.add(network.latest_diagnosis)
            return len(stamps) > 4

        network.wait_until(diagnosed, "some diagnoses of the violation")
        assert ("calm", "violated") not in own.changes
        with Node(emitted(OTHER, tmp_path, "other"), places[1]) as other:
            network.wait_until(lambda: ("calm", "violated") in other.changes, "another node hears it")
            network.wait_until(lambda: ("calm", "violated") in own.changes, "the error of another node is heard")
            assert other.end() == 1
        assert own.end() == 1
    assert "lost_messages" not in own.runs[0]["calm"]
