"""The emitted node judges a property for each id that comes, and says which ids violate it."""

from __future__ import annotations

from pathlib import Path

import pytest
from ros_support import Network, Node, emitted

pytestmark = pytest.mark.ros
pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros]")

PROPERTIES = """
decl robot /fleet sensor_msgs/JoyFeedback.id
decl kind /fleet sensor_msgs/JoyFeedback.type
decl level /fleet sensor_msgs/JoyFeedback.intensity
charges: each r of robot: always (level < 0.2 implies eventually kind == 1 within 3 s)
few: each f of robot limit 2: eventually kind == 1
"""


@pytest.fixture(scope="module")
def script(folder: Path) -> Path:
    return emitted(PROPERTIES, folder, "fleet")


def test_a_live_node_names_the_ids_that_violate_a_property(script: Path, network: Network, tmp_path: Path) -> None:
    from sensor_msgs.msg import JoyFeedback

    publisher = network.publisher(JoyFeedback, "/fleet")
    with Node(script, tmp_path) as node:
        network.matched([publisher])
        for robot, kind, level in ((1, 0, 0.5), (2, 0, 0.1), (2, 1, 0.1), (3, 0, 0.1), (4, 0, 0.1)):
            publisher.publish(JoyFeedback(id=robot, type=kind, intensity=level))
        network.wait_until(lambda: sum("id" in line for line in node.lines) == 2, "the ids that violate")
        name = "fleet_monitor: charges"
        network.wait_until(lambda: "4 at" in network.message(name), "a diagnosis")
        values = {each.key: each.value for each in network.statuses[name].values}
        assert node.end() == 1
    told = {line["id"]: (line["label"], line["verdict"], line["by_time"]) for line in node.lines if "id" in line}
    assert told == dict.fromkeys((3, 4), ("charges", "violated", True))
    assert network.message(name).startswith("violated by 2 ids: 3 at ")
    assert (values["violated ids"], values["open ids"]) == ("3, 4", "")
    assert "(charges[r = 3])" in node.log
    (run,) = node.runs
    assert [each["id"] for each in run["charges"]["each"]["violated"]] == [3, 4]
    assert (run["few"]["each"]["left_out"], run["few"]["each"]["satisfied"]) == (2, 1)
    publisher.destroy()
