"""What is read of a bag: of each topic the fields that signals are read from, and why others are not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from functools import cached_property

import numpy as np

from ltlc.base.nearest import did_you_mean, nearest_first
from ltlc.dataclass import dataclass
from ltlc.inputs.messages.definitions import JAZZY, FieldType, MessageTypes
from ltlc.inputs.messages.texts import full_name
from ltlc.inputs.recordings.bags import cdr
from ltlc.inputs.recordings.bags.choices import Path
from ltlc.inputs.recordings.bags.compressed import unpacked
from ltlc.inputs.recordings.bags.definitions import (
    RECORDING,
    Defined,
    Layer,
    UnknownTypeError,
    merged,
    misfit,
    other_layers,
    types_of,
)
from ltlc.inputs.recordings.bags.merging import Rows
from ltlc.inputs.recordings.bags.messages import Messages, Topic
from ltlc.inputs.recordings.bags.scalars import MisfitError
from ltlc.inputs.recordings.blocks import Places, Ragged, Samples, kind_of
from ltlc.inputs.recordings.reading import ReadOptions, Stamp, kept_name
from ltlc.inputs.recordings.rows import Column
from ltlc.runtime.times import SECOND
from ltlc.specification.expressions import Field, Signal

_STAMP = (("header", "stamp", "sec"), ("header", "stamp", "nanosec"))
_OFFERED = 5
"""So many topics are listed where one is missing."""


@dataclass(frozen=True, slots=True)
class Absence:
    """Why a signal is not in a bag, and what would help."""

    reason: str
    help: str


@dataclass
class TopicReader:
    """Reads signals from the messages of a topic, as they are `defined`.

    Its rows have the times of their headers if it `has_stamps`; `unstamped` counts those messages that were omitted
    because their headers have no time. If they are `kept`, the messages are samples themselves, of that name.
    """

    defined: Defined
    message: str
    has_stamps: bool
    signals: dict[str, tuple[Signal, Field]] = field(default_factory=dict)
    unstamped: int = 0
    kept: str = ""

    def _columns(self, messages: Messages) -> dict[Path, Samples]:
        """The fields of the messages. Raises MisfitError."""
        paths = [field.path for _, field in self.signals.values()]
        wanted = [*paths, *(_STAMP if self.has_stamps else ())]
        return cdr.columns(self.defined.types, self.message, wanted, unpacked(messages))

    def rows(self, messages: Messages) -> Rows:
        """The messages as rows. Raises MisfitError."""
        found = self._columns(messages)
        samples = {name: _as_kept(signal, found.get(field.path)) for name, (signal, field) in self.signals.items()}
        if self.kept:
            whole = np.empty(len(messages), object)
            whole[:] = [bytes(each) for each in unpacked(messages).raw()]
            samples[self.kept] = Samples(np.arange(len(messages)), whole)
        if not self.has_stamps or not len(messages):
            return Rows(messages.times, messages.places, samples)
        seconds, rest = (found[path].values for path in _STAMP)
        assert not isinstance(seconds, Ragged)
        assert not isinstance(rest, Ragged)
        times = seconds.astype(np.int64) * SECOND + rest.astype(np.int64)
        rows = Rows(times, messages.places, samples)
        stamped = np.flatnonzero(times)
        self.unstamped += len(times) - len(stamped)
        return rows if len(stamped) == len(times) else rows.taken(stamped)

    def readable(self, messages: Messages) -> int:
        """How many messages, from the first on, fit their definition."""
        least, most = 0, len(messages)
        while least < most:
            middle = (least + most + 1) // 2
            try:
                self._columns(messages.first(middle))
                least = middle
            except MisfitError:
                most = middle - 1
        return least

    def misfit(self, messages: Messages) -> str:
        """How the first of `messages` differs from its definition: as in `is 4 bytes shorter than`."""
        try:
            self._columns(messages.first(1))
        except MisfitError as error:
            return error.reason
        return MisfitError().reason  # beside others only


def _has_stamps(types: MessageTypes, message: str) -> bool:
    """Whether messages of a type have a header with a time in it."""
    return all(_scalar_at(types, message, path) in ("int32", "uint32") for path in _STAMP)


def _scalar_at(types: MessageTypes, message: str, path: tuple[str, ...]) -> str | None:
    """The primitive type of the single value that `path` leads to in a message; None if there is none."""
    current: FieldType | None = FieldType(message)
    for step in path:
        if current is None or current.is_list or current.base not in types.messages:
            return None
        current = types.messages[current.base].fields.get(step)
    return None if current is None or current.is_list else current.base


def _as_kept(signal: Signal, samples: Samples | None) -> Samples:
    """Samples in the form of all recordings; None becomes empty ones."""
    element = signal.type.element
    kind = kind_of(Column(element or signal.type, signal.numbers))
    none: Places = np.array([], np.int64)
    if samples is None:
        empty = np.array([], kind)
        return Samples(none, empty if element is None else Ragged(empty, none))
    if isinstance(samples.values, Ragged):
        elements = samples.values.elements.astype(kind, copy=False)
        return Samples(samples.rows, Ragged(elements, samples.values.lengths))
    return Samples(samples.rows, samples.values.astype(kind, copy=False))


class Plan:
    """What is read of the `topics` of a bag for the signals that are wanted.

    What the bag does not define is as in the `distribution` of ROS 2 that it was recorded with. `differences` say by
    signal what others define where the bag has its own.
    """

    def __init__(
        self, topics: Mapping[str, Topic], signals: Mapping[str, Signal], reading: ReadOptions, distribution: str = ""
    ) -> None:
        self._topics = {absolute(name): topic for name, topic in topics.items()}
        self._reading = reading
        self._distribution = distribution or JAZZY
        self._signals = signals
        self._types: dict[str, Defined | Absence] = {}
        self.readers: dict[str, TopicReader] = {}
        self.absences: dict[str, Absence] = {}
        self.differences: dict[str, str] = {}
        for name, signal in signals.items():
            if isinstance(signal.definition, Field):
                self._place(name, signal, signal.definition)

    @property
    def columns(self) -> tuple[str, ...]:
        """The signals that are read."""
        return tuple(name for reader in self.readers.values() for name in reader.signals)

    @property
    def missing(self) -> set[str]:
        """The topics that signals are wanted from and the bag has not."""
        definitions = [signal.definition for signal in self._signals.values()]
        return {field.topic for field in definitions if isinstance(field, Field)} - self._topics.keys()

    def absence(self, name: str) -> Absence:
        """Why a signal is not read, or the first of those that it is computed from."""
        if name in self.absences:
            return self.absences[name]
        parts = (part.signal.name for part in self._signals[name].inputs)
        missing = next(part for part in parts if part not in self.columns)
        return self.absence(missing)

    def _place(self, name: str, signal: Signal, field: Field) -> None:
        defined = self._types_of(field)
        if isinstance(defined, Absence):
            self.absences[name] = defined
            return
        types = defined.types
        reason = misfit(signal, field, types)
        if reason:
            help = f"give the matching definition of `{field.message}` with `--msg-path DIR`"
            self.absences[name] = Absence(f"`{field.message}` on `{field.topic}` in the recording {reason}", help)
            return
        if RECORDING in defined.origins:
            self._compare(name, signal, field)
        has_stamps = self._reading.stamp is Stamp.HEADER and _has_stamps(types, field.message)
        reader = self.readers.setdefault(field.topic, TopicReader(defined, field.message, has_stamps))
        reader.signals[name] = (signal, field)
        reader.kept = kept_name(field.topic) if field.topic in self._reading.kept else ""

    def _compare(self, name: str, signal: Signal, field: Field) -> None:
        """Keep how others define a field that the bag defines, if it is otherwise."""
        if field.message in self._without_recording.messages:
            reason = misfit(signal, field, self._without_recording)
            if reason:
                self.differences[name] = f"`{field.message}` {reason}"

    def _types_of(self, field: Field) -> Defined | Absence:
        """The types of the messages on the topic of `field`, if they are those of the specification."""
        topic = self._topics.get(field.topic)
        if topic is None:
            return Absence(f"the recording has no topic `{field.topic}`", self._other_topics(field))
        if topic.type != field.message:
            reason = f"the messages on `{field.topic}` are `{topic.type}` in the recording, not `{field.message}`"
            return Absence(reason, "declare the signal with the type in the recording")
        if topic.serialization != "cdr":
            reason = f"the messages on `{field.topic}` are serialised as `{topic.serialization}`, not as `cdr`"
            return Absence(reason, "convert the recording with `ros2 bag convert`, or rosbags-convert")
        if field.topic not in self._types:
            try:
                self._types[field.topic] = types_of(topic, self._others)
            except UnknownTypeError as error:
                reason = f"the messages on `{field.topic}` are `{topic.type}`, {error.reason}"
                self._types[field.topic] = Absence(reason, error.help)
        return self._types[field.topic]

    @cached_property
    def _others(self) -> list[Layer]:
        return other_layers(self._reading.message_paths, self._distribution)

    @cached_property
    def _without_recording(self) -> MessageTypes:
        return merged(self._others)

    def _other_topics(self, field: Field) -> str:
        """Which topic may be meant: if no name is near, those with messages of its type come first."""
        if field.topic.startswith("~/"):
            return "a private topic is recorded under the name of its node: write it as `/node/topic`"
        near = did_you_mean(field.topic, self._topics)
        others = nearest_first(field.topic, self._topics)
        others.sort(key=lambda topic: self._topics[topic].type != field.message)
        listed = ", ".join(f"`{topic}`" for topic in others[:_OFFERED])
        more = f" and {len(others) - _OFFERED} more" if len(others) > _OFFERED else ""
        topics = "topics are" if len(others) > 1 else "only topic is"
        return near or (f"its {topics} {listed}{more}" if listed else "it has no topics")


def absolute(name: str) -> str:
    """The name of a topic as specifications have it, also where a recorder has omitted the first slash."""
    return f"/{name.lstrip('/')}"


def of_all_files(files: list[Mapping[str, Topic]]) -> dict[str, Topic]:
    """The topics of all files; where a type differs, it is that of all, with commas."""
    found: dict[str, Topic] = {}
    for name, topic in (item for topics in files for item in topics.items()):
        before = found.setdefault(name, topic)
        if before is not topic:
            type_ = before.type if full_name(topic.type) in before.type.split(", ") else f"{before.type}, {topic.type}"
            count = None if before.count is None or topic.count is None else before.count + topic.count
            has_text = bool(before.definition)
            form, text = (before.form, before.definition) if has_text else (topic.form, topic.definition)
            found[name] = replace(before, type=type_, form=form, definition=text, count=count)
    return found
