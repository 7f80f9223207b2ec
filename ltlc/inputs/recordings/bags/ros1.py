"""Bags of ROS 1, read by rosbags; each message is made one of ROS 2."""

from __future__ import annotations

import bz2
import re
import struct
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from typing import Any

import lz4.frame
from rosbags.interfaces import Connection  # noqa: TID251
from rosbags.rosbag1 import Reader, ReaderError  # noqa: TID251
from rosbags.serde import SerdeError  # noqa: TID251
from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore  # noqa: TID251

from ltlc.inputs.recordings.bags.chunked import Message
from ltlc.inputs.recordings.bags.mcap_records import Channel, Contents, Schema
from ltlc.inputs.recordings.bags.messages import LARGEST, LATEST, Batch, Topic, batch_of
from ltlc.inputs.recordings.rows import RecordingError, failure
from ltlc.runtime.mcap import metadata
from ltlc.semantics.durations import Nanoseconds

ENOUGH = 1 << 12
"""So many messages of a topic are taken together."""

ENOUGH_BYTES = 1 << 22
"""Or so many bytes."""

_MISFITS = (SerdeError, struct.error, AssertionError, ValueError, IndexError)
"""What rosbags raises for a message that is longer or shorter than its definition says."""

_FAULTS = (ReaderError, AssertionError, struct.error, ValueError, KeyError, IndexError, EOFError, RuntimeError)
"""What rosbags raises of a bag that is damaged, and what the decompressors do."""


class Ros1Storage:
    """A `.bag` file. Raises RecordingError if it is not one."""

    distribution = ""
    remarks = ()

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            with path.open("rb") as file:
                version = re.match(rb"#ROS\w+ V(1\.[\d.]+)", file.readline(20))
            if version is not None:
                message = f"`{path}` is a bag in the format {version.group(1).decode()}, from before 2010"
                raise failure("LTL811", path, message, "`rosbag fix` converts it to format 2.0")
            with Reader(path) as reader:
                self.span = (reader.start_time, reader.end_time - 1) if reader.message_count else None
                self.topics = {name: _topic(of.connections, of.msgcount) for name, of in reader.topics.items()}
        except OSError as error:
            raise failure("LTL902", path, f"`{path}` cannot be read: {error.strerror}") from None
        except _FAULTS as error:
            raise self._damaged(error, "if only the index is missing, `rosbag reindex` makes a new one") from None

    def _damaged(self, error: Exception, help: str) -> RecordingError:
        why = str(error).rstrip(".") or "its index is malformed"
        return failure("LTL811", self._path, f"`{self._path}` cannot be read as a bag of ROS 1: {why}", help)

    def batches(self, topics: Collection[str], since: Nanoseconds, until: Nanoseconds) -> Iterator[Batch]:
        """The messages of `topics`, in the order of time. Raises RecordingError after those that could be read."""
        found: dict[str, tuple[list[bytes], list[int], list[int]]] = {}
        fault: Exception | None = None
        count = size = 0
        try:
            for topic, time, data in self._messages(topics, since, until):
                messages, times, places = found.setdefault(topic, ([], [], []))
                messages.append(data)
                times.append(time)
                places.append(count)
                count += 1
                size += len(data)
                if len(times) >= ENOUGH or size >= ENOUGH_BYTES:
                    yield Batch({name: batch_of(*of) for name, of in found.items()}, time)
                    found, size = {}, 0
        except (*_FAULTS, OSError, SerdeError) as error:
            fault = error
        yield Batch({name: batch_of(*of) for name, of in found.items()})
        if fault is not None:
            raise self._damaged(fault, "the verdicts are about what comes before the damage")

    def _messages(
        self, topics: Collection[str], since: Nanoseconds, until: Nanoseconds
    ) -> Iterator[tuple[str, Nanoseconds, bytes]]:
        converters: dict[int, Converter] = {}
        for connection, time, raw in self._raw(topics, since, until):
            convert = converters.get(connection.id)
            if convert is None:
                convert = converters[connection.id] = converter(connection.msgtype, connection.msgdef.data)
            yield connection.topic, time, convert(raw)

    def _raw(
        self, topics: Collection[str], since: Nanoseconds, until: Nanoseconds
    ) -> Iterator[tuple[Connection, Nanoseconds, bytes]]:
        with Reader(self._path) as reader:
            for place, chunk in reader.chunks.items():
                reader.chunks[place] = _bounded(place, chunk)
            connections = [each for each in reader.connections if each.topic in topics]
            if connections:  # none would mean all to rosbags
                yield from reader.messages(connections, max(since, 0), min(until, LATEST - 1) + 1)

    def contents(self) -> Contents:
        """Its connections as schemas and channels of MCAP, each with the number that it has. Raises RecordingError."""
        contents = Contents()
        try:
            with Reader(self._path) as reader:
                connections = list(reader.connections)
        except (*_FAULTS, OSError) as error:
            raise self._damaged(error, "") from None
        for each in connections:
            said = {**each.ext._asdict(), "md5sum": each.digest}
            more = metadata({key: str(value) for key, value in said.items() if value is not None})
            type_ = each.msgtype.replace("/msg/", "/")
            contents.schemas[each.id] = Schema(type_, "ros1msg", each.msgdef.data.encode())
            contents.channels[each.id] = Channel(each.id, each.topic, "ros1", more)
        return contents

    def items(self, since: Nanoseconds, until: Nanoseconds) -> Iterator[Message]:
        """The messages recorded from `since` to `until`. Raises RecordingError."""
        try:
            for connection, time, raw in self._raw(self.topics, since, until):
                yield Message(connection.id, 0, time, time, raw)
        except (*_FAULTS, OSError) as error:
            raise self._damaged(error, "`rosbag fix` or `rosbag reindex` may save it") from None


