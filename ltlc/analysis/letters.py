"""Which letters exist over the atoms of a file, and values of the signals that give them.

Atoms that compare one value with constants, by far the most, are decided by trying values; z3 is asked, and imported,
only where several values meet in one atom, and some plain ones do not show that every letter exists.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

from ltlc.analysis import thresholds
from ltlc.analysis.doubles import reached, reached_plainly
from ltlc.analysis.groups import grouped, reads_of
from ltlc.analysis.thresholds import Values
from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.words import Letter, Word, letters_over
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import letter
from ltlc.specification.expressions import Opening, Past

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
        order = sorted(set(names) & self._places.keys(), key=self._places.__getitem__)
        return Alphabet(tuple(order), tuple(self.touched(order))).restricted_to(order)

    def related(self, names: Iterable[str]) -> frozenset[str]:
        """The atoms called `names` and those that constrain them."""
        kept = frozenset(names)
        return kept.union(*(group.atoms for group in self.touched(kept)))

    @cached_property
    def _places(self) -> dict[str, int]:
        """Where each atom stands."""
        return {atom.name: place for place, atom in enumerate(self.atoms)}

    @cached_property
    def _groups_of(self) -> dict[str, list[int]]:
        """The numbers of the groups that each atom is in."""
        found: dict[str, list[int]] = {}
        for number, group in enumerate(self.groups):
            for atom in group.atoms:
                found.setdefault(atom, []).append(number)
        return found

    def touched(self, names: Iterable[str]) -> list[Group]:
        """The groups of the atoms called `names`, in their order."""
        return [self.groups[number] for number in sorted({n for name in names for n in self._groups_of.get(name, ())})]


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


def with_messages(letters: Letters, messages: Collection[str], is_rated: bool) -> Letters:
    """`letters` where `messages`, from which ages count, may come that are no news since they make no step.

    With a rate, news at a tick may be of earlier messages.
    """

    def freed(group: Group) -> Group:
        own = frozenset(group.atoms).intersection(messages)
        alone = (frozenset(v & own) for v in group.valuations)
        earlier = (frozenset(v - own) for v in group.valuations if is_rated)
        return replace(group, valuations=tuple(dict.fromkeys([*group.valuations, *alone, *earlier]))) if own else group

    return replace(letters, groups=tuple(map(freed, letters.groups)))


def real_letters(atoms: Sequence[Atom], solve: Solve) -> Letters:
    """The letters over `atoms` that finite numbers give, without rounding; more where `solve` does not decide."""
    groups = ((members, solve(members)) for members in grouped(atoms, through_definitions=True))
    known = [
        Group(tuple(atom.name for atom in members), tuple(found)) for members, found in groups if found is not None
    ]
    return Letters(tuple(atoms), tuple(known), {})


def _group(members: Sequence[Atom], solve: Solve) -> tuple[Group, dict[Letter, Values]] | None:
    """The group of `members`, with values that give its valuations where these are known; None if it is too hard."""
    names = tuple(atom.name for atom in members)
    simple = thresholds.valuations(members)
    if simple is not None:
        return Group(names, tuple(simple)), simple
    plain = reached_plainly(members)
    if len(plain) == 1 << len(members):
        return Group(names, tuple(letters_over(names))), plain
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


def steps_of(
    atoms: Sequence[Atom], word: Word, letters: Letters, linked: bool, taken: Mapping[tuple[Opening, int], int]
) -> list[Values] | None:
    """Values of the signals at each step that give the letters of `word` over `atoms`; None if none are found.

    If `linked`, every step is a sample of every signal, so that `@{x, -1}` follows x. `taken` says for the values at an
    opening that are read at a step at which step they were taken.
    """
    history = linked and any(isinstance(value, Past) for atom in atoms for value in reads_of(atom.condition))
    if not history and not taken:
        simple = [_simple_values(atoms, letter_, letters) for letter_ in word]
        if all(values is not None for values in simple):
            return [values for values in simple if values is not None]
    from ltlc.analysis import solving

    return solving.realise(atoms, word, linked, taken)


def _simple_values(atoms: Sequence[Atom], wanted: Letter, letters: Letters) -> Values | None:
    """Values that give the letter `wanted`, put together from those of the groups; None if that does not succeed."""
    names = {atom.name for atom in atoms}
    values: Values = {}
    for group in letters.touched(names):
        fitting = [v for v in group.valuations if v & names == wanted & frozenset(group.atoms)]
        known = [letters.values[group.atoms, v] for v in fitting if (group.atoms, v) in letters.values]
        if not known:
            return None
        given = min(known, key=lambda found: len(str(list(found.values()))))
        values.update(given)
    inputs = {value for atom in atoms for value in reads_of(atom.condition)}
    if not inputs <= values.keys() or letter(tuple(atoms), values) != wanted:
        return None
    return {value: given for value, given in values.items() if value in inputs}
