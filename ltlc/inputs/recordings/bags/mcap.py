"""MCAP files: by their index where they have one, else record by record."""

from __future__ import annotations

import struct
from collections.abc import Callable, Collection, Container, Iterator
from contextlib import closing
from functools import partial
from io import BufferedReader
from itertools import accumulate, groupby
from pathlib import Path

import numpy as np

from ltlc.inputs.messages.texts import full_name
from ltlc.inputs.recordings.ahead import each_ahead
from ltlc.inputs.recordings.bags.mcap_chunks import Chunks
from ltlc.inputs.recordings.bags.mcap_records import (
    MESSAGE_HEAD,
    Channel,
    Contents,
    DamageError,
    Schema,
    records,
)
from ltlc.inputs.recordings.bags.mcap_summary import summary
from ltlc.inputs.recordings.bags.messages import LATEST, Batch, Room, Topic, batch_of, span_of
from ltlc.inputs.recordings.rows import RecordingError, failure
from ltlc.runtime.mcap import MAGIC, ChunkIndex
from ltlc.semantics.durations import Nanoseconds

ENOUGH = 1 << 22
"""So many bytes of messages are taken together."""

ROS1 = "ros1"
"""The serialization of messages of ROS 1."""

MOST_AHEAD = 1 << 25
"""Where more bytes are worked on at a time, one thread does it: several would hold several times as many."""


class McapStorage:
    """An MCAP file. Raises RecordingError if it is not one."""

    distribution = ""
    remarks = ()

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            with path.open("rb") as file:
                if file.read(len(MAGIC)) != MAGIC:
                    raise failure("LTL811", path, f"`{path}` is not an MCAP file: it does not begin like one")
                self.contents = summary(file) or self._looked_through(file)
        except OSError as error:
            raise failure("LTL902", path, f"`{path}` cannot be read: {error.strerror}") from None
        self._old: dict[str, tuple[str, str]] = {}
        self._converters: dict[str, Callable[[memoryview], bytes]] = {}
        self.topics = {name: self._topic(name) for name in dict.fromkeys(c.topic for c in self._channels.values())}
        self.span = self.contents.span

    @property
    def _channels(self) -> dict[int, Channel]:
        return self.contents.channels

    def _topic(self, name: str) -> Topic:
        """A topic of one channel or several; if these differ in type, it is that of all, with commas."""
        numbers = [number for number, channel in self._channels.items() if channel.topic == name]
        none = Schema("", "", b"")
        schemas = [self.contents.schemas.get(self._channels[number].schema, none) for number in numbers]
        types = ", ".join(dict.fromkeys(full_name(schema.name) for schema in schemas))
        forms = ", ".join(dict.fromkeys(self._channels[number].serialization for number in numbers))
        if forms == ROS1:
            self._old[name] = (types, schemas[0].text.decode(errors="replace"))
            forms = "cdr"
        counts = self.contents.counts
        count = None if counts is None else sum(counts.get(number, 0) for number in numbers)
        return Topic(types, forms, schemas[0].form, schemas[0].text.decode(errors="replace"), count)

    def _looked_through(self, file: BufferedReader) -> Contents:
        """What a file without an index is about."""
        contents = Contents()
        file.seek(len(MAGIC))
        first, last = LATEST, -1
        try:
            for body in records(file, contents):
                _, _, time, _ = MESSAGE_HEAD.unpack_from(body)
                first, last = min(first, time), max(last, time)
        except (DamageError, struct.error):
            pass  # it is reported when it is reached
        contents.span = span_of(first, last)
        return contents

    def batches(self, topics: Collection[str], since: Nanoseconds, until: Nanoseconds) -> Iterator[Batch]:
        """The messages of `topics`. Raises RecordingError after those that could be read."""
        wanted = {number: channel.topic for number, channel in self._channels.items() if channel.topic in topics}
        try:
            if self.contents.chunks is None:
                batches = self._walked(wanted)
            else:
                batches = self._indexed(wanted, self.contents.chunks, since, until)
            yield from map(self._as_ros2, batches) if self._old else batches
        except DamageError as error:
            raise self._damaged(str(error)) from None
        except OSError as error:
            raise failure("LTL902", self._path, f"`{self._path}` cannot be read: {error.strerror}") from None

    def _as_ros2(self, batch: Batch) -> Batch:
        """The same, with the messages of ROS 1, as `mcap convert` and `--cut` leave them, made those of ROS 2."""
        from rosbags.rosbag1 import ReaderError  # noqa: TID251

        from ltlc.inputs.recordings.bags.ros1 import converter

        found = dict(batch.messages)
        for topic in found.keys() & self._old.keys():
            if topic not in self._converters:
                try:
                    self._converters[topic] = converter(*self._old[topic])
                except ReaderError as error:
                    raise DamageError(str(error)) from None
            messages = found[topic]
            data = list(map(self._converters[topic], messages.raw()))
            found[topic] = batch_of(data, messages.times, messages.places)
        return Batch(found, batch.next)

    def _damaged(self, what: str) -> RecordingError:
        help = "`mcap recover` saves what can be saved; the verdicts are about what comes before the damage"
        return failure("LTL811", self._path, f"`{self._path}` is damaged: {what}", help)

    def _indexed(
        self, wanted: dict[int, str], chunks: list[ChunkIndex], since: Nanoseconds, until: Nanoseconds
    ) -> Iterator[Batch]:
        """The messages of the chunks that have some by the index; their buffers are reused for later ones."""
        groups = list(_groups([each for each in chunks if _is_of_use(each, wanted, since, until)]))
        rooms: list[Room] = []
        pieces = ((group, rooms.pop() if rooms else Room(ENOUGH)) for group in groups)
        taken: Chunks | None = None
        with closing(each_ahead(pieces, partial(self._read, wanted), _is_work(groups))) as found:
            for part, following in zip(found, _following(groups), strict=True):
                if taken is None:
                    taken = part
                else:
                    taken.extend(part)
                    rooms.append(part.room)
                if taken.size >= ENOUGH or following == LATEST or taken.damage is not None:
                    yield taken.batch(following)
                    rooms.append(taken.room)
                    if taken.damage is not None:
                        raise taken.damage
                    taken = None

    def _read(self, wanted: dict[int, str], piece: tuple[list[ChunkIndex], Room]) -> Chunks:
        """The messages of some chunks, up to the first that is damaged, in a room. Raises OSError."""
        chunks, room = piece
        found = Chunks(wanted, room)
        try:
            with self._path.open("rb") as file:
                for chunk in chunks:
                    found.add(file, chunk)
        except DamageError as error:
            found.damage = error
        return found

    def _walked(self, wanted: dict[int, str]) -> Iterator[Batch]:
        """The messages of a file without an index."""
        gathered = _Gathered(wanted)
        try:
            with self._path.open("rb") as file:
                file.seek(len(MAGIC))
                for body in records(file, Contents()):
                    if gathered.add(body):
                        yield gathered.batch()
        except DamageError:
            yield gathered.batch()
            raise
        yield gathered.batch()


