"""Parts of bags, copied to MCAP files: the messages of some time on all topics, bit for bit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import zstandard

from ltlc.inputs.messages.texts import full_name, text_of
from ltlc.inputs.recordings.bags.chunked import ChunkedFile, Message, Whole
from ltlc.inputs.recordings.bags.compressed import is_packed, message_in
from ltlc.inputs.recordings.bags.definitions import merged, other_layers
from ltlc.inputs.recordings.bags.folders import bag_at, unpacked
from ltlc.inputs.recordings.bags.mcap import McapStorage
from ltlc.inputs.recordings.bags.mcap_copy import McapParts
from ltlc.inputs.recordings.bags.mcap_records import Channel, Contents, DamageError, Schema
from ltlc.inputs.recordings.bags.messages import LATEST
from ltlc.inputs.recordings.bags.ros1 import Ros1Storage
from ltlc.inputs.recordings.bags.scalars import MisfitError
from ltlc.inputs.recordings.bags.sqlite import SqliteStorage
from ltlc.inputs.recordings.bags.ulog import ULogStorage
from ltlc.inputs.recordings.fence import fenced
from ltlc.inputs.recordings.rows import RecordingError, failure
from ltlc.semantics.durations import Nanoseconds

MOST = 1 << 16
"""An MCAP file has fewer channels, and fewer schemas."""


class _File(NamedTuple):
    """A file of a bag, the times of its messages, and the numbers that its channels have in what is copied."""

    parts: McapParts | SqliteStorage | Ros1Storage | ULogStorage
    span: tuple[Nanoseconds, Nanoseconds] | None
    numbers: dict[int, int]
    is_same: bool


class Copier:
    """A bag, from which MCAP files are made; a context, as files that are compressed are unpacked for that long.

    Definitions that a database lacks are those that its messages are read by, with those of `message_paths`. Messages
    that the recorder compressed one by one are as they were before that. Raises RecordingError if it cannot be used.
    """

    def __init__(self, path: Path, message_paths: Sequence[str] = ()) -> None:
        self._path, self._message_paths = path, message_paths
        self._files: list[_File] = []
        self._schemas: dict[Schema, int] = {}
        self._channels: dict[Channel, int] = {}
        self._profile, self._compression = "ros2", b""
        self._decompressor = zstandard.ZstdDecompressor()
        self._unpacked = ExitStack()

    def __enter__(self) -> Copier:
        with self._unpacked, fenced(self._path, "LTL811"):
            bag = bag_at(self._path)
            for file in bag.files:
                self._open(self._unpacked.enter_context(unpacked(file)), bag.distribution)
            self._unpacked = self._unpacked.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._unpacked.close()

    def _open(self, file: Path, distribution: str) -> None:
        """Take the next file of the bag. Raises RecordingError."""
        match file.suffix.lower():
            case ".mcap":
                mcap = McapStorage(file)
                parts = McapParts(file, mcap.contents)
                self._profile, self._compression = parts.profile, parts.compression
                self._files.append(_File(parts, mcap.span, *self._numbered(mcap.contents)))
            case ".db3":
                database = SqliteStorage(file)
                contents = self._defined(database.contents(), distribution or database.distribution)
                self._files.append(_File(database, database.span, *self._numbered(contents)))
            case ".ulg":
                log = ULogStorage(file, {})
                self._files.append(_File(log, log.span, *self._numbered(log.contents())))
            case _:
                bag = Ros1Storage(file)
                self._profile = "ros1"
                self._files.append(_File(bag, bag.span, *self._numbered(bag.contents())))

    def _defined(self, contents: Contents, distribution: str) -> Contents:
        """The same, with definitions added for known types without one."""
        if all(schema.form for schema in contents.schemas.values()):
            return contents
        types = merged(other_layers(self._message_paths, distribution)).messages
        for number, schema in contents.schemas.items():
            name = full_name(schema.name)
            if not schema.form and name in types:
                contents.schemas[number] = schema._replace(form="ros2msg", text=text_of(name, types).encode())
        return contents

    def _numbered(self, contents: Contents) -> tuple[dict[int, int], bool]:
        """The numbers that channels get, and whether they and their schemas have these already.

        What is the same in several files is one. Raises RecordingError.
        """
        numbers, is_same = {}, True
        for number, channel in contents.channels.items():
            schema = contents.schemas.get(channel.schema)
            of = 0 if schema is None else _number(self._schemas, schema, channel.schema)
            numbers[number] = _number(self._channels, channel._replace(schema=of), number)
            is_same &= (of, numbers[number]) == (channel.schema, number)
        if max(self._schemas.values(), default=0) >= MOST or max(self._channels.values(), default=0) >= MOST:
            raise failure("LTL811", self._path, f"an MCAP file has at most {MOST - 1} topics, too few for this bag")
        return numbers, is_same

    def copy(self, since: Nanoseconds, until: Nanoseconds, file: BinaryIO) -> int:
        """Write an MCAP file of the messages recorded from `since` to `until`; how many these are.

        Raises RecordingError, and OSError if the file cannot be written.
        """
        target = ChunkedFile(file, self._profile, self._compression)
        for schema, number in self._schemas.items():
            target.add_schema(number, *schema)
        for channel, number in self._channels.items():
            target.add_channel(number, *channel)
        for part in self._files:
            if part.span is None or (part.span[0] <= until and part.span[1] >= since):
                self._copy(part, self._read(part, max(since, 0), until), target)
        target.end()
        return target.count

    def first_from(self, time: Nanoseconds) -> Nanoseconds | None:
        """When a message was recorded at `time` or, if there is none, next. Raises RecordingError."""
        for part in self._files:
            if part.span is None or part.span[1] >= time:
                for each in self._read(part._replace(is_same=False), time, LATEST):
                    assert isinstance(each, Message)
                    return each.time
        return None

    def _read(self, part: _File, since: Nanoseconds, until: Nanoseconds) -> Iterator[Message | Whole]:
        """What there is of these times in a file. Raises RecordingError."""
        with fenced(self._path, "LTL811"):
            try:
                if isinstance(part.parts, McapParts):
                    yield from part.parts.items(since, until, whole=part.is_same)
                else:
                    yield from part.parts.items(since, until)
            except DamageError as error:
                raise self._damaged(str(error)) from None

    def _copy(self, part: _File, items: Iterator[Message | Whole], target: ChunkedFile) -> None:
        numbers: Mapping[int, int] = part.numbers
        try:
            for each in items:
                if isinstance(each, Whole):
                    target.take(each)
                    continue
                if each.channel not in numbers:
                    raise DamageError("a message is on an unknown topic")
                data = message_in(each.data, self._decompressor) if is_packed(each.data) else each.data
                target.add(numbers[each.channel], each.sequence, each.time, each.sent, data)
        except DamageError as error:
            raise self._damaged(str(error)) from None
        except MisfitError:
            raise self._damaged("a message cannot be decompressed") from None

    def _damaged(self, what: str) -> RecordingError:
        return failure("LTL811", self._path, f"`{self._path}` is damaged: {what}")


def _number(numbers: dict[Any, int], what: Schema | Channel, wanted: int) -> int:
    """The number of `what`: the one that it has, the one `wanted` if that is free, or the next one."""
    if what not in numbers:
        is_free = 0 < wanted < MOST and wanted not in numbers.values()
        numbers[what] = wanted if is_free else max(numbers.values(), default=0) + 1
    return numbers[what]
