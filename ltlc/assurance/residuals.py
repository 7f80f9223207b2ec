"""Residuals: what remains of a formula after a run, as a diagram over the formulas that the rest has to satisfy.

A residual is a Boolean function of obligations: atoms, `next` and `until` formulas, exactly as they stand in the
formula it came from. Residuals are in normal form with respect to those, which is all that the checker compares.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ltlc.semantics.diagrams import Diagram, Diagrams, formulas
from ltlc.semantics.ltl import And, Atom, Formula, Next, Not, Or, Truth, Until
from ltlc.semantics.progression import NON_EMPTY
from ltlc.semantics.reset_machine import Clocks, Move, ResetMachine
from ltlc.semantics.words import Letter

Cube = frozenset[tuple[int, bool]]
"""A conjunction of obligations, each by its level, asserted or denied."""


class Residuals:
    """Residuals of formulas over `atoms`, and their successors under letters that satisfy `assumption`.

    The levels of the diagrams are those of the atoms of the current step, then two for each obligation: itself, and the
    mark with which `Tableau` notes that an eventuality is met.
    """

    def __init__(self, atoms: tuple[str, ...], assumption: Formula) -> None:
        self.diagrams = Diagrams()
        self.atoms = atoms
        self._level_of_atom = {atom: level for level, atom in enumerate(atoms)}
        self._obligations: list[Formula] = []
        self._level_of_obligation: dict[int, int] = {}
        self._numbers: dict[tuple[object, ...], int] = {}
        self._numbered: dict[int, tuple[Formula, int]] = {}
        self._later: dict[int, Diagram] = {}
        self._now: dict[int, Diagram] = {}
        self._progressed: dict[Diagram, Diagram] = {}
        self.formula = formulas(self.obligation, self.diagrams)
        self._moves: dict[Clocks, list[Move[Diagram]]] = {}
        self.possible = self.now(assumption)

    def _number(self, formula: Formula) -> int:
        """Equal formulas have the same number; found by identity where possible, since trees are large."""
        known = self._numbered.get(id(formula))
        if known is not None:
            return known[1]
        key: tuple[object, ...]
        match formula:
            case Truth():
                key = (Truth,)
            case Atom(name):
                key = (Atom, name)
            case Not(operand) | Next(operand):
                key = (type(formula), self._number(operand))
            case And(left, right) | Or(left, right) | Until(left, right):
                key = (type(formula), self._number(left), self._number(right))
        number = self._numbers.setdefault(key, len(self._numbers))
        self._numbered[id(formula)] = (formula, number)
        return number

    def is_obligation(self, level: int) -> bool:
        """Whether `level` is that of an obligation, neither an atom's nor a mark's."""
        return level >= len(self.atoms) and (level - len(self.atoms)) % 2 == 0

    def obligation(self, level: int) -> Formula:
        """The obligation of a level."""
        return self._obligations[(level - len(self.atoms)) // 2]

    def mark(self, level: int) -> int:
        """The level of the mark of an obligation's level."""
        return level + 1

    def _obligation_variable(self, formula: Formula) -> Diagram:
        number = self._number(formula)
        if number not in self._level_of_obligation:
            self._level_of_obligation[number] = len(self.atoms) + 2 * len(self._obligations)
            self._obligations.append(formula)
        return self.diagrams.variable(self._level_of_obligation[number])

    def of(self, formula: Formula) -> Diagram:
        """The residual that a word satisfies exactly if it satisfies `formula`."""
        return self._build(formula, self._later, self._obligation_variable)

    def now(self, formula: Formula) -> Diagram:
        """`formula` in terms of the atoms of the current step and of the residual after it."""
        return self._build(formula, self._now, self._unfold)

    def _unfold(self, leaf: Formula) -> Diagram:
        match leaf:
            case Atom(name):
                return self.diagrams.variable(self._level_of_atom[name])
            case Next(operand):
                return self.diagrams.conjunction(self._obligation_variable(NON_EMPTY), self.of(operand))
            case Until(left, right):
                again = self.diagrams.conjunction(self.now(left), self._obligation_variable(leaf))
                return self.diagrams.disjunction(self.now(right), again)
            case _:
                raise TypeError(f"not an obligation: {leaf!r}")

    def _build(self, formula: Formula, known: dict[int, Diagram], leaf: Callable[[Formula], Diagram]) -> Diagram:
        number = self._number(formula)
        if number not in known:
            known[number] = self._combine(formula, known, leaf)
        return known[number]

    def _combine(self, formula: Formula, known: dict[int, Diagram], leaf: Callable[[Formula], Diagram]) -> Diagram:
        match formula:
            case Truth():
                return self.diagrams.true
            case Not(operand):
                return self.diagrams.negation(self._build(operand, known, leaf))
            case And(left, right):
                return self.diagrams.conjunction(self._build(left, known, leaf), self._build(right, known, leaf))
            case Or(left, right):
                return self.diagrams.disjunction(self._build(left, known, leaf), self._build(right, known, leaf))
            case _:
                return leaf(formula)

    def progress(self, residual: Diagram) -> Diagram:
        """`residual` in terms of the atoms of its first step and of the residual after it."""
        if self.diagrams.is_terminal(residual):
            return residual
        if residual not in self._progressed:
            level, low, high = self.diagrams.split(residual)
            self._progressed[residual] = self.diagrams.choose(
                self.now(self.obligation(level)), self.progress(high), self.progress(low)
            )
        return self._progressed[residual]

    def after(self, residual: Diagram, letter: Letter) -> Diagram:
        """What remains of `residual` after `letter`."""
        left = self.progress(residual)
        while not self.diagrams.is_terminal(left):
            level, low, high = self.diagrams.split(left)
            if level >= len(self.atoms):
                break
            left = high if self.atoms[level] in letter else low
        return left

    def moves(self, time: ResetMachine, clocks: Clocks) -> list[Move[Diagram]]:
        """How time can go on from `clocks`, by the letters that exist."""
        if clocks not in self._moves:
            self._moves[clocks] = list(time.moves(clocks, self.possible, self._narrowed))
        return self._moves[clocks]

    def _narrowed(self, letters: Diagram, predicate: Formula) -> Diagram | None:
        found = self.diagrams.conjunction(letters, self.now(predicate))
        return None if found == self.diagrams.false else found

    def cubes(self, residual: Diagram) -> Iterator[Cube]:
        """The conjunctions of obligations whose disjunction is `residual`."""
        for answers, value in self.diagrams.paths(residual):
            if value:
                yield frozenset(answers.items())

    def of_cube(self, cube: Cube) -> Diagram:
        """The conjunction as a residual."""
        result = self.diagrams.true
        for level, asserted in sorted(cube, reverse=True):
            low, high = (self.diagrams.false, result) if asserted else (result, self.diagrams.false)
            result = self.diagrams.decision(level, low, high)
        return result

    def after_letters(self, condition: Diagram) -> dict[Diagram, Letter]:
        """What `condition` can leave of the obligations and marks, each with a letter that leaves it; not `false`."""
        left: dict[Diagram, Letter] = {}
        seen: set[Diagram] = set()
        stack: list[tuple[Diagram, Letter]] = [(condition, frozenset())]
        while stack:
            diagram, letter = stack.pop()
            if diagram in seen or diagram == self.diagrams.false:
                continue
            seen.add(diagram)
            if self.diagrams.is_terminal(diagram) or self.diagrams.split(diagram)[0] >= len(self.atoms):
                left[diagram] = letter
                continue
            level, low, high = self.diagrams.split(diagram)
            stack.append((high, letter | {self.atoms[level]}))
            stack.append((low, letter))
        return left
