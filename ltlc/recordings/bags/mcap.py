"""MCAP files: by their index where they have one, else record by record."""

from __future__ import annotations

import struct
from collections.abc import Collection, Iterator
from io import BufferedReader
from pathlib import Path
from typing import Any

import numpy as np

from ltlc.recordings.bags.definitions import full_name
from ltlc.recordings.bags.mcap_records import (
    CHUNK,
    CHUNK_HEAD,
    HEAD,
    MAGIC,
    MESSAGE,
    MESSAGE_HEAD,
    Channel,
    Contents,
    DamageError,
    Schema,
    messages_in,
    records,
    unpacked,
)
from ltlc.recordings.bags.messages import LATEST, Batch, Messages, Topic, batch_of, together
from ltlc.recordings.blocks import Array
from ltlc.recordings.rows import RecordingError, failure
from ltlc.semantics.durations import Nanoseconds

ENOUGH = 1 << 22
"""So many bytes of messages are taken together."""


class McapStorage:
    """An MCAP file. Raises RecordingError if it is none."""

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            with path.open("rb") as file:
                if file.read(len(MAGIC)) != MAGIC:
                    raise failure("LTL811", path, f"`{path}` is no MCAP file: it does not begin as one")
                self._contents = _summary(file) or self._looked_through(file)
        except OSError as error:
            raise failure("LTL902", path, f"`{path}` cannot be read: {error.strerror}") from None
        self.topics = {name: self._topic(name) for name in dict.fromkeys(c.topic for c in self._channels.values())}
        self.span = self._contents.span

    @property
    def _channels(self) -> dict[int, Channel]:
        return self._contents.channels

    def _topic(self, name: str) -> Topic:
        """A topic of one channel or several; if these differ in type, it is that of all, with commas."""
        numbers = [number for number, channel in self._channels.items() if channel.topic == name]
        none = Schema("", "", b"")
        schemas = [self._contents.schemas.get(self._channels[number].schema, none) for number in numbers]
        types = ", ".join(dict.fromkeys(full_name(schema.name) for schema in schemas))
        forms = ", ".join(dict.fromkeys(self._channels[number].serialization for number in numbers))
        counts = self._contents.counts
        count = None if counts is None else sum(counts.get(number, 0) for number in numbers)
        return Topic(types, forms, schemas[0].form, schemas[0].text.decode(errors="replace"), count)

    def _looked_through(self, file: BufferedReader) -> Contents:
        """What a file without an index is about."""
        contents = Contents()
        try:
            for _ in records(file, contents):
                pass
        except DamageError:
            pass  # it is told when it is come to
        return contents

    def batches(self, topics: Collection[str], since: Nanoseconds, until: Nanoseconds) -> Iterator[Batch]:
        """The messages of `topics`. Raises RecordingError after those that could be read."""
        wanted = {number: channel.topic for number, channel in self._channels.items() if channel.topic in topics}
        try:
            with self._path.open("rb") as file:
                if self._contents.chunks is None:
                    yield from self._walked(file, wanted)
                else:
                    yield from self._indexed(file, wanted, self._contents.chunks, since, until)
        except DamageError as error:
            raise self._damaged(str(error)) from None
        except OSError as error:
            raise failure("LTL902", self._path, f"`{self._path}` cannot be read: {error.strerror}") from None

    def _damaged(self, what: str) -> RecordingError:
        help = "`mcap recover` saves what can be saved; the verdicts are of what is before"
        return failure("LTL811", self._path, f"`{self._path}` is damaged: {what}", help)

    def _indexed(
        self, file: BufferedReader, wanted: dict[int, str], chunks: list[Any], since: Nanoseconds, until: Nanoseconds
    ) -> Iterator[Batch]:
        """The messages of those chunks that the index says have some."""
        read = [
            chunk
            for chunk in chunks
            if chunk.message_start_time <= until
            and chunk.message_end_time >= since
            and (not chunk.message_index_offsets or not chunk.message_index_offsets.keys().isdisjoint(wanted))
        ]
        starts = np.array([*(chunk.message_start_time for chunk in read), LATEST], np.uint64).astype(np.int64)
        following = np.minimum.accumulate(starts[::-1])[::-1]
        parts = _Parts()
        for chunk, after in zip(read, following[1:].tolist(), strict=True):
            try:
                parts.add(self._chunk(file, chunk, wanted))
            except DamageError:
                yield parts.batch(after)
                raise
            if parts.size >= ENOUGH or after == LATEST:
                yield parts.batch(after)

    def _chunk(self, file: BufferedReader, chunk: Any, wanted: dict[int, str]) -> dict[str, Messages]:
        """The messages of a chunk. Raises DamageError."""
        file.seek(chunk.chunk_start_offset)
        raw = file.read(chunk.chunk_length + chunk.message_index_length)
        where = f"the chunk at byte {chunk.chunk_start_offset}"
        if len(raw) < HEAD.size + CHUNK_HEAD.size or raw[0] != CHUNK:
            raise DamageError(f"{where} is not there")
        data = unpacked(memoryview(raw)[HEAD.size : chunk.chunk_length], where)
        if chunk.message_index_offsets:
            return _by_index(chunk, raw, data, wanted, where)
        return _by_walking(data, wanted)

    def _walked(self, file: BufferedReader, wanted: dict[int, str]) -> Iterator[Batch]:
        """The messages of a file without an index."""
        gathered = _Gathered(wanted)
        file.seek(len(MAGIC))
        try:
            for body in records(file, Contents()):
                if gathered.add(body):
                    yield gathered.batch()
        except DamageError:
            yield gathered.batch()
            raise
        yield gathered.batch()


