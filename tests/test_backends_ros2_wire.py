"""Fields read from serialised messages: the same as from the messages that rclpy makes of them."""

from __future__ import annotations

import random
from contextlib import suppress
from typing import Any

import pytest

pytestmark = pytest.mark.ros
pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros]")

from rclpy.serialization import deserialize_message, serialize_message  # noqa: E402

from ltlc.backends.ros2.node.classes import class_of  # noqa: E402
from ltlc.backends.ros2.node.topics import Topic  # noqa: E402
from ltlc.backends.ros2.node.wire import MALFORMED, Extractor, UnsupportedError, fields_reader, message_reader  # noqa: E402

TYPES = [
    *("std_msgs/msg/Bool", "std_msgs/msg/Byte", "std_msgs/msg/Char", "std_msgs/msg/UInt64", "std_msgs/msg/String"),
    *("geometry_msgs/msg/Twist", "geometry_msgs/msg/PoseWithCovarianceStamped", "geometry_msgs/msg/PolygonStamped"),
    *("nav_msgs/msg/Odometry", "nav_msgs/msg/OccupancyGrid", "nav_msgs/msg/Path", "sensor_msgs/msg/BatteryState"),
    *("sensor_msgs/msg/LaserScan", "sensor_msgs/msg/Imu", "sensor_msgs/msg/JointState", "sensor_msgs/msg/NavSatFix"),
    *("sensor_msgs/msg/CameraInfo", "sensor_msgs/msg/Joy", "sensor_msgs/msg/Image", "sensor_msgs/msg/PointCloud2"),
    *("diagnostic_msgs/msg/DiagnosticStatus", "std_msgs/msg/ColorRGBA", "std_msgs/msg/Empty"),
]

NUMBERS = {"float": 32, "double": 64, "octet": 8, "char": 8, "boolean": 1}


