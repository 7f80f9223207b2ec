"""Messages that were compressed one by one, as rosbag2 does in its mode `message`, and what a batch holds at once."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ltlc.inputs.recordings.bags.messages import LARGEST, Batch, Messages, batch_of
from ltlc.inputs.recordings.bags.scalars import MisfitError
from ltlc.inputs.recordings.blocks import Places

MAGIC = b"\x28\xb5\x2f\xfd"
"""How what zstd has compressed begins; no message does."""

ENOUGH = 1 << 23
"""So many bytes of messages, decompressed, are made into rows at once: these can take eight times as many."""


def portions(batch: Batch) -> Iterator[Batch]:
    """`batch` in parts of about `ENOUGH` bytes when its messages are decompressed, or of one message that is larger."""
    if not batch.messages:
        yield batch
        return
    every = list(batch.messages.values())
    places = np.concatenate([messages.places for messages in every])
    order = places.argsort()
    ends = np.concatenate([_sizes(messages) for messages in every])[order].cumsum()
    cuts = np.flatnonzero(np.diff((ends - 1) // ENOUGH)) + 1
    if not cuts.size:
        yield batch
        return
    times = np.concatenate([messages.times for messages in every])[order]
    following = np.minimum.accumulate(times[::-1])[::-1][cuts].tolist()
    edges = [-1, *places[order][cuts].tolist(), batch.extent]
    for first, end, time in zip(edges[:-1], edges[1:], [*following, None], strict=True):
        part = {topic: _between(messages, first, end) for topic, messages in batch.messages.items()}
        yield Batch(part, batch.next if time is None or batch.next is None else min(batch.next, time))


def _between(messages: Messages, first: int, end: int) -> Messages:
    """Those at the places from `first` to before `end`."""
    return messages.taken(np.arange(*messages.places.searchsorted([first, end])))


def _sizes(messages: Messages) -> Places:
    """How large each claims to be when it is decompressed; one that claims too much is not decompressed."""
    if not _is_packed(messages):
        return messages.sizes
    return np.array([min(_claimed(each), LARGEST) for each in messages.raw()], np.int64)


def _claimed(raw: bytes | memoryview) -> int:
    """The size that a compressed message claims to have; beyond any limit if it claims none, or is damaged."""
    import zstandard

    if not is_packed(raw):
        return len(raw)
    try:
        claimed = zstandard.frame_content_size(raw)
    except zstandard.ZstdError:
        return LARGEST + 1
    return LARGEST if claimed < 0 else claimed


def unpacked(messages: Messages) -> Messages:
    """The messages as they were before compression. Raises MisfitError."""
    if not _is_packed(messages):
        return messages
    import zstandard

    decompressor = zstandard.ZstdDecompressor()
    data = [message_in(each, decompressor) for each in messages.raw()]
    return batch_of(data, messages.times, messages.places)


def _is_packed(messages: Messages) -> bool:
    """Whether they are compressed, as the first of them is."""
    if not len(messages):
        return False
    start = int(messages.starts[0])
    return is_packed(messages.data[start : start + len(MAGIC)].tobytes())


def is_packed(message: bytes | memoryview) -> bool:
    """Whether it is compressed."""
    return message[: len(MAGIC)] == MAGIC


def message_in(raw: bytes | memoryview, decompressor: Any) -> bytes | memoryview:
    """The message that may be compressed, which zstandard's `decompressor` takes. Raises MisfitError."""
    import zstandard

    if not is_packed(raw):
        return raw
    if _claimed(raw) > LARGEST:
        raise MisfitError
    try:
        message: bytes = decompressor.decompress(raw, max_output_size=LARGEST)
        return message
    except (zstandard.ZstdError, MemoryError):
        raise MisfitError from None
