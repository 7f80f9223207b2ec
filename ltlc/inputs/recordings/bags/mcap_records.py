"""The records of MCAP files, one after the other, and the chunks that they are packed in."""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from dataclasses import field
from io import SEEK_CUR, SEEK_END, BufferedReader, BytesIO
from typing import NamedTuple

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.bags.messages import LARGEST
from ltlc.inputs.recordings.blocks import Array
from ltlc.runtime.mcap import CHANNEL, CHUNK, CHUNK_HEAD, DATA_END, HEAD, MAGIC, MESSAGE, SCHEMA, ChunkIndex
from ltlc.semantics.durations import Nanoseconds

MESSAGE_HEAD = struct.Struct("<HIqq")
"""A message's channel, number, time of recording and of sending; the data follow.

The times are without a sign in the file: one that is below 0 here is one that no clock shows.
"""

_OF_USE = {SCHEMA, CHANNEL, MESSAGE, CHUNK}
_CUT_OFF = "it is cut off, as if the recorder was killed"


class Channel(NamedTuple):
    """The messages of one recorder on a topic: their schema and serialization, and the record's other fields."""

    schema: int
    topic: str
    serialization: str
    more: bytes = b"\0\0\0\0"


class Schema(NamedTuple):
    """The name of a type, its form, and its definition."""

    name: str
    form: str
    text: bytes


class DamageError(Exception):
    """What is wrong with a record."""


@dataclass
class Contents:
    """What a file is about: its schemas and channels by number, and the parts of the index that are of use."""

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    counts: dict[int, int] | None = None
    span: tuple[Nanoseconds, Nanoseconds] | None = None
    chunks: list[ChunkIndex] | None = None
    """The chunks, in the order of the file, if the index has them all."""

    def take(self, opcode: int, body: bytes | memoryview) -> None:
        """Learn of a schema or a channel from its record."""
        stream = BytesIO(body)
        if opcode == SCHEMA:
            (number,) = struct.unpack("<H", stream.read(2))
            self.schemas.setdefault(number, Schema(_text(stream), _text(stream), _bytes(stream)))
        elif opcode == CHANNEL:
            number, schema = struct.unpack("<HH", stream.read(4))
            self.channels.setdefault(number, Channel(schema, _text(stream), _text(stream), stream.read()))


def _bytes(stream: BytesIO) -> bytes:
    (length,) = struct.unpack("<I", stream.read(4))
    return stream.read(length)


def _text(stream: BytesIO) -> str:
    return _bytes(stream).decode()


def records(file: BufferedReader, contents: Contents) -> Iterator[bytes | memoryview]:
    """The bodies of all messages' records from here on; what else is told goes to `contents`.

    Raises DamageError where the file is damaged or ends too early.
    """
    size = os.fstat(file.fileno()).st_size
    while True:
        place = file.tell()
        head = file.read(HEAD.size)
        if len(head) < HEAD.size:
            raise DamageError(_CUT_OFF)
        opcode, length = HEAD.unpack(head)
        if opcode == DATA_END:
            file.seek(-len(MAGIC), SEEK_END)
            if file.read() != MAGIC:
                raise DamageError("all messages are present, but the file is cut off after them")
            return
        if opcode == 0:
            raise DamageError(f"there is no record at byte {place}")
        if opcode not in _OF_USE:  # an attachment may be as large as it likes
            if length > size - file.tell():
                raise DamageError(_CUT_OFF)
            file.seek(length, SEEK_CUR)
            continue
        if length > LARGEST:
            raise DamageError(_too_large(f"the record at byte {place}", length))
        body = file.read(length)
        if opcode == CHUNK:
            chunk = opened(body, f"the chunk at byte {place}", len(body) < length)
            yield from (message for _, message in messages_in(chunk, contents))
        if len(body) < length:
            raise DamageError(_CUT_OFF)
        if opcode == MESSAGE:
            yield body
        _learn(contents, opcode, body)


def _too_large(where: str, size: int) -> str:
    return f"{where} claims {size} bytes, more than the maximum of {LARGEST}"


def opened(body: bytes, where: str, is_cut: bool) -> memoryview:
    """The records of a chunk; of one that is cut off, as much as there is. Raises DamageError."""
    if not is_cut:
        return memoryview(unpacked(memoryview(body), where).tobytes())
    if len(body) < CHUNK_HEAD.size:
        return memoryview(b"")
    _, _, size, _, length = CHUNK_HEAD.unpack_from(body)
    name = body[CHUNK_HEAD.size : CHUNK_HEAD.size + length]
    return memoryview(_beginning(name, body[CHUNK_HEAD.size + length + 8 :], min(size, LARGEST)))


def messages_in(data: memoryview, contents: Contents) -> Iterator[tuple[int, memoryview]]:
    """The messages' records in a chunk, as far as they are whole: where each begins, and its body."""
    place = 0
    while place + HEAD.size <= len(data):
        opcode, length = HEAD.unpack_from(data, place)
        place += HEAD.size
        if place + length > len(data):
            return
        body = data[place : place + length]
        if opcode == MESSAGE:
            yield place - HEAD.size, body
        _learn(contents, opcode, body)
        place += length


def _learn(contents: Contents, opcode: int, body: bytes | memoryview) -> None:
    try:
        contents.take(opcode, body)
    except (struct.error, UnicodeDecodeError):
        raise DamageError("a schema or channel is malformed") from None


def unpacked(body: memoryview, where: str) -> Array:
    """The records of a chunk. Raises DamageError."""
    from isal.isal_zlib import crc32  # takes a third of the time that zlib takes

    if len(body) < CHUNK_HEAD.size:
        raise DamageError(f"{where} is shorter than its header")
    _, _, size, checksum, length = CHUNK_HEAD.unpack_from(body)
    if size > LARGEST:
        raise DamageError(_too_large(where, size))
    name = bytes(body[CHUNK_HEAD.size : CHUNK_HEAD.size + length])
    data = _decompressed(name, body[CHUNK_HEAD.size + length + 8 :], size, where)
    if len(data) != size:
        raise DamageError(f"{where} does not have the size it states")
    if checksum and crc32(data) != checksum:
        raise DamageError(f"{where} has the wrong checksum")
    return np.frombuffer(data, np.uint8)


def _decompressed(name: bytes, packed: memoryview, size: int, where: str) -> bytes | memoryview:
    import lz4.frame
    import zstandard

    try:
        match name:
            case b"":
                return packed
            case b"zstd":
                if zstandard.frame_content_size(packed) not in (-1, size):
                    raise DamageError(f"{where} does not have the size it states")
                return zstandard.ZstdDecompressor().decompress(packed, max_output_size=size)
            case b"lz4":
                unpacked: bytes = lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=size + 1)
                return unpacked
            case _:
                pass
    except (zstandard.ZstdError, RuntimeError, MemoryError, EOFError):
        raise DamageError(f"{where} cannot be decompressed") from None
    raise DamageError(f"{where} uses the unknown compression `{name.decode(errors='replace')}`")


def _beginning(name: bytes, packed: bytes, size: int) -> bytes:
    """What can be decompressed of something that is cut off, up to this size."""
    import lz4.frame
    import zstandard

    try:
        match name:
            case b"zstd":
                return zstandard.ZstdDecompressor().stream_reader(packed).read(size)
            case b"lz4":
                unpacked: bytes = lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=size)
                return unpacked
            case _:
                pass
    except (zstandard.ZstdError, RuntimeError, EOFError):
        return b""
    return packed if not name else b""
