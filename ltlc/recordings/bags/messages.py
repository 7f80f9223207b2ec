"""What the storages of bags have in common: topics, and messages as they were serialised."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ltlc.recordings.blocks import Array, Places
from ltlc.semantics.durations import Nanoseconds

_Integers = Sequence[int] | NDArray[np.int64]

LATEST = 2**63 - 1
"""Later than any message."""


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


class Storage(Protocol):
    """A file of a bag."""

    @property
    def topics(self) -> Mapping[str, Topic]:
        """The topics, by name."""
        ...

    @property
    def span(self) -> tuple[Nanoseconds, Nanoseconds] | None:
        """When the first and the last message were recorded; None if that is not known, or there is none."""
        ...

    def batches(self, topics: Collection[str], since: Nanoseconds, until: Nanoseconds) -> Iterator[Batch]:
        """The messages of `topics` in the order of the file; those outside the times may be left out.

        Raises RecordingError after those that could be read.
        """
        ...


def together(parts: Sequence[Messages]) -> Messages:
    """Messages of one topic, those of each part later in the recording than those before."""
    if len(parts) == 1:
        return parts[0]
    times, places = (np.concatenate([getattr(part, name) for part in parts]) for name in ("times", "places"))
    return batch_of([each for part in parts for each in part.raw()], times, places)


def batch_of(data: Sequence[bytes | memoryview], times: _Integers, places: _Integers) -> Messages:
    """Messages, one after the other."""
    sizes = np.fromiter(map(len, data), np.int64, len(data))
    joined = np.frombuffer(b"".join(data), np.uint8)
    return Messages(np.asarray(times, np.int64), np.asarray(places, np.int64), joined, sizes.cumsum() - sizes, sizes)
