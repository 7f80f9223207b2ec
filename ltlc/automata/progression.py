"""The second construction of the monitor: states are what remains to be satisfied, decided by progression.

It shares with the first the diagrams, the minimisation, and Spot's emptiness check, but neither Spot's finite automata
nor any determinisation: that the two give equal monitors is a test of both.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any, Literal, NamedTuple, assert_never

from ltlc.automata.engine import spot
from ltlc.automata.machine import Letter, Letters, Machine, explore, letters_of, to_monitor
from ltlc.automata.spot_translation import Session
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.diagrams import Diagram
from ltlc.semantics.ltl import And, Atom, Formula, Next, Not, Or, Truth, Until
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.verdicts import Verdict


def translate(formula: Formula, alphabet: Alphabet) -> Monitor:
    """The canonical minimal monitor of `formula` over the letters of `alphabet`."""
    letters = letters_of(formula, alphabet)
    diagrams = letters.diagrams
    residuals, session = Residuals(letters), Session(letters)

    def step(place: Place) -> Diagram:
        return diagrams.combine(_place, residuals.step(place.remains), letters.time.moves[place.clocks])

    graph = explore(letters, Place(residuals.of(formula), 0), step, lambda place: place)
    satisfiable = _satisfiable(graph, graph.outputs, residuals, session)
    negations = [Place(diagrams.negation(place.remains), place.clocks) for place in graph.outputs]
    falsifiable = _satisfiable(graph, negations, residuals, session)
    verdicts = [
        _verdict(can_hold, can_fail, residuals.holds_on_empty_word(place.remains))
        for can_hold, can_fail, place in zip(satisfiable, falsifiable, graph.outputs, strict=True)
    ]
    return to_monitor(Machine(letters, verdicts, graph.successors))


class Place(NamedTuple):
    """Where a run can be: what remains to be satisfied, and the state of the reset machine."""

    remains: Diagram
    clocks: int


def _place(remains: Any, move: Any) -> Hashable:
    return Letter.IMPOSSIBLE if move is None else Place(remains, move.target)


def _verdict(can_hold: bool, can_fail: bool, holds: bool) -> Verdict:
    if not can_hold:
        return Verdict.VIOLATED
    if not can_fail:
        return Verdict.SATISFIED
    return Verdict.PRESUMABLY_SATISFIED if holds else Verdict.PRESUMABLY_VIOLATED


Obligation = tuple[Literal["atom"], int] | tuple[Literal["next"], Diagram] | tuple[Literal["until"], Diagram, Diagram]
"""What the rest of a word may have to satisfy: an atom, by its level, or an operator on residuals."""


class Residuals:
    """What remains of a formula, as Boolean functions of obligations on the rest of the word, in normal form.

    A residual is a diagram whose levels, below those of the letter, are obligations. On the empty word they are false.
    """

    def __init__(self, letters: Letters) -> None:
        self.letters = letters
        self._diagrams = letters.diagrams
        self._first_level = len(letters.atoms)
        self._obligations: list[Obligation] = []
        self._levels: dict[Obligation, int] = {}
        self._non_empty = self._obligation(("until", self._diagrams.true, self._diagrams.true))
        self._progressed: dict[Diagram, Diagram] = {}
        self._constant: dict[Diagram, Diagram] = {}
        self._in_spot: dict[Diagram, Any] = {}

    def _obligation(self, obligation: Obligation) -> Diagram:
        if obligation not in self._levels:
            self._levels[obligation] = self._first_level + len(self._obligations)
            self._obligations.append(obligation)
        return self._diagrams.variable(self._levels[obligation])

    def of(self, formula: Formula) -> Diagram:
        """The residual that a word satisfies exactly if it satisfies `formula`."""
        levels = {atom: level for level, atom in enumerate(self.letters.atoms)}
        known: dict[int, Diagram] = {}  # by identity, as in `Session.to_spot`

        def build(node: Formula) -> Diagram:
            match node:
                case Truth():
                    return self._diagrams.true
                case Atom(name):
                    return self._obligation(("atom", levels[name]))
                case Not(operand):
                    return self._diagrams.negation(visit(operand))
                case And(left, right):
                    return self._diagrams.conjunction(visit(left), visit(right))
                case Or(left, right):
                    return self._diagrams.disjunction(visit(left), visit(right))
                case Next(operand):
                    return self._obligation(("next", visit(operand)))
                case Until(left, right):
                    return self._obligation(("until", visit(left), visit(right)))
                case _:
                    assert_never(node)

        def visit(node: Formula) -> Diagram:
            if id(node) not in known:
                known[id(node)] = build(node)
            return known[id(node)]

        return visit(formula)

    def holds_on_empty_word(self, residual: Diagram) -> bool:
        """Whether nothing remains to be satisfied if the word ends here."""
        return bool(self._diagrams.evaluate(residual, lambda _: False))

    def step(self, residual: Diagram) -> Diagram:
        """The residual after each letter: a diagram over the atoms, whose values are residuals."""
        known: dict[Diagram, Diagram] = {}

        def lift(node: Diagram) -> Diagram:
            if node not in known:
                level, low, high = self._diagrams.split(node)
                known[node] = (
                    self._diagrams.terminal(node)
                    if level >= self._first_level
                    else self._diagrams.decision(level, lift(low), lift(high))
                )
            return known[node]

        return lift(self._progress(residual))

    def _progress(self, residual: Diagram) -> Diagram:
        """What remains after a letter: a function of the letter's atoms and of obligations on what follows it."""

        def after(level: int) -> Diagram:
            match self._obligations[level - self._first_level]:
                case "atom", atom:
                    return self._diagrams.variable(atom)
                case "next", operand:
                    return self._diagrams.conjunction(self._non_empty, operand)
                case "until", left, right:
                    again = self._diagrams.conjunction(self._progress(left), self._diagrams.variable(level))
                    return self._diagrams.disjunction(self._progress(right), again)

        return self._substitute(residual, after, self._progressed)

    def letters_repeated(self, residual: Diagram) -> Diagram:
        """True for the letters that satisfy `residual` if they are repeated forever."""

        def forever(level: int) -> Diagram:
            match self._obligations[level - self._first_level]:
                case "atom", atom:
                    return self._diagrams.variable(atom)
                case _, *_, operand:
                    return self.letters_repeated(operand)

        return self._substitute(residual, forever, self._constant)

    def _substitute(
        self, residual: Diagram, meaning: Callable[[int], Diagram], known: dict[Diagram, Diagram]
    ) -> Diagram:
        """`residual` with the `meaning` of every obligation in its place."""
        if self._diagrams.is_terminal(residual):
            return residual
        if residual not in known:
            level, low, high = self._diagrams.split(residual)
            then = self._substitute(high, meaning, known)
            otherwise = self._substitute(low, meaning, known)
            known[residual] = self._diagrams.choose(meaning(level), then, otherwise)
        return known[residual]

    def to_spot(self, residual: Diagram) -> Any:
        """`residual` as a formula of Spot's."""
        if residual not in self._in_spot:
            self._in_spot[residual] = self._decision_in_spot(residual)
        return self._in_spot[residual]

    def _decision_in_spot(self, residual: Diagram) -> Any:
        if self._diagrams.is_terminal(residual):
            return spot.formula.tt() if self._diagrams.value(residual) else spot.formula.ff()
        level, low, high = self._diagrams.split(residual)
        condition = self._obligation_in_spot(level)
        then = spot.formula.And([condition, self.to_spot(high)])
        otherwise = spot.formula.And([spot.formula.Not(condition), self.to_spot(low)])
        return spot.formula.Or([then, otherwise])

    def _obligation_in_spot(self, level: int) -> Any:
        match self._obligations[level - self._first_level]:
            case "atom", atom:
                return spot.formula.ap(f"p{atom}")
            case "next", operand:
                return spot.formula.X(self.to_spot(operand))
            case "until", left, right:
                return spot.formula.U(self.to_spot(left), self.to_spot(right))


