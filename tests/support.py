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
from ltlc.specification.specification import PropertySpecification


def compiled(property_: Property, encoding: Encoding = EPISODE, alphabet: Alphabet | None = None) -> Compiled:
    """`property_` through encoding and translation, over free atoms unless `alphabet` says otherwise."""
    alphabet = alphabet or Alphabet(atoms(property_))
    specification = PropertySpecification("line 1", 1, Span(0, 0), str(property_), property_, (), alphabet, {})
    formula = encode(property_, encoding)
    return Compiled(specification, encoding, formula, translate(formula, alphabet))


def place(remains: Formula) -> Place:
    """Where a formula without clocks remains to be satisfied."""
    return Place(WITHOUT_CLOCKS, remains)
