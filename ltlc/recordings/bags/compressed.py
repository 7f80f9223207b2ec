"""Messages that were compressed one by one, as rosbag2 does in its mode `message`."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ltlc.recordings.bags.messages import LARGEST, Messages, batch_of
from ltlc.recordings.bags.scalars import MisfitError

MAGIC = b"\x28\xb5\x2f\xfd"
"""How what zstd has compressed begins; no message does."""


def portions(messages: Messages) -> Iterator[Messages]:
    """`messages` in parts that are not large when they are decompressed. Raises MisfitError at one that is."""
    if not len(messages) or not _is_packed(messages, 0):
        yield messages
        return
    ends = np.cumsum([_size(each) for each in messages.raw()])
    first = 0
    while first < len(messages):
        before = int(ends[first - 1]) if first else 0
        end = max(first + 1, int(ends.searchsorted(before + LARGEST, "right")))
        yield messages.taken(np.arange(first, end))
        first = end


def _size(raw: memoryview) -> int:
    """How large a message claims to be when it is decompressed. Raises MisfitError if no message is."""
    import zstandard

    if raw[: len(MAGIC)] != MAGIC:
        return len(raw)
    try:
        claimed = zstandard.frame_content_size(raw)
    except zstandard.ZstdError:
        raise MisfitError from None
    if claimed > LARGEST:
        raise MisfitError
    return LARGEST if claimed < 0 else claimed


def unpacked(messages: Messages) -> Messages:
    """The messages as they were before compression. Raises MisfitError."""
    if not len(messages) or not _is_packed(messages, 0):
        return messages
    import zstandard

    decompressor = zstandard.ZstdDecompressor()
    raw = [bytes(each) for each in messages.raw()]
    try:
        data = [
            decompressor.decompress(each, max_output_size=LARGEST) if each.startswith(MAGIC) else each for each in raw
        ]
    except (zstandard.ZstdError, MemoryError):
        raise MisfitError from None
    return batch_of(data, messages.times, messages.places)


def _is_packed(messages: Messages, number: int) -> bool:
    start = int(messages.starts[number])
    return messages.data[start : start + len(MAGIC)].tobytes() == MAGIC