def _satisfiable(graph: Machine, wanted: list[Place], residuals: Residuals, session: Session) -> list[bool]:
    """Whether some run from `wanted[q]` satisfies it, for each state q; q's successors want what remains of it.

    Most are decided by a letter that can be repeated forever, or by a successor; Spot decides what is left.
    """
    diagrams = graph.letters.diagrams
    successors = [[q for q in diagrams.values(row) if q is not Letter.IMPOSSIBLE] for row in graph.successors]
    predecessors: list[list[int]] = [[] for _ in successors]
    for state, after in enumerate(successors):
        for successor in after:
            predecessors[successor].append(state)
    known: dict[int, bool] = {}

    def spread(state: int, value: bool, neighbours: list[list[int]]) -> None:
        pending = [state]
        while pending:
            if (current := pending.pop()) not in known:
                known[current] = value
                pending += neighbours[current]

    for state, place in enumerate(wanted):
        constant = diagrams.conjunction(graph.letters.lasting(place.clocks), residuals.letters_repeated(place.remains))
        if constant != diagrams.false:
            spread(state, True, predecessors)
    for state in reversed(range(len(wanted))):
        if state in known:
            continue
        if session.is_satisfiable(residuals.to_spot(wanted[state].remains), wanted[state].clocks):
            spread(state, True, predecessors)
        else:
            spread(state, False, successors)
    return [known[state] for state in range(len(wanted))]
