"""The rows of several topics as one sequence in the order of time, without holding more than a part of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from functools import cached_property
from sys import getsizeof

import numpy as np
from numpy.typing import NDArray

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Array, Block, Places, Ragged, Samples, joined
from ltlc.inputs.recordings.rows import LONGEST_GAP
from ltlc.runtime.times import SECOND
from ltlc.semantics.durations import Nanoseconds

WITHIN_TOPIC = SECOND
"""Messages of one topic may be recorded so much out of order: more is a clock that was set back."""

BETWEEN_TOPICS = 10 * SECOND
"""So much later than those of other topics may the messages of a topic be recorded."""

ENOUGH = 1 << 16
"""So many rows make a block."""

ENOUGH_BYTES = 1 << 22
"""Or so many bytes of arrays and strings."""

MOST_BYTES = 1 << 26
"""So many bytes of rows wait for others at most: then the earlier half of them does not wait any longer."""

EACH, OF_SAMPLE = 16, 16
"""So many bytes each row takes, and each of its samples, arrays and strings apart."""


@dataclass(frozen=True)
class Rows:
    """Messages of a topic: their times, where they stand among those of other topics, and samples by signal."""

    times: NDArray[np.int64]
    places: NDArray[np.int64]
    samples: Mapping[str, Samples]

    def __len__(self) -> int:
        return len(self.times)

    @cached_property
    def size(self) -> int:
        """How many bytes their arrays and strings have."""
        return sum(_size(samples.values) for samples in self.samples.values())

    @property
    def whole_size(self) -> int:
        """How many bytes they take in all."""
        return self.size + len(self) * EACH + sum(len(of.rows) for of in self.samples.values()) * OF_SAMPLE

    @cached_property
    def span(self) -> tuple[Nanoseconds, Nanoseconds]:
        """The first and the last of their times, of which there is one at least."""
        return int(self.times.min()), int(self.times.max())

    def between(self, first: int, end: int) -> Rows:
        """Those from the number `first` to before `end`."""
        samples = {name: of.between(first, end) for name, of in self.samples.items()}
        return Rows(self.times[first:end], self.places[first:end], samples)

    def taken(self, chosen: Places) -> Rows:
        """The `chosen` ones, in that order."""
        where = np.full(len(self.times), -1, np.int64)
        where[chosen] = np.arange(len(chosen))
        samples = {}
        for name, of in self.samples.items():
            kept = np.flatnonzero(where[of.rows] >= 0)
            moved = Samples(where[of.rows[kept]], of.taken(kept).values)
            samples[name] = moved.taken(moved.rows.argsort())
        return Rows(self.times[chosen], self.places[chosen], samples)

    def in_order(self) -> Rows:
        """In the order of time; of those with the same time, in the order of the recording."""
        if (np.diff(self.times) >= 0).all():
            return self
        return self.taken(np.lexsort((self.places, self.times)))


def _size(values: Array | Ragged) -> int:
    """How many bytes arrays and strings have."""
    if isinstance(values, Ragged):
        return values.elements.nbytes
    return sum(map(getsizeof, values)) if values.dtype == object else 0


def stacked(parts: Sequence[Rows]) -> Rows:
    """All rows of a topic, of which there is one part at least, in the order of the parts."""
    if len(parts) == 1:
        return parts[0]
    firsts = np.cumsum([0, *(len(part) for part in parts)])[:-1].tolist()
    samples = {
        name: joined(
            [
                Samples(part.samples[name].rows + first, part.samples[name].values)
                for first, part in zip(firsts, parts, strict=True)
            ]
        )
        for name in parts[0].samples
    }
    times = np.concatenate([part.times for part in parts])
    return Rows(times, np.concatenate([part.places for part in parts]), samples)


@dataclass
class Disorder:
    """What was irregular about the times of a topic: how many came late, by how much at most, and how many at once."""

    late: int = 0
    most: Nanoseconds = 0
    together: int = 0
    latest: Nanoseconds | None = None
    last: Nanoseconds | None = None

    def first_back(self, times: NDArray[np.int64]) -> int | None:
        """The number of the first of the next times that goes back too far, if one does."""
        far = np.flatnonzero(self._newest(times)[1:] - times > WITHIN_TOPIC)
        return int(far[0]) if far.size else None

    def watch(self, times: NDArray[np.int64]) -> None:
        """Take note of the next times of the recording, of which there is one at least."""
        newest = self._newest(times)
        behind = newest[1:] - times
        self.late += int((behind > 0).sum())
        self.most = max(self.most, int(behind.max()))
        before = times[:1] - 1 if self.last is None else [self.last]
        self.together += int((np.diff(np.concatenate([before, times])) == 0).sum())
        self.latest, self.last = int(newest[-1]), int(times[-1])

    def _newest(self, times: NDArray[np.int64]) -> NDArray[np.int64]:
        """The latest time before the first of `times`, and up to each of them."""
        before = times[:1] if self.latest is None else [self.latest]
        return np.maximum.accumulate(np.concatenate([before, times]))


@dataclass
class Merger:
    """Rows on their way from the order of the recording to that of time."""

    waiting: dict[str, list[Rows]] = field(default_factory=dict)
    disorders: dict[str, Disorder] = field(default_factory=dict)
    newest: Nanoseconds | None = None
    last: Nanoseconds | None = None
    is_short: bool = False
    """Whether rows had to go before it was known that no earlier ones come."""

    def first_back(self, topic: str, rows: Rows) -> int | None:
        """The number of the first of more rows of a topic that is earlier than it may be, if one is."""
        back = self.disorders.setdefault(topic, Disorder()).first_back(rows.times)
        early = [] if self.last is None else np.flatnonzero(rows.times < self.last)[:1].tolist()
        return min([*early, *([] if back is None else [back])], default=None)

    def add(self, topic: str, rows: Rows) -> None:
        """Take more rows of a topic, none of which is earlier than it may be."""
        if not len(rows):
            return
        self.disorders.setdefault(topic, Disorder()).watch(rows.times)
        newest = int(rows.times.max())
        self.newest = newest if self.newest is None else max(self.newest, newest)
        self.waiting.setdefault(topic, []).append(rows)

    @property
    def is_enough(self) -> bool:
        """Whether what waits is worth a block."""
        waiting = self._parts
        return sum(rows.size for rows in waiting) >= ENOUGH_BYTES or sum(map(len, waiting)) >= ENOUGH

    @property
    def _parts(self) -> list[Rows]:
        return [rows for parts in self.waiting.values() for rows in parts]

    def settled(self, following: Nanoseconds | None) -> Block:
        """The rows before which no other can come, where what follows is not before the time `following`, if known.

        If too much waits, also those before which others could come, which is then an error.
        """
        if following is None and self.newest is not None:
            following = self._between_parts(self.newest - BETWEEN_TOPICS)
        least = self._least()
        if following is not None and least is not None and following < least:
            following, self.is_short = least, True
        return self._released(following)

    def _least(self) -> Nanoseconds | None:
        """The time before which rows have to go because too much waits, if it does."""
        parts = sorted(self._parts, key=lambda rows: rows.span[1])
        left = sum(rows.whole_size for rows in parts)
        if left <= MOST_BYTES:
            return None
        for rows in parts:
            left -= rows.whole_size
            if left <= MOST_BYTES // 2:
                return rows.span[1] + 1
        return None

    def _between_parts(self, end: Nanoseconds) -> Nanoseconds:
        """The time `end`, or one before it at which no part is cut in two: what is left would be joined by copying."""
        spans = [rows.span for rows in self._parts]
        return min([end, *(first for first, last in spans if first < end <= last)])

    def rest(self) -> Block:
        """All the rows that wait."""
        return self._released(None)

    def _released(self, end: Nanoseconds | None) -> Block:
        """The rows before the time `end`, and all if that is None."""
        ready = {}
        for topic, parts in self.waiting.items():
            begun = [n for n, rows in enumerate(parts, 1) if end is None or rows.span[0] < end]
            if not begun:
                continue
            rows = stacked(parts[: begun[-1]]).in_order()
            count = len(rows) if end is None else int(rows.times.searchsorted(end))
            ready[topic] = rows.between(0, count)
            left = [rows.between(count, len(rows))] if count < len(rows) else []
            self.waiting[topic] = left + parts[begun[-1] :]
        block = _merged({topic: rows for topic, rows in ready.items() if len(rows)})
        self.last = int(block.times[-1]) if len(block.times) else self.last
        return block


def _merged(topics: Mapping[str, Rows]) -> Block:
    """The rows of all topics, which are in order each."""
    if not topics:
        return Block(np.array([], np.int64), {}, {})
    times = np.concatenate([rows.times for rows in topics.values()])
    order = np.lexsort((np.concatenate([rows.places for rows in topics.values()]), times))
    rank = np.empty(len(times), np.int64)
    rank[order] = np.arange(len(times))
    samples: dict[str, Samples] = {}
    messages: dict[str, Places] = {}
    first = 0
    for topic, rows in topics.items():
        own = rank[first : first + len(rows)]
        samples |= {name: Samples(own[of.rows], of.values) for name, of in rows.samples.items()}
        if all(len(of.rows) < len(rows) for of in rows.samples.values()):
            messages[topic] = own
        first += len(rows)
    return Block(times[order], samples, messages)


def change_of_clocks(times: NDArray[np.int64], before: Nanoseconds | None) -> int | None:
    """The number of the first row that is more than a year after the one before it, if there is one."""
    previous = times[:1] if before is None else np.array([before], np.int64)
    far = np.flatnonzero(np.diff(np.concatenate([previous, times])) > LONGEST_GAP)
    return int(far[0]) if far.size else None


def watched(blocks: Iterator[Block], extent: tuple[Nanoseconds, Nanoseconds] | None) -> Iterator[Block]:
    """`blocks`, with time alone where the recording begins and ends, which may be with topics that nobody reads.

    An end that is more than a year away from the rows is of another clock, and is omitted. Raises RecordingError where
    `blocks` do.
    """
    if extent is None:
        yield from blocks
        return
    first, last = extent
    before: Nanoseconds | None = None
    for block in blocks:
        if before is None:
            yield block.between(None, first - 1)  # what lies in the chunk in which the recording begins, and before
            block = block.between(first, None)
            if len(block.times) and 0 < int(block.times[0]) - first <= LONGEST_GAP:
                yield _moment(first)
        before = int(block.times[-1]) if len(block.times) else before
        yield block
    if before is None and 0 <= last - first <= LONGEST_GAP:
        yield _moment(first)
        before = first
    if before is not None and 0 < last - before <= LONGEST_GAP:
        yield _moment(last)


def _moment(time: Nanoseconds) -> Block:
    """A row in which nothing came."""
    return Block(np.array([time], np.int64), {}, {})
