"""Questions about formulas that Spot decides: emptiness, implication, the temporal class, the sizes of its automata."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from enum import Enum
from typing import Any

from ltlc.automata.engine import spot
from ltlc.automata.languages import Languages
from ltlc.automata.machine import Letters, Machine, letters_of, read_by, successor_sets, to_monitor
from ltlc.automata.spot_translation import FAST, Session
from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.diagrams import Diagram
from ltlc.semantics.ltl import And, Atom, Formula, Not, Or, conjunction, globally
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.timed_atoms import TimedAtom, atoms_within, timed_atoms
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso, Letter


class TemporalClass(Enum):
    """The smallest class of the hierarchy of Manna and Pnueli (1990) that a formula belongs to, on infinite runs."""

    SAFETY_AND_GUARANTEE = "safety and guarantee"
    SAFETY = "safety"
    GUARANTEE = "guarantee"
    OBLIGATION = "obligation"
    RECURRENCE = "recurrence"
    PERSISTENCE = "persistence"
    REACTIVITY = "reactivity"


_CLASSES = dict(zip("BSGORPT", TemporalClass, strict=True))
"""The classes by the letter that Spot has for each."""

_CLASSES_IN_TIME = {
    (True, True): TemporalClass.SAFETY_AND_GUARANTEE,
    (True, False): TemporalClass.SAFETY,
    (False, True): TemporalClass.GUARANTEE,
    (False, False): None,
}


@dataclass(frozen=True, slots=True)
class Size:
    """How large an automaton of Spot's is; `edges` have a guard each, which may stand for many letters."""

    states: int
    edges: int


@dataclass(frozen=True, slots=True)
class Buchi:
    """A nondeterministic Büchi automaton over our diagrams, with state 0 initial.

    A state's diagram gives the set (`frozenset`) of the edges that a letter can take: `2 * q + 1` leads to state q and
    is accepting, `2 * q` leads there and is not. A run with infinitely many accepting edges accepts.
    """

    letters: Letters
    successors: list[Diagram]


def is_satisfiable(formula: Formula, alphabet: Alphabet) -> bool:
    """Whether some infinite run over the letters of `alphabet` satisfies `formula`."""
    session = Session(letters_of(formula, alphabet))
    return session.is_satisfiable(session.to_spot(formula, finite=False))


def implies(left: Formula, right: Formula, alphabet: Alphabet) -> bool:
    """Whether every infinite run over the letters of `alphabet` that satisfies `left` satisfies `right`."""
    return not is_satisfiable(And(left, Not(right)), alphabet)


def can_be_kept(formula: Formula, outputs: Collection[str], alphabet: Alphabet) -> bool:
    """Whether someone who sets the atoms in `outputs` can make sure that `formula`, without timed atoms, holds.

    The world sets the other atoms, at each step first; both keep to the letters of `alphabet`. Decided by a game
    (Pnueli and Rosner 1989; Spot's `ltl_to_game`).
    """
    exists = read_by(formula, alphabet)
    of_world = exists.restricted_to(atom for atom in exists.atoms if atom not in outputs)
    kept = Or(Not(globally(of_world.as_formula())), And(formula, globally(exists.as_formula())))
    session = Session(letters_of(kept, _own_alphabet(kept)))
    names = [name for name in exists.atoms if name in outputs]
    written = [str(session.to_spot(Atom(name), finite=False)) for name in names]
    return bool(spot.solve_game(spot.ltl_to_game(session.to_spot(kept, finite=False), written)))


def temporal_class(formula: Formula, alphabet: Alphabet) -> TemporalClass:
    """The class of `formula` among the infinite runs over the letters of `alphabet`.

    Those runs are a closed set, so intersecting with them changes no class but guarantee; for that, the other runs are
    added instead. Of runs in time, in which a deadline passes some time, only safety and guarantee are decided; what is
    neither has the class that it has where clocks may do as they like, which is no smaller.
    """
    in_time = _CLASSES_IN_TIME[_closed_in_time(formula, alphabet)] if timed_atoms(formula) else None
    if in_time is not None:
        return in_time
    exists = globally(read_by(formula, alphabet).as_formula())
    closed, open_ = _class(And(exists, formula)), _class(Or(Not(exists), formula))
    if open_ in "BG":
        return _CLASSES["B" if closed in "BS" else "G"]
    return _CLASSES["S" if closed == "B" else closed]


def _closed_in_time(formula: Formula, alphabet: Alphabet) -> tuple[bool, bool]:
    """Whether what violates `formula` shows after some finite time, and whether what satisfies it does."""
    space = Languages(alphabet)
    return space.is_closed(space.of(formula)), space.is_closed(space.of(Not(formula)))


