"""Messages that are written are those that a middleware would send: rosbags reads and writes them alike."""

from __future__ import annotations

import numpy as np
import pytest
from bag_support import made
from rosbags.typesys import Stores, get_typestore  # noqa: TID251

from ltlc.inputs.messages.definitions import shipped
from ltlc.inputs.recordings.bags.written import nested, written

STORE = get_typestore(Stores.ROS2_JAZZY)


def test_a_message_of_each_type_is_as_rosbags_writes_it() -> None:
    known = [name for name in shipped() if name in STORE.fielddefs and "/msg/" in name]
    assert len(known) > 100
    for name in known:
        data = written(name, shipped(), {})
        again = bytes(STORE.serialize_cdr(STORE.deserialize_cdr(data, name), name))
        assert data == again, name


def test_lists_and_the_messages_in_them_are_as_rosbags_writes_them() -> None:
    marker = made("visualization_msgs/msg/Marker", ns="wall", pose__position__z=-0.0, colors=[made(COLOR, a=0.5)] * 2)
    some = (
        made("nav_msgs/msg/Odometry", pose__covariance=np.arange(36.0), header__frame_id="odom"),
        made("trajectory_msgs/msg/JointTrajectory", joint_names=["a", "bc"]),
        made("trajectory_msgs/msg/JointTrajectoryPoint", positions=np.array([0.5]), effort=np.array([1.0, np.nan])),
        made("std_msgs/msg/UInt8MultiArray", data=np.array([1, 2, 3], np.uint8)),
        made("visualization_msgs/msg/MarkerArray", markers=[marker, made("visualization_msgs/msg/Marker")]),
    )
    for message in some:
        name = message.__msgtype__
        assert written(name, shipped(), message) == bytes(STORE.serialize_cdr(message, name)), name


COLOR = "std_msgs/msg/ColorRGBA"


@pytest.mark.parametrize(
    ("message", "values"),
    [
        ("geometry_msgs/msg/Twist", {("linear", "x"): 0.5, ("angular", "z"): -1.25}),
        ("sensor_msgs/msg/JointState", {("header", "frame_id"): "arm", ("header", "stamp", "sec"): 7}),
        ("sensor_msgs/msg/BatteryState", {("present",): True, ("voltage",): 0.5, ("serial_number",): "ä"}),
        ("std_msgs/msg/UInt64", {("data",): 2**64 - 1}),
    ],
)
def test_values_are_where_rosbags_reads_them(message: str, values: dict[tuple[str, ...], object]) -> None:
    found = STORE.deserialize_cdr(written(message, shipped(), nested(values)), message)
    for path, value in values.items():
        at = found
        for name in path:
            at = getattr(at, name)
        assert at == value, path
