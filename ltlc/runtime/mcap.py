"""MCAP files of recorded messages, as Foxglove, rosbag2 and other tools read them."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from typing import BinaryIO, NamedTuple
from zlib import crc32

MAGIC = b"\x89MCAP0\r\n"
FILE_HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK = range(1, 7)
MESSAGE_INDEX, CHUNK_INDEX, STATISTICS, DATA_END = 7, 8, 11, 15

HEAD = struct.Struct("<BQ")
"""Before each record: what it is, and its length."""

MESSAGE_HEAD = struct.Struct("<HIQQ")
"""A message's channel, number, time of recording and of sending; the data follow."""

CHUNK_HEAD = struct.Struct("<QQQII")
"""A chunk's first and last time, size, checksum (0 is none), and the length of the name
of its compression."""

ENTRY = struct.Struct("<QQ")
"""How an index leads to a message: its time, and where its record begins in the chunk.
"""

ENOUGH_FOR_A_CHUNK = 1 << 20
"""So many bytes of messages make a chunk."""


class ChunkIndex(NamedTuple):
    """A chunk: its first and last time, which bytes of the file it is, what compresses
    it, and its size unpacked.

    Behind it lie `index_length` bytes, in which the index of the messages of each
    channel is at the place in the file that `indexes` has; without, there is none.
    """

    first: int
    last: int
    start: int
    length: int
    indexes: dict[int, int]
    index_length: int
    compression: bytes
    size: int


def sized(data: bytes) -> bytes:
    """`data` behind their length, as strings stand in records."""
    return struct.pack("<I", len(data)) + data


def metadata(pairs: Mapping[str, str]) -> bytes:
    """What else is known of a channel, as `McapFile.add_channel` takes it."""
    texts = (text for pair in pairs.items() for text in pair)
    return sized(b"".join(sized(text.encode()) for text in texts))


def record(opcode: int, *parts: bytes) -> bytes:
    """A record of these parts."""
    return b"".join((HEAD.pack(opcode, sum(map(len, parts))), *parts))


class McapFile:
    """An MCAP file while it is written: chunks of messages, then a summary.

    Schemas and channels have numbers, and come before the messages. Times are in ns
    since 1970.
    """

    compression = b""

    def __init__(self, file: BinaryIO, profile: str, library: str) -> None:
        self._file = file
        self._summary: list[bytes] = []
        self._schemas = self._chunks = 0
        self._counts: dict[int, int] = {}
        self._span = (1 << 64, 0)
        self._clear()
        file.write(MAGIC)
        file.write(
            record(FILE_HEADER, sized(profile.encode()), sized(library.encode()))
        )

    def _clear(self) -> None:
        """Nothing is in the chunk that is being made."""
        self._parts: list[bytes | memoryview] = []
        self._indexes: dict[int, bytearray] = {}
        self._times = (1 << 64, 0)
        self._size = 0

    @property
    def count(self) -> int:
        """How many messages there are in finished chunks."""
        return sum(self._counts.values())

    def add_schema(self, number: int, name: str, form: str, text: bytes) -> None:
        """The type `name` is defined by `text` in a `form` such as `ros2msg`."""
        parts = (struct.pack("<H", number), sized(name.encode()), sized(form.encode()))
        self._schemas += 1
        self._define(record(SCHEMA, *parts, sized(text)))

    def add_channel(
        self, number: int, schema: int, topic: str, serialization: str, more: bytes
    ) -> None:
        """Messages on a topic, which are as their schema says; `more` is `metadata`."""
        parts = (sized(topic.encode()), sized(serialization.encode()), more)
        self._counts[number] = 0
        self._define(record(CHANNEL, struct.pack("<HH", number, schema), *parts))

    def _define(self, definition: bytes) -> None:
        self._summary.append(definition)
        self._file.write(definition)

    def add(
        self,
        channel: int,
        sequence: int,
        time: int,
        sent: int,
        data: bytes | memoryview,
    ) -> None:
        """A message, when it was recorded, and when it was sent."""
        index = self._indexes.setdefault(channel, bytearray())
        index += ENTRY.pack(time, self._size)
        length = MESSAGE_HEAD.size + len(data)
        head = MESSAGE_HEAD.pack(channel, sequence, time, sent)
        self._parts += (HEAD.pack(MESSAGE, length), head, data)
        self._size += HEAD.size + length
        self._times = min(self._times[0], time), max(self._times[1], time)
        if self._size >= ENOUGH_FOR_A_CHUNK:
            self.close_chunk()

    def close_chunk(self) -> None:
        """Write the chunk that is being made."""
        if not self._parts:
            return
        data, name = b"".join(self._parts), self.compression
        packed = self._packed(data)
        head = CHUNK_HEAD.pack(*self._times, self._size, self._sum(data), len(name))
        head += name + struct.pack("<Q", len(packed))
        length = HEAD.size + len(head) + len(packed)
        indexes, places = bytearray(), {}
        for channel, entries in self._indexes.items():
            places[channel] = len(indexes)
            number = struct.pack("<H", channel)
            indexes += record(MESSAGE_INDEX, number, sized(bytes(entries)))
            self._counts[channel] += len(entries) // ENTRY.size
        chunk = (*self._times, 0, length, places, len(indexes), name, self._size)
        parts = (HEAD.pack(CHUNK, length - HEAD.size), head, packed, indexes)
        self._write(ChunkIndex(*chunk), parts)
        self._clear()

    def _packed(self, data: bytes) -> bytes:
        """The data of a chunk, compressed by `compression`."""
        return data

    def _sum(self, data: bytes) -> int:
        """The checksum of the data of a chunk."""
        return crc32(data)

    def _write(
        self, chunk: ChunkIndex, parts: Sequence[bytes | bytearray | memoryview]
    ) -> None:
        """Write a chunk, with its indexes, whose places are those behind it."""
        start = self._file.tell()
        self._file.writelines(parts)
        self._chunks += 1
        behind = start + chunk.length
        pairs = ((channel, behind + at) for channel, at in chunk.indexes.items())
        places = b"".join(struct.pack("<HQ", *pair) for pair in pairs)
        around = HEAD.size + CHUNK_HEAD.size + len(chunk.compression) + 8
        index = (
            struct.pack("<QQQQ", chunk.first, chunk.last, start, chunk.length),
            sized(places),
            struct.pack("<Q", chunk.index_length),
            sized(chunk.compression),
            struct.pack("<QQ", chunk.length - around, chunk.size),
        )
        self._summary.append(record(CHUNK_INDEX, *index))
        first, last = self._span
        self._span = min(first, chunk.first), max(last, chunk.last)

    def end(self) -> None:
        """Write what is left, and the summary."""
        self.close_chunk()
        self._file.write(record(DATA_END, bytes(4)))
        start = self._file.tell()
        self._file.writelines((*self._summary, self._statistics()))
        self._file.write(record(FOOTER, struct.pack("<QQI", start, 0, 0)))
        self._file.write(MAGIC)

    def _statistics(self) -> bytes:
        counts, times = self._counts.items(), self._span if self._chunks else (0, 0)
        numbers = (self.count, self._schemas, len(counts), 0, 0, self._chunks)
        head = struct.pack("<QHIIIIQQ", *numbers, *times)
        pairs = b"".join(struct.pack("<HQ", *pair) for pair in counts)
        return record(STATISTICS, head, sized(pairs))