def paths(type_: Any, path: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """All that names alone lead to in a message of this class."""
    found = []
    for name, kind in type_.get_fields_and_field_types().items():
        if "/" in kind and "[" not in kind and "<" not in kind:
            package, short = kind.split("/")
            found += paths(class_of(f"{package}/msg/{short}"), (*path, name))
        else:
            found.append((*path, name))
    return found


def at(message: Any, path: tuple[str, ...]) -> Any:
    """The value at `path`; of the message itself, of which no field is wanted, that it has come."""
    for name in path:
        message = getattr(message, name)
    return message if path else True


def one(kind: str, chance: random.Random) -> Any:
    if kind.startswith("string"):
        return "".join(chance.choices("aé 0", k=chance.randrange(9)))
    if kind == "boolean":
        return chance.random() < 1 / 2
    if kind == "octet":
        return bytes([chance.randrange(256)])
    if kind in ("float", "double"):
        return chance.choice([0.0, -1.5, 2.0**-20, float("inf"), 3e10])
    bits = int("".join(c for c in kind if c.isdigit()) or 8)
    least = 0 if kind.startswith(("u", "c")) else -(2 ** (bits - 1))
    return chance.choice([least, least + 2**bits - 1, least + chance.randrange(2**bits)])


def fill(message: Any, chance: random.Random) -> Any:
    """`message` with random values in all its places, arrays of any length among them."""
    for name, kind in message.get_fields_and_field_types().items():
        inner, is_list = kind.removeprefix("sequence<").partition(">")[0].partition(",")[0], kind.startswith("sequence")
        length = chance.randrange(4) if is_list else None
        if "[" in kind:
            inner, _, size = kind.rstrip("]").partition("[")
            length = int(size)
        if "/" in inner:
            class_ = class_of("{}/msg/{}".format(*inner.split("/")))
            made = [fill(class_(), chance) for _ in range(1 if length is None else length)]
        else:
            made = [one(inner, chance) for _ in range(1 if length is None else length)]
        setattr(message, name, made[0] if length is None else made)
    return message


def plain(value: Any) -> Any:
    if isinstance(value, bytes):
        return value[0]
    return value if isinstance(value, str | bool | int | float) else [plain(each) for each in value]


def reader(type_: Any, wanted: tuple[tuple[str, ...], ...]) -> Any:
    topic = Topic("/t", "", lambda message: [at(message, path) for path in wanted], wanted)

    def decoded(data: bytes) -> Any:
        return message_reader(topic, type_)(data)

    return fields_reader(topic, type_, decoded)


@pytest.mark.parametrize("name", TYPES)
def test_fields_of_serialised_messages_are_those_of_the_messages(name: str) -> None:
    chance, type_ = random.Random(name), class_of(name)
    known, compared = [*paths(type_), ()], 0
    for _ in range(40):
        wanted = tuple(chance.choices(known, k=chance.randrange(1, 5)))
        read = reader(type_, wanted)
        if read is None:
            continue
        for _ in range(5):
            data = serialize_message(fill(type_(), chance))
            made = deserialize_message(data, type_)
            assert plain(read(data)) == [plain(at(made, path)) for path in wanted], wanted
            compared += 1
    assert compared >= 20


def test_what_names_do_not_lead_to_is_read_from_messages() -> None:
    for name, path in [("nav_msgs/msg/Path", ("poses",)), ("sensor_msgs/msg/JointState", ("name",))]:
        with pytest.raises(UnsupportedError):
            Extractor(class_of(name), [path])
        assert reader(class_of(name), (path,)) is None
    assert reader(class_of("std_msgs/msg/Bool"), (("dta",),)) is None
    assert reader(class_of("std_msgs/msg/Bool"), ()) is None


def test_what_comes_in_another_byte_order_is_read_from_the_message() -> None:
    type_ = class_of("std_msgs/msg/UInt32")
    read = reader(type_, (("data",),))
    assert list(read(b"\x00\x00\x00\x00\x00\x00\x00\x07")) == [7]
    assert list(read(b"\x00\x01\x00\x00\x07\x00\x00\x00")) == [7]


def test_a_reader_that_finds_something_else_than_the_message_has_is_not_taken() -> None:
    type_ = class_of("geometry_msgs/msg/Vector3")
    wrong = Topic("/t", "", lambda message: [message.y], (("x",),))
    right = Topic("/t", "", lambda message: [message.x], (("x",),))
    assert fields_reader(wrong, type_, message_reader(wrong, type_)) is None
    assert fields_reader(right, type_, message_reader(right, type_)) is not None


def test_an_array_of_any_length_is_read_unless_another_one_is_meant() -> None:
    """An empty one says nothing of that: they are compared with elements."""
    type_ = class_of("sensor_msgs/msg/LaserScan")
    wrong = Topic("/t", "", lambda message: [message.intensities], (("ranges",),))
    assert fields_reader(wrong, type_, message_reader(wrong, type_)) is None
    assert reader(type_, (("ranges",),)) is not None


def test_a_byte_in_another_byte_order_is_the_same_number() -> None:
    read = reader(class_of("std_msgs/msg/Byte"), (("data",),))
    assert [list(read(start + b"\0\0\7")) for start in (b"\0\1", b"\0\0")] == [[7], [7]]


HEADER = b"\0\1\0\0"

BROKEN = {
    "empty": b"",
    "nothing behind its header": HEADER,
    "a string that is cut short": HEADER + b"\5\0\0\0ab",
    "a string that is not UTF-8": HEADER + b"\3\0\0\0\xff\xfe\0",
    "a string longer than memory": HEADER + b"\xff\xff\xff\xffab\0",
    "in no representation": b"\xff\xff\0\0\2\0\0\0a\0",
}


@pytest.mark.parametrize("name", BROKEN)
def test_what_is_no_message_is_found_out_in_bytes_and_in_messages(name: str) -> None:
    type_ = class_of("std_msgs/msg/String")
    topic = Topic("/t", "", lambda message: [message.data], (("data",),))
    decoded = message_reader(topic, type_)
    fields = fields_reader(topic, type_, decoded)
    assert fields is not None
    for read in (decoded, fields):
        assert list(read(serialize_message(type_(data="a\ufffdb")))) == ["a\ufffdb"]
        with pytest.raises(MALFORMED):
            read(BROKEN[name])


@pytest.mark.parametrize("name", [name for name in TYPES if name != "std_msgs/msg/Empty"])
def test_of_messages_cut_short_anywhere_all_fields_are_read_or_none(name: str) -> None:
    chance, type_ = random.Random(name), class_of(name)
    for _ in range(10):
        wanted = tuple(chance.choices(paths(type_), k=chance.randrange(1, 4)))
        read = reader(type_, wanted)
        if read is None:
            continue
        data = serialize_message(fill(type_(), chance))
        whole = plain(read(data))
        for end in range(min(len(data), 300)):
            with suppress(*MALFORMED):
                assert plain(read(data[:end])) == whole, (wanted, end)
