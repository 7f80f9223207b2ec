"""Which letters exist over the atoms of a file, and values of the signals that give them.

Atoms that compare one value with constants, by far the most, are decided by trying values; z3 is asked, and imported,
only where several values meet in one atom.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from ltlc.analysis import thresholds
from ltlc.analysis.groups import grouped, inputs_of
from ltlc.analysis.thresholds import Values
from ltlc.language.expressions import Past
from ltlc.language.reference import letter
from ltlc.language.specification import Atom
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.words import Letter, Word

Solve = Callable[[Sequence[Atom]], Sequence[Letter] | None]
"""The sets of atoms that can hold together, or None where that was not decided."""


@dataclass(frozen=True)
class Letters:
    """The letters over `atoms`, which are each atom of the file once.

    `values` has, for the groups whose atoms compare one value, one that gives each valuation. `undecided` are the
    groups of atoms of which more seem possible than may be.
    """

    atoms: tuple[Atom, ...]
    groups: tuple[Group, ...]
    values: dict[tuple[tuple[str, ...], Letter], Values]
    undecided: tuple[tuple[Atom, ...], ...] = ()

    def alphabet(self, names: Iterable[str]) -> Alphabet:
        """The alphabet over the atoms called `names`."""
        kept = set(names)
        groups = tuple(group for group in self.groups if not kept.isdisjoint(group.atoms))
        order = [atom.name for atom in self.atoms if atom.name in kept]
        return Alphabet(tuple(order), groups).restricted_to(order)

    def related(self, names: Iterable[str]) -> frozenset[str]:
        """The atoms called `names` and those that constrain them."""
        kept = frozenset(names)
        return kept.union(*(group.atoms for group in self.groups if not kept.isdisjoint(group.atoms)))


def letters_of(atoms: Iterable[Atom], solve: Solve) -> Letters:
    """The letters over `atoms`; `solve` decides the groups in which several values meet."""
    different = tuple({atom.name: atom for atom in atoms}.values())
    groups: list[Group] = []
    values: dict[tuple[tuple[str, ...], Letter], Values] = {}
    undecided: list[tuple[Atom, ...]] = []
    for members in grouped(different, through_definitions=True):
        found = thresholds.valuations(members)
        if found is not None:
            groups.append(_group(members, found))
            values.update({(groups[-1].atoms, valuation): given for valuation, given in found.items()})
            continue
        for part, valuations in _solved(members, solve):
            if valuations is None:
                undecided.append(part)
            else:
                groups.append(_group(part, valuations))
    return Letters(different, tuple(groups), values, tuple(undecided))


def _group(members: Sequence[Atom], valuations: Iterable[Letter]) -> Group:
    return Group(tuple(atom.name for atom in members), tuple(valuations))


def _solved(members: Sequence[Atom], solve: Solve) -> Iterator[tuple[tuple[Atom, ...], Sequence[Letter] | None]]:
    """`members` as a whole or, where that is too hard, in parts that have no value in common."""
    valuations = solve(members)
    if valuations is not None:
        yield tuple(members), valuations
        return
    parts = grouped(members, through_definitions=False)
    for part in parts:
        simple = thresholds.valuations(part)
        yield part, list(simple) if simple is not None else solve(part) if len(parts) > 1 else None


def steps_of(atoms: Sequence[Atom], word: Word, letters: Letters, linked: bool) -> list[Values] | None:
    """Values of the signals at each step that give the letters of `word` over `atoms`; None if none are found.

    If `linked`, every step is a sample of every signal, so that `@{x, -1}` follows x.
    """
    history = linked and any(isinstance(value, Past) for atom in atoms for value in inputs_of(atom.condition))
    if not history:
        simple = [_simple_values(atoms, letter_, letters) for letter_ in word]
        if all(values is not None for values in simple):
            return [values for values in simple if values is not None]
    from ltlc.analysis import solving

    return solving.realise(atoms, word, linked)


def _simple_values(atoms: Sequence[Atom], wanted: Letter, letters: Letters) -> Values | None:
    """Values that give the letter `wanted`, put together from those of the groups; None if that does not succeed."""
    names = {atom.name for atom in atoms}
    values: Values = {}
    for group in letters.groups:
        if names.isdisjoint(group.atoms):
            continue
        fitting = [v for v in group.valuations if v & names == wanted & frozenset(group.atoms)]
        known = [letters.values[group.atoms, v] for v in fitting if (group.atoms, v) in letters.values]
        if not known:
            return None
        given = min(known, key=lambda found: len(str(list(found.values()))))
        values.update(given)
    inputs = {value for atom in atoms for value in inputs_of(atom.condition)}
    if not inputs <= values.keys() or letter(tuple(atoms), values) != wanted:
        return None
    return {value: given for value, given in values.items() if value in inputs}
