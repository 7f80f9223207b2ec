"""MCAP files of chunks: messages are put into chunks, and chunks of other files are taken as they are."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import BinaryIO, NamedTuple

from ltlc import __version__
from ltlc.inputs.recordings.bags.mcap_records import CHUNK_HEAD, ChunkIndex, DamageError
from ltlc.runtime.mcap import CHUNK, CHUNK_INDEX, HEAD, MESSAGE, MESSAGE_HEAD, MESSAGE_INDEX, McapFile, record, sized
from ltlc.semantics.durations import Nanoseconds

ENOUGH = 1 << 20
"""So many bytes of messages make a chunk."""


class Message(NamedTuple):
    """A message: its channel, number, times of recording and of sending."""

    channel: int
    sequence: int
    time: Nanoseconds
    sent: Nanoseconds
    data: bytes | memoryview


class Whole(NamedTuple):
    """A chunk as the index of its file has it, and its bytes, with those of the indexes of its channels behind it."""

    chunk: ChunkIndex
    data: bytes


_INDEX_HEAD = struct.Struct("<BQHI")
"""How the index of a channel begins: with the head of a record, the channel, and the length of its entries."""

_ENTRY = struct.Struct("<QQ")


class ChunkedFile(McapFile):
    """An MCAP file of chunks, each with an index: they are compressed by `lz4`, `zstd`, or not at all."""

    def __init__(self, file: BinaryIO, profile: str, compression: bytes) -> None:
        super().__init__(file, profile, f"ltlc {__version__}")
        self._compression = compression
        self._clear()

    def _clear(self) -> None:
        self._parts, self._size = list[bytes | memoryview](), 0
        self._indexes, self._times = dict[int, bytearray](), (1 << 64, 0)

    def add(self, channel: int, sequence: int, time: int, sent: int, data: bytes | memoryview) -> None:
        """A message, for the chunk that is being made."""
        self._indexes.setdefault(channel, bytearray()).extend(_ENTRY.pack(time, self._size))
        length = MESSAGE_HEAD.size + len(data)
        self._parts += HEAD.pack(MESSAGE, length), MESSAGE_HEAD.pack(channel, sequence, time, sent), data
        self._size += HEAD.size + length
        self._times = min(self._times[0], time), max(self._times[1], time)
        if self._size >= ENOUGH:
            self._close_chunk()

    def _close_chunk(self) -> None:
        """Write the chunk that was being made."""
        from isal.isal_zlib import crc32

        if not self._parts:
            return
        data, name = b"".join(self._parts), self._compression
        packed = _compressed(name, data)
        head = CHUNK_HEAD.pack(*self._times, self._size, crc32(data), len(name)) + name
        head += struct.pack("<Q", len(packed))
        length = HEAD.size + len(head) + len(packed)
        indexes, places = bytearray(), {}
        for channel, entries in self._indexes.items():
            places[channel] = len(indexes)
            indexes += record(MESSAGE_INDEX, struct.pack("<H", channel), sized(bytes(entries)))
        chunk = ChunkIndex(*self._times, 0, length, places, len(indexes), name, self._size)
        self._write(chunk, [HEAD.pack(CHUNK, length - HEAD.size), head, packed], bytes(indexes))
        self._clear()

    def take(self, whole: Whole) -> None:
        """Take a chunk of another file as it is. Raises DamageError."""
        self._close_chunk()
        chunk, data = whole
        where = f"the chunk at byte {chunk.start}"
        places = {channel: place - chunk.start - chunk.length for channel, place in chunk.indexes.items()}
        if data[: HEAD.size] != HEAD.pack(CHUNK, chunk.length - HEAD.size):
            raise DamageError(f"{where} is missing")
        if len(data) != chunk.length + chunk.index_length or not all(at >= 0 for at in places.values()):
            raise DamageError(f"the index of {where} is missing")
        self._write(chunk._replace(indexes=places), [memoryview(data)[: chunk.length]], data[chunk.length :])

    def _write(self, chunk: ChunkIndex, data: Sequence[bytes | memoryview], indexes: bytes) -> None:
        """Write a chunk and the `indexes` behind it, in which that of each channel has a place. Raises DamageError."""
        start = self._file.tell()
        for channel, place in chunk.indexes.items():
            if place + _INDEX_HEAD.size > len(indexes):
                raise DamageError(f"the index of the chunk at byte {chunk.start} is incomplete")
            opcode, _, number, length = _INDEX_HEAD.unpack_from(indexes, place)
            if (opcode, number) != (MESSAGE_INDEX, channel) or channel not in self._counts:
                raise DamageError(f"the index of the chunk at byte {chunk.start} is missing")
            self._count(channel, length // _ENTRY.size, chunk.first, chunk.last)
        self._file.writelines((*data, indexes))
        self._chunks += 1
        behind = start + chunk.length
        places = b"".join(struct.pack("<HQ", channel, behind + place) for channel, place in chunk.indexes.items())
        packed = chunk.length - HEAD.size - CHUNK_HEAD.size - len(chunk.compression) - 8
        self._summary.append(
            record(
                CHUNK_INDEX,
                struct.pack("<QQQQ", chunk.first, chunk.last, start, chunk.length),
                sized(places),
                struct.pack("<Q", chunk.index_length),
                sized(chunk.compression),
                struct.pack("<QQ", packed, chunk.size),
            )
        )

    def end(self) -> None:
        """Write what is left, and the summary."""
        self._close_chunk()
        super().end()


def _compressed(name: bytes, data: bytes) -> bytes:
    import lz4.frame
    import zstandard

    match name:
        case b"zstd":
            return zstandard.ZstdCompressor(level=1).compress(data)
        case b"lz4":
            packed: bytes = lz4.frame.compress(data)
            return packed
        case _:
            return data
