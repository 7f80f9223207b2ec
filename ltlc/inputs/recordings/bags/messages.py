"""What the storages of bags have in common: topics, and messages as they were serialised."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ltlc.base.diagnostics import Diagnostic
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.runtime.times import NEVER
from ltlc.semantics.durations import Nanoseconds

_Integers = Sequence[int] | NDArray[np.int64]

LATEST = 2**63 - 1
"""Later than any message."""

LARGEST = 1 << 27
"""No message is larger, and no chunk of messages; what claims to be, unpacked or not, is not read."""

PX4_MESSAGES = "px4_msgs"
"""The package that defines the messages of PX4."""

FEW = 1 << 16
"""So many views of data there are at once."""


@dataclass(frozen=True, slots=True)
class Topic:
    """A recorded topic: the type of its messages as a full name, how they are serialised, and their definition.

    `definition` is text in the form `form` (`ros2msg`, `ros2idl`, `ros1msg`), or empty. The storage says that there are
    `count` messages, unless that is None.
    """

    type: str
    serialization: str
    form: str
    definition: str
    count: int | None


@dataclass(frozen=True, slots=True)
class Messages:
    """Messages of one topic in the order of the recording: each lies in `data` from its start on, and has a size.

    `times` are those at which they were recorded, in ns; `places` order them among those of other topics in the batch.
    """

    times: NDArray[np.int64]
    places: NDArray[np.int64]
    data: Array
    starts: Places
    sizes: Places

    def __len__(self) -> int:
        return len(self.times)

    def first(self, count: int) -> Messages:
        """The first ones."""
        return self.taken(np.arange(count))

    def raw(self) -> list[memoryview]:
        """The bytes of each."""
        data: memoryview = self.data.data
        ends = (self.starts + self.sizes).tolist()
        return [data[start:end] for start, end in zip(self.starts.tolist(), ends, strict=True)]

    def taken(self, chosen: Places) -> Messages:
        """The `chosen` ones."""
        starts, sizes = self.starts[chosen], self.sizes[chosen]
        return Messages(self.times[chosen], self.places[chosen], self.data, starts, sizes)

    def moved(self, by: int) -> Messages:
        """With places that are higher by so much."""
        return Messages(self.times, self.places + by, self.data, self.starts, self.sizes)

    def behind(self, size: int) -> Messages:
        """As they are when their data lie behind others of this size."""
        return Messages(self.times, self.places, self.data, self.starts + size, self.sizes)


@dataclass(frozen=True, slots=True)
class Batch:
    """Messages by topic, all later in the recording than those before.

    What follows in the file was not recorded before `next`; None: that is not known.
    """

    messages: Mapping[str, Messages]
    next: Nanoseconds | None = None

    @property
    def extent(self) -> int:
        """More than the place of each of its messages."""
        return max((int(each.places[-1]) + 1 for each in self.messages.values() if len(each)), default=0)


def span_of(first: Nanoseconds, last: Nanoseconds) -> tuple[Nanoseconds, Nanoseconds] | None:
    """The times of the first and the last message; None if a clock cannot show these."""
    return (first, last) if 0 <= first <= last < NEVER else None


class Storage(Protocol):
    """A file of a bag."""

    @property
    def topics(self) -> Mapping[str, Topic]:
        """The topics, by name."""
        ...

    @property
    def distribution(self) -> str:
        """The distribution of ROS 2 that recorded it, such as `humble`; empty if unknown."""
        ...

    @property
    def span(self) -> tuple[Nanoseconds, Nanoseconds] | None:
        """When the first and the last message were recorded; None if that is not known, or there is none."""
        ...

    @property
    def remarks(self) -> Sequence[Diagnostic]:
        """What was irregular about the file, as far as that is known before it is read."""
        ...

    def batches(self, topics: Collection[str], since: Nanoseconds, until: Nanoseconds) -> Iterator[Batch]:
        """The messages of `topics` in the order of the file; those outside the times may be omitted.

        The data of a batch are gone when the next is taken. Raises RecordingError after those that could be read.
        """
        ...


def batch_of(data: Sequence[bytes | memoryview], times: _Integers, places: _Integers) -> Messages:
    """Messages, one after the other."""
    sizes = np.fromiter(map(len, data), np.int64, len(data))
    joined = np.frombuffer(b"".join(data), np.uint8)
    return Messages(np.asarray(times, np.int64), np.asarray(places, np.int64), joined, sizes.cumsum() - sizes, sizes)


def numbers_at(data: Array, places: Places, kind: str) -> Array:
    """The numbers of a kind, such as `<u4`, at these places in `data`. Raises IndexError beyond its end."""
    dtype = np.dtype(kind)
    anywhere = np.ndarray((max(0, len(data) - dtype.itemsize + 1),), dtype, data, 0, (1,))
    found: Array = anywhere[places]
    return found


def gathered(data: Array, starts: Places, sizes: Places) -> Array:
    """The bytes of `data` from each of `starts` on, side by side; all have to be there."""
    size = int(sizes[0]) if sizes.size else 0
    if size and (sizes == size).all():
        anywhere = np.ndarray((len(data) - size + 1,), f"V{size}", data, 0, (1,))
        return anywhere[starts].view(np.uint8)
    raw: memoryview = data.data
    parts = []
    for first in range(0, len(starts), FEW):  # a view is larger than most messages
        some, of = starts[first : first + FEW], sizes[first : first + FEW]
        pairs = zip(some.tolist(), (some + of).tolist(), strict=True)
        parts.append(b"".join([raw[start:end] for start, end in pairs]))
    return np.frombuffer(parts[0] if len(parts) == 1 else b"".join(parts), np.uint8)


class Room:
    """Where the data of a batch lie, and then those of the next: to get memory takes longer than to fill it."""

    def __init__(self, capacity: int) -> None:
        self.data: Array = np.empty(capacity, np.uint8)
        self.size = 0

    def add(self, data: Array) -> None:
        """Put `data` behind those that are there."""
        end = self.size + len(data)
        if end > len(self.data):
            kept = self.data[: self.size]
            self.data = np.empty(max(end, 2 * len(self.data)), np.uint8)
            self.data[: self.size] = kept
        self.data[self.size : end] = data
        self.size = end

    def clear(self) -> None:
        """Begin the next batch."""
        self.size = 0