def _is_of_use(chunk: ChunkIndex, wanted: Container[int], since: Nanoseconds, until: Nanoseconds) -> bool:
    """Whether a chunk may have messages that are wanted."""
    is_in_time = chunk.first <= until and chunk.last >= since
    return is_in_time and (not chunk.indexes or any(number in wanted for number in chunk.indexes))


def _is_work(groups: list[list[ChunkIndex]]) -> bool:
    """Whether two threads are faster than one: where memory is not the limit, as it is for lz4 and copying."""
    sizes = [sum(chunk.size for chunk in group) for group in groups]
    return len(sizes) > 1 and max(sizes) <= MOST_AHEAD and any(c.compression == b"zstd" for g in groups for c in g)


def _groups(chunks: list[ChunkIndex]) -> Iterator[list[ChunkIndex]]:
    """The chunks, as many together as are one thread's work at a time."""
    ends = accumulate(chunk.size for chunk in chunks)
    for _, group in groupby(zip(chunks, ends, strict=True), lambda each: each[1] // (2 * ENOUGH)):
        yield [chunk for chunk, _ in group]


def _following(groups: list[list[ChunkIndex]]) -> list[Nanoseconds]:
    """The time before which nothing was recorded that is in the groups behind each."""
    starts = np.array([*(min(chunk.first for chunk in group) for group in groups), LATEST], np.uint64).astype(np.int64)
    following: list[Nanoseconds] = np.minimum.accumulate(starts[::-1])[::-1][1:].tolist()
    return following


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
            raise DamageError("a message is shorter than its header")
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
