"""The end of an MCAP file: what it is about, and where its chunks and their messages lie."""

from __future__ import annotations

import struct
from io import SEEK_END, BufferedReader

from ltlc.inputs.recordings.bags.mcap_records import Contents
from ltlc.inputs.recordings.bags.messages import LARGEST, span_of
from ltlc.runtime.mcap import CHANNEL, CHUNK_INDEX, FOOTER, HEAD, MAGIC, SCHEMA, STATISTICS, ChunkIndex

_FOOTER = struct.Struct("<QQI")
_CHUNK_INDEX = struct.Struct("<QQQQI")
_INDEX_AND_NAME = struct.Struct("<QI")
_SIZES = struct.Struct("<QQ")
_STATISTICS = struct.Struct("<QHIIIIQQI")
_BY_CHANNEL = struct.Struct("<HQ")


def summary(file: BufferedReader) -> Contents | None:
    """What the end of a file says, if it has one that is complete enough. Raises OSError."""
    try:
        return _contents(*_section(file))
    except (struct.error, UnicodeDecodeError):
        return None


def _section(file: BufferedReader) -> tuple[int, bytes]:
    """Where the summary begins, and its bytes, empty without one. Raises struct.error."""
    size = HEAD.size + _FOOTER.size + len(MAGIC)
    end = file.seek(0, SEEK_END) - size
    file.seek(max(0, end))
    footer = file.read(size)
    opcode, length = HEAD.unpack_from(footer)
    start, _, _ = _FOOTER.unpack_from(footer, HEAD.size)
    if (
        not footer.endswith(MAGIC)
        or (opcode, length) != (FOOTER, _FOOTER.size)
        or not 0 < start <= end <= start + LARGEST
    ):
        return 0, b""
    file.seek(start)
    return start, file.read(end - start)


def _contents(start: int, section: bytes) -> Contents | None:
    """The contents of the summary, after the chunks. Raises struct.error and UnicodeDecodeError."""
    contents, statistics, place = Contents(), None, 0
    chunks: list[ChunkIndex] = []
    while place < len(section):
        opcode, length = HEAD.unpack_from(section, place)
        place += HEAD.size + length
        if place > len(section):
            return None
        if opcode == CHUNK_INDEX:
            chunks.append(_chunk_index(section, place - length))
        elif opcode == STATISTICS:
            statistics = _STATISTICS.unpack_from(section, place - length)
            contents.counts = _by_channel(section, place - length + _STATISTICS.size, statistics[-1])
        elif opcode in (SCHEMA, CHANNEL):
            contents.take(opcode, section[place - length : place])
    if statistics is None:
        return None
    message_count, _, channel_count, _, _, chunk_count, first, last, _ = statistics
    if channel_count > len(contents.channels):
        return None
    contents.span = span_of(first, last) if message_count else None
    is_whole = len(chunks) == chunk_count and (bool(chunks) or not message_count)
    chunks.sort(key=lambda chunk: chunk.start)
    ends = [chunk.start + chunk.length + chunk.index_length for chunk in chunks]
    is_whole &= all(
        end <= begin for end, begin in zip(ends, [*(chunk.start for chunk in chunks[1:]), start], strict=False)
    )
    contents.chunks = chunks if is_whole else None
    return contents


def _chunk_index(section: bytes, place: int) -> ChunkIndex:
    first, last, start, length, size = _CHUNK_INDEX.unpack_from(section, place)
    place += _CHUNK_INDEX.size
    index_length, name_length = _INDEX_AND_NAME.unpack_from(section, place + size)
    begin = place + size + _INDEX_AND_NAME.size
    name = section[begin : begin + name_length]
    _, unpacked = _SIZES.unpack_from(section, begin + name_length)
    return ChunkIndex(first, last, start, length, _by_channel(section, place, size), index_length, name, unpacked)


def _by_channel(section: bytes, place: int, size: int) -> dict[int, int]:
    """A number for each channel."""
    return dict(_BY_CHANNEL.iter_unpack(section[place : place + size]))
