"""MCAP files of recorded messages, as Foxglove, rosbag2 and other tools read them."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Mapping
from typing import BinaryIO

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK = range(1, 7)
MESSAGE_INDEX, CHUNK_INDEX, STATISTICS, DATA_END = 7, 8, 11, 15

HEAD = struct.Struct("<BQ")
"""Before each record: what it is, and its length."""

MESSAGE_HEAD = struct.Struct("<HIQQ")
"""A message's channel, number, time of recording and of sending; the data follow."""


def sized(data: bytes) -> bytes:
    """`data` behind their length, as strings stand in records."""
    return struct.pack("<I", len(data)) + data


def metadata(pairs: Mapping[str, str]) -> bytes:
    """What else is known of a channel, as `McapFile.add_channel` takes it."""
    texts = (text for pair in pairs.items() for text in pair)
    return sized(b"".join(sized(text.encode()) for text in texts))


class McapFile:
    """An MCAP file while it is written: messages, one after the other, then a summary.

    Schemas and channels have numbers, and are known before messages refer to them.
    Times are in ns since 1970.
    """

    def __init__(self, file: BinaryIO, profile: str, library: str) -> None:
        self._file = file
        self._summary: list[bytes] = []
        self._schemas = self._chunks = 0
        self._counts: dict[int, int] = {}
        self._first, self._last = 1 << 64, 0
        file.write(MAGIC)
        self._record(HEADER, sized(profile.encode()), sized(library.encode()))

    @property
    def count(self) -> int:
        """How many messages there are."""
        return sum(self._counts.values())

    def add_schema(self, number: int, name: str, form: str, text: bytes) -> None:
        """The type `name` is defined by `text` in a `form` such as `ros2msg`."""
        parts = (struct.pack("<H", number), sized(name.encode()), sized(form.encode()))
        self._schemas += 1
        self._define(SCHEMA, *parts, sized(text))

    def add_channel(
        self, number: int, schema: int, topic: str, serialization: str, more: bytes
    ) -> None:
        """Messages on a topic, which are as their schema says; `more` is `metadata`."""
        parts = (sized(topic.encode()), sized(serialization.encode()), more)
        self._counts[number] = 0
        self._define(CHANNEL, struct.pack("<HH", number, schema), *parts)

    def add(
        self,
        channel: int,
        sequence: int,
        time: int,
        sent: int,
        data: bytes | memoryview,
    ) -> None:
        """A message, when it was recorded, and when it was sent."""
        self._record(MESSAGE, MESSAGE_HEAD.pack(channel, sequence, time, sent), data)
        self._count(channel, 1, time, time)

    def end(self) -> None:
        """Write the summary, without which readers have to look through the file."""
        self._record(DATA_END, bytes(4))
        start = self._file.tell()
        self._file.writelines(self._summary)
        self._record(*self._statistics())
        self._record(FOOTER, struct.pack("<QQI", start, 0, 0))
        self._file.write(MAGIC)

    def _statistics(self) -> tuple[int, bytes]:
        first = self._first if self.count else 0
        channels, counts = len(self._counts), self._counts.items()
        numbers = (self.count, self._schemas, channels, 0, 0, self._chunks)
        head = struct.pack("<QHIIIIQQ", *numbers, first, self._last)
        pairs = b"".join(struct.pack("<HQ", *pair) for pair in counts)
        return STATISTICS, head + sized(pairs)

    def _count(self, channel: int, count: int, first: int, last: int) -> None:
        self._counts[channel] += count
        self._first, self._last = min(self._first, first), max(self._last, last)

    def _define(self, opcode: int, *parts: bytes) -> None:
        self._summary.append(record(opcode, *parts))
        self._file.write(self._summary[-1])

    def _record(self, opcode: int, *parts: bytes | memoryview) -> None:
        self._file.writelines(_parts(opcode, parts))


def record(opcode: int, *parts: bytes) -> bytes:
    """A record of these parts."""
    return b"".join(_parts(opcode, parts))


def _parts(
    opcode: int, parts: tuple[bytes | memoryview, ...]
) -> Iterable[bytes | memoryview]:
    return (HEAD.pack(opcode, sum(map(len, parts))), *parts)