def _summary(file: BufferedReader) -> Contents | None:
    """What the end of a file says, if it has an end, and that says enough to go by."""
    from mcap.exceptions import McapError
    from mcap.reader import SeekingReader

    file.seek(0)
    try:
        summary = SeekingReader(file).get_summary()
    except (McapError, OSError, ValueError, struct.error, KeyError, UnicodeDecodeError, StopIteration):
        return None
    finally:
        file.seek(len(MAGIC))
    if summary is None or summary.statistics is None or summary.statistics.channel_count > len(summary.channels):
        return None
    statistics = summary.statistics
    schemas = {number: Schema(s.name, s.encoding, s.data) for number, s in summary.schemas.items()}
    channels = {k: Channel(c.schema_id, c.topic, c.message_encoding) for k, c in summary.channels.items()}
    span = (statistics.message_start_time, statistics.message_end_time) if statistics.message_count else None
    chunks = sorted(summary.chunk_indexes, key=lambda chunk: chunk.chunk_start_offset)
    is_whole = len(chunks) == statistics.chunk_count and (chunks or not statistics.message_count)
    counts = dict(statistics.channel_message_counts)
    return Contents(schemas, channels, counts, span, chunks if is_whole else None)


def _by_index(chunk: Any, raw: bytes, data: Array, wanted: dict[int, str], where: str) -> dict[str, Messages]:
    """The messages of a chunk that its index leads to. Raises DamageError."""
    found: dict[str, list[Messages]] = {}
    for number, offset in chunk.message_index_offsets.items():
        if number not in wanted:
            continue
        begin = offset - chunk.chunk_start_offset
        if not chunk.chunk_length <= begin <= len(raw) - 15:
            raise DamageError(f"the index of {where} is not there")
        length = int.from_bytes(raw[begin + 11 : begin + 15], "little")
        if length % 16 or begin + 15 + length > len(raw):
            raise DamageError(f"the index of {where} is not whole")
        entries = np.frombuffer(raw, np.int64, length // 8, begin + 15).reshape(-1, 2)
        if length:
            found.setdefault(wanted[number], []).append(_at(data, number, entries[:, 0], entries[:, 1], where))
    return {topic: _merged(parts) for topic, parts in found.items()}


def _at(data: Array, number: int, times: Array, places: Array, where: str) -> Messages:
    """The messages of a channel whose records are at `places`. Raises DamageError if there are others."""
    if places.min() < 0 or places.max() > len(data) - HEAD.size - MESSAGE_HEAD.size:
        raise DamageError(f"the index of {where} leads out of it")
    lengths = _numbers(data, "<i8", places + 1)
    ends = places + HEAD.size + lengths
    is_right = (data[places] == MESSAGE) & (_numbers(data, "<u2", places + 9) == number)
    is_right &= (_numbers(data, "<i8", places + 15) == times) & (lengths >= MESSAGE_HEAD.size) & (ends <= len(data))
    if not is_right.all():
        raise DamageError(f"the index of {where} does not lead to its messages")
    order = places.argsort(kind="stable") if (np.diff(places) < 0).any() else slice(None)
    head = HEAD.size + MESSAGE_HEAD.size
    return Messages(times[order], places[order], data, places[order] + head, lengths[order] - MESSAGE_HEAD.size)


def _numbers(data: Array, kind: str, places: Array) -> Array:
    dtype = np.dtype(kind)
    anywhere = np.ndarray((max(0, len(data) - dtype.itemsize + 1),), dtype, data, 0, (1,))
    return anywhere[places]


def _merged(parts: list[Messages]) -> Messages:
    """The messages of several channels of one topic in one chunk."""
    if len(parts) == 1:
        return parts[0]
    places = np.concatenate([part.places for part in parts])
    order = places.argsort()
    times, starts, sizes = (
        np.concatenate([getattr(part, name) for part in parts])[order] for name in ("times", "starts", "sizes")
    )
    return Messages(times, places[order], parts[0].data, starts, sizes)


class _Parts:
    """Messages of several chunks on the way to a batch: few large batches are read faster than many small ones."""

    def __init__(self) -> None:
        self.size = 0
        self._extent = 0
        self._parts: dict[str, list[Messages]] = {}

    def add(self, found: dict[str, Messages]) -> None:
        """Take those of the next chunk."""
        for topic, messages in found.items():
            self._parts.setdefault(topic, []).append(messages.moved(self._extent))
            self.size += int(messages.sizes.sum())
        self._extent += Batch(found).extent

    def batch(self, following: Nanoseconds) -> Batch:
        """All of them, before what was recorded from the time `following` on."""
        found = {topic: together(parts) for topic, parts in self._parts.items()}
        self.size, self._extent, self._parts = 0, 0, {}
        return Batch(found, following)


class _Gathered:
    """Messages on the way to a batch."""

    def __init__(self, wanted: dict[int, str]) -> None:
        self._wanted = wanted
        self._clear()

    def _clear(self) -> None:
        self._size = self._count = 0
        self._found: dict[str, tuple[list[bytes], list[int], list[int]]] = {}

    def add(self, body: bytes | memoryview) -> bool:
        """Take the body of a message's record; whether there are enough. Raises DamageError."""
        if len(body) < MESSAGE_HEAD.size:
            raise DamageError("a message is shorter than its head")
        number, _, time, _ = MESSAGE_HEAD.unpack_from(body)
        topic = self._wanted.get(number)
        if topic is not None:
            data, times, places = self._found.setdefault(topic, ([], [], []))
            data.append(bytes(body[MESSAGE_HEAD.size :]))
            times.append(time)
            places.append(self._count)
            self._size += len(body)
            self._count += 1
        return self._size >= ENOUGH

    def batch(self) -> Batch:
        """All of them, by topic."""
        found = {topic: batch_of(*lists) for topic, lists in self._found.items()}
        self._clear()
        return Batch(found)


def _by_walking(data: Array, wanted: dict[int, str]) -> dict[str, Messages]:
    gathered = _Gathered(wanted)
    for body in messages_in(memoryview(data.tobytes()), Contents()):
        gathered.add(body)
    return dict(gathered.batch().messages)
