"""Copying all of a bag as an extract, beside copying its file: python -m benchmarks.extracts [FOLDER]

The bag has a second of camera images, scans and odometry, many times over. Figures are seconds, the least of five.
"""

from __future__ import annotations

import os
import shutil
import sqlite3
import sys
import tempfile
from contextlib import closing
from pathlib import Path
from time import perf_counter

from mcap.writer import CompressionType, Writer

from ltlc.inputs.recordings.bags.copying import Copier

TOPICS = {"/image": (30, 200_000), "/scan": (40, 6_000), "/odom": (100, 720)}
"""How many messages a second a topic has, and how many bytes each."""

SECONDS = 30
RUNS = 5


def messages() -> list[tuple[int, str, bytes]]:
    """The time, topic and data of each; half of the bytes are noise."""
    found = []
    for topic, (rate, size) in TOPICS.items():
        for number in range(rate * SECONDS):
            data = b"\0\1\0\0" + bytes(size // 2) + os.urandom(size // 2)
            found.append((10**18 + number * 10**9 // rate, topic, data))
    return sorted(found)


def mcap(path: Path, compression: CompressionType) -> None:
    """A bag in one MCAP file, in chunks as rosbag2 makes them."""
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=786_432, compression=compression)
        writer.start("ros2")
        schema = writer.register_schema("std_msgs/msg/ByteMultiArray", "ros2msg", b"byte[] data")
        channels = {topic: writer.register_channel(topic, "cdr", schema) for topic in TOPICS}
        for time, topic, data in messages():
            writer.add_message(channels[topic], time, data, time)
        writer.finish()


def database(path: Path) -> None:
    """A bag in one database."""
    with closing(sqlite3.connect(path)) as base:
        base.execute("create table topics (id integer primary key, name, type, serialization_format)")
        base.execute("create table messages (id integer primary key, topic_id, timestamp integer, data blob)")
        base.execute("create index timestamp_idx on messages (timestamp)")
        ids = {topic: number for number, topic in enumerate(TOPICS, 1)}
        for topic, number in ids.items():
            base.execute("insert into topics values (?, ?, 'std_msgs/msg/ByteMultiArray', 'cdr')", (number, topic))
        rows = ((ids[topic], time, data) for time, topic, data in messages())
        base.executemany("insert into messages (topic_id, timestamp, data) values (?, ?, ?)", rows)
        base.commit()


def main() -> None:
    """Make the bags in a folder, and copy them."""
    with tempfile.TemporaryDirectory(dir=sys.argv[1] if len(sys.argv) > 1 else None) as folder:
        target = Path(folder) / "copy"
        mcap(Path(folder) / "plain.mcap", CompressionType.NONE)
        mcap(Path(folder) / "lz4.mcap", CompressionType.LZ4)
        mcap(Path(folder) / "zstd.mcap", CompressionType.ZSTD)
        database(Path(folder) / "plain.db3")
        for path in sorted(Path(folder).iterdir()):
            copying, extracting = [], []
            for _ in range(RUNS):
                start = perf_counter()
                shutil.copyfile(path, target)
                copying.append(perf_counter() - start)
                target.unlink()
                start = perf_counter()
                with Copier(path) as copier, target.open("wb") as file:
                    copier.copy(0, 1 << 62, file)
                extracting.append(perf_counter() - start)
                target.unlink()
            size = path.stat().st_size / 1e6
            print(f"{path.name}: {size:.0f} MB, copied in {min(copying):.3f} s, extracted in {min(extracting):.3f} s")


if __name__ == "__main__":
    main()
