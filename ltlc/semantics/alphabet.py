"""Which letters exist: the atoms of a property are not independent if they are about the same number.

`d < 1` and `d > 1` never hold together. Atoms that constrain one another form a group, and the letters that exist are
the products of the groups' valuations: thirty thresholds on one signal have thirty-one valuations, not 2^30.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import product
from math import prod

from ltlc.dataclass import dataclass
from ltlc.semantics.ltl import TRUE, Atom, Formula, Not, conjunction, disjunction
from ltlc.semantics.words import Letter, letters_over

Answers = Mapping[str, bool]
"""Some atoms, and whether they hold."""


@dataclass(frozen=True, slots=True)
class Group:
    """Atoms that constrain one another: `valuations` are the sets of them that can hold at one step."""

    atoms: tuple[str, ...]
    valuations: tuple[Letter, ...]

    def as_formula(self) -> Formula:
        """The state predicate that holds in exactly the valuations of the group."""
        return disjunction(
            conjunction(Atom(a) if a in valuation else Not(Atom(a)) for a in self.atoms)
            for valuation in self.valuations
        )

    def fitting(self, answers: Answers) -> list[Letter]:
        """The valuations that agree with `answers`, which may be about other atoms too."""
        asked = [(atom, answers[atom]) for atom in self.atoms if atom in answers]
        return [v for v in self.valuations if all((atom in v) == answer for atom, answer in asked)]


@dataclass(frozen=True, slots=True)
class Alphabet:
    """The letters that exist over `atoms`, in the order of first use; an atom in no group is free."""

    atoms: tuple[str, ...]
    groups: tuple[Group, ...] = ()

    def allows(self, letter: Letter) -> bool:
        """Whether a step can have this letter."""
        return all(letter & frozenset(group.atoms) in group.valuations for group in self.groups)

    def free_atoms(self) -> list[str]:
        """The atoms that are in no group."""
        grouped = {atom for group in self.groups for atom in group.atoms}
        return [atom for atom in self.atoms if atom not in grouped]

    def count(self) -> int:
        """How many letters exist."""
        return prod(len(group.valuations) for group in self.groups) << len(self.free_atoms())

    def letters(self) -> Iterator[Letter]:
        """Every letter that exists, one after the other; there may be more than anyone wants, see `count`."""
        for free in letters_over(self.free_atoms()):
            for parts in product(*(group.valuations for group in self.groups)):
                yield free.union(*parts)

    def completed(self, answers: Answers) -> Letter | None:
        """A letter that exists and gives `answers`, with as few further atoms as it goes; None if there is none."""
        grouped = {atom for group in self.groups for atom in group.atoms}
        held = {atom for atom, answer in answers.items() if answer and atom not in grouped}
        for group in self.groups:
            fitting = group.fitting(answers)
            if not fitting:
                return None
            held |= min(fitting, key=len)
        return frozenset(held)

    def as_formula(self) -> Formula:
        """The state predicate that holds for exactly the letters that exist; `true` if all atoms are free."""
        return conjunction(group.as_formula() for group in self.groups) if self.groups else TRUE

    def restricted_to(self, atoms: Iterable[str]) -> Alphabet:
        """The alphabet over some of the atoms: what remains of each letter that exists.

        Atoms of a group of which every valuation remains are free.
        """
        kept = tuple(atoms)
        wanted, groups = frozenset(kept), []
        for group in self.groups:
            inside = tuple(atom for atom in group.atoms if atom in wanted)
            valuations = dict.fromkeys(v & frozenset(inside) for v in group.valuations)
            if len(valuations) < 2 ** len(inside):
                groups.append(Group(inside, tuple(valuations)))
        return Alphabet(kept, tuple(groups))
