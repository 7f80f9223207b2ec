"""Bags of ROS: rosbag2 folders, MCAP files and databases, bags of ROS 1, flight logs: fields as columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.source import Source
from ltlc.inputs.messages.definitions import MessageTypes
from ltlc.inputs.recordings.bags.compressed import portions
from ltlc.inputs.recordings.bags.definitions import GIVEN, RECORDING, NonsenseError, distribution_name
from ltlc.inputs.recordings.bags.folders import bag_at, is_bag, is_flight_log, is_packed, opened
from ltlc.inputs.recordings.bags.merging import Merger, Rows, change_of_clocks, watched
from ltlc.inputs.recordings.bags.messages import LATEST, Batch, Messages, Storage, Topic
from ltlc.inputs.recordings.bags.plan import Plan, absolute, of_all_files
from ltlc.inputs.recordings.bags.scalars import MisfitError
from ltlc.inputs.recordings.bags.simulated import other_pace
from ltlc.inputs.recordings.blocks import Block
from ltlc.inputs.recordings.fence import fenced
from ltlc.inputs.recordings.reading import ReadOptions, Stamp
from ltlc.inputs.recordings.rows import RecordingError, failure, outside
from ltlc.runtime.reports import counted
from ltlc.runtime.times import NEVER, seconds_text
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.expressions import Field, Signal

__all__ = ["BagRecording", "is_bag"]


class BagRecording:
    """A bag, of which the wanted signals are read. Raises RecordingError if it cannot be used."""

    def __init__(self, path: Path, signals: Mapping[str, Signal], reading: ReadOptions) -> None:
        self._path = path
        self._reading = reading
        definitions = (signal.definition for signal in signals.values())
        wanted = {field.topic: field.message for field in definitions if isinstance(field, Field)}
        self._opened = partial(opened, wanted=wanted)
        self._bag = bag_at(path)
        self._unusable: RecordingError | None = None
        self._storages: dict[Path, Storage | None] = {}
        self._of_files: list[Diagnostic] = []
        self._spans: list[tuple[Nanoseconds, Nanoseconds] | None] = []
        self._distribution = self._bag.distribution
        self._topics = of_all_files(list(self._looked_at()))
        try:
            self._plan = Plan(self._topics, signals, reading, self._distribution)
        except NonsenseError as error:
            raise failure("LTL811", path, f"`{path}` is damaged: it contains an invalid definition: {error}") from None
        self._merger = Merger()
        self._read: dict[str, int] = {}
        self._next_place = 0

    def _looked_at(self) -> Iterator[Mapping[str, Topic]]:
        """The topics of each file, up to one that cannot be used; of the first, this is raised."""
        for file in self._bag.files:
            try:
                with self._opened(file) as storage:
                    self._spans.append(storage.span)
                    self._of_files += storage.remarks
                    self._distribution = self._distribution or storage.distribution
                    self._storages[file] = None if is_packed(file) else storage
                    yield storage.topics
            except RecordingError as error:
                if not self._storages:
                    raise
                self._unusable = error
                return

    @property
    def topics(self) -> Mapping[str, Topic]:
        """All that was recorded, by name; where the types of files differ, a type has them all, with commas."""
        return self._topics

    @property
    def is_flight_log(self) -> bool:
        """Whether PX4 has logged it, instead of ROS."""
        return any(is_flight_log(file) for file in self._bag.files)

    @property
    def columns(self) -> tuple[str, ...]:
        """The signals that are read."""
        return self._plan.columns

    def absence(self, name: str) -> str:
        """Why a signal is not read."""
        return self._plan.absence(name).reason

    def remedy(self, name: str) -> str:
        """What would give it a value."""
        return self._plan.absence(name).help

    @property
    def definitions(self) -> Mapping[str, str]:
        """Who defines the messages on each topic that is read."""
        return {topic: ", ".join(reader.defined.origins) for topic, reader in self._plan.readers.items()}

    @property
    def types(self) -> list[tuple[str, MessageTypes]]:
        """The types of the messages that are read, each with the definitions of all types in it."""
        return [(reader.message, reader.defined.types) for reader in self._plan.readers.values()]

    @property
    def beginning(self) -> Nanoseconds | None:
        """When its first message was recorded, on any topic; not known if messages have the times of their headers."""
        firsts = [span[0] for span in self._spans if span is not None]
        return min(firsts, default=None) if self._reading.stamp is Stamp.LOG else None

    def remarks(self) -> list[Diagnostic]:
        """What was irregular about the files and definitions, and, once they have been read, about times."""
        found = [*self._bag.remarks, *self._of_files, *self._about_definitions()]
        for topic, reader in self._plan.readers.items():
            if self._reading.stamp is Stamp.HEADER and not reader.has_stamps:
                message = f"the messages on `{topic}` have no header: the time of recording is used"
                found.append(self._remark("LTL815", message, "judge by the time of recording: `--stamp log`"))
            if reader.unstamped:
                were, their = ("was", "its header") if reader.unstamped == 1 else ("were", "their headers")
                skipped = f"{counted(reader.unstamped, 'message')} on `{topic}` {were} skipped"
                message = f"{skipped}: the time in {their} is 0"
                found.append(self._remark("LTL815", message, "judge by the time of recording: `--stamp log`"))
        return [*found, *self._about_times()]

    def _about_times(self) -> Iterator[Diagnostic]:
        """Messages that were recorded late, and those at the same time as another of their topic."""
        together: list[str] = []
        for topic, seen in sorted(self._merger.disorders.items()):
            if seen.late:
                by = f"by at most {seconds_text(seen.most)} s"
                message = f"{counted(seen.late, 'message')} on `{topic}` came late, {by}: sorted by time"
                yield self._remark("LTL814", message, "")
            if seen.together > 0:
                together.append(f"{seen.together if together else counted(seen.together, 'message')} on `{topic}`")
        if together:
            message = f"{', '.join(together)} came at the same time as the previous one: each is a step"
            yield self._remark("LTL814", message, "")
        storages, spans = list(self._storages.values()), [span for span in self._spans if span is not None]
        first, last = storages[0], storages[-1]
        if spans and first is not None and last is not None and self._reading.stamp is Stamp.LOG:
            message = other_pace(first, last, min(begin for begin, _ in spans), max(end for _, end in spans))
            if message:
                help = (
                    "`--stamp header` takes the times in headers; `ros2 bag record --use-sim-time` records by `/clock`"
                )
                yield self._remark("LTL817", message, help)

    def _about_definitions(self) -> Iterator[Diagnostic]:
        """Topics that are read by definitions that are not the recording's, and fields that others define otherwise."""
        undefined: dict[str, list[str]] = {}
        for topic, reader in self._plan.readers.items():
            if not self._read.get(topic, 1):
                continue
            for origin in set(reader.defined.origins) - {RECORDING, GIVEN}:
                undefined.setdefault(origin, []).append(f"`{topic}`")
        for origin, topics in sorted(undefined.items()):
            own = self._distribution and distribution_name(self._distribution)
            why = f"the recording is from {own}" if own else "the recording does not name its ROS distribution"
            message = f"the recording does not define all messages on {', '.join(topics)}: {origin} does; {why}"
            help = "" if origin == own else "if these are wrong, give the right ones with `--msg-path DIR`"
            yield self._remark("LTL818", message, help)
        for name, difference in self._plan.differences.items():
            message = f"`{name}` is read as the recording defines it; elsewhere {difference}"
            help = f"use the recording's definitions to check and build: `--msg-path {self._path}`"
            yield self._remark("LTL818", message, help)

    def _remark(self, code: str, message: str, help: str) -> Diagnostic:
        return diagnostic(code, Source(str(self._path), ""), None, message, help=help)

    def blocks(self) -> Iterator[Block]:
        """The rows of all topics in the order of time. Raises RecordingError after those that could be read."""
        with fenced(self._path, "LTL811"):
            yield from self._in_one_clock()

    def _in_one_clock(self) -> Iterator[Block]:
        """The rows up to where time jumps to that of another clock. Raises RecordingError there."""
        self._check_span()
        before: Nanoseconds | None = None
        for block in watched(self._merged(), self._extent):
            jump = change_of_clocks(block.times, before)
            if jump is not None:
                after = int(block.times[jump])
                before = int(block.times[jump - 1]) if jump else before
                yield block.between(None, after - 1)
                raise self._jump(before or 0, after)
            before = int(block.times[-1]) if len(block.times) else before
            yield block

    def _jump(self, before: Nanoseconds, after: Nanoseconds) -> RecordingError:
        message = f"time jumps from {seconds_text(before)} to {seconds_text(after)}, by more than a year"
        help = "a run has one clock: do some times count from the start of a simulation and others from 1970?"
        return failure("LTL804", self._path, message, help)

    @property
    def _limits(self) -> tuple[Nanoseconds, Nanoseconds] | None:
        """The times of recording of what has to be read; None: all."""
        since, until = self._reading.limits(self.beginning)
        if self._reading.stamp is Stamp.HEADER or (since is None and until is None):
            return None
        return -LATEST if since is None else since, LATEST if until is None else until

    def _check_span(self) -> None:
        """Raise RecordingError if nothing was recorded in the times that are asked for."""
        spans = [span for span in self._spans if span is not None]
        if self._limits is not None and spans and len(spans) == len(self._bag.files):
            since, until = self._limits
            first, last = min(first for first, _ in spans), max(last for _, last in spans)
            if last < since:
                raise outside(self._path, first, last)
            if first > until:
                raise outside(self._path, first, None)

    @property
    def _extent(self) -> tuple[Nanoseconds, Nanoseconds] | None:
        """From when to when messages were recorded in the times asked for, on any topic; None: that is unknown."""
        spans = [span for span in self._spans if span is not None]
        if self._reading.stamp is Stamp.HEADER or not spans:
            return None
        since, until = self._limits or (-LATEST, LATEST)
        return max(since, min(first for first, _ in spans)), min(until, max(last for _, last in spans))

    def _merged(self) -> Iterator[Block]:
        """The rows in the order of time, without a look at jumps."""
        merger = self._merger = Merger()
        self._read = dict.fromkeys(self._plan.readers, 0)
        damage: RecordingError | None = None
        try:
            for batch in self._batches():
                for part in portions(batch):
                    self._take(merger, part)
                    if merger.is_enough:
                        yield merger.settled(part.next)
        except RecordingError as error:
            damage = error
        yield merger.rest()
        if damage is not None:
            raise damage
        self._check_counts()

    def _batches(self) -> Iterator[Batch]:
        """The messages of all files. Raises RecordingError after those that could be read."""
        names = [name for name in self._topics if absolute(name) in self._plan.readers]
        since, until = self._limits or (-LATEST, LATEST)
        for number, (file, known) in enumerate(self._storages.items()):
            opening: AbstractContextManager[Storage] = self._opened(file) if known is None else nullcontext(known)
            with opening as storage:
                for batch in storage.batches([name for name in names if name in storage.topics], since, until):
                    yield replace(batch, next=self._next(batch, number))
        if self._unusable is not None:
            raise self._unusable

    def _next(self, batch: Batch, number: int) -> Nanoseconds | None:
        """No row after a batch of the file with this number is before that time; None: that is not known."""
        later = [span[0] for span in self._spans[number + 1 :] if span is not None]
        is_known = None not in self._spans[number + 1 :] and self._reading.stamp is Stamp.LOG
        return min([batch.next, *later]) if is_known and batch.next is not None else None

    def _take(self, merger: Merger, batch: Batch) -> None:
        """Give a batch to the merger as rows. Raises RecordingError after what is before the damage."""
        found: dict[str, Rows] = {}
        damages: list[tuple[int, RecordingError]] = []
        first, self._next_place = self._next_place, self._next_place + batch.extent
        for name, of_batch in batch.messages.items():
            topic, messages = absolute(name), of_batch.moved(first)
            rows, misfit = self._rows(topic, messages)
            odd = self._first_odd(messages)
            back = merger.first_back(topic, rows)
            if odd is not None:
                damages.append((int(messages.places[odd]), self._odd_time(topic, int(messages.times[odd]))))
            if misfit is not None:
                damages.append((int(messages.places[misfit]), self._misfit(topic, messages, misfit)))
            if back is not None:
                damages.append((int(rows.places[back]), self._set_back(merger, topic, rows, back)))
            self._read[topic] += len(messages)
            found[topic] = rows
        end, damage = min(damages, key=lambda each: each[0], default=(None, None))
        for topic, rows in found.items():
            merger.add(topic, rows if end is None else rows.between(0, int(rows.places.searchsorted(end))))
        if damage is not None:
            raise damage

    def _rows(self, topic: str, messages: Messages) -> tuple[Rows, int | None]:
        """Messages as rows, up to one that is not as it is defined, and the number of that."""
        reader = self._plan.readers[topic]
        try:
            return reader.rows(messages), None
        except MisfitError:
            count = reader.readable(messages)
            return reader.rows(messages.first(count)), count

    def _first_odd(self, messages: Messages) -> int | None:
        """The number of the first message that was recorded at a time that no clock shows, if that time counts."""
        odd = (messages.times < 0) | (messages.times >= NEVER)
        return int(odd.argmax()) if odd.any() and self._reading.stamp is Stamp.LOG else None

    def _odd_time(self, topic: str, time: Nanoseconds) -> RecordingError:
        message = f"a message on `{topic}` has the impossible time {seconds_text(time)} s"
        return failure(
            "LTL811",
            self._path,
            message,
            "times must be before the year 2116; the verdicts are about what comes before",
        )

    def _set_back(self, merger: Merger, topic: str, rows: Rows, number: int) -> RecordingError:
        times = [*rows.times[:number].tolist(), *([] if merger.newest is None else [merger.newest])]
        moments = f"from {seconds_text(max(times))} to {seconds_text(int(rows.times[number]))}"
        message = f"time goes back {moments}, with a message on `{topic}`"
        help = "a restarted simulation or a clock that was set back begins another run: split the recording there"
        if merger.is_short:
            help = "messages are too far out of order to be sorted while reading: sort it first, as with `mcap sort`"
        return failure("LTL804", self._path, message, help)

    def _misfit(self, topic: str, messages: Messages, number: int) -> RecordingError:
        """What is wrong with the one of `messages` that has this number."""
        reader = self._plan.readers[topic]
        is_what = reader.misfit(messages.taken(np.array([number])))
        where = f"the message on `{topic}` at {seconds_text(int(messages.times[number]))} s"
        read = self._read[topic] + number
        after = f"after {read} on this topic" if read else "the first on this topic"
        origins = " and ".join(reader.defined.origins)
        message = f"{where}, {after}, {is_what} `{reader.message}` as {origins} defines it"
        help = "it is damaged, or its definition is that of another version: give the right one with `--msg-path DIR`"
        if reader.defined.origins == (RECORDING,):
            help = "it is damaged, or the definition in the recording does not match its messages"
        return failure("LTL811", self._path, message, help)

    def _check_counts(self) -> None:
        """Raise RecordingError if the bag says that it has other messages than were read."""
        if self._limits is not None:
            return
        said = {absolute(name): topic.count for name, topic in self._topics.items() if topic.count is not None}
        counts = {absolute(name): count for name, count in (self._bag.counts or {}).items()}
        for source, numbers in (("its index", said), ("its metadata", counts)):
            for topic, count in {**dict.fromkeys(self._plan.missing, 0), **self._read}.items():
                if numbers.get(topic, count) != count:
                    message = f"{count} messages on `{topic}` were read, but {source} counts {numbers[topic]}"
                    help = "the verdicts are about what was read; `ros2 bag reindex` repairs a wrong count"
                    raise failure("LTL812", self._path, message, help)
