"""What a replay gives to emitted code: values of signals, or of the fields of messages that signals are made of."""

from __future__ import annotations

import random
from collections.abc import Hashable, Iterable, Iterator, Mapping
from dataclasses import replace

from ltlc.assurance.histories import Sample
from ltlc.assurance.messages import Content, Messages, Path
from ltlc.dataclass import dataclass
from ltlc.inputs.messages.definitions import STRINGS, FieldType
from ltlc.specification.evaluation import Single, Value
from ltlc.specification.expressions import Bytes, Each, Field, New, OfSlice, Parallel, Signal, inputs, operands
from ltlc.specification.specification import PropertySpecification, fields
from ltlc.specification.wire import DOUBLES, PRIMITIVES, Numbers

Key = tuple[str, Path]
"""A topic, and a place in its messages."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where a source is read: a field, its type, and the entry of the message that it is in, if that can be missing.

    Of a list the entry is the list, and a message has those elements whose `index` it is long enough for.
    """

    field: Field
    type: FieldType
    entry: Hashable = None
    index: int = 0

    @property
    def key(self) -> Key:
        """The same for all sources that are read at the same place."""
        return self.field.topic, self.field.path

    def is_beyond(self, lengths: Mapping[Hashable, int]) -> bool:
        """Whether messages whose lists have these lengths, and which lack what has a length of 0, have none of it."""
        return self.entry in lengths and self.index >= lengths[self.entry]


@dataclass(frozen=True, slots=True)
class Arrays:
    """The arrays whose elements are in one list and, of each, where some elements are read by themselves."""

    places: tuple[Place, ...]
    elements: tuple[Mapping[int, Key], ...]

    def align(self, said: dict[Key, Value]) -> None:
        """Make all as long as the first, or as an element demands, with the elements that are read by themselves."""
        first = said[self.places[0].key]
        assert isinstance(first, tuple)
        length = max([len(first), *(index + 1 for elements in self.elements for index in elements)])
        for place, elements in zip(self.places, self.elements, strict=True):
            values = _repeated(place.type, said[place.key], length)
            read = {i: value for i, key in elements.items() if not isinstance(value := said[key], tuple)}
            said[place.key] = tuple(read.get(index, value) for index, value in enumerate(values))


@dataclass(frozen=True, slots=True)
class Sources:
    """The signals that values are given of; those that are read from messages have a place there."""

    signals: tuple[Signal, ...]
    places: Mapping[Signal, Place]
    lists: tuple[Arrays, ...] = ()

    def possible(self, drawn: Sample) -> Sample:
        """What messages with the values in `drawn` say: rounded, and equal where the same place is read.

        A source without a place is given values of its type.
        """
        said: dict[Key, Value] = {}
        for signal, place in self.places.items():
            said.setdefault(place.key, signal.is_message or _held(place.type, drawn[signal]))
        for arrays in self.lists:
            arrays.align(said)
        return {
            signal: said[self.places[signal].key] if signal in self.places else _fitting(signal.numbers, value)
            for signal, value in drawn.items()
        }

    def without_entries(self, sample: Sample, chance: random.Random) -> Sample:
        """`sample` as messages have it of which some lack entries."""
        indexes = sorted({place.index for place in self.places.values()})
        entries = dict.fromkeys(p.entry for p in self.places.values() if p.entry is not None)
        lengths = {entry: chance.choice(indexes) for entry in entries if chance.random() < 1 / 8}
        kept = (signal for signal in sample if not self.places[signal].is_beyond(lengths))
        return {signal: _shortened(sample[signal], lengths.get(self.places[signal].field.list)) for signal in kept}

    def topics(self) -> dict[str, str]:
        """The topics that sources are read from, with the types of their messages."""
        return {place.field.topic: place.field.message for place in self.places.values()}

    def on(self, topic: str, sample: Sample) -> Sample:
        """What of `sample` comes on `topic`."""
        return {signal: value for signal, value in sample.items() if self.places[signal].field.topic == topic}

    def content(self, sample: Sample) -> Content:
        """A message in which the sources have these values."""
        return {self.places[signal].field.path: value for signal, value in sample.items()}


