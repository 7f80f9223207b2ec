"""An exact oracle for the four verdicts: the tableau of a formula over letters written out one by one.

A state is a letter and a guess, for each subformula `Next` or `Until`, whether it holds; a step must keep the guesses'
promises, and for ever putting off an `Until` is unfair (Lichtenstein and Pnueli 1985). Slow, for few operators only.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product

from ltlc.semantics import finite
from ltlc.semantics.ltl import And, Atom, Formula, Next, Not, Or, Truth, Until, subformulas
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter, Word

State = tuple[Letter, frozenset[Next | Until]]
"""A letter, and the `Next` and `Until` subformulas that are guessed to hold."""


class Tableau:
    """Which verdict a word of `letters` deserves for `formula`."""

    def __init__(self, formula: Formula, letters: Iterable[Letter]) -> None:
        self.formula = formula
        self._temporal = list(dict.fromkeys(f for f in subformulas(formula) if isinstance(f, Next | Until)))
        guesses = [
            frozenset(f for f, holds in zip(self._temporal, bits, strict=True) if holds)
            for bits in product((False, True), repeat=len(self._temporal))
        ]
        states = [(letter, guess) for letter in letters for guess in guesses]
        self._successors = {s: [t for t in states if self._promises_kept(s, t)] for s in states}
        self._live = self._states_of_fair_paths()

    def verdict(self, word: Word) -> Verdict:
        """The verdict on `word`, by definition."""
        if not self._continues(word, satisfying=True):
            return Verdict.VIOLATED
        if not self._continues(word, satisfying=False):
            return Verdict.SATISFIED
        return Verdict.PRESUMABLY_SATISFIED if finite.holds(self.formula, word) else Verdict.PRESUMABLY_VIOLATED

    def _continues(self, word: Word, satisfying: bool) -> bool:
        """Whether some infinite continuation of `word` satisfies the formula, or fails it."""
        current = {state for state in self._live if _truth(self.formula, state) == satisfying}
        for position, letter in enumerate(word):
            current = {state for state in current if state[0] == letter}
            if position + 1 < len(word):
                current = {t for s in current for t in self._successors[s] if t in self._live}
        return bool(current)

    def _promises_kept(self, state: State, successor: State) -> bool:
        for formula in self._temporal:
            match formula:
                case Next(operand):
                    kept = _truth(operand, successor)
                case Until(left, right):
                    kept = _truth(right, state) or (_truth(left, state) and formula in successor[1])
            if kept != (formula in state[1]):
                return False
        return True

    def _states_of_fair_paths(self) -> set[State]:
        """The states from which some infinite path fulfils every `Until` (Emerson and Lei 1986)."""
        live = set(self._successors)
        untils = [f for f in self._temporal if isinstance(f, Until)]
        while True:
            before = len(live)
            live = {s for s in live if any(t in live for t in self._successors[s])}
            for until in untils:
                fulfilled = {s for s in live if until not in s[1] or _truth(until.right, s)}
                live = self._reaching(fulfilled, live)
            if len(live) == before:
                return live

    def _reaching(self, goal: set[State], within: set[State]) -> set[State]:
        reached = set(goal)
        while more := {s for s in within - reached if any(t in reached for t in self._successors[s])}:
            reached |= more
        return reached


def _truth(formula: Formula, state: State) -> bool:
    match formula:
        case Truth():
            return True
        case Atom(name):
            return name in state[0]
        case Not(operand):
            return not _truth(operand, state)
        case And(left, right):
            return _truth(left, state) and _truth(right, state)
        case Or(left, right):
            return _truth(left, state) or _truth(right, state)
        case Next() | Until():
            return formula in state[1]
