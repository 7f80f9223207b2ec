"""The members of the structs of emitted C: the specification says which there are, the text what they are called.

What a name stands for is told by its place, and it has to recall that: whoever fills in samples goes by their names.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

from pycparser import c_ast

from ltlc.assurance.reading.c.definitions import Definitions
from ltlc.assurance.reading.c.front import plural
from ltlc.assurance.reading.c.front import type_of as type_text
from ltlc.assurance.reading.names import recalls
from ltlc.assurance.reading.trees import NotUnderstoodError
from ltlc.dataclass import dataclass
from ltlc.program.lowering import read, undefined_parts
from ltlc.program.machine import Age, Machine, Occurrences
from ltlc.program.types import BOOL, DOUBLE, Type, recent_of, type_of
from ltlc.semantics.ltl import Formula
from ltlc.specification import expressions as e
from ltlc.specification.evaluation import number
from ltlc.specification.expressions import Field, Input, Match, New, Parallel, Past, Recent, Signal, Slope
from ltlc.specification.samples import Sample, entry, in_order, reach, together
from ltlc.specification.specification import Instances, PropertySpecification, fields, topics, topics_of
from ltlc.specification.wire import as_double


class Property(Protocol):
    """A property, and the machine that has to be in the text."""

    @property
    def specification(self) -> PropertySpecification:
        """What it is about."""
        ...

    @property
    def formula(self) -> Formula:
        """It in core LTL."""
        ...

    @property
    def machine(self) -> Machine:
        """What judges it."""
        ...


@dataclass(frozen=True)
class Struct:
    """What a property remembers, by the names of members.

    When clock steps are due, values at openings, those that clock steps take next, what held at the last step, and
    whether what is counted did.
    """

    of: Property
    name: str
    dues: tuple[str, ...]
    kept: tuple[str, ...]
    taken: tuple[str, ...]
    held: tuple[str, ...]
    occurring: tuple[str, ...]

    @property
    def inputs(self) -> tuple[Input, ...]:
        """What its steps read."""
        return self.of.specification.inputs()

    @property
    def clocks(self) -> tuple[str, ...]:
        """When its clocks are due; one alone may be due whenever a clock step is."""
        return self.dues[:-1] or self.dues[: len(self.of.machine.clocks)]

    @property
    def ages(self) -> dict[str, Age]:
        """The clocks that messages renew."""
        clocks = zip(self.clocks, self.of.machine.clocks, strict=True)
        return {name: clock.age for name, clock in clocks if clock.age is not None}

    @property
    def counts(self) -> dict[str, Occurrences]:
        """The clocks that count."""
        clocks = zip(self.clocks, self.of.machine.clocks, strict=True)
        return {name: clock.occurrences for name, clock in clocks if clock.occurrences is not None}

    @property
    def histories(self) -> dict[str, int]:
        """Of these, the times that are kept, and how many."""
        return {name.replace("due", "times"): count.times for name, count in self.counts.items()}

    @property
    def news(self) -> list[str]:
        """The topics of which it reads whether a message has come."""
        read = (i for i in self.inputs if isinstance(i, New))
        return list(dict.fromkeys(topic for i in read for topic in topics_of(i.signal)))

    @property
    def is_from_session(self) -> bool:
        """Whether it begins with the session: it waits for no value."""
        return not self.of.machine.waits_for

    @property
    def waited(self) -> list[Input]:
        """The inputs that a step needs a value of."""
        return [each for each in self.inputs if read(each) in self.of.machine.waits_for]

    @property
    def excused(self) -> Iterator[tuple[Input, list[Input]]]:
        """The others, but for news, each with the news without which it may have no value; some always have one."""
        by_read = {read(each): each for each in self.inputs}
        for wanted, news, _ in self.of.machine.excused:
            if not news:
                continue
            yield by_read[wanted], [by_read[each] for each in news]

    @property
    def undefined(self) -> list[e.Expression]:
        """What can be NaN though no sample is."""
        atoms = self.of.specification.atoms
        return list(dict.fromkeys(part for atom in atoms for part in undefined_parts(atom.condition)))

    @property
    def values(self) -> list[e.Expression]:
        """What of that is computed where samples are kept; the rest depends on openings, and a step computes it."""
        return [part for part in self.undefined if not any(e.openings(part)) and any(True for _ in e.inputs(part))]

    @property
    def width(self) -> int:
        """How many bits its state has."""
        return next(bits for bits in (8, 16, 32) if len(self.of.machine.states) < 2**bits)

    def declared(self, prefix: str) -> list[str]:
        """The members that there have to be."""
        machine = self.of.machine
        types = {name: type_text(prefix, r.kept.type) for name, r in zip(self.kept, machine.registers, strict=True)}
        nexts = {f"{name}_next": type_ for name, type_ in types.items()}
        return [
            "int64_t since",
            *(f"int64_t {name}" for name in self.dues),
            *(f"int64_t {name}[{most}]" for name, most in self.histories.items()),
            *(f"uint32_t {name}_count" for name in self.histories),
            "uint32_t invalid",
            "uint32_t apart",
            *(f"{_constant(type_)}{name}" for name, type_ in types.items()),
            *(f"{_constant(nexts[name])}{name}" for name in self.taken),
            f"uint{self.width}_t state",
            "uint8_t verdict",
            *(f"bool {name} : 1" for name in (*self.held, *self.occurring)),
        ]


def _constant(type_: str) -> str:
    """A type in a declaration: strings are constant."""
    return f"const {type_}" if type_.endswith("*") else f"{type_} "


def declared(prefix: str, type_: Type) -> str:
    """A type where a constant is declared."""
    return _constant(type_text(prefix, type_)).removeprefix("const ")


@dataclass(frozen=True)
class Kept:
    """What is kept of a signal, or of a value that can be NaN: the last `depth` of it, with times if `has_times`.

    It is kept `of` that signal; a value is one that is computed.
    """

    name: str
    of: Signal
    type: Type
    depth: int
    has_times: bool = False
    has_arrays: bool = False

    def ago(self, samples: int = 0, times: str = "") -> str:
        """Where its value from so many samples ago is or, with `_times`, the time of that."""
        latest = f"signals->{self.name}_latest"
        place = f"past({latest}, {samples}u, {self.depth}u)" if samples else latest
        return f"signals->{self.name}" if self.depth == 1 else f"signals->{self.name}{times}[{place}]"

    def declared(self, prefix: str) -> list[str]:
        """The members that there have to be."""
        declared = f"{_constant(type_text(prefix, self.type))}{self.name}"
        if self.depth == 1:
            return [declared]
        times = [f"int64_t {self.name}_times[{self.depth}]"] if self.has_times else []
        places = self.depth * (2 if self.has_arrays else 1)
        return [f"{declared}[{places}]", *times, f"uint32_t {self.name}_latest", f"uint32_t {self.name}_count"]

    def pushed(self, value: str) -> str:
        """What keeps a new value."""
        name = f"signals->{self.name}"
        if self.depth == 1:
            return f"{name} = {value};"
        again = f"{name}[{name}_latest + {self.depth}u] = {name}[{name}_latest];" if self.has_arrays else ""
        times = f"{name}_times[{name}_latest] = time;" if self.has_times else ""
        return (
            f"{name}_latest = {name}_latest + 1u < {self.depth}u ? {name}_latest + 1u : 0u; "
            f"{name}[{name}_latest] = {value}; {again} {times} if ({name}_count < {self.depth}u) {{ {name}_count++; }}"
        )


class Group(NamedTuple):
    """What comes together, as `flag` says, and what each of its signals is called in what comes."""

    flag: str
    of: Sample
    fields: Mapping[Signal, str]


@dataclass(frozen=True)
class Given:
    """What comes in at one moment: samples, and for each topic in `told` whether there is a message on it.

    On `marks` there is none, and their news is set otherwise.
    """

    groups: Sequence[Group]
    told: Mapping[str, str]
    marks: frozenset[str]

    def groups_of(self, wanted: Iterable[Input]) -> list[Group]:
        """What inputs are computed from, in the order of first use."""
        read = (signal for i in wanted if not isinstance(i, New) for signal, _ in fields(i.signal))
        return list({g.flag: g for signal in read for g in self.groups if signal in g.fields}.values())

    def fresh(self, wanted: Iterable[Input]) -> list[str]:
        """One of these holds if a sample of an input comes."""
        return [f"samples->{group.flag}" for group in self.groups_of(wanted)]

    def news(self, among: Collection[str]) -> list[str]:
        """One of these holds if something comes on one of these topics."""
        told = [f"samples->{name}" for topic, name in self.told.items() if topic in among]
        return [*told, *(f"samples->{group.flag}" for group in self.groups if group.of.topic in among)]

    def declared(self, prefix: str) -> list[str]:
        """The members that there have to be."""
        read = [(type_text(prefix, type_of(s)), name) for group in self.groups for s, name in group.fields.items()]
        flags = (*(group.flag for group in self.groups), *self.told.values())
        found = [*(f"{_constant(type_)}{name}" for type_, name in read), *(f"bool {flag} : 1" for flag in flags)]
        return found or ["bool nothing"]


@dataclass(frozen=True)
class Pace:
    """Properties whose steps see the same samples; with a rate, those whose ticks `begin` with the same topics.

    None of those topics is the session. `heard` has for each topic the flag that keeps whether there is news.
    """

    suffix: str
    begin: frozenset[str] | None
    properties: Sequence[Struct]
    groups: Sequence[Group]
    heard: Mapping[str, str]
    kept: Mapping[Signal, Kept]
    values: Mapping[e.Expression, Kept]

    @property
    def name(self) -> str:
        """What it keeps, in the monitors."""
        return f"signals{self.suffix}"

    def place(self, wanted: Input) -> str:
        """Where the value of an input is when a step is judged."""
        if isinstance(wanted, New):
            return " || ".join(f"signals->{self.heard[topic]}" for topic in topics_of(wanted.signal))
        if wanted.signal not in self.kept:
            assert isinstance(wanted.signal.definition, e.Expression)
            return repr(as_double(number(wanted.signal.definition, {})))
        kept = self.kept[wanted.signal]
        match wanted:
            case Past(_, samples):
                return kept.ago(samples)
            case Recent(_, samples):
                place = f"signals->{kept.name}, signals->{kept.name}_latest"
                return f"recent_{plural(kept.type)}({place}, {kept.depth}u, {samples + 1}u)"
            case Slope():
                now, before = (f"{'' if kept.type == DOUBLE else '(double)'}{kept.ago(n)}" for n in (0, 1))
                return f"slope({now} - {before}, {kept.ago(0, '_times')} - {kept.ago(1, '_times')})"
            case _:
                return kept.ago()

    def type(self, wanted: Input) -> Type:
        """The type of that value."""
        if isinstance(wanted, New):
            return BOOL
        if isinstance(wanted, Recent):
            return recent_of(wanted.signal)
        return DOUBLE if isinstance(wanted, Slope) or wanted.signal not in self.kept else self.kept[wanted.signal].type

    def numbers(self, struct: Struct) -> list[str]:
        """Where the numbers are that can be NaN, of which one makes a step of a property invalid."""
        read = [i for i in struct.inputs if not isinstance(i, New) and i.signal in self.kept]
        found = [self.place(i) for i in read if self.type(i).is_number and not self.type(i).scalar.is_integer]
        return [*found, *(self.values[value].ago() for value in struct.values)]

    def ready(self, given: Given, wanted: Iterable[Input]) -> list[str]:
        """All of these hold if every input has a value, as those have that have one before their first sample."""
        wanted = [i for i in wanted if not isinstance(i, New) and self._is_awaited(i.signal)]
        flags = [f"signals->{group.flag}" for group in given.groups_of(wanted)]
        return [*flags, *dict.fromkeys(each for i in wanted for each in self._long_enough(i))]

    def _long_enough(self, wanted: Input) -> Iterator[str]:
        kept = self.kept[wanted.signal]
        if reach(wanted) > 1 or wanted.signal.when is not None:
            yield f"signals->{kept.name}_count >= {reach(wanted)}u"
        else:
            for part in wanted.signal.inputs:
                if self._is_awaited(part.signal):
                    yield from self._long_enough(part)

    def _is_awaited(self, signal: Signal) -> bool:
        return signal in self.kept and signal.otherwise is None

    def declared(self, prefix: str, is_rated: bool) -> list[str]:
        """The members that there have to be."""
        kept = [each for kept in (*self.kept.values(), *self.values.values()) for each in kept.declared(prefix)]
        ticks = [f"{prefix}_ticks ticks"] if is_rated else []
        flags = ("has_started", *(group.flag for group in self.groups), *self.heard.values())
        return [*kept, *ticks, "uint32_t together", *(f"bool {flag} : 1" for flag in flags)]


class Members:
    """The structs of a file for `properties`. Raises NotUnderstoodError where a name does not recall what it has to."""

    def __init__(
        self, definitions: Definitions, properties: Sequence[Property], is_rated: bool, is_grouped: bool
    ) -> None:
        self.definitions = definitions
        self.prefix = definitions.prefix
        names = self._names("monitors")[: len(properties)]
        if len(names) != len(properties):
            raise NotUnderstoodError(f"there are {len(names)} monitors, not {len(properties)}")
        self.structs = [self._struct(name, of) for name, of in zip(names, properties, strict=True)]
        self._instances = [of for each in self.structs if isinstance(of := each.of.specification.slicing, Instances)]
        openers = [New(of.signal) for of in self._instances]
        self._wanted = [*(i for each in self.structs for i in each.inputs), *openers]
        self._topics = list(dict.fromkeys(t for i in self._wanted if isinstance(i, New) for t in topics_of(i.signal)))
        self.given = self._given(is_grouped)
        self.paces = list(self._paces(is_rated))

    def _names(self, end: str) -> list[str]:
        struct = self.definitions.type(f"{self.prefix}_{end}")
        if not isinstance(struct, c_ast.Struct):
            raise NotUnderstoodError(f"`{self.prefix}_{end}` is not a struct")
        return [each.name for each in struct.decls or ()]

    def _struct(self, name: str, of: Property) -> Struct:
        _require_recalled(name, of.specification.label)
        names = self._names(name)
        invalid, apart, state, verdict = map(names.index, ("invalid", "apart", "state", "verdict"))
        latest = apart + 1 + len(of.machine.registers)
        counts = [clock.occurrences for clock in of.machine.clocks if clock.occurrences]
        held = len(names) - sum(each.begins for each in counts)
        dues = names[1 : invalid - 2 * len(counts)]
        parts_ = (dues, names[apart + 1 : latest], names[latest:state], names[verdict + 1 : held], names[held:])
        struct = Struct(of, name, *map(tuple, parts_))
        if len(struct.clocks) != len(of.machine.clocks) or struct.dues[-1:] not in ((), ("due",)):
            raise NotUnderstoodError(f"`{name}` has other clocks")
        return struct

    def _given(self, is_grouped: bool) -> Given:
        samples = together(in_order(self._wanted), is_grouped)
        names = iter(self._names("samples"))
        called = [{signal: next(names) for signal in sample.signals} for sample in samples]
        groups = [Group(next(names), sample, of) for sample, of in zip(samples, called, strict=True)]
        for group in groups:
            _require_recalled(group.flag, f"has {_called(group.of)}")
            for signal, name in group.fields.items():
                _require_recalled(name, signal.name)
        read = [signal.definition for group in groups for signal in group.fields]
        whole = {entry(each) for each in read if isinstance(each, Field)}
        marks = frozenset(of.mark.name for of in self._instances)
        told = {topic: next(names) for topic in self._topics if topic not in whole | marks}
        for topic, name in told.items():
            self._require_news(topic, name)
        return Given(groups, told, marks)

    def _require_news(self, topic: str, name: str) -> None:
        """Raise NotUnderstoodError unless `name` is that of news on a topic."""
        signals = (i.signal for i in self._wanted if isinstance(i, New) and topic in topics_of(i.signal))
        words = [_words(f"new {signal.name}") for signal in signals]
        if not recalls(name, words[0], words):
            raise NotUnderstoodError(f"`{name}` does not pass on that a message has arrived on `{topic}`")

    def _paces(self, is_rated: bool) -> Iterator[Pace]:
        """One, or with a rate one for all properties whose ticks begin alike; of what never is judged, the first."""
        begins = [_begin(each) if is_rated else frozenset[str]() for each in self.structs]
        ticking = [begin for begin in dict.fromkeys(begins) if begin != frozenset()] or [frozenset[str]()]
        for place, begin in enumerate(ticking):
            alike = {begin, frozenset[str]()} if place == 0 else {begin}
            own = [struct for struct, each in zip(self.structs, begins, strict=True) if each in alike]
            yield self._pace(f"_{place + 1}" if place else "", begin, own, is_rated)

    def _pace(self, suffix: str, begin: frozenset[str] | None, own: Sequence[Struct], is_rated: bool) -> Pace:
        wanted = [i for each in own for i in each.inputs]
        signals = in_order(wanted)
        needed = [*wanted, *(i for signal in signals for i in signal.inputs)]
        values = dict.fromkeys(value for each in own for value in each.values)
        rest = self._names(f"signals{suffix}")
        kept = {s: _kept(s, needed, rest) for s in signals if not _is_constant(s)}
        computed = {value: _taken(_value(value), rest) for value in values}
        groups = [group for group in self.given.groups if not set(signals).isdisjoint(group.fields)]
        flags = rest[rest.index("has_started") + 1 + len(groups) :]
        heard = dict(
            zip((topic for topic in self._topics if any(topic in each.news for each in own)), flags, strict=True)
        )
        for topic, name in heard.items():
            self._require_news(topic, name)
            if self.given.told.get(topic, name) != name:
                raise NotUnderstoodError(f"`{name}` is not the right news")
        return Pace(suffix, begin, own, groups, heard, kept, computed)


def _begin(struct: Struct) -> frozenset[str] | None:
    """The topics with which the ticks of a property begin; None: with the session."""
    return None if struct.is_from_session else frozenset(topics(struct.of.specification))


def _is_constant(signal: Signal) -> bool:
    """Whether it is computed from nothing."""
    return not isinstance(signal.definition, Field) and not signal.inputs


def _kept(signal: Signal, needed: Sequence[Input], names: list[str]) -> Kept:
    of_signal = [i for i in needed if i.signal == signal]
    depth = max([1 if signal.when is None else 2, *map(reach, of_signal)])
    is_computed = not isinstance(signal.definition, Field) and not signal.is_taken
    type_ = DOUBLE if is_computed and signal.type is e.ValueType.NUMBER else type_of(signal)
    has_times, has_arrays = (any(isinstance(i, each) for i in of_signal) for each in (Slope, Recent))
    return _taken(Kept(signal.name, signal, type_, depth, has_times, has_arrays), names)


def _value(expression: e.Expression) -> Kept:
    """What is kept of an expression that can be NaN."""
    return Kept("value", Signal("value", e.ValueType.NUMBER, expression), DOUBLE, 1)


def _taken(kept: Kept, names: list[str]) -> Kept:
    """`kept` under the name that is next, whose members are taken off `names`."""
    if not names:
        raise NotUnderstoodError(f"no sample of `{kept.name}` is kept")
    _require_recalled(names[0], kept.name)
    found = replace(kept, name=names[0])
    del names[: len(found.declared(""))]
    return found


def _called(sample: Sample) -> str:
    """What comes together, in words."""
    [first, *more] = sample.signals
    assert isinstance(first.definition, Field)
    entries = [step.value for step in first.definition.path if isinstance(step, Match | Parallel)]
    return " ".join([sample.topic, *entries]) if more else first.name


def _words(text: str) -> str:
    return "_".join(re.findall(r"[A-Za-z0-9]+", text))


def _require_recalled(name: str, called: str) -> None:
    """Raise NotUnderstoodError unless `name` recalls what is `called` so."""
    words = _words(called)
    if not recalls(name, called, [words, f"signal_{words}", "signal", words.replace("has_", "has_signal_", 1)]):
        raise NotUnderstoodError(f"`{name}` is not `{called}`")