def _bounded(place: int, chunk: Any) -> Any:
    """A chunk of which no more is decompressed than one may have. Raises ReaderError."""
    message = f"the chunk at byte {place} has more than {LARGEST} bytes"
    if chunk.datasize > LARGEST:
        raise ReaderError(message)
    if chunk.decompressor not in (bz2.decompress, lz4.frame.decompress):
        return chunk

    def decompressed(packed: bytes) -> bytes:
        is_bz2 = chunk.decompressor is bz2.decompress
        decompressor = bz2.BZ2Decompressor() if is_bz2 else lz4.frame.LZ4FrameDecompressor()
        data: bytes = decompressor.decompress(packed, max_length=LARGEST)
        if not decompressor.eof:
            raise ReaderError(message if len(data) == LARGEST else f"the chunk at byte {place} is cut off")
        return data

    return chunk._replace(decompressor=decompressed)


def _topic(connections: list[Connection], count: int) -> Topic:
    types = ", ".join(dict.fromkeys(each.msgtype for each in connections))
    return Topic(types, "cdr", "ros1msg", connections[0].msgdef.data, count)


Converter = Callable[[bytes | memoryview], bytes]
"""Converts a message of ROS 1 to ROS 2; to no bytes, which is no message, if it does not fit its definition."""


def converter(type_: str, definition: str) -> Converter:
    """What converts messages of a type that is so defined. Raises ReaderError."""
    store = get_typestore(Stores.EMPTY)
    try:
        types = get_types_from_msg(definition, type_)
    except TypesysError as error:
        first = str(error).partition("\n")[0]
        raise ReaderError(f"the definition of {type_} cannot be read: {first}") from None
    store.register({_unlike(name): _unlike(definition) for name, definition in types.items()})

    def convert(raw: bytes | memoryview) -> bytes:
        try:
            return bytes(store.ros1_to_cdr(raw, _unlike(type_)))
        except _MISFITS:
            return b""

    return convert


def _unlike(part: Any) -> Any:
    """A part of definitions, with another name for headers: in `std_msgs/msg/Header` rosbags omits `seq`."""
    if isinstance(part, list | tuple):
        return type(part)(map(_unlike, part))
    return f"{part}_" if part == "std_msgs/msg/Header" else part
