"""What slices a run: the ids of messages, and what of a row belongs to which slice."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from uuid import UUID

from ltlc.dataclass import dataclass
from ltlc.runtime.properties import MonitoredProperty
from ltlc.runtime.sampling import (
    Derived,
    Reading,
    Sampler,
    Update,
    Value,
    topics_of,
)

Id = bool | int | float | str
"""What distinguishes slices."""


def id_of(value: Value) -> Id | None:
    """A value as an id; NaN is not an id, and a whole number is an integer."""
    if value.__class__ is float:
        if value.is_integer():
            return int(value)
        return None if math.isnan(value) else value
    if value.__class__ is tuple:
        return bytes_text(bytes(map(int, value)))
    found: Id = value
    return found


def bytes_text(value: bytes) -> str:
    """Bytes as text: hexadecimal, 16 of them as UUIDs are written."""
    return str(UUID(bytes=value)) if len(value) == 16 else value.hex()


@dataclass(frozen=True, slots=True)
class Key:
    """What slices the messages on `topic`: the reading `name` has their ids.

    If that is an array, each element is a message of its own, and of the arrays in
    `elements` it has the element beside it, as the reading of a slice that is named
    there. `gone` is a reading of a slice that says whether the last message had no
    element with its id.
    """

    topic: str
    name: str
    elements: Mapping[str, str] = field(default_factory=dict)
    gone: str | None = None


@dataclass(frozen=True, slots=True)
class Part:
    """The part of a row that a slice gets, or that all slices share.

    It has samples of `names`, which stand at `places` of the row; `update` takes them
    from the row. It has messages on `topics`, which are `news` at these places and
    renew the ages of the signals in `aged`. It `is_step` if the property reads some of
    it.
    """

    names: tuple[str, ...]
    places: tuple[int, ...]
    topics: frozenset[str]
    update: Update
    news: tuple[int, ...]
    aged: frozenset[str]
    is_step: bool

    def take(self, known: list[Value], time: int, row: Sequence[Value]) -> None:
        """Take what a row has of this, and that its messages are new."""
        for place in self.news:
            known[place] = True
        update = self.update
        # As `update.take` does: calling it would be much of what a message costs.
        for place, target in update.plain:
            known[target] = row[place]
        if update.deep or update.derived:
            update.take_more(known, time, row)

    def of(self, row: Sequence[Value]) -> dict[str, Value]:
        """The samples of this part of a row."""
        places = zip(self.names, self.places, strict=True)
        return {name: row[place] for name, place in places}


@dataclass(frozen=True, slots=True)
class Opener:
    """A message on `topic` opens an instance; to that it is news of `mark`, too.

    On `mark`, a signal and its topic, there are none. `name` is what the author calls
    the topic of the message.
    """

    name: str
    topic: str
    mark: str


@dataclass(frozen=True)
class Row:
    """What rows with the same names and topics are to slices.

    `keys` are those of sliced topics with a message, each with the place of its id, or
    None if the row has none. `shared` is what all slices share, `rest` what that is to
    one that gets nothing else, `opening` what it is to an instance that it opens. `own`
    has what the slice of the ids on some topics gets.
    """

    names: tuple[str, ...]
    keys: tuple[tuple[Key, int | None], ...]
    shared: Part
    rest: Part
    opening: Part | None
    own: dict[tuple[str, ...], Part] = field(default_factory=dict)
    only: tuple[int, Part] | None = None

    @property
    def concerns(self) -> bool:
        """Whether any slice gets something of such rows."""
        return bool(self.keys or self.shared.topics)


SliceMessage = tuple[Id, Part, Sequence[Value]]
"""A message of a slice, with its values."""

Counted = Callable[[Value], Id | None]
"""Gives the id that a message has as a value, None if it has none, and counts it."""


class Cut:
    """How rows are cut into messages of slices, of a property that reads `signals`.

    The `sampler` knows what a slice does before its first message, and says where it
    keeps samples: those that all share, and from the place `own` on its own.

    keys: by the topics that they slice
    window: what the property looks at
    read: the topics of the messages that are judged
    deep: of a slice's own samples those that are more than the latest
    ages: the signals of which the property asks for ages, `own_ages` those of slices
    """

    def __init__(
        self,
        signals: Sequence[Reading | Derived],
        keys: Sequence[Key],
        variable: str,
        property_: MonitoredProperty,
        opener: Opener | None = None,
    ) -> None:
        self.signals = tuple(signals)
        self.keys = {key.topic: key for key in keys}
        self.variable = variable
        self.opener = opener
        self._opening = frozenset(() if opener is None else [opener.topic])
        inputs, topics = property_.inputs, topics_of(signals)
        shared_first = sorted(
            signals, key=lambda s: not topics[s.name].isdisjoint(self.keys)
        )
        self.sampler = Sampler(shared_first, inputs)
        self.window = self.sampler.window(inputs)
        self.ages = _ages(property_)
        marked = set() if opener is None else {opener.mark}
        self.read = self.window.read.union(
            self.keys, self._opening, *(self.sampler.topics[n] for n in self.ages)
        ).difference(marked)
        self.own_ages = frozenset(name for name in self.ages if self.is_own(name))
        self.shared_ages = self.ages - self.own_ages
        self._topic = {s.name: s.topic for s in signals if isinstance(s, Reading)}
        samples, known = self.sampler.samples, self.sampler.known
        own = [s for name, s in samples.items() if self.is_own(name)]
        self.own = min((s.first for s in own), default=len(known))
        self.deep = [s for s in own if s.depth > 1]
        self._id = samples[variable].first if variable in samples else None
        self._rows: dict[tuple[tuple[str, ...], frozenset[str]], Row] = {}
        for key in keys:
            if key.gone is not None:
                known[samples[key.gone].first] = False

    def is_own(self, signal: str) -> bool:
        """Whether each slice has samples of the signal of its own."""
        return not self.sampler.topics[signal].isdisjoint(self.keys)

    def known(self, id_: Id) -> list[Value]:
        """What a slice knows before its first message: what all share, and its id."""
        found = self.sampler.known.copy()
        if self._id is not None:
            found[self._id] = id_
        return found

    def share(self, known: list[Value]) -> None:
        """What all share has changed, and so has what a slice knows."""
        known[: self.own] = self.sampler.known[: self.own]

    def row(self, names: tuple[str, ...], topics: frozenset[str]) -> Row:
        """What rows of samples of `names` with messages on `topics` are to slices."""
        found = self._rows.get((names, topics))
        if found is None:
            found = self._rows[names, topics] = self._row(names, topics)
        return found

    def _row(self, names: tuple[str, ...], topics: frozenset[str]) -> Row:
        keys = tuple(
            (key, names.index(key.name) if key.name in names else None)
            for key in self.keys.values()
            if key.topic in topics
        )
        others = (topics & self.read).difference(self.keys)
        shared = self._part(names, others, is_own=False)
        rest, opening = self._part(names, others, is_own=True), None
        if self.opener is not None and self.opener.topic in topics:
            opening = self._part(names, others | {self.opener.mark}, is_own=True)
        found = Row(names, keys, shared, rest, opening)
        if len(keys) == 1 and not shared.topics:
            [(key, place)] = keys
            if place is not None and not key.elements:
                return replace(found, only=(place, self.own_part(found, (key.topic,))))
        return found

    def _part(
        self, names: Sequence[str], topics: frozenset[str], *, is_own: bool
    ) -> Part:
        """What samples of `names` on `topics` are to a slice, or to all of them."""
        places = tuple(
            p for p, name in enumerate(names) if self._topic.get(name) in topics
        )
        taken = tuple(names[place] for place in places)
        found, window = self.sampler.update(taken, topics), self.window
        own, deep, derived = self.own, found.deep, found.derived
        update = Update(
            found.fresh,
            tuple((places[p], to) for p, to in found.plain if (to >= own) is is_own),
            tuple((places[p], to) for p, to in deep if (to.first >= own) is is_own),
            (),
            tuple(each for each in derived if (each[0].first >= own) is is_own),
        )
        is_step = (
            (self._id is not None and not topics.isdisjoint(self.keys))
            or not self._opening.isdisjoint(topics)
            or not window.signals.isdisjoint(found.fresh)
            or not window.topics.isdisjoint(topics)
        )
        aged = frozenset(
            n for n in self.ages if not self.sampler.topics[n].isdisjoint(topics)
        )
        news = self.sampler.news(topics)
        return Part(taken, places, topics, update, news, aged, is_step)

    def own_part(self, row: Row, topics: tuple[str, ...]) -> Part:
        """What a slice gets of a row whose messages on these topics have its id."""
        part = row.own.get(topics)
        if part is None:
            of = row.shared.topics.union(topics)
            keys = [self.keys[topic] for topic in topics]
            arrays = {name: own for key in keys for name, own in key.elements.items()}
            names = [arrays.get(name, name) for name in row.names]
            names += [key.gone for key in keys if key.gone is not None]
            part = row.own[topics] = self._part(names, of, is_own=True)
        return part

    def gone_part(self, key: Key, gone: str) -> Part:
        """What a slice gets of a message on the topic of `key` that has not its id."""
        part = self._part((gone,), frozenset({key.topic}), is_own=True)
        return replace(part, topics=frozenset(), news=(), aged=frozenset())

    def tick_part(self, names: tuple[str, ...], *, is_own: bool) -> Part:
        """What a tick that sees samples of `names` is to a slice, or to all."""
        return self._part(names, frozenset(self._topic.values()), is_own=is_own)

    def messages(
        self, row: Row, values: Sequence[Value], counted: Counted
    ) -> Iterator[SliceMessage]:
        """The messages of slices in a row: those with one id are one, but of arrays."""
        topics: dict[Id, tuple[str, ...]] = {}
        for key, place in row.keys:
            if key.elements:
                yield from self._elements(row, key, place, values, counted)
                continue
            id_ = counted(None if place is None else values[place])
            if id_ is not None:
                topics[id_] = (*topics.get(id_, ()), key.topic)
        for id_, of in topics.items():
            part = self.own_part(row, of)
            yield id_, part, values

    def _elements(
        self,
        row: Row,
        key: Key,
        place: int | None,
        values: Sequence[Value],
        counted: Counted,
    ) -> Iterator[SliceMessage]:
        """The elements of a message, as far as the shortest array goes.

        A message without the array of ids is one without an id.
        """
        if place is None:
            counted(None)
            return
        ids = values[place]
        if key.gone is not None:
            values = (*values, False)
        part = self.own_part(row, (key.topic,))
        own = set(key.elements.values())
        pairs = zip(part.places, part.names, strict=True)
        arrays = {place for place, name in pairs if name in own}
        count = min([len(ids), *(len(values[p]) for p in arrays)])
        for number, id_ in enumerate(map(counted, ids[:count])):
            if id_ is not None:
                pairs_ = enumerate(values)
                yield id_, part, [v[number] if p in arrays else v for p, v in pairs_]


def _ages(of: MonitoredProperty) -> frozenset[str]:
    """The signals of which the property asks for ages."""
    ages = (*of.ages, *(age for event in of.events for age in event.ages))
    return frozenset(age.signal for age in ages)
