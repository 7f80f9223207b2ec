"""The emitted node while it is kept from its work: what comes meanwhile is judged when it can work again."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from ros_support import Network, Node, emitted, own_domain

pytestmark = pytest.mark.ros
pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros]")

COUNT = 200


@pytest.fixture
def network(tmp_path: Path) -> Iterator[Network]:
    with own_domain(tmp_path):
        network = Network()
        yield network
        network.close()


def test_messages_that_come_while_a_node_is_held_up_are_all_judged(network: Network, tmp_path: Path) -> None:
    from std_msgs.msg import Float64

    publisher = network.publisher(Float64, "/x")
    with Node(emitted("decl x /x std_msgs/Float64.data\nlow: never x > 5\n", tmp_path), tmp_path) as node:
        network.matched([publisher])
        publisher.publish(Float64(data=1.0))
        network.wait_until(lambda: node.changes, "the first verdict")
        node.pause()
        for _ in range(COUNT):
            publisher.publish(Float64(data=2.0))
        node.resume()
        publisher.publish(Float64(data=6.0))
        network.wait_until(lambda: ("low", "violated") in node.changes, "the last message")
        assert node.end() == 1
    assert node.runs[0]["low"]["steps"] == 1 + COUNT + 1
