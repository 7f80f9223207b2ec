"""Messages that are written are those that a middleware would send: rosbags reads and writes them alike."""

from __future__ import annotations

import pytest
from rosbags.typesys import Stores, get_typestore  # noqa: TID251

from ltlc.inputs.messages.definitions import shipped
from ltlc.inputs.recordings.bags.written import written

STORE = get_typestore(Stores.ROS2_JAZZY)


def test_a_message_of_each_type_is_as_rosbags_writes_it() -> None:
    known = [name for name in shipped() if name in STORE.fielddefs and "/msg/" in name]
    assert len(known) > 100
    for name in known:
        data = written(name, shipped(), {})
        again = bytes(STORE.serialize_cdr(STORE.deserialize_cdr(data, name), name))
        assert data == again, name


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
    found = STORE.deserialize_cdr(written(message, shipped(), values), message)  # type: ignore[arg-type]
    for path, value in values.items():
        at = found
        for name in path:
            at = getattr(at, name)
        assert at == value, path
