"""Messages that were compressed one by one, as rosbag2 does in its mode `message`."""

from __future__ import annotations

from ltlc.recordings.bags.messages import Messages, batch_of
from ltlc.recordings.bags.scalars import MisfitError

MAGIC = b"\x28\xb5\x2f\xfd"
"""How what zstd has compressed begins; no message does."""


def unpacked(messages: Messages) -> Messages:
    """The messages as they were before compression. Raises MisfitError."""
    if not len(messages) or not _is_packed(messages, 0):
        return messages
    import zstandard

    decompressor = zstandard.ZstdDecompressor()
    raw = [bytes(each) for each in messages.raw()]
    try:
        data = [decompressor.decompressobj().decompress(each) if each.startswith(MAGIC) else each for each in raw]
    except zstandard.ZstdError:
        raise MisfitError from None
    return batch_of(data, messages.times, messages.places)


def _is_packed(messages: Messages, number: int) -> bool:
    start = int(messages.starts[number])
    return messages.data[start : start + len(MAGIC)].tobytes() == MAGIC
