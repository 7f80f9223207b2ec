"""MCAP files: by their index where they have one, else record by record."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from io import BufferedReader
from pathlib import Path

import numpy as np

from ltlc.recordings.bags.definitions import full_name
from ltlc.recordings.bags.mcap_chunks import Chunks
from ltlc.recordings.bags.mcap_records import (
    MAGIC,
    MESSAGE_HEAD,
    Channel,
    ChunkIndex,
    Contents,
    DamageError,
    Schema,
    records,
)
from ltlc.recordings.bags.mcap_summary import summary
from ltlc.recordings.bags.messages import LATEST, Batch, Topic, batch_of
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
                self._contents = summary(file) or self._looked_through(file)
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
        file.seek(len(MAGIC))
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
        self,
        file: BufferedReader,
        wanted: dict[int, str],
        chunks: list[ChunkIndex],
        since: Nanoseconds,
        until: Nanoseconds,
    ) -> Iterator[Batch]:
        """The messages of those chunks that the index says have some."""
        read = [
            chunk
            for chunk in chunks
            if chunk.first <= until
            and chunk.last >= since
            and (not chunk.indexes or not chunk.indexes.keys().isdisjoint(wanted))
        ]
        starts = np.array([*(chunk.first for chunk in read), LATEST], np.uint64).astype(np.int64)
        following = np.minimum.accumulate(starts[::-1])[::-1]
        taken = Chunks(wanted, ENOUGH)
        for chunk, after in zip(read, following[1:].tolist(), strict=True):
            try:
                taken.add(file, chunk)
            except DamageError:
                yield taken.batch(after)
                raise
            if taken.size >= ENOUGH or after == LATEST:
                yield taken.batch(after)

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
