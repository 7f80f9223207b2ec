"""Ways to get a compiled property without a file."""

from __future__ import annotations

from ltlc.automata import translate
from ltlc.base.source import Span
from ltlc.compiler import Compiled
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.certificate import Place
from ltlc.semantics.encodings import EPISODE, Encoding, encode
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import Property, atoms
from ltlc.semantics.reset_machine import WITHOUT_CLOCKS
from ltlc.semantics.timed_atoms import news_of
from ltlc.specification.atoms import Atom as Condition
from ltlc.specification.expressions import Current, Field, Input, IsTrue, New, Signal, ValueType
from ltlc.specification.specification import PropertySpecification


def compiled(
    property_: Property, encoding: Encoding = EPISODE, alphabet: Alphabet | None = None, label: str = "line 1"
) -> Compiled:
    """`property_` through encoding and translation, over free atoms unless `alphabet` says otherwise.

    `new s` and `message on s` are news of s, every other atom is a signal.
    """
    alphabet, formula = alphabet or Alphabet(atoms(property_)), encode(property_, encoding)
    read: dict[str, Input] = {name: Current(signal(name)) for name in alphabet.atoms}
    read |= {news.name: New(signal(news.name.rpartition(" ")[2])) for news in news_of(formula)}
    written = tuple(Condition(name, IsTrue(value), Span(0, 0)) for name, value in read.items())
    specification = PropertySpecification(label, 1, Span(0, 0), str(property_), property_, written, alphabet, {})
    return Compiled(specification, encoding, formula, translate(formula, alphabet))


def signal(name: str) -> Signal:
    """A boolean of a topic of its own."""
    return Signal(name, ValueType.BOOLEAN, Field(f"/{name}", "std_msgs/msg/Bool", ("data",)))


def place(remains: Formula) -> Place:
    """Where a formula without clocks remains to be satisfied."""
    return Place(WITHOUT_CLOCKS, remains)
