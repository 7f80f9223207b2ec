"""Flight logs of PX4, in the format ULog, as bags of ROS 2.

A log has the format of each of its topics, all of whose fields have a fixed place. That makes a definition of ROS 2,
and a layout by which all messages of a topic become CDR at once.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from functools import cache
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.provenance import digest_of
from ltlc.base.source import Source
from ltlc.inputs.messages.definitions import FieldType
from ltlc.inputs.messages.definitions import Message as Definition
from ltlc.inputs.messages.texts import text_of
from ltlc.inputs.recordings.bags import ulog_records as records
from ltlc.inputs.recordings.bags.chunked import Message
from ltlc.inputs.recordings.bags.mcap_records import Channel, Contents, Schema
from ltlc.inputs.recordings.bags.messages import (
    LATEST,
    PX4_MESSAGES,
    Batch,
    Messages,
    Topic,
    batch_of,
    gathered,
    numbers_at,
    span_of,
)
from ltlc.inputs.recordings.bags.ulog_layout import LITTLE_ENDIAN, TYPES, Layout, is_padding
from ltlc.inputs.recordings.bags.ulog_records import BODY, MICROSECOND, DamageError
from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.inputs.recordings.rows import failure
from ltlc.runtime.mcap import metadata
from ltlc.runtime.reports import counted
from ltlc.runtime.times import SECOND, seconds_text, span_text
from ltlc.semantics.durations import Nanoseconds

FOLDER = "/fmu/out/"
"""Before the name of a topic, where PX4 publishes it to ROS 2."""

RECENT = SECOND
"""The last message of each topic before a log begins is in it, too. Its time counts if it is not older than this;
otherwise it stands where the run begins."""

PARAMETERS = "parameters"
"""The topic of the parameters: all of them when the log begins, and again whenever one changes."""


class _Logged(NamedTuple):
    """A topic of a log: how its messages lie in it, at which bytes, and their times in ns, in the order of these."""

    format: str
    layout: Layout
    places: Places
    times: NDArray[np.int64]


class _Scan:
    """A log that was looked through: its `data`, what is in them, and its topics up to its damage, by name.

    Raises DamageError.
    """

    def __init__(self, data: Array) -> None:
        self.data = data
        self.log = records.read(data)
        self.logged = self._topics()

    def _topics(self) -> dict[str, _Logged]:
        log, found = self.log, {}
        every, fits = self._chosen(), np.zeros(len(log.places), np.bool_)
        layouts = {format: Layout(log.formats, format) for format, _ in every}
        for (format, _), chosen in every.items():
            layout, sizes = layouts[format], log.sizes[chosen]
            fits[chosen] = (layout.least <= sizes) & (sizes <= layout.most)
        if not fits.all():
            end = int(fits.argmin())
            log.damage = f"the message at byte {log.places[end]} is not in the format of its topic"
            log.places = log.places[:end]
        times = np.zeros(len(log.places), np.int64)
        for (format, _), chosen in every.items():
            known = chosen[: chosen.searchsorted(len(times))]
            moments = numbers_at(self.data, log.places[known] + BODY + layouts[format].time, "<u8")
            times[known] = np.minimum(moments, LATEST // MICROSECOND).astype(np.int64) * MICROSECOND
        is_old = times < log.begin - RECENT
        times[is_old] = times[~is_old].min(initial=log.begin)
        for (format, instance), chosen in every.items():
            known = chosen[: chosen.searchsorted(len(times))]
            known = known[times[known].argsort(kind="stable")]
            name = f"{format}[{instance}]" if instance else format
            found[name] = _Logged(format, layouts[format], log.places[known], times[known])
        self._times = np.maximum.accumulate(times)
        return found

    def time(self, place: int) -> Nanoseconds:
        """When the log was written up to this byte."""
        before = int(self.log.places.searchsorted(place))
        return int(self._times[before - 1]) if before else self.log.begin

    def _chosen(self) -> dict[tuple[str, int], Places]:
        """Which of the logged messages are those of each format and instance, in the order of the log."""
        log = self.log
        order = log.numbers.argsort(kind="stable")
        numbers, ends = log.numbers[order], dict[int, int]()
        found: dict[tuple[str, int], Places] = {}
        for each in reversed(log.subscriptions):
            chosen = order[numbers.searchsorted(each.number) : numbers.searchsorted(each.number, "right")]
            first, end = log.places[chosen].searchsorted([each.since, ends.get(each.number, len(self.data))])
            key = each.format, each.instance
            found[key] = np.concatenate([chosen[first:end], found.get(key, chosen[:0])])
            ends[each.number] = each.since
        return dict(reversed(found.items()))


LAST: dict[str, _Scan] = {}
"""The log that was looked through last, by its SHA-256: a command asks for its types and topics before it judges it."""


def _scanned(path: Path) -> _Scan:
    """The log at `path`, looked through. Raises OSError and DamageError."""
    digest = digest_of(path, path.name).sha256
    found = LAST.get(digest)
    if found is None:
        LAST.clear()
        found = LAST[digest] = _Scan(np.fromfile(path, np.uint8))
    return found


class ULogStorage:
    """A `.ulg` file. Raises RecordingError if it is not one.

    The last part of a topic's name says which it is, with its instance: `battery_status`, `battery_status[1]`. Those
    that are `wanted` have the name and the type by which they are wanted, and all have those that PX4 gives them in
    ROS 2, as in `/fmu/out/battery_status` of `px4_msgs/BatteryStatus`.
    """

    distribution = ""

    def __init__(self, path: Path, wanted: Mapping[str, str]) -> None:
        self._path = path
        try:
            self._scan = _scanned(path)
        except OSError as error:
            raise failure("LTL902", path, f"`{path}` cannot be read: {error.strerror}") from None
        except DamageError as error:
            raise failure("LTL811", path, f"`{path}` cannot be read as a flight log: {error}") from None
        self._parameters = self._messages_of_parameters()
        names = [*self._scan.logged, *([PARAMETERS] if len(self._parameters) else ())]
        self._names = {FOLDER + name: name for name in names}
        self._names |= {topic: name for topic in wanted if (name := topic.rpartition("/")[2]) in names}
        self.topics = {topic: self._topic(name, wanted.get(topic)) for topic, name in self._names.items()}
        times = [int(time) for each in self._scan.logged.values() if each.times.size for time in each.times[[0, -1]]]
        self.span = span_of(min(times), max(times)) if times else None

    def _messages_of_parameters(self) -> Messages:
        """All parameters at the beginning of the log, and after each change; one that comes later was as it is then."""
        values: dict[str, bytes] = {}
        for each in self._scan.log.parameters:
            values.setdefault(each.name, each.value)
        found: dict[Nanoseconds, bytes] = {}
        for time, changes in groupby(self._scan.log.parameters, lambda each: self._scan.time(each.since)):
            values |= {each.name: each.value for each in changes}
            found[time] = LITTLE_ENDIAN + b"".join(values.values())
        return batch_of(list(found.values()), list(found), range(len(found)))

    def _topic(self, name: str, type_: str | None) -> Topic:
        """A topic whose messages have this type, or that of PX4."""
        types: dict[str, Definition] = {}
        if name == PARAMETERS:
            fields = {each.name: FieldType(TYPES[each.type]) for each in self._scan.log.parameters}
            top, count = Definition(fields, {}), len(self._parameters)
        else:
            logged = self._scan.logged[name]
            top, count = self._message(logged.format, types), len(logged.places)
        type_ = type_ or _type_of(name.partition("[")[0])
        return Topic(type_, "cdr", "ros2msg", text_of(type_, types | {type_: top}), count)

    def _message(self, format: str, types: dict[str, Definition]) -> Definition:
        """The message that a format is, with those that it contains put among `types`."""
        fields = {}
        for part in self._scan.log.formats[format]:
            if not is_padding(part):
                fields[part.name] = FieldType(TYPES.get(part.base, _type_of(part.base)), part.length)
                if part.base not in TYPES:
                    types[_type_of(part.base)] = self._message(part.base, types)
        return Definition(fields, {})

    @property
    def remarks(self) -> list[Diagnostic]:
        """That something was not logged, if the log says so."""
        dropouts = self._scan.log.dropouts
        if not dropouts:
            return []
        place, longest = max(dropouts, key=lambda dropout: dropout[1])
        lost = f"{counted(len(dropouts), 'dropout')}, {span_text(sum(lost for _, lost in dropouts))} in all"
        message = f"messages are missing in the log: {lost}, the longest of {span_text(longest)}"
        help = f"that one was at {seconds_text(self._scan.time(place))} s; what happened meanwhile was not judged"
        return [diagnostic("LTL819", Source(str(self._path), ""), None, message, help=help)]

    def batches(self, topics: Collection[str], since: Nanoseconds, until: Nanoseconds) -> Iterator[Batch]:
        """The messages of `topics` in the order of time. Raises RecordingError after those before a damage."""
        found = {topic: self._messages(self._names[topic], since, until) for topic in topics}
        yield Batch(_in_order(found), LATEST)
        if self._scan.log.damage:
            message = f"`{self._path}` is damaged: {self._scan.log.damage}"
            raise failure("LTL811", self._path, message, "the verdicts are about what comes before the damage")

    def _messages(self, name: str, since: Nanoseconds, until: Nanoseconds) -> Messages:
        """Those of a topic in these times; their places are bytes of the log."""
        if name == PARAMETERS:
            times = self._parameters.times
            return self._parameters.taken(np.flatnonzero((times >= since) & (times <= until)))
        logged = self._scan.logged[name]
        first, end = logged.times.searchsorted(since), logged.times.searchsorted(until, "right")
        places = logged.places[first:end]
        sizes = np.full(len(places), logged.layout.least)
        data, size = logged.layout.written(gathered(self._scan.data, places + BODY, sizes))
        starts = np.arange(len(places)) * size
        return Messages(logged.times[first:end], places, data, starts, np.full(len(places), size))

    def contents(self) -> Contents:
        """Its topics as schemas and channels of MCAP."""
        contents = Contents()
        for number, (name, topic) in enumerate(self.topics.items(), 1):
            contents.schemas[number] = Schema(topic.type.replace("/msg/", "/"), topic.form, topic.definition.encode())
            contents.channels[number] = Channel(number, name, topic.serialization, metadata({}))
        return contents

    def items(self, since: Nanoseconds, until: Nanoseconds) -> Iterator[Message]:
        """The messages logged from `since` to `until`. Raises RecordingError."""
        for batch in self.batches(self.topics, since, until):
            found = [
                (place, Message(number, 0, time, time, raw))
                for number, messages in enumerate(batch.messages.values(), 1)
                for place, time, raw in zip(messages.places, messages.times.tolist(), messages.raw(), strict=True)
            ]
            yield from (message for _, message in sorted(found, key=itemgetter(0)))


def _in_order(found: Mapping[str, Messages]) -> dict[str, Messages]:
    """The same, with places by time; in the order of the log where times are equal."""
    if not found:
        return {}
    every = list(found.values())
    order = np.lexsort(tuple(np.concatenate([getattr(each, key) for each in every]) for key in ("places", "times")))
    ranks = np.empty(len(order), np.int64)
    ranks[order] = np.arange(len(order))
    ends = np.cumsum([len(each) for each in every])[:-1]
    return {
        topic: replace(each, places=of) for (topic, each), of in zip(found.items(), np.split(ranks, ends), strict=True)
    }


@cache
def _type_of(name: str) -> str:
    """The type that PX4 has for a topic or for a format inside of others: `px4_msgs/msg/BatteryStatus`."""
    return f"{PX4_MESSAGES}/msg/" + "".join(part[:1].upper() + part[1:] for part in name.split("_"))
