"""Formulas as sets of infinite words, each translated once: which of them exclude, and which imply, one another."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property, reduce
from itertools import islice
from typing import Any

from ltlc.automata.engine import buddy, spot
from ltlc.automata.machine import Letters, Move, edges_in_time, runs_in_time
from ltlc.automata.spot_translation import FAST, Session, add_edges, useful_states
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.diagrams import Diagrams
from ltlc.semantics.ltl import TRUE, And, Atom, Formula, Not, Or, Truth, atoms, conjunction
from ltlc.semantics.ordered_machine import OrderedMachine
from ltlc.semantics.reset_machine import ResetMachine
from ltlc.semantics.timed_atoms import TimedAtom, atoms_within
from ltlc.semantics.words import Lasso, Letter, Word

FIRST_EDGES = 16
"""So much of the runs in time is made before they are looked at."""


class Language:
    """The infinite words of `formula`, or with `finite` its finite ones, and those that are not."""

    def __init__(self, space: Languages, formula: Formula, finite: bool) -> None:
        self.formula = formula
        self._space, self._finite = space, finite

    @cached_property
    def words(self) -> Any:
        """An automaton of Spot's that accepts them."""
        return self._space.automaton(self.formula, self._finite)

    @cached_property
    def others(self) -> Any:
        """An automaton of Spot's that accepts all other words."""
        return self._space.automaton(Not(self.formula), self._finite)


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
        self._groups = alphabet.groups
        self._group_of = {atom: number for number, group in enumerate(alphabet.groups) for atom in group.atoms}
        self._possible: dict[int, Any] = {}

    def of(self, formula: Formula, finite: bool = False) -> Language:
        """The words of `formula`, with `finite` the finite ones; they are translated when they are first needed."""
        return Language(self, formula, finite)

    def compatible(self, languages: Sequence[Language]) -> bool:
        """Whether some word is in all of `languages`, and is a run in time."""
        return self._have_a_run([language.words for language in languages])

    def implies(self, given: Sequence[Language], then: Language) -> bool:
        """Whether every word in all of `given` that is a run in time is in `then`."""
        return not self._have_a_run([*(language.words for language in given), then.others])

    def equal(self, left: Language, right: Language) -> bool:
        """Whether the same runs in time are in both."""
        return self.implies([left], right) and self.implies([right], left)

    def is_closed(self, language: Language) -> bool:
        """Whether every run in time that is not in `language` shows that after some finite time."""
        beginnings = spot.scc_filter_states(self._in_time(language.words))
        beginnings.set_acceptance(0, spot.acc_code.t())
        for edge in beginnings.edges():
            edge.acc = spot.mark_t([])
        return not self._have_a_run([beginnings, language.others])

    def word(self, languages: Sequence[Language]) -> Lasso | None:
        """A word in all of `languages`, not the shortest; None if there is none."""
        together = reduce(spot.product, [language.words for language in languages])
        found = self._in_time(together).accepting_word()
        if found is None:
            return None
        found.simplify()
        return Lasso(tuple(map(self._letter, found.prefix)), tuple(map(self._letter, found.cycle)))

    def shortest_word(self, languages: Sequence[Language]) -> Word | None:
        """A shortest word, not empty, that is in all finite `languages` and begins a word of each other one."""
        return self._session.shortest_word(reduce(spot.product, [language.words for language in languages]))

    def _have_a_run(self, automata: list[Any]) -> bool:
        """Whether some word that all of `automata` accept is a run in time."""
        runs = self._session.runs(automata)
        if runs is None:
            return _meet(automata)
        together = reduce(spot.product, automata)
        while not together.intersects(runs.automaton):
            if together.is_empty() or not runs.grow():
                return False
        return True

    def _in_time(self, automaton: Any) -> Any:
        """`automaton` on the words that are runs in time."""
        runs = self._session.runs([automaton])
        return automaton if runs is None else spot.product(automaton, runs.whole())

    def automaton(self, formula: Formula, finite: bool) -> Any:
        """An automaton of the words of `formula`."""
        self._session.learn(formula)
        possible = buddy.bddtrue
        for number in sorted({self._group_of[atom] for atom in atoms(formula) if atom in self._group_of}):
            possible &= self._valuations(number, self._groups[number])
        return self._session.automaton(formula, possible, finite)

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


