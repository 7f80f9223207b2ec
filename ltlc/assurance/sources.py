"""What a replay gives to emitted code: values of signals, or of the fields of messages that signals are made of."""

from __future__ import annotations

import random
from collections.abc import Hashable, Mapping
from dataclasses import dataclass, replace

from ltlc.assurance.histories import Sample
from ltlc.assurance.messages import Content, Messages, Path, representable
from ltlc.messages.definitions import FieldType
from ltlc.specification.atoms import operands
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Field, New, Parallel, PathStep, Signal, inputs
from ltlc.specification.specification import PropertySpecification, fields


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
    def key(self) -> tuple[str, Path]:
        """The same for all sources that are read at the same place."""
        return self.field.topic, self.field.path

    def is_beyond(self, lengths: Mapping[Hashable, int]) -> bool:
        """Whether messages whose lists have these lengths, and which lack what has a length of 0, have none of it."""
        return self.entry in lengths and self.index >= lengths[self.entry]


@dataclass(frozen=True, slots=True)
class Sources:
    """The signals that values are given of; those that are read from messages have a place there."""

    signals: tuple[Signal, ...]
    places: Mapping[Signal, Place]

    def possible(self, drawn: Sample) -> Sample:
        """What messages with the values in `drawn` say: rounded, and equal where the same place is read."""
        said: dict[tuple[str, Path], Value] = {}
        for signal, place in self.places.items():
            said.setdefault(place.key, _fitting(place.type, drawn[signal]))
        for topic, path in list(said):
            if isinstance(array := said.get((topic, path[:-1])), tuple):
                said[topic, path[:-1]] = _with_element(array, path[-1], said[topic, path])
        return {**drawn, **{signal: said[place.key] for signal, place in self.places.items()}}

    def without_entries(self, sample: Sample, chance: random.Random) -> Sample:
        """`sample` as messages have it of which some lack entries."""
        indexes = sorted({place.index for place in self.places.values()})
        entries = dict.fromkeys(p.entry for p in self.places.values() if p.entry is not None)
        lengths = {entry: chance.choice(indexes) for entry in entries if chance.random() < 1 / 8}
        kept = (signal for signal in sample if not self.places[signal].is_beyond(lengths))
        return {signal: _shortened(sample[signal], lengths.get(self.places[signal].key)) for signal in kept}

    def topics(self) -> dict[str, str]:
        """The topics that sources are read from, with the types of their messages."""
        return {place.field.topic: place.field.message for place in self.places.values()}

    def on(self, topic: str, sample: Sample) -> Sample:
        """What of `sample` comes on `topic`."""
        return {signal: value for signal, value in sample.items() if self.places[signal].field.topic == topic}

    def content(self, sample: Sample) -> Content:
        """What a message says in which the sources have these values."""
        return {self.places[signal].field.path: value for signal, value in sample.items()}


def given(specification: PropertySpecification) -> Sources:
    """The signals of a property themselves, as if each could have any value."""
    return Sources(tuple(dict.fromkeys(i.signal for i in specification.inputs())), {})


def read(specification: PropertySpecification, messages: Messages) -> Sources:
    """What the signals of a property are computed from: fields of messages."""
    found = dict.fromkeys(pair for i in specification.inputs() for pair in fields(i.signal))
    return Sources(tuple(signal for signal, _ in found), {signal: _place(field, messages) for signal, field in found})


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
    depth = next((n for n, step in enumerate(field.path) if not isinstance(step, str)), None)
    if depth is None or messages.type_at(field.message, field.path[:depth]).length:
        return Place(field, type_)
    match field.path[depth]:
        case int(index):
            return Place(field, type_, (field.topic, field.path[:depth]), index)
        case Parallel() as step:
            return Place(field, type_, (field.topic, step))
        case _:
            return Place(field, type_, (field.topic, field.path[: depth + 1]))


def _with_element(array: tuple[float, ...], index: PathStep, value: Value) -> Value:
    """`array`, as long as it needs to be, with an element that is read by itself."""
    assert isinstance(index, int)
    assert isinstance(value, float)
    long = array + (value,) * (index + 1 - len(array))
    return (*long[:index], value, *long[index + 1 :])


def _shortened(value: Value, length: int | None) -> Value:
    return value if length is None or not isinstance(value, tuple) else value[:length]


def _fitting(type_: FieldType, value: Value) -> Value:
    """The value that a field holds when it is given `value`; an array of fixed length repeats what there is."""
    if isinstance(value, tuple):
        numbers = tuple(representable(type_, v) for v in value)
        return (numbers * type_.length + (0.0,) * type_.length)[: type_.length] if type_.length else numbers
    return value if isinstance(value, bool | str) else representable(type_, value)
