"""Which letters exist: atoms that compare the same expression with constants hold or fail together."""

from __future__ import annotations

from collections.abc import Iterable

from ltlc.language.specification import Atom
from ltlc.semantics.alphabet import Alphabet


def alphabet(atoms: Iterable[Atom]) -> Alphabet:
    """The letters over `atoms` that some values of the signals give."""
    return Alphabet(tuple(atom.name for atom in atoms))
