"""Formulas as sets of infinite words, each translated once: which of them exclude, and which imply, one another."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

from ltlc.automata.engine import buddy, spot
from ltlc.automata.machine import Letters
from ltlc.automata.spot_translation import FAST, Session
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.diagrams import Diagrams
from ltlc.semantics.ltl import Formula, Not, atoms
from ltlc.semantics.words import Lasso, Letter


class Language:
    """The infinite words of `formula`, and those that are not."""

    def __init__(self, space: Languages, formula: Formula) -> None:
        self.formula = formula
        self._space = space

    @cached_property
    def words(self) -> Any:
        """An automaton of Spot's that accepts them."""
        return self._space.automaton(self.formula)

    @cached_property
    def others(self) -> Any:
        """An automaton of Spot's that accepts all other words."""
        return self._space.automaton(Not(self.formula))


class Languages:
    """Questions about formulas over the letters of one alphabet.

    Automata read only the groups of atoms that their formula touches, so that large alphabets cost nothing.
    """

    def __init__(self, alphabet: Alphabet) -> None:
        # Atoms that constrain one another stand together: their diagrams are small in that order.
        grouped = [atom for group in alphabet.groups for atom in group.atoms]
        order = tuple(dict.fromkeys([*grouped, *alphabet.atoms]))
        diagrams = Diagrams()
        self._session = _SharedSession(Letters(order, diagrams, diagrams.true))
        self._groups = alphabet.groups
        self._possible: dict[int, Any] = {}

    def of(self, formula: Formula) -> Language:
        """The words of `formula`; they are translated when they are first needed."""
        return Language(self, formula)

    def compatible(self, languages: Sequence[Language]) -> bool:
        """Whether some word is in all of `languages`."""
        return _meet([language.words for language in languages])

    def implies(self, given: Sequence[Language], then: Language) -> bool:
        """Whether every word in all of `given` is in `then`."""
        return not _meet([*(language.words for language in given), then.others])

    def word(self, languages: Sequence[Language]) -> Lasso | None:
        """A word in all of `languages`, not the shortest; None if there is none."""
        product = languages[0].words
        for language in languages[1:]:
            product = spot.product(product, language.words)
        found = product.accepting_word()
        if found is None:
            return None
        found.simplify()
        return Lasso(tuple(map(self._letter, found.prefix)), tuple(map(self._letter, found.cycle)))

    def automaton(self, formula: Formula) -> Any:
        """An automaton of the words of `formula`."""
        used = set(atoms(formula))
        possible = buddy.bddtrue
        for number, group in enumerate(self._groups):
            if not used.isdisjoint(group.atoms):
                possible &= self._valuations(number, group)
        return self._session.automaton(formula, possible)

    def _valuations(self, number: int, group: Group) -> Any:
        if number not in self._possible:
            self._possible[number] = self._session.valuations(group)
        return self._possible[number]

    def _letter(self, guard: Any) -> Letter:
        """A letter that exists and that `guard` admits."""
        possible = buddy.bddtrue
        for number, group in enumerate(self._groups):
            possible &= self._valuations(number, group)
        return self._session.letter(guard & possible)


def _meet(automata: list[Any]) -> bool:
    """Whether some word is accepted by all of `automata`."""
    product = automata[0]
    for automaton in automata[1:-1]:
        product = spot.product(product, automaton)
    return bool(product.intersects(automata[-1])) if len(automata) > 1 else not product.is_empty()


class _SharedSession(Session):
    """A session for many formulas."""

    def automaton(self, formula: Formula, possible: Any) -> Any:
        """A generalised Büchi automaton of the words of `formula` whose letters are in `possible`."""
        return self._restricted(self._run(self.to_spot(formula, finite=False), FAST), possible)

    def valuations(self, group: Group) -> Any:
        """The letters in which the atoms of `group` have one of its valuations."""
        numbers = {atom: self._variables[level] for level, atom in enumerate(self.letters.atoms)}
        found = buddy.bddfalse
        for valuation in group.valuations:
            cube = buddy.bddtrue
            for atom in reversed(group.atoms):
                cube &= (buddy.bdd_ithvar if atom in valuation else buddy.bdd_nithvar)(numbers[atom])
            found |= cube
        return found

    def letter(self, guard: Any) -> Letter:
        """The atoms that hold in one letter of `guard`, as few as on one path through it."""
        names = dict(zip(self._variables, self.letters.atoms, strict=True))
        held = []
        while guard != buddy.bddtrue:
            if buddy.bdd_low(guard) != buddy.bddfalse:
                guard = buddy.bdd_low(guard)
                continue
            held.append(names[buddy.bdd_var(guard)])
            guard = buddy.bdd_high(guard)
        return frozenset(held)
