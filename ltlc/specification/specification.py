"""A specification with all names resolved and all types checked: what every later pass works on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum

from ltlc.semantics import ltl, properties
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import Property
from ltlc.source import Source, Span
from ltlc.specification.atoms import Atom, operands
from ltlc.specification.expressions import Field, Input, Signal, inputs

Path = tuple[int, ...]
"""The way to a part of a property: indexes into `parts`, from the outside in."""


@dataclass(frozen=True)
class PropertySpecification:
    """One property to be monitored.

    `label` is the author's, or `line N` (`line N.2` for the second on that line). `text` is the property as written,
    without its label and with white space folded. `atoms` are in the order of first use, which is that of `alphabet`.
    `spans` has the place of every part of `property`, by its path; of an association, the place of its use.
    """

    label: str
    line: int
    span: Span
    text: str
    property: Property
    atoms: tuple[Atom, ...]
    alphabet: Alphabet
    spans: Mapping[Path, Span]

    def inputs(self) -> tuple[Input, ...]:
        """The values of signals that its atoms are computed from, each once, in the order of first use."""
        return tuple(dict.fromkeys(i for atom in self.atoms for e in operands(atom.condition) for i in inputs(e)))


class DefinitionKind(Enum):
    """What a name in a specification can be defined as."""

    DECLARATION = "declaration"
    MODEL = "model"
    OBJECT = "object"
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
    """A whole file. `rate` is in Hz and `timeout` in s, None where the file does not set them."""

    source: Source
    properties: tuple[PropertySpecification, ...]
    definitions: tuple[Definition, ...]
    rate: float | None = None
    timeout: float | None = None


def parts(node: Property | Formula) -> tuple[Property | Formula, ...]:
    """The immediate parts of a property or state predicate, events included, in the order of the text."""
    match node:
        case properties.Now(predicate) | properties.Throughout(predicate):
            return ltl.children(predicate)
        case properties.After(event, body) | properties.Until(event, body):
            return (event, body)
        case properties.AfterUntil(opening, closing, body):
            return (opening, closing, body)
        case Property():
            return properties.children(node)
        case _:
            return ltl.children(node)


def fields(signal: Signal) -> Iterator[tuple[Signal, Field]]:
    """The signals read from messages that `signal` is computed from, possibly itself, with their fields."""
    if isinstance(signal.definition, Field):
        yield signal, signal.definition
        return
    for part in inputs(signal.definition):
        yield from fields(part.signal)


def topics(specification: PropertySpecification) -> tuple[str, ...]:
    """The topics that a property reads, each once, in the order of first use."""
    found = (field.topic for part in specification.inputs() for _, field in fields(part.signal))
    return tuple(dict.fromkeys(found))
