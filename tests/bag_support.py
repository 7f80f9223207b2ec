"""Random ROS messages, and bags of them."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import CompressionType, IndexType
from mcap.writer import Writer as McapWriter
from rosbags.interfaces import Nodetype  # noqa: TID251
from rosbags.rosbag1 import Writer as Rosbag1  # noqa: TID251
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin  # noqa: TID251
from rosbags.rosbag2 import Writer as Rosbag2  # noqa: TID251
from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: TID251

LEVEL = "own_msgs/msg/Level"
OWN = {
    LEVEL: "uint8 LOW=1\nuint8 FULL=3\nstd_msgs/Header header\nuint8 state\nfloat32 level\nown_msgs/Part[] parts\n",
    "own_msgs/msg/Part": "string name\nfloat64 share\n",
    "nav2_msgs/msg/NavigateToPose_Feedback": "int16 number_of_recoveries\nfloat32 distance_remaining\n",
    "nav2_msgs/msg/NavigateToPose_FeedbackMessage": "unique_identifier_msgs/UUID goal_id\n"
    "nav2_msgs/NavigateToPose_Feedback feedback\n",
    "moveit_msgs/msg/ServoStatus": "int8 code\nstring message\n",
    "control_msgs/msg/JointTrajectoryControllerState": "std_msgs/Header header\nstring[] joint_names\n"
    "trajectory_msgs/JointTrajectoryPoint reference\ntrajectory_msgs/JointTrajectoryPoint feedback\n"
    "trajectory_msgs/JointTrajectoryPoint error\ntrajectory_msgs/JointTrajectoryPoint output\n",
    "autoware_adapi_v1_msgs/msg/MrmState": "builtin_interfaces/Time stamp\nuint16 state\nuint16 behavior\n",
    "autoware_control_msgs/msg/Control": "builtin_interfaces/Time stamp\nbuiltin_interfaces/Time control_time\n"
    "autoware_control_msgs/Lateral lateral\nautoware_control_msgs/Longitudinal longitudinal\n",
    "autoware_control_msgs/msg/Lateral": "builtin_interfaces/Time stamp\nfloat32 steering_tire_angle\n",
    "autoware_control_msgs/msg/Longitudinal": "builtin_interfaces/Time stamp\nfloat32 velocity\nfloat32 acceleration\n",
    "autoware_planning_msgs/msg/Trajectory": "std_msgs/Header header\n"
    "autoware_planning_msgs/TrajectoryPoint[] points\n",
    "autoware_planning_msgs/msg/TrajectoryPoint": "geometry_msgs/Pose pose\nfloat32 longitudinal_velocity_mps\n"
    "float32 acceleration_mps2\nfloat32 front_wheel_angle_rad\n",
    "autoware_vehicle_msgs/msg/SteeringReport": "builtin_interfaces/Time stamp\nfloat32 steering_tire_angle\n",
    "autoware_vehicle_msgs/msg/VelocityReport": "std_msgs/Header header\nfloat32 longitudinal_velocity\n",
}
"""Messages of packages that no distribution has here, with the fields that are read."""


def _with_own(store: Stores) -> Any:
    found = get_typestore(store)
    for name, text in OWN.items():
        found.register(get_types_from_msg(text, name))
    return found


STORE, OLD_STORE = _with_own(Stores.ROS2_JAZZY), _with_own(Stores.ROS1_NOETIC)
WORDS = ("", "a", "map", "base_link", "grüße", "a longer name")


def random_message(name: str, chance: random.Random) -> Any:
    """Any message of the type, arrays of any small lengths included."""
    fields = STORE.get_msgdef(name).fields
    return STORE.types[name](**{field: random_value(type_, chance) for field, type_ in fields})


def random_value(type_: Any, chance: random.Random) -> Any:
    kind, content = type_
    if kind == Nodetype.NAME:
        return random_message(content, chance)
    if kind == Nodetype.BASE:
        return chance.choice(WORDS) if content[0] == "string" else numbers(content[0], 1, chance)[0].item()
    of, length = content
    if kind == Nodetype.SEQUENCE:
        length = chance.choice((0, 1, 1, 2, 3, 5))
    if of[0] == Nodetype.BASE and of[1][0] != "string":
        return numbers(of[1][0], length, chance)
    return [random_value(of, chance) for _ in range(length)]


def numbers(base: str, count: int, chance: random.Random) -> Any:
    if base == "bool":
        return np.array([chance.random() < 0.5 for _ in range(count)], np.bool_)
    kind = np.dtype({"byte": "uint8", "char": "uint8", "octet": "uint8"}.get(base, base))
    if kind.kind == "f":
        return np.array([chance.choice((0.0, -1.5, 0.1, 1e9, chance.gauss(0, 10))) for _ in range(count)], kind)
    least, most = int(np.iinfo(kind).min), 127 if base == "byte" else int(np.iinfo(kind).max)  # signed in rosbags
    return np.array([chance.choice((least, most, 0, 1, chance.randint(least, most))) for _ in range(count)], kind)


@dataclass(frozen=True)
class Sent:
    """A message, when it was recorded, and on which topic."""

    topic: str
    type: str
    time: int
    message: Any

    @property
    def cdr(self) -> bytes:
        return bytes(STORE.serialize_cdr(self.message, self.type))


def made(name: str, **values: Any) -> Any:
    """A message of the type, with zeros, but for the `values`; `a__b` is the field b of the field a."""
    message = random_message(name, _Zeros())
    for path, value in values.items():
        place = message
        *outer, last = path.split("__")
        for step in outer:
            place = getattr(place, step)
        setattr(place, last, value)
    return message


def filled(name: str, values: Mapping[str, Any]) -> Any:
    """A message of the type, with zeros, but for the `values`: of a message by its fields, of an array all of them."""
    message = made(name)
    for field, (kind, content) in STORE.get_msgdef(name).fields:
        if field in values:
            setattr(message, field, _filled(kind, content, values[field]))
    return message


def _filled(kind: Any, content: Any, value: Any) -> Any:
    if kind == Nodetype.NAME:
        return filled(content, value)
    if kind == Nodetype.BASE:
        return value
    of, _ = content
    each = [_filled(of[0], of[1], one) for one in value]
    return np.array(each, of[1][0]) if of[0] == Nodetype.BASE and of[1][0] != "string" else each


class _Zeros(random.Random):
    """Chooses 0, the empty string and the empty list."""

    def choice(self, options: Any) -> Any:
        return options[0] if 0 not in options else 0

    def random(self) -> float:
        return 1.0

    def randint(self, a: int, b: int) -> int:
        return 0

    def gauss(self, mu: float = 0.0, sigma: float = 1.0) -> float:
        return 0.0


def odometry(time: int, topic: str = "/odom", stamp: int | None = None, **values: Any) -> Sent:
    """A message of an odometer, recorded at `time`."""
    sec, nanosec = divmod(time if stamp is None else stamp, 10**9)
    of_header = {"header__stamp__sec": sec, "header__stamp__nanosec": nanosec, "header__frame_id": "odom"}
    return Sent(topic, ODOMETRY, time, made(ODOMETRY, **of_header, **values))


ODOMETRY, TWIST, SCAN = "nav_msgs/msg/Odometry", "geometry_msgs/msg/Twist", "sensor_msgs/msg/LaserScan"


def rosbag2(path: Path, sent: Sequence[Sent], storage: str = "sqlite3", mode: str = "NONE") -> Path:
    """A folder as rosbag2 writes it; `mode` is NONE, FILE, MESSAGE or STORAGE, of compression by zstd."""
    writer = Rosbag2(path, version=9, storage_plugin=StoragePlugin[storage.upper()])
    if mode != "NONE":
        writer.set_compression(CompressionMode[mode], CompressionFormat.ZSTD)
    with writer:
        topics = dict.fromkeys((each.topic, each.type) for each in sent)
        connections = {topic: writer.add_connection(topic, type_, typestore=STORE) for topic, type_ in topics}
        for each in sent:
            writer.write(connections[each.topic], each.time, each.cdr)
    return path


def mcap(path: Path, sent: Sequence[Sent], compression: str = "NONE", is_finished: bool = True, **options: Any) -> Path:
    """An MCAP file."""
    with path.open("wb") as file:
        writer = McapWriter(file, compression=CompressionType[compression], **{"chunk_size": 4000, **options})
        writer.start("ros2")
        channels: dict[str, int] = {}
        for each in sent:
            if each.topic not in channels:
                text, _ = STORE.generate_msgdef(each.type, ros_version=2)
                schema = writer.register_schema(each.type, "ros2msg", text.encode())
                channels[each.topic] = writer.register_channel(each.topic, "cdr", schema)
            writer.add_message(channels[each.topic], each.time, each.cdr, each.time)
        if is_finished:
            writer.finish()
    return path


def ros1(path: Path, sent: Sequence[Sent]) -> Path:
    """A bag of ROS 1."""
    with Rosbag1(path) as writer:
        topics = dict.fromkeys((each.topic, each.type) for each in sent)
        connections = {topic: writer.add_connection(topic, type_, typestore=OLD_STORE) for topic, type_ in topics}
        for each in sent:
            writer.write(connections[each.topic], each.time, bytes(STORE.cdr_to_ros1(each.cdr, each.type)))
    return path


FORMS: dict[str, Callable[[Path, Sequence[Sent]], Path]] = {
    "sqlite3": lambda folder, sent: rosbag2(folder / "bag", sent),
    "sqlite3 file": lambda folder, sent: next(rosbag2(folder / "bag", sent).glob("*.db3")),
    "sqlite3 by message": lambda folder, sent: rosbag2(folder / "bag", sent, mode="MESSAGE"),
    "sqlite3 by file": lambda folder, sent: rosbag2(folder / "bag", sent, mode="FILE"),
    "mcap folder": lambda folder, sent: rosbag2(folder / "bag", sent, "mcap"),
    "mcap folder by chunk": lambda folder, sent: rosbag2(folder / "bag", sent, "mcap", "STORAGE"),
    "mcap folder by file": lambda folder, sent: rosbag2(folder / "bag", sent, "mcap", "FILE"),
    "mcap folder by message": lambda folder, sent: rosbag2(folder / "bag", sent, "mcap", "MESSAGE"),
    "mcap": lambda folder, sent: mcap(folder / "a.mcap", sent),
    "mcap lz4": lambda folder, sent: mcap(folder / "a.mcap", sent, "LZ4"),
    "mcap zstd": lambda folder, sent: mcap(folder / "a.mcap", sent, "ZSTD"),
    "mcap without chunks": lambda folder, sent: mcap(folder / "a.mcap", sent, use_chunking=False),
    "mcap without index": lambda folder, sent: mcap(folder / "a.mcap", sent, "LZ4", index_types=IndexType.NONE),
    "mcap with chunk index": lambda folder, sent: mcap(folder / "a.mcap", sent, "ZSTD", index_types=IndexType.CHUNK),
    "mcap without summary": lambda folder, sent: mcap(
        folder / "a.mcap",
        sent,
        "ZSTD",
        index_types=IndexType.NONE,
        repeat_channels=False,
        repeat_schemas=False,
        use_statistics=False,
        use_summary_offsets=False,
    ),
    "ros1": lambda folder, sent: ros1(folder / "a.bag", sent),
}
"""Every form in which a bag can be written."""