def _own_alphabet(formula: Formula) -> Alphabet:
    """The atoms that decide `formula` and that nothing else decides, free."""
    return Alphabet(tuple(atom.name for atom in atoms_within(formula) if not isinstance(atom, TimedAtom)))


def _class(formula: Formula) -> str:
    session = Session(letters_of(formula, _own_alphabet(formula)))
    return str(spot.mp_class(session.to_spot(formula, finite=False)))


def nondeterministic_size(formula: Formula) -> Size:
    """The size of Spot's nondeterministic automaton of `formula`: generalised Büchi, as small as Spot can make it."""
    return _size(formula, spot.postprocessor.GeneralizedBuchi, spot.postprocessor.Small)


def deterministic_size(formula: Formula) -> Size:
    """The size of Spot's deterministic parity automaton of `formula`."""
    return _size(formula, spot.postprocessor.Parity, spot.postprocessor.Deterministic)


def _size(formula: Formula, kind: Any, preference: Any) -> Size:
    session = Session(letters_of(formula, _own_alphabet(formula)))
    translator = spot.translator()
    translator.set_type(kind)
    translator.set_pref(preference)
    automaton = translator.run(session.to_spot(formula, finite=False))
    return Size(automaton.num_states(), automaton.num_edges())


def words_of(formulas: Sequence[Formula], alphabet: Alphabet) -> list[Machine]:
    """For each of `formulas`, the minimal machine of whether a word, not empty, satisfies it (LTLf).

    The machines read the letters of `alphabet` and share their diagrams.
    """
    session = Session(letters_of(conjunction(formulas), alphabet))
    return [session.finitely_satisfied(formula) for formula in formulas]


def ending(formula: Formula, alphabet: Alphabet) -> Monitor:
    """Whether a word, not empty, satisfies the formula, as a monitor with presumable verdicts only."""
    (machine,) = words_of([formula], alphabet)
    presumed = {True: Verdict.PRESUMABLY_SATISFIED, False: Verdict.PRESUMABLY_VIOLATED}
    return to_monitor(replace(machine, outputs=[presumed[holds] for holds in machine.outputs]))


def buchi(formula: Formula, alphabet: Alphabet) -> Buchi:
    """A Büchi automaton of the infinite runs over the letters of `alphabet` that satisfy `formula`."""
    return _BuchiSession(letters_of(formula, alphabet)).buchi(formula)


def some_lasso(formula: Formula, alphabet: Alphabet) -> Lasso | None:
    """An infinite run over the letters of `alphabet` that satisfies `formula`, of any length; None if none does."""
    return _BuchiSession(letters_of(formula, alphabet)).some_lasso(formula)


class _BuchiSession(Session):
    """Büchi automata of one formula, and the words that they accept."""

    def some_lasso(self, formula: Formula) -> Lasso | None:
        automaton = self._restricted(self._run(self.to_spot(formula, finite=False), FAST), self._possible)
        word = automaton.accepting_word()
        if word is None:
            return None
        return Lasso(tuple(map(self._letter, word.prefix)), tuple(map(self._letter, word.cycle)))

    def _letter(self, guard: Any) -> Letter:
        """A letter that satisfies `guard`."""
        diagrams, letters = self.letters.diagrams, self.letters
        node, letter = diagrams.conjunction(self._to_diagram(guard), letters.possible), set()
        while not diagrams.is_terminal(node):
            level, low, node = diagrams.split(node)
            if low != diagrams.false:
                node = low
            else:
                letter.add(letters.atoms[level])
        return frozenset(letter)

    def buchi(self, formula: Formula) -> Buchi:
        translator = spot.translator(self._dict)
        translator.set_type(spot.postprocessor.Buchi)
        translator.set_pref(spot.postprocessor.Small)
        automaton = self._restricted(translator.run(self.to_spot(formula, finite=False)), self._possible)
        numbers = {automaton.get_init_state_number(): 0}
        for state in range(automaton.num_states()):
            numbers.setdefault(state, len(numbers))
        guards = [self._guards_of_edges(automaton, state, numbers) for state in numbers]
        return Buchi(self.letters, [successor_sets(self.letters.diagrams, of_state) for of_state in guards])

    def _guards_of_edges(self, automaton: Any, state: int, numbers: dict[int, int]) -> dict[int, Diagram]:
        """The letters by which each edge of `Buchi` can be taken from `state`."""
        guards: dict[int, Any] = {}
        for edge in automaton.out(state):
            target = 2 * numbers[edge.dst] + bool(edge.acc.count())
            guards[target] = guards[target] | edge.cond if target in guards else edge.cond
        return {target: self._to_diagram(guard) for target, guard in guards.items()}
