"""How fast bags are read: `python -m benchmarks.bags [--messages N] [--rounds N]`.

Bags of Odometry, Twist and LaserScan (360 ranges) in sqlite3 and MCAP, in a temporary folder: for each topic the time
in which rosbags iterates over its raw messages and decodes them, and that in which fields of it are read into blocks.
The topic `/rare` has a message every 20 s, so that most chunks can be skipped. What is compared takes turns; medians of
the time on the clock, and of that of the CPUs, which is more where several threads work.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.highlevel import AnyReader  # noqa: TID251
from rosbags.rosbag2 import StoragePlugin, Writer  # noqa: TID251
from rosbags.typesys import Stores, get_typestore  # noqa: TID251

from ltlc.inputs.recordings import open_recording
from ltlc.specification.expressions import Field, Signal, ValueType
from ltlc.specification.wire import SINGLES

STORE = get_typestore(Stores.ROS2_JAZZY)
ODOMETRY, TWIST, SCAN = "nav_msgs/msg/Odometry", "geometry_msgs/msg/Twist", "sensor_msgs/msg/LaserScan"
TYPES = {"/odom": ODOMETRY, "/cmd_vel": TWIST, "/scan": SCAN, "/rare": ODOMETRY}
NUMBER, NUMBERS = ValueType.NUMBER, ValueType.NUMBERS
POSITION = ("pose", "pose", "position")
READ = {
    "Odometry, 3 fields": [
        Signal("x", NUMBER, Field("/odom", ODOMETRY, (*POSITION, "x"))),
        Signal("y", NUMBER, Field("/odom", ODOMETRY, (*POSITION, "y"))),
        Signal("v", NUMBER, Field("/odom", ODOMETRY, ("twist", "twist", "linear", "x"))),
    ],
    "Twist, 2 fields": [
        Signal("v", NUMBER, Field("/cmd_vel", TWIST, ("linear", "x"))),
        Signal("w", NUMBER, Field("/cmd_vel", TWIST, ("angular", "z"))),
    ],
    "LaserScan, a range": [Signal("r", NUMBER, Field("/scan", SCAN, ("ranges", 180), SINGLES))],
    "LaserScan, all ranges": [Signal("r", NUMBERS, Field("/scan", SCAN, ("ranges",), SINGLES))],
    "rare Odometry": [Signal("x", NUMBER, Field("/rare", ODOMETRY, (*POSITION, "x")))],
}


def messages(count: int) -> list[tuple[str, int, bytes]]:
    """`count` messages of each topic at 100 Hz, but /rare, with noise, so that they compress as real ones do."""
    chance = np.random.default_rng(1)
    types = STORE.types
    vector, point = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Point"]
    turn = types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    twist, none = types[TWIST], np.zeros(36)
    found = []

    def odometry(header: Any) -> bytes:
        pose = types["geometry_msgs/msg/Pose"](point(*chance.normal(size=2), 0.0), turn)
        of_pose = types["geometry_msgs/msg/PoseWithCovariance"](pose, none)
        motion = twist(vector(chance.normal(), 0.0, 0.0), vector(0.0, 0.0, chance.normal()))
        of_twist = types["geometry_msgs/msg/TwistWithCovariance"](motion, none)
        return bytes(STORE.serialize_cdr(types[ODOMETRY](header, "base_link", of_pose, of_twist), ODOMETRY))

    for number in range(count):
        moment = 1_700_000_000_000_000_000 + number * 10_000_000
        stamp = types["builtin_interfaces/msg/Time"](*divmod(moment, 10**9))
        header = types["std_msgs/msg/Header"](stamp, "odom")
        found.append(("/odom", moment, odometry(header)))
        motion = twist(vector(chance.normal(), 0.0, 0.0), vector(0.0, 0.0, chance.normal()))
        found.append(("/cmd_vel", moment + 1_000_000, bytes(STORE.serialize_cdr(motion, TWIST))))
        ranges = chance.normal(5, 0.02, 360).astype(np.float32).round(3)
        scan = types[SCAN](header, -3.1, 3.1, 0.017, 0.0, 0.1, 0.1, 30.0, ranges, np.zeros(0, np.float32))
        found.append(("/scan", moment + 2_000_000, bytes(STORE.serialize_cdr(scan, SCAN))))
        if number % 2000 == 0:
            found.append(("/rare", moment + 3_000_000, odometry(header)))
    return found


def write_sqlite(path: Path, sent: list[tuple[str, int, bytes]]) -> None:
    with Writer(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connections = {name: writer.add_connection(name, type_, typestore=STORE) for name, type_ in TYPES.items()}
        for topic, moment, data in sent:
            writer.write(connections[topic], moment, data)


def write_mcap(path: Path, sent: list[tuple[str, int, bytes]], compression: CompressionType) -> None:
    with path.open("wb") as file:
        writer = McapWriter(file, chunk_size=768 * 1024, compression=compression)
        writer.start("ros2")
        channels = {}
        for name, type_ in TYPES.items():
            text, _ = STORE.generate_msgdef(type_, ros_version=2)
            schema = writer.register_schema(type_, "ros2msg", text.encode())
            channels[name] = writer.register_channel(name, "cdr", schema)
        for topic, moment, data in sent:
            writer.add_message(channels[topic], moment, data, moment)
        writer.finish()


def iterate(path: Path, topic: str, decode: bool) -> None:
    with AnyReader([path]) as reader:
        chosen = [each for each in reader.connections if each.topic == topic]
        for connection, _, raw in reader.messages(chosen):
            if decode:
                reader.deserialize(raw, connection.msgtype)


def read(path: Path, signals: list[Signal]) -> None:
    for block in open_recording(path, {signal.name: signal for signal in signals}).blocks():
        assert len(block.times) or not block.samples


class Taken(NamedTuple):
    """Seconds on the clock, and of all CPUs together; the files are in memory."""

    clock: float
    cpu: float


def taken(work: Callable[[], None]) -> Taken:
    clock, cpu = time.perf_counter(), time.process_time()
    work()
    return Taken(time.perf_counter() - clock, time.process_time() - cpu)


def medians(rounds: list[Taken]) -> Taken:
    return Taken(*map(statistics.median, zip(*rounds, strict=True)))


def compare(path: Path, name: str, signals: list[Signal], rounds: int) -> str:
    """A row of the table: the time of raw iteration, and ours as a share of it and of decoding."""
    field = signals[0].definition
    assert isinstance(field, Field)
    found: dict[str, list[Taken]] = {"raw": [], "decoded": [], "ours": []}
    for _ in range(rounds):
        found["raw"].append(taken(lambda: iterate(path, field.topic, False)))
        found["ours"].append(taken(lambda: read(path, signals)))
        found["decoded"].append(taken(lambda: iterate(path, field.topic, True)))
    raw, decoded, ours = (medians(found[kind]) for kind in ("raw", "decoded", "ours"))
    times = f"{raw.clock * 1e3:.0f} | {ours.clock * 1e3:.1f} | {ours.cpu * 1e3:.1f}"
    shares = f"{ours.clock / raw.clock:.2f} | {ours.cpu / raw.cpu:.2f} | {decoded.clock / ours.clock:.1f}"
    return f"| {path.name} | {name} | {times} | {shares} |"


HEAD = """\
| bag | read | raw, ms | ours, ms | ours, ms of CPUs | ours / raw | of CPUs | decoded / ours |
|---|---|---|---|---|---|---|---|"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--messages", type=int, default=50_000, help="of each topic (default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=5, help="default: %(default)s")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        sent = messages(options.messages)
        paths = [Path(folder) / "sqlite3", *(Path(folder) / f"{kind}.mcap" for kind in ("none", "lz4", "zstd"))]
        write_sqlite(paths[0], sent)
        for path in paths[1:]:
            write_mcap(path, sent, CompressionType[path.stem.upper()])
        del sent
        print(HEAD)
        for path in paths:
            for name, signals in READ.items():
                print(compare(path, name, signals, options.rounds), flush=True)


if __name__ == "__main__":
    main()