class Runs:
    """The words that are runs in time: an automaton of Spot's, which is made only as far as a question needs it."""

    def __init__(self, automaton: Any, edges: Iterator[tuple[int, Move, Any]]) -> None:
        self.automaton = automaton
        self._edges = edges

    def grow(self) -> bool:
        """Add about as many edges as there are; whether there was one left."""
        before = self.automaton.num_edges()
        add_edges(self.automaton, islice(self._edges, max(before, FIRST_EDGES)))
        return bool(self.automaton.num_edges() > before)

    def whole(self) -> Any:
        """The automaton with all its edges."""
        add_edges(self.automaton, self._edges)
        return self.automaton


class _SharedSession(Session):
    """A session for many formulas, whose timed atoms it learns one after the other."""

    def __init__(self, letters: Letters) -> None:
        super().__init__(letters)
        self._holding = {n: buddy.bdd_ithvar(v) for n, v in zip(letters.atoms, self._variables, strict=True)}
        self._timed: dict[str, TimedAtom] = {}
        self._runs: dict[frozenset[str], Runs] = {}

    def learn(self, formula: Formula) -> None:
        """Give each atom that decides `formula` a variable."""
        for atom in atoms_within(formula):
            if atom.name not in self._names:
                self._names[atom.name] = spot.formula.ap(f"p{len(self._variables)}")
                self._variables.append(self._registry.register_ap(self._names[atom.name]))
                self._holding[atom.name] = buddy.bdd_ithvar(self._variables[-1])
                self.letters = replace(self.letters, atoms=(*self.letters.atoms, atom.name))
            if isinstance(atom, TimedAtom):
                self._timed[self._names[atom.name].ap_name()] = atom

    def runs(self, automata: Iterable[Any]) -> Runs | None:
        """The words that are runs in time, as far as what `automata` read shows; None if all words are."""
        read = frozenset(self._timed).intersection(atom.ap_name() for automaton in automata for atom in automaton.ap())
        if read and read not in self._runs:
            unordered = ResetMachine(conjunction(self._timed[variable] for variable in sorted(read)))
            clocks = sum(bool(tracker.bounds) for tracker in unordered.trackers)
            machine = OrderedMachine(unordered) if clocks > 1 else unordered  # one clock has no order
            edges = edges_in_time(machine, buddy.bddtrue, self._narrowed)
            self._runs[read] = Runs(self._automaton_in_time(machine.sets), edges)
        return self._runs.get(read)

    def _narrowed(self, letters: Any, predicate: Formula) -> Any:
        found = letters & self._letters_with(predicate)
        return None if found == buddy.bddfalse else found

    def _letters_with(self, predicate: Formula) -> Any:
        """The letters in which a state predicate holds."""
        match predicate:
            case Truth():
                return buddy.bddtrue
            case Atom(name):
                return self._holding[name]
            case Not(operand):
                return -self._letters_with(operand)
            case And(left, right):
                return self._letters_with(left) & self._letters_with(right)
            case Or(left, right):
                return self._letters_with(left) | self._letters_with(right)
            case _:
                raise TypeError(f"not a state predicate: {predicate!r}")

    def automaton(self, formula: Formula, possible: Any, finite: bool) -> Any:
        """A generalised Büchi automaton of the words of `formula` whose letters are in `possible`."""
        spot_formula = self.to_spot(formula, finite)
        if finite:
            spot_formula, possible = self.ending(spot_formula), possible | -self._alive
        return self._restricted(self._run(spot_formula, FAST), possible)

    def shortest_word(self, automaton: Any) -> Word | None:
        """A shortest finite word that `automaton`, of `finite` words, accepts; None if there is none."""
        ending = useful_states(self._restricted(automaton, -self._alive))
        living = self._restricted(automaton, self._alive)
        start = living.get_init_state_number()
        words: dict[int, Word] = {start: ()}
        waiting = deque([start])
        while waiting:
            state = waiting.popleft()
            for edge in living.out(state):
                if edge.dst in ending:
                    return (*words[state], self.letter(edge.cond))
                if edge.dst not in words:
                    words[edge.dst] = (*words[state], self.letter(edge.cond))
                    waiting.append(edge.dst)
        return None

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
            held.append(names.get(buddy.bdd_var(guard), ""))
            guard = buddy.bdd_high(guard)
        return frozenset(filter(None, held))
