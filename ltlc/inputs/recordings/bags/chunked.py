"""MCAP files that take chunks of other files as they are, or messages, in compressed chunks."""

from __future__ import annotations

import struct
from typing import BinaryIO, NamedTuple

from ltlc import __version__
from ltlc.inputs.recordings.bags.mcap_records import DamageError
from ltlc.runtime.mcap import CHUNK, ENTRY, HEAD, MESSAGE_INDEX, ChunkIndex, McapFile
from ltlc.semantics.durations import Nanoseconds

_INDEX_HEAD = struct.Struct("<BQHI")
"""How the index of a channel begins: with the head of a record, the channel, and the length of its entries."""


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


class ChunkedFile(McapFile):
    """An MCAP file whose chunks are compressed by `lz4`, `zstd`, or not at all."""

    def __init__(self, file: BinaryIO, profile: str, compression: bytes) -> None:
        super().__init__(file, profile, f"ltlc {__version__}")
        self.compression = compression

    def take(self, whole: Whole) -> None:
        """Take a chunk of another file as it is. Raises DamageError."""
        self.close_chunk()
        chunk, data = whole
        where = f"the chunk at byte {chunk.start}"
        if data[: HEAD.size] != HEAD.pack(CHUNK, chunk.length - HEAD.size):
            raise DamageError(f"{where} is missing")
        places = {channel: place - chunk.start - chunk.length for channel, place in chunk.indexes.items()}
        for channel, place in places.items():
            if not 0 <= place <= len(data) - chunk.length - _INDEX_HEAD.size:
                raise DamageError(f"the index of {where} is incomplete")
            opcode, _, number, length = _INDEX_HEAD.unpack_from(data, chunk.length + place)
            if (opcode, number) != (MESSAGE_INDEX, channel) or channel not in self._counts:
                raise DamageError(f"the index of {where} is missing")
            self._counts[channel] += length // ENTRY.size
        self._write(chunk._replace(indexes=places), [data])

    def _packed(self, data: bytes) -> bytes:
        import lz4.frame
        import zstandard

        match self.compression:
            case b"zstd":
                return zstandard.ZstdCompressor(level=1).compress(data)
            case b"lz4":
                packed: bytes = lz4.frame.compress(data)
                return packed
            case _:
                return data

    def _sum(self, data: bytes) -> int:
        from isal.isal_zlib import crc32  # takes a third of the time that zlib takes

        return crc32(data)
