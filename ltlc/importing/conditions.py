"""Predicate abstraction: the conditions of formulas as atoms of their own, with the letters that they can have."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field

from ltlc.dataclass import dataclass
from ltlc.importing import formulas as f
from ltlc.semantics import ltl
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.diagrams import Diagram, Diagrams, of_diagrams
from ltlc.semantics.words import Letter

States = Mapping[str, ltl.Formula]
"""What conditions are, by their texts: formulas over the atoms of properties."""

MOST_DEPENDENT = 16
"""Of so many conditions about the same atoms it is found out which can hold together."""


class NotComparedError(Exception):
    """A property, or a formula, is not of a form that is compared; the message says why."""


@dataclass(frozen=True)
class Abstraction:
    """Gives each condition an atom: the same one if they hold in the same letters of `possible`.

    A run over these atoms tells two formulas apart if and only if a run over those of `possible` does, and automata
    read few atoms instead of all that conditions are made of.
    """

    states: States
    possible: Alphabet
    _diagrams: Diagrams = field(default_factory=Diagrams)
    _levels: dict[str, int] = field(default_factory=dict)
    _atoms: dict[Diagram, ltl.Formula] = field(default_factory=dict)

    def of(self, condition: f.Formula) -> ltl.Formula:
        """The atom of a condition of one position, or its negation, or what is always or never true."""
        diagrams = self._diagrams
        diagram = self._diagram(condition)
        if diagrams.is_terminal(diagram):
            return ltl.TRUE if diagram == diagrams.true else ltl.Not(ltl.TRUE)
        if (opposite := diagrams.negation(diagram)) in self._atoms:
            return ltl.Not(self._atoms[opposite])
        return self._atoms.setdefault(diagram, ltl.Atom(f"condition {len(self._atoms)}"))

    def _diagram(self, condition: f.Formula) -> Diagram:
        diagrams = self._diagrams
        match condition:
            case f.Atom(text):
                return of_diagrams(self.states.get(text, ltl.Atom(text)), diagrams, self._variable)
            case f.Not(operand):
                return diagrams.negation(self._diagram(operand))
            case f.And(left, right):
                return diagrams.conjunction(self._diagram(left), self._diagram(right))
            case f.Or(left, right):
                return diagrams.disjunction(self._diagram(left), self._diagram(right))
            case _:
                return diagrams.true

    def _variable(self, atom: str) -> Diagram:
        return self._diagrams.variable(self._levels.setdefault(atom, len(self._levels)))

    def alphabet(self) -> Alphabet:
        """The letters over the atoms of conditions. Raises NotComparedError."""
        return Alphabet(tuple(map(_name, self._atoms.values())), tuple(group for group, _ in self._groups()))

    def letter(self, letter: Letter) -> Letter:
        """A letter of `possible` in which the conditions hold whose atoms are in `letter`: one with few atoms."""
        found: set[str] = set()
        names = {level: atom for atom, level in self._levels.items()}
        for group, possible in self._groups():
            for diagram, atom in self._atoms.items():
                if _name(atom) in group.atoms:
                    held = diagram if _name(atom) in letter else self._diagrams.negation(diagram)
                    possible = self._diagrams.conjunction(possible, held)
            paths = (path for path, holds in self._diagrams.paths(possible) if holds)
            path = min(paths, key=lambda path: sum(path.values()))
            found.update(names[level] for level, holds in path.items() if holds)
        return frozenset(found)

    def _groups(self) -> Iterator[tuple[Group, Diagram]]:
        """Conditions that depend on one another, which of them can hold together, and what their letters satisfy."""
        diagrams = self._diagrams
        known = self.possible.restricted_to(atom for atom in self.possible.atoms if atom in self._levels)
        limits = [of_diagrams(group.as_formula(), diagrams, self._variable) for group in known.groups]
        open_ = [(diagram, self._read(diagram)) for diagram in (*self._atoms, *limits)]
        while open_:
            together, read = [open_[0][0]], open_.pop(0)[1]
            while near := [each for each in open_ if each[1] & read]:
                together += [diagram for diagram, _ in near]
                read = read.union(*(more for _, more in near))
                open_ = [each for each in open_ if each not in near]
            conditions = [diagram for diagram in together if diagram in self._atoms]
            possible = diagrams.true
            for limit in set(limits).intersection(together):
                possible = diagrams.conjunction(possible, limit)
            names = tuple(_name(self._atoms[diagram]) for diagram in conditions)
            if len(names) > MOST_DEPENDENT:
                raise NotComparedError("too many conditions depend on one another")
            if names:
                yield Group(names, tuple(self._valuations(conditions, possible))), possible

    def _read(self, diagram: Diagram) -> frozenset[int]:
        nodes = (node for node in self._diagrams.reachable(diagram) if not self._diagrams.is_terminal(node))
        return frozenset(self._diagrams.split(node)[0] for node in nodes)

    def _valuations(self, conditions: list[Diagram], possible: Diagram) -> Iterator[Letter]:
        """The atoms of `conditions` that can hold together where `possible` does."""
        if possible == self._diagrams.false:
            return
        if not conditions:
            yield frozenset()
            return
        first, *rest = conditions
        for letter in self._valuations(rest, self._diagrams.conjunction(possible, first)):
            yield letter | {_name(self._atoms[first])}
        yield from self._valuations(rest, self._diagrams.conjunction(possible, self._diagrams.negation(first)))


def _name(atom: ltl.Formula) -> str:
    assert isinstance(atom, ltl.Atom)
    return atom.name
