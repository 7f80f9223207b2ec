"""Formulas as sets of infinite words, each translated once: which of them exclude, and which imply, one another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property, reduce
from typing import Any

from ltlc.automata.engine import buddy, spot
from ltlc.automata.machine import Letters, numbered, runs_in_time
from ltlc.automata.spot_translation import FAST, Session
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.diagrams import Diagrams
from ltlc.semantics.ltl import TRUE, Formula, Not, atoms, conjunction
from ltlc.semantics.ordered_machine import OrderedMachine
from ltlc.semantics.reset_machine import ResetMachine
from ltlc.semantics.timed_atoms import atoms_within, timed_atoms
from ltlc.semantics.trackers import trackers_of
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
        self._session = _SharedSession(Letters(order, diagrams, diagrams.true, runs_in_time(TRUE, order, diagrams)))
        self._in_time: dict[frozenset[str], Any] = {}
        self._groups = alphabet.groups
        self._possible: dict[int, Any] = {}

    def of(self, formula: Formula) -> Language:
        """The words of `formula`; they are translated when they are first needed."""
        return Language(self, formula)

    def compatible(self, languages: Sequence[Language]) -> bool:
        """Whether some word is in all of `languages`, and is a run in time."""
        return _meet([*(language.words for language in languages), *self._runs(languages)])

    def implies(self, given: Sequence[Language], then: Language) -> bool:
        """Whether every word in all of `given` that is a run in time is in `then`."""
        automata = [*(language.words for language in given), then.others, *self._runs([*given, then])]
        return not _meet(automata)

    def equal(self, left: Language, right: Language) -> bool:
        """Whether the same runs in time are in both."""
        return self.implies([left], right) and self.implies([right], left)

    def is_closed(self, language: Language) -> bool:
        """Whether every run in time that is not in `language` shows that after some finite time."""
        runs = self._runs([language])
        beginnings = spot.scc_filter_states(reduce(spot.product, runs, language.words))
        beginnings.set_acceptance(0, spot.acc_code.t())
        for edge in beginnings.edges():
            edge.acc = spot.mark_t([])
        return not _meet([beginnings, language.others, *runs])

    def word(self, languages: Sequence[Language]) -> Lasso | None:
        """A word in all of `languages`, not the shortest; None if there is none."""
        first, *others = [*(language.words for language in languages), *self._runs(languages)]
        product = reduce(spot.product, others, first)
        found = product.accepting_word()
        if found is None:
            return None
        found.simplify()
        return Lasso(tuple(map(self._letter, found.prefix)), tuple(map(self._letter, found.cycle)))

    def _runs(self, languages: Sequence[Language]) -> list[Any]:
        """An automaton of the words that are runs in time, as far as `languages` see it; none if all words are."""
        formula = conjunction(language.formula for language in languages)
        clocks = frozenset(atom.name for atom in timed_atoms(formula))
        if not clocks:
            return []
        if clocks not in self._in_time:
            self._in_time[clocks] = self._session.runs(formula)
        return [self._in_time[clocks]]

    def automaton(self, formula: Formula) -> Any:
        """An automaton of the words of `formula`."""
        self._session.learn(formula)
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
    """A session for many formulas, whose timed atoms it learns one after the other."""

    def learn(self, formula: Formula) -> None:
        """Give each atom that decides `formula` a variable."""
        for atom in atoms_within(formula):
            if atom.name not in self._names:
                self._names[atom.name] = spot.formula.ap(f"p{len(self._variables)}")
                self._variables.append(self._registry.register_ap(self._names[atom.name]))
                self.letters = replace(self.letters, atoms=(*self.letters.atoms, atom.name))

    def runs(self, formula: Formula) -> Any:
        """An automaton of the words that are runs in time, as far as the clocks of `formula` tell."""
        self.learn(formula)
        atoms, diagrams = self.letters.atoms, self.letters.diagrams
        clocks = sum(bool(tracker.bounds) for tracker in trackers_of(formula))
        machine = OrderedMachine(formula) if clocks > 1 else ResetMachine(formula)  # one clock has no order
        time = numbered(machine, atoms, diagrams)
        return self._reset_automaton(time)

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
