"""A specification with all names resolved and all types checked: what every later pass works on."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import field, replace
from enum import Enum
from functools import cached_property

from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.semantics import ltl, properties
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import Formula
from ltlc.semantics.openings import scope_clocks
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import (
    Clock,
    Historically,
    Occurred,
    Once,
    Previously,
    Since,
    atoms_within,
    counts_of,
    messages_of,
)
from ltlc.semantics.timed_atoms import operands as operands_of
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import (
    Field,
    Input,
    New,
    Opening,
    Read,
    Signal,
    ValueType,
    inputs,
    openings,
    operands,
)
from ltlc.specification.guards import LEAD, Guard
from ltlc.specification.requirements import Requirement
from ltlc.specification.text import read_texts, text

Path = tuple[int, ...]
"""The way to a part of a property: indexes into `parts`, from the outside in."""


def gone_name(key: str) -> str:
    """The name of the signal that is true while the last array of ids, of this `key`, lacks that of a slice."""
    return f"gone {key}"


THIS_ONE = " (this one)"
"""The end of the name of a message from which on a property is judged."""

MOST_IDS = 1000
"""How many ids a node keeps for an `each` without a limit."""


@dataclass(frozen=True, slots=True)
class Slicing:
    """A property is judged for each id, on the slice of the run for it: `each variable of keys limit N`.

    `keys` have the ids, each on a topic of its own; in the property the id is the signal called `variable`. Where a key
    is an array, each element is a message of its own; of `arrays` on its topic the property reads the elements that
    belong to it. At most `limit` ids are kept, None is any number.
    """

    keys: tuple[Signal, ...]
    variable: str
    limit: int | None = None
    arrays: tuple[Signal, ...] = ()

    def element_of(self, array: Signal) -> str:
        """How the signal is called that has the element of an array which belongs to the id."""
        return f"{array.name}[{self.variable}]"

    @property
    def elements(self) -> Mapping[str, Signal]:
        """The arrays of which the property reads elements, by the names of these."""
        return {self.element_of(array): array for array in self.arrays}

    @property
    def made(self) -> frozenset[str]:
        """The signals of a slice that no message has."""
        return frozenset({self.variable, *(gone_name(key.name) for key in self.keys)})

    @property
    def topics(self) -> frozenset[str]:
        """The topics that are sliced."""
        return frozenset(topic for key in self.keys for topic in topics_of(key))


@dataclass(frozen=True, slots=True)
class Instances:
    """A property is judged anew from each message on: `each new signal limit N`.

    It is `after MARK, P`, where MARK is the news of `mark`, which comes with that message and never again. At most
    `limit` messages are open at a time, None is any number.
    """

    signal: Signal
    limit: int | None = None

    @property
    def mark(self) -> Signal:
        """A signal that no message has; it stands for the message from which on the property is judged."""
        _, field = next(fields(self.signal))
        name = f"{self.signal.heard}{THIS_ONE}"
        return Signal(name, ValueType.BOOLEAN, replace(field, topic=name, path=()))

    @property
    def keys(self) -> tuple[Signal, ...]:
        """The signals that the run has to have messages of, whatever the property reads."""
        return (self.signal,)

    @property
    def elements(self) -> Mapping[str, Signal]:
        """As of slices: none."""
        return {}

    @property
    def made(self) -> frozenset[str]:
        """The signals of an instance that no message has."""
        return frozenset({self.mark.name})


@dataclass(frozen=True)
class PropertySpecification:
    """One property to be monitored.

    `label` is the author's, or `line N` (`line N.2` for the second on that line). `text` is the property as written,
    without its label and with white space folded. `atoms` are in the order of first use, which is that of `alphabet`.
    `spans` has the place of every part of `property`, by its path; of an association, the place of its use. Of a copy
    that `forall` makes, `names` has those that its variables stand for, and `written` what stands in their places.
    One of `each` has a `slicing`; everything else is about a single slice or instance. A guard relies on one that
    `is_assumed`, and does not keep it.
    """

    label: str
    line: int
    span: Span
    text: str
    property: Property
    atoms: tuple[Atom, ...]
    alphabet: Alphabet
    spans: Mapping[Path, Span]
    names: Mapping[str, str] = field(default_factory=dict)
    written: Mapping[Span, str] = field(default_factory=dict)
    requirement: Requirement | None = None
    slicing: Slicing | Instances | None = None
    is_assumed: bool = False

    def whole(self) -> Span:
        """The place of all of it, the attributes in front of it included."""
        return self.requirement.span if self.requirement else self.span

    def excerpt(self, source: Source, span: Span) -> str:
        """The text of `source` at `span` of this property, on one line."""
        return " ".join(source.replaced(span, self.written).split())

    def inputs(self) -> tuple[Input, ...]:
        """The values of signals that its atoms are computed from, each once, in the order of first use.

        The news on which signals have samples come last.
        """
        read = [i for atom in self.atoms for e in operands(atom.condition) for i in inputs(e)]
        return tuple(dict.fromkeys([*read, *news_within(read)]))

    def signals(self) -> tuple[Signal, ...]:
        """The signals that a run has to have samples or messages of: those that it reads, and its ids."""
        read = (wanted.signal for wanted in self.inputs())
        if self.slicing is None:
            return tuple(dict.fromkeys(read))
        arrays = self.slicing.elements
        others = (arrays.get(signal.name, signal) for signal in read if signal.name not in self.slicing.made)
        return tuple(dict.fromkeys((*self.slicing.keys, *others)))

    def messages(self) -> frozenset[str]:
        """The atoms of messages from which ages count, which may come where there is no step."""
        return messages_of(atom for part in properties.predicates(self.property) for atom in atoms_within(part))

    def counts(self) -> tuple[Occurred, ...]:
        """What it counts, each once."""
        return tuple(dict.fromkeys(each for part in properties.predicates(self.property) for each in counts_of(part)))

    def arrival(self, news: str) -> New:
        """The operand of the atom `news`, which is true when its message comes."""
        (operand,) = (e for atom in self.atoms if atom.name == news for e in operands(atom.condition))
        assert isinstance(operand, New)
        return operand

    def as_written(self, name: str) -> str:
        """The name of one of its atoms as the author wrote it, without the property that an opening belongs to."""
        openings = list(self.openings())
        for opening, written in zip(openings, read_texts(openings), strict=True):
            name = name.replace(text(opening), written)
        return name

    def reads(self) -> tuple[Read, ...]:
        """All that its atoms read: the inputs, then the values at an opening."""
        return (*self.inputs(), *self.openings())

    def openings(self) -> Mapping[Opening, Clock]:
        """The values at an opening that its atoms read, with the clocks that start where they are taken."""
        return self._openings

    def scopes(self) -> Mapping[Clock, Collection[str]]:
        """The scopes at whose opening values are taken, each by its clock, with the atoms that read these values."""
        found: dict[Clock, list[str]] = {clock: [] for clock in self._openings.values()}
        for atom in self.atoms:
            read = {o for e in operands(atom.condition) for o in openings(e)}
            for clock in dict.fromkeys(clock for o, clock in self._openings.items() if o in read):
                found[clock].append(atom.name)
        return found

    @cached_property
    def _openings(self) -> dict[Opening, Clock]:
        clocks = scope_clocks(self.property)
        found = (o for atom in self.atoms for e in operands(atom.condition) for o in openings(e))
        return {opening: clock for opening in found if (clock := clocks[opening.scope])}


class DefinitionKind(Enum):
    """What a name in a specification can be defined as."""

    DECLARATION = "declaration"
    MODEL = "model"
    OBJECT = "object"
    ZONE = "zone"
    MESSAGE = "message"
    ASSOCIATION = "association"


@dataclass(frozen=True, slots=True)
class Definition:
    """A name that the specification defines, where, and whether some property uses it."""

    kind: DefinitionKind
    name: str
    span: Span
    used: bool


@dataclass(frozen=True)
class Specification:
    """A whole file. `rate` is in Hz and `timeout` in ns, None where the file does not set them.

    So long before a deadline its `guards` act: `lead`.
    """

    source: Source
    properties: tuple[PropertySpecification, ...]
    definitions: tuple[Definition, ...]
    rate: float | None = None
    timeout: Nanoseconds | None = None
    guards: tuple[Guard, ...] = ()
    lead: Nanoseconds = LEAD

    def kept_by(self, guard: Guard) -> tuple[PropertySpecification, ...]:
        """The properties that `guard` keeps: those that read what it lets through."""
        return tuple(each for each in self.properties if not each.is_assumed and guard.out in topics(each))


def parts(node: Property | Formula) -> tuple[Property | Formula, ...]:
    """The immediate parts of a property or state predicate, events included, in the order of the text."""
    match node:
        case properties.Now(predicate) | properties.Throughout(predicate):
            return parts(predicate)
        case properties.After(event, body) | properties.Until(event, body):
            return (event, body)
        case properties.AfterUntil(opening, closing, body):
            return (opening, closing, body)
        case Previously() | Once() | Historically() | Since():
            return operands_of(node)
        case Occurred(operand=operand):
            return (operand,)
        case _:
            return properties.children(node) if isinstance(node, Property) else ltl.children(node)


def news_within(wanted: Iterable[Input]) -> Iterator[New]:
    """The news among inputs, and those on which the others, or what these are computed from, have samples."""
    for each in wanted:
        if isinstance(each, New):
            yield each
        else:
            yield from news_within(each.signal.inputs)


def fields(signal: Signal) -> Iterator[tuple[Signal, Field]]:
    """The signals read from messages that `signal` is computed from, possibly itself, with their fields."""
    if isinstance(signal.definition, Field):
        yield signal, signal.definition
        return
    for part in signal.inputs:
        if not isinstance(part, New):
            yield from fields(part.signal)


def topics_of(signal: Signal) -> tuple[str, ...]:
    """The topics that `signal` is read from, each once."""
    return tuple(dict.fromkeys(field.topic for _, field in fields(signal)))


def topics(specification: PropertySpecification) -> tuple[str, ...]:
    """The topics that a property reads, each once, in the order of first use; first that of its messages."""
    is_new = isinstance(specification.slicing, Instances)
    read = specification.signals() if is_new else (part.signal for part in specification.inputs())
    found = (topic for signal in read for topic in topics_of(signal))
    return tuple(dict.fromkeys(found))
