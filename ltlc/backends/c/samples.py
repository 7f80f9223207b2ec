"""Samples in C: what all properties of a file are given at one moment, from which messages it comes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from ltlc.backends.c.code import comment
from ltlc.backends.c.expressions import C
from ltlc.backends.c.names import member_names
from ltlc.backends.inputs import origin
from ltlc.backends.names import input_name, variable
from ltlc.backends.trees import INDENT, Code, Text
from ltlc.dataclass import dataclass
from ltlc.program.lowering import read
from ltlc.program.types import type_of
from ltlc.specification.expressions import Field, Input, Match, New, Parallel, Signal
from ltlc.specification.samples import Sample, entry, in_order, together
from ltlc.specification.specification import Instances, PropertySpecification, fields, topics_of


@dataclass(frozen=True, slots=True)
class Group:
    """Fields that are always in a message together: a sample has all of them or none, as the flag `has_name` says."""

    topic: str
    name: str
    readings: tuple[Signal, ...]


@dataclass(frozen=True, slots=True)
class Heard:
    """The messages on `topic` are news, called `name`; unless each has values that are read, samples have that flag."""

    topic: str
    name: str
    has_flag: bool


class Samples:
    """The signals that `properties` read from messages, as a step is given them: `together`, if that `is_grouped`.

    The messages that open instances are among them. `marks` are topics without messages: their news is set otherwise.
    """

    def __init__(self, properties: Sequence[PropertySpecification], helpers: C, is_grouped: bool = True) -> None:
        self._helpers = helpers
        wanted = [i for p in properties for i in p.inputs()]
        self.groups = _named(together(in_order(wanted), is_grouped))
        self.group_of = {signal: group for group in self.groups for signal in group.readings}
        instances = [of for p in properties if isinstance(of := p.slicing, Instances)]
        self.marks = frozenset(of.mark.name for of in instances)
        news = dict.fromkeys([*(i for i in wanted if isinstance(i, New)), *(New(of.signal) for of in instances)])
        self.heard = {heard.topic: heard for heard in self._heard(news)}
        self.fields = self._fields()

    def _heard(self, news: Iterable[New]) -> Iterator[Heard]:
        local = member_names()
        for topic in dict.fromkeys(topic for each in news for topic in topics_of(each.signal)):
            name = next(input_name(read(each)) for each in news if topic in topics_of(each.signal))
            is_told = topic not in self.marks and not any(
                isinstance(signal.definition, Field) and entry(signal.definition) == topic for signal in self.group_of
            )
            yield Heard(topic, local.unique(name), is_told)

    def _fields(self) -> dict[Signal, str]:
        """What a step is given of each reading."""
        flags = [f"has_{group.name}" for group in self.groups]
        local = member_names(*flags, *(heard.name for heard in self.heard.values()))
        return {signal: local.unique(variable(signal.name)) for group in self.groups for signal in group.readings}

    def sources(self, wanted: Iterable[Input]) -> list[Group]:
        """The groups that inputs are computed from."""
        read = (signal for i in wanted if not isinstance(i, New) for signal, _ in fields(i.signal))
        return list(dict.fromkeys(self.group_of[signal] for signal in read))

    def fresh(self, wanted: Iterable[Input]) -> list[Code]:
        """One of these holds if a sample of an input comes in."""
        return [Text(f"samples->has_{group.name}") for group in self.sources(wanted)]

    def news(self, topics: Iterable[str]) -> list[Text]:
        """One of these holds if the samples tell of a message on one of the topics."""
        topics = frozenset(topics)
        said = [f"samples->{heard.name}" for heard in self.heard.values() if heard.has_flag and heard.topic in topics]
        return [Text(flag) for flag in (*said, *(f"samples->has_{g.name}" for g in self.groups if g.topic in topics))]

    def declared(self) -> list[str]:
        """The fields of the samples that a step is given."""
        lines = []
        for group in self.groups:
            for signal in group.readings:
                assert isinstance(signal.definition, Field)
                declared = self._helpers.declared(type_of(signal), self.fields[signal])
                lines += [*comment(origin(signal), indent=INDENT), f"{INDENT}{declared};"]
        lines += [f"{INDENT}bool has_{group.name} : 1;" for group in self.groups]
        for heard in self.heard.values():
            if heard.has_flag:
                lines += comment(f"a message on {heard.topic} has come", indent=INDENT)
                lines.append(f"{INDENT}bool {heard.name} : 1;")
        return lines


def _named(samples: Iterable[Sample]) -> list[Group]:
    local = member_names("started")
    groups = []
    for topic, readings in samples:
        first, *more = readings
        assert isinstance(first.definition, Field)
        entries = [s.value for s in first.definition.path if isinstance(s, Match | Parallel)]
        name = " ".join([topic, *entries]) if more else first.name
        groups.append(Group(topic, local.unique(variable(name)), readings))
    return groups