def given(specification: PropertySpecification) -> Sources:
    """The signals of a property themselves, as if each could have any value."""
    return Sources(tuple(dict.fromkeys(i.signal for i in specification.inputs())), {})


def read(specification: PropertySpecification, messages: Messages) -> Sources:
    """What the signals of a property are computed from: fields of messages."""
    return read_at((pair for i in specification.inputs() for pair in fields(i.signal)), messages)


def read_at(found: Iterable[tuple[Signal, Field]], messages: Messages) -> Sources:
    """Signals that are fields of messages."""
    places = {signal: _place(field, messages) for signal, field in dict.fromkeys(found)}
    return Sources(tuple(places), places, tuple(_lists(places)))


def _lists(places: Mapping[Signal, Place]) -> Iterator[Arrays]:
    """The lists that arrays are read from."""
    by_list: dict[Field, dict[Key, Place]] = {}
    for signal, place in places.items():
        if signal.type.element is not None:
            by_list.setdefault(place.field.list, {})[place.key] = place
    keys = {place.key for place in places.values()}
    for arrays in by_list.values():
        read = ({i: key for key in keys if (i := _index(place.field, key)) is not None} for place in arrays.values())
        yield Arrays(tuple(arrays.values()), tuple(read))


def without_news(specification: PropertySpecification) -> PropertySpecification:
    """`specification` as far as it reads values."""
    kept = (
        atom
        for atom in specification.atoms
        if not any(isinstance(each, New) for operand in operands(atom.condition) for each in inputs(operand))
    )
    return replace(specification, atoms=tuple(kept))


def _place(field: Field, messages: Messages) -> Place:
    type_ = messages.type_at(field.message, field.path)
    depth = next((n for n, step in enumerate(field.path) if not isinstance(step, str | Each | OfSlice | Bytes)), None)
    if depth is None or messages.type_at(field.message, field.path[:depth]).length:
        return Place(field, type_)
    match field.path[depth]:
        case int(index):
            return Place(field, type_, Field(field.topic, field.message, field.path[:depth]), index)
        case Parallel() as step:
            return Place(field, type_, (field.topic, step))
        case _:
            return Place(field, type_, (field.topic, field.path[: depth + 1]))


def _index(array: Field, key: Key) -> int | None:
    """Which element of `array` is at `key`; None if none is."""
    topic, path = key
    depth = len(array.list.path)
    index = path[depth] if len(path) > depth else None
    is_inside = topic == array.topic and path == (*array.path[:depth], index, *array.path[depth + 1 :])
    return index if is_inside and isinstance(index, int) else None


def _repeated(type_: FieldType, values: Value, length: int) -> tuple[Single, ...]:
    """So many values, repeated in turn; without any, the default of the field."""
    assert isinstance(values, tuple)
    default = "" if type_.base in STRINGS else type_.base not in ("bool", "boolean") and 0.0
    return ((values or (default,)) * length)[:length]


def _shortened(value: Value, length: int | None) -> Value:
    return value if length is None or not isinstance(value, tuple) else value[:length]


def _held(type_: FieldType, value: Value) -> Value:
    """The value that a field holds when it is given `value`; an array of fixed length repeats what there is."""
    fitting = _fitting(PRIMITIVES.get(type_.base, DOUBLES), value)
    return _repeated(type_, fitting, type_.length or len(fitting)) if isinstance(fitting, tuple) else fitting


def _fitting(numbers: Numbers, value: Value) -> Value:
    """`value` as the one of `numbers` that is nearest to it; each element of an array."""
    if isinstance(value, tuple):
        return tuple(v if isinstance(v, bool | str) else numbers.nearest(v) for v in value)
    return value if isinstance(value, bool | str) else numbers.nearest(value)
