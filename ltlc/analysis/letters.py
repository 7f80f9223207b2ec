"""Which letters exist over the atoms of a file, and values of the signals that give them.

Atoms that compare one value with constants, by far the most, are decided by trying values; z3 is asked, and imported,
only where several values meet in one atom.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from ltlc.analysis import thresholds
from ltlc.analysis.doubles import reached
from ltlc.analysis.groups import grouped, inputs_of
from ltlc.analysis.thresholds import Values
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.words import Letter, Word
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import letter
from ltlc.specification.expressions import Past

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


def letters_of(properties: Iterable[Sequence[Atom]], solve: Solve) -> Letters:
    """The letters over the atoms of `properties`; `solve` decides the groups in which several values meet.

    Where a group is too hard as a whole, the atoms of one property after the other are taken by themselves.
    """
    by_property = list(properties)
    different = tuple({atom.name: atom for atoms in by_property for atom in atoms}.values())
    found: list[tuple[Group, dict[Letter, Values]]] = []
    undecided: list[tuple[Atom, ...]] = []
    for members in grouped(different, through_definitions=True):
        group = _group(members, solve)
        if group is not None:
            found.append(group)
            continue
        undecided.append(members)
        parts = (_group(part, solve) for part in _by_property(members, by_property))
        found.extend(part for part in parts if part is not None)
    values = {(group.atoms, valuation): given for group, known in found for valuation, given in known.items()}
    return Letters(different, tuple(group for group, _ in found), values, tuple(undecided))


def _group(members: Sequence[Atom], solve: Solve) -> tuple[Group, dict[Letter, Values]] | None:
    """The group of `members`, with values that give its valuations where these are known; None if it is too hard."""
    names = tuple(atom.name for atom in members)
    simple = thresholds.valuations(members)
    if simple is not None:
        return Group(names, tuple(simple)), simple
    valuations = solve(members)
    if valuations is None:
        return None
    rounded = {v: values for v, values in reached(members).items() if v not in valuations}
    return Group(names, (*valuations, *rounded)), rounded


def _by_property(members: Sequence[Atom], properties: Sequence[Sequence[Atom]]) -> Iterator[tuple[Atom, ...]]:
    """`members` in parts that stand in one property each: every atom in that of its first use."""
    left = {atom.name for atom in members}
    for atoms in properties:
        part = tuple(atom for atom in atoms if atom.name in left)
        left -= {atom.name for atom in part}
        yield from grouped(part, through_definitions=True)


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
