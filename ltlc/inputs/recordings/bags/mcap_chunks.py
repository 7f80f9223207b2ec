"""The chunks of MCAP files, several at a time."""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Mapping
from io import BufferedReader

import numpy as np

from ltlc.inputs.recordings.bags.mcap_records import (
    MESSAGE_HEAD,
    Contents,
    DamageError,
    messages_in,
    unpacked,
)
from ltlc.inputs.recordings.bags.messages import LARGEST, Batch, Messages, Room, gathered
from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.runtime.mcap import CHUNK, CHUNK_HEAD, HEAD, MESSAGE, ChunkIndex
from ltlc.semantics.durations import Nanoseconds

_HEAD = np.dtype([("opcode", "u1"), ("length", "<i8"), ("channel", "<u2"), ("number", "<u4"), ("times", "<i8", 2)])
"""How a message begins: with the head of a record, and its own."""

_ENTRY = np.dtype([("time", "<i8"), ("place", "<i8")])
"""How an index leads to a message: its time, and where its record begins in the chunk."""

assert _HEAD.itemsize == HEAD.size + MESSAGE_HEAD.size


class Chunks:
    """The wanted messages of several chunks: few large batches are read faster than many small ones.

    If one is damaged, `damage` says how, and only those before it are there.
    """

    def __init__(self, wanted: Mapping[int, str], room: Room) -> None:
        room.clear()
        self.room = room
        self._wanted = wanted
        self._extent = 0
        self._found: dict[str, list[Messages]] = {}
        self.damage: DamageError | None = None

    @property
    def size(self) -> int:
        """How many bytes they have."""
        return self.room.size

    def add(self, file: BufferedReader, chunk: ChunkIndex) -> None:
        """Take those of the next chunk. Raises DamageError."""
        where = f"the chunk at byte {chunk.start}"
        if chunk.length > LARGEST + HEAD.size + CHUNK_HEAD.size:
            raise DamageError(f"{where} is larger than the maximum of {LARGEST} bytes")
        file.seek(chunk.start)
        raw = file.read(chunk.length)
        if len(raw) < HEAD.size + CHUNK_HEAD.size or raw[0] != CHUNK:
            raise DamageError(f"{where} is missing")
        data = unpacked(memoryview(raw)[HEAD.size :], where)
        entries = _indexed(file, chunk, self._wanted, where) if chunk.indexes else _walked(data, self._wanted)
        heads = [(number, of["place"], _heads(data, number, of, where)) for number, of in entries]
        for number, places, of_channel in heads:
            self._keep(self._wanted[number], data, places, of_channel)
        self._extent += len(data)

    def _keep(self, topic: str, data: Array, places: Places, heads: Array) -> None:
        sizes = heads["length"] - MESSAGE_HEAD.size
        starts = self.room.size + sizes.cumsum() - sizes
        self.room.add(gathered(data, places + _HEAD.itemsize, sizes))
        messages = Messages(heads["times"][:, 0], places + self._extent, self.room.data, starts, sizes)
        self._found.setdefault(topic, []).append(messages)

    def extend(self, others: Chunks) -> None:
        """Take those of chunks that follow."""
        for topic, parts in others._found.items():
            moved = [part.moved(self._extent).behind(self.room.size) for part in parts]
            self._found.setdefault(topic, []).extend(moved)
        self.room.add(others.room.data[: others.size])
        self._extent += others._extent
        self.damage = others.damage

    def batch(self, following: Nanoseconds) -> Batch:
        """All of them, before what was recorded from the time `following` on."""
        return Batch({topic: self._messages(parts) for topic, parts in self._found.items()}, following)

    def _messages(self, parts: list[Messages]) -> Messages:
        """Those of a topic, in the order of the file."""
        times, places, starts, sizes = (
            np.concatenate([getattr(part, name) for part in parts]) for name in ("times", "places", "starts", "sizes")
        )
        messages = Messages(times, places, self.room.data, starts, sizes)
        return messages.taken(places.argsort(kind="stable")) if (np.diff(places) < 0).any() else messages


def _indexed(
    file: BufferedReader, chunk: ChunkIndex, wanted: Mapping[int, str], where: str
) -> Iterator[tuple[int, Array]]:
    """What the index of a chunk, which comes next in the file, has of each channel. Raises DamageError."""
    raw = file.read(chunk.index_length)
    for number, place in chunk.indexes.items():
        if number not in wanted:
            continue
        begin = place - chunk.start - chunk.length
        if not 0 <= begin <= len(raw) - 15:
            raise DamageError(f"the index of {where} is missing")
        length = int.from_bytes(raw[begin + 11 : begin + 15], "little")
        if length % _ENTRY.itemsize or begin + 15 + length > len(raw):
            raise DamageError(f"the index of {where} is incomplete")
        if length:
            yield number, np.frombuffer(raw, _ENTRY, length // _ENTRY.itemsize, begin + 15)


def _walked(data: Array, wanted: Mapping[int, str]) -> Iterator[tuple[int, Array]]:
    """What an index would have of each channel. Raises DamageError."""
    found: dict[int, array[int]] = {}
    for place, body in messages_in(data.data, Contents()):
        if len(body) < MESSAGE_HEAD.size:
            raise DamageError("a message is shorter than its header")
        number, _, time, _ = MESSAGE_HEAD.unpack_from(body)
        if number in wanted:
            found.setdefault(number, array("q")).extend((time, place))
    for number, entries in found.items():
        yield number, np.frombuffer(entries, _ENTRY)


def _heads(data: Array, number: int, entries: Array, where: str) -> Array:
    """How the messages of a channel begin that an index leads to. Raises DamageError if there are others."""
    places = entries["place"]
    if places.min() < 0 or places.max() > len(data) - _HEAD.itemsize:
        raise DamageError(f"the index of {where} points outside it")
    anywhere = np.ndarray((len(data) - _HEAD.itemsize + 1,), _HEAD, data, 0, (1,))
    heads: Array = anywhere[places]
    lengths = heads["length"]
    is_right = (heads["opcode"] == MESSAGE) & (heads["channel"] == number) & (heads["times"][:, 0] == entries["time"])
    is_right &= lengths.sum() <= len(data)  # none is there twice
    is_right &= (lengths >= MESSAGE_HEAD.size) & (lengths <= len(data) - HEAD.size - places)
    if not is_right.all():
        raise DamageError(f"the index of {where} does not point to its messages")
    return heads
