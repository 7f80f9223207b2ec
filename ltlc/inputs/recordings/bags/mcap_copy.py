"""A part of an MCAP file, copied: whole chunks as they are, of others the messages."""

from __future__ import annotations

from collections.abc import Iterator
from io import BufferedReader
from pathlib import Path
from typing import NamedTuple

from ltlc.inputs.recordings.bags.chunked import Message, Whole
from ltlc.inputs.recordings.bags.compressed import is_packed
from ltlc.inputs.recordings.bags.mcap_records import Contents, DamageError, messages_in, opened
from ltlc.runtime.mcap import (
    CHUNK,
    CHUNK_HEAD,
    DATA_END,
    ENOUGH_FOR_A_CHUNK,
    FILE_HEADER,
    HEAD,
    MAGIC,
    MESSAGE,
    MESSAGE_HEAD,
    ChunkIndex,
)
from ltlc.semantics.durations import Nanoseconds


class Piece(NamedTuple):
    """Bytes of a file with messages of some time: a chunk, or else messages, one after the other.

    `chunk` is what the index of the file says of it, if it has one.
    """

    first: Nanoseconds
    last: Nanoseconds
    start: int
    length: int
    is_chunk: bool
    chunk: ChunkIndex | None = None


class McapParts:
    """What can be copied of an MCAP file, whose `contents` are known. Raises OSError and DamageError."""

    def __init__(self, path: Path, contents: Contents) -> None:
        self._path = path
        with path.open("rb") as file:
            self.profile = _profile(file)
            self._pieces = list(_scanned(file) if contents.chunks is None else map(_indexed, contents.chunks))
            first = next((data for piece in self._pieces[:1] for *_, data in _messages(file, piece)), b"")
        self._is_packed = is_packed(first)

    @property
    def compression(self) -> bytes:
        """What compresses its chunks."""
        return next((piece.chunk.compression for piece in self._pieces if piece.chunk is not None), b"")

    def items(self, since: Nanoseconds, until: Nanoseconds, *, whole: bool) -> Iterator[Whole | Message]:
        """The messages of these times, in the order of the file; chunks of them, if they may be `whole`.

        Messages that are compressed one by one are not left in chunks. Raises OSError and DamageError.
        """
        with self._path.open("rb") as file:
            for piece in self._pieces:
                if piece.last < since or piece.first > until:
                    continue
                is_inside = since <= piece.first and piece.last <= until
                if whole and is_inside and not self._is_packed and piece.chunk is not None and piece.chunk.indexes:
                    file.seek(piece.start)
                    yield Whole(piece.chunk, file.read(piece.length + piece.chunk.index_length))
                    continue
                for message in _messages(file, piece):
                    if since <= message.time <= until:
                        yield message


def _profile(file: BufferedReader) -> str:
    """The profile of the file: `ros2`."""
    head = file.read(len(MAGIC) + HEAD.size + 4)
    opcode, _ = HEAD.unpack_from(head, len(MAGIC))
    return file.read(int.from_bytes(head[-4:], "little")).decode() if opcode == FILE_HEADER else ""


def _indexed(chunk: ChunkIndex) -> Piece:
    return Piece(chunk.first, chunk.last, chunk.start, chunk.length, is_chunk=True, chunk=chunk)


def _scanned(file: BufferedReader) -> Iterator[Piece]:
    """The pieces of a file without an index, as far as it goes: short messages that follow each other are one."""
    run: Piece | None = None
    file.seek(len(MAGIC))
    while True:
        start = file.tell()
        head = file.read(HEAD.size + max(CHUNK_HEAD.size, MESSAGE_HEAD.size))
        opcode, length = HEAD.unpack_from(head) if len(head) >= HEAD.size else (DATA_END, 0)
        if run is not None and (opcode != MESSAGE or run.length >= ENOUGH_FOR_A_CHUNK):
            yield run
            run = None
        if opcode in (DATA_END, 0):
            return
        if opcode == CHUNK and len(head) >= HEAD.size + CHUNK_HEAD.size:
            first, last, *_ = CHUNK_HEAD.unpack_from(head, HEAD.size)
            yield Piece(first, last, start, HEAD.size + length, is_chunk=True)
        elif opcode == MESSAGE and len(head) >= HEAD.size + MESSAGE_HEAD.size:
            _, _, time, _ = MESSAGE_HEAD.unpack_from(head, HEAD.size)
            before = run or Piece(time, time, start, 0, is_chunk=False)
            size = before.length + HEAD.size + length
            run = Piece(min(before.first, time), max(before.last, time), before.start, size, is_chunk=False)
        file.seek(start + HEAD.size + length)


def _messages(file: BufferedReader, piece: Piece) -> Iterator[Message]:
    """The messages of a piece. Raises DamageError."""
    file.seek(piece.start)
    data = file.read(piece.length)
    records = memoryview(data)
    if piece.is_chunk:
        if data[:1] != bytes([CHUNK]):
            raise DamageError(f"the chunk at byte {piece.start} is missing")
        records = opened(data[HEAD.size :], f"the chunk at byte {piece.start}", len(data) < piece.length)
    for _, body in messages_in(records, Contents()):
        if len(body) < MESSAGE_HEAD.size:
            raise DamageError("a message is shorter than its header")
        channel, sequence, time, sent = MESSAGE_HEAD.unpack_from(body)
        yield Message(channel, sequence, time, sent, body[MESSAGE_HEAD.size :])
