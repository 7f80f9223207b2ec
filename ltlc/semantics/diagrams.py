"""Reduced ordered decision diagrams with any terminals (Bryant 1986; Fujita, McGeer and Yang 1997).

A diagram is a function from letters to values that asks one atom after the other, in a fixed order, and only those that
matter. Diagrams of one `Diagrams` are shared: the same function is the same number. That makes them the normal form of
guards, of step functions, and of Boolean combinations in general.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from typing import Any

from ltlc.semantics.ltl import FALSE, TRUE, And, Atom, Formula, Not, Or, Truth

Diagram = int
"""A diagram is known by its number in its `Diagrams`."""

_TERMINAL_LEVEL = 1 << 60


class Diagrams:
    """A store of diagrams over levels 0, 1, …: level 0 is asked first. What a level stands for, its user knows."""

    def __init__(self) -> None:
        self._levels: list[int] = []
        self._low: list[Diagram] = []
        self._high: list[Diagram] = []
        self._values: dict[Diagram, Hashable] = {}
        self._terminals: dict[tuple[type, Hashable], Diagram] = {}
        self._nodes: dict[tuple[int, Diagram, Diagram], Diagram] = {}
        self._choices: dict[tuple[Diagram, Diagram, Diagram], Diagram] = {}
        self.false = self.terminal(False)
        self.true = self.terminal(True)

    def __len__(self) -> int:
        """The number of terminals and decisions made so far."""
        return len(self._levels)

    def terminal(self, value: Hashable) -> Diagram:
        """The diagram that gives `value` for every letter."""
        key = (type(value), value)
        if key not in self._terminals:
            self._terminals[key] = self._new(_TERMINAL_LEVEL, -1, -1)
            self._values[self._terminals[key]] = value
        return self._terminals[key]

    def decision(self, level: int, low: Diagram, high: Diagram) -> Diagram:
        """The diagram that asks `level`, then goes on with `high` if it holds, else with `low`."""
        if low == high:
            return low
        key = (level, low, high)
        found = self._nodes.get(key)
        if found is None:
            found = self._nodes[key] = self._new(level, low, high)
        return found

    def _new(self, level: int, low: Diagram, high: Diagram) -> Diagram:
        self._levels.append(level)
        self._low.append(low)
        self._high.append(high)
        return len(self._levels) - 1

    def variable(self, level: int) -> Diagram:
        """True where `level` holds."""
        return self.decision(level, self.false, self.true)

    def is_terminal(self, diagram: Diagram) -> bool:
        """Whether `diagram` asks nothing."""
        return self._levels[diagram] == _TERMINAL_LEVEL

    def value(self, terminal: Diagram) -> Any:
        """The value of a terminal."""
        return self._values[terminal]

    def split(self, diagram: Diagram) -> tuple[int, Diagram, Diagram]:
        """The level that a decision asks first, and what follows if it does not hold and if it does."""
        return self._levels[diagram], self._low[diagram], self._high[diagram]

    def choose(self, condition: Diagram, then: Diagram, otherwise: Diagram) -> Diagram:
        """`then` where `condition` (true or false) is true, `otherwise` where it is false."""
        if condition == self.true:
            return then
        if condition == self.false:
            return otherwise
        if then == otherwise:
            return then
        key = (condition, then, otherwise)
        found = self._choices.get(key)
        if found is None:
            level, lows, highs = self._cofactors(key)
            low, high = self.choose(*lows), self.choose(*highs)
            found = self._choices[key] = self.decision(level, low, high)
        return found

    def negation(self, diagram: Diagram) -> Diagram:
        """True where `diagram` is false."""
        return self.choose(diagram, self.false, self.true)

    def conjunction(self, left: Diagram, right: Diagram) -> Diagram:
        """True where both are."""
        return self.choose(left, right, self.false)

    def disjunction(self, left: Diagram, right: Diagram) -> Diagram:
        """True where at least one is."""
        return self.choose(left, self.true, right)

    def given(self, answers: Mapping[int, bool], diagram: Diagram) -> Diagram:
        """`diagram` where it is known of some levels whether they hold."""
        known: dict[Diagram, Diagram] = {}

        def visit(node: Diagram) -> Diagram:
            if self.is_terminal(node):
                return node
            if node not in known:
                level, low, high = self.split(node)
                answer = answers.get(level)
                if answer is None:
                    known[node] = self.decision(level, visit(low), visit(high))
                else:
                    known[node] = visit(high if answer else low)
            return known[node]

        return visit(diagram)

    def combine(self, function: Callable[..., Hashable], *diagrams: Diagram) -> Diagram:
        """The diagram whose value at a letter is `function` of the values of `diagrams` there.

        `function` is asked once for each combination of values that occurs, that of the smallest letter first.
        """
        known: dict[tuple[Diagram, ...], Diagram] = {}

        def visit(operands: tuple[Diagram, ...]) -> Diagram:
            found = known.get(operands)
            if found is not None:
                return found
            if min([self._levels[d] for d in operands]) == _TERMINAL_LEVEL:
                found = self.terminal(function(*[self._values[d] for d in operands]))
            else:
                level, lows, highs = self._cofactors(operands)
                found = self.decision(level, visit(lows), visit(highs))
            known[operands] = found
            return found

        return visit(diagrams)

    def relabel(self, function: Callable[[Any], Hashable], diagrams: Iterable[Diagram]) -> list[Diagram]:
        """Each of `diagrams` with its values replaced by `function` of them."""
        known: dict[Diagram, Diagram] = {}

        def visit(diagram: Diagram) -> Diagram:
            found = known.get(diagram)
            if found is None:
                level = self._levels[diagram]
                if level == _TERMINAL_LEVEL:
                    found = self.terminal(function(self._values[diagram]))
                else:
                    found = self.decision(level, visit(self._low[diagram]), visit(self._high[diagram]))
                known[diagram] = found
            return found

        return [visit(diagram) for diagram in diagrams]

    def _cofactors(self, diagrams: tuple[Diagram, ...]) -> tuple[int, tuple[Diagram, ...], tuple[Diagram, ...]]:
        """The first level that any of `diagrams` asks, and what they are where it does not hold and where it does."""
        levels = self._levels
        level = min([levels[d] for d in diagrams])
        lows = tuple([self._low[d] if levels[d] == level else d for d in diagrams])
        highs = tuple([self._high[d] if levels[d] == level else d for d in diagrams])
        return level, lows, highs

    def evaluate(self, diagram: Diagram, holds: Callable[[int], bool]) -> Any:
        """The value of `diagram` at the letter in which exactly the levels with `holds` hold."""
        while not self.is_terminal(diagram):
            level, low, high = self.split(diagram)
            diagram = high if holds(level) else low
        return self._values[diagram]

    def values(self, diagram: Diagram) -> list[Any]:
        """Every value that `diagram` takes, each once, the one of the smallest letter first (low before high)."""
        return [self._values[d] for d in self.reachable(diagram) if self.is_terminal(d)]

    def reachable(self, *roots: Diagram) -> Iterator[Diagram]:
        """The decisions and terminals of `roots`, each once: a decision, then all below its low side, then its high."""
        seen: set[Diagram] = set()
        stack = list(reversed(roots))
        while stack:
            diagram = stack.pop()
            if diagram in seen:
                continue
            seen.add(diagram)
            yield diagram
            if not self.is_terminal(diagram):
                stack.append(self._high[diagram])
                stack.append(self._low[diagram])

    def paths(self, diagram: Diagram) -> Iterator[tuple[dict[int, bool], Any]]:
        """Each way through `diagram`: the levels asked with their answers, and the value at the end."""
        if self.is_terminal(diagram):
            yield {}, self._values[diagram]
            return
        level, low, high = self.split(diagram)
        for answer, rest in ((False, low), (True, high)):
            for answers, value in self.paths(rest):
                yield {level: answer, **answers}, value


def of_predicate(predicate: Formula, diagrams: Diagrams, levels: Mapping[str, int]) -> Diagram:
    """A state predicate as a diagram that is true where it holds; `levels` says which level asks which atom."""
    return of_diagrams(predicate, diagrams, lambda name: diagrams.variable(levels[name]))


def of_diagrams(predicate: Formula, diagrams: Diagrams, atom: Callable[[str], Diagram]) -> Diagram:
    """A state predicate over atoms that are diagrams themselves."""
    match predicate:
        case Truth():
            return diagrams.true
        case Atom(name):
            return atom(name)
        case Not(operand):
            return diagrams.negation(of_diagrams(operand, diagrams, atom))
        case And(left, right):
            return diagrams.conjunction(of_diagrams(left, diagrams, atom), of_diagrams(right, diagrams, atom))
        case Or(left, right):
            return diagrams.disjunction(of_diagrams(left, diagrams, atom), of_diagrams(right, diagrams, atom))
        case _:
            raise TypeError(f"not a state predicate: {predicate!r}")


def rows(
    diagrams: Diagrams,
    decisions: Sequence[tuple[Any, int, int]],
    asked: Callable[[Any], Diagram],
    value: Callable[[int], Hashable] = lambda end: end,
) -> Callable[[int], Diagram]:
    """Where the targets of a monitor, or of a machine, lead, as diagrams with a `value` for each end.

    A target that is negative is a decision: the one with the number `~target` says what is asked, which is true where
    `asked` is, where it leads if not, and where if so. What compiles has its own, so that what judges shares no
    mistake with it.
    """

    @cache
    def row(target: int) -> Diagram:
        if target >= 0:
            return diagrams.terminal(value(target))
        question, low, high = decisions[~target]
        then, otherwise = row(high), row(low)
        return diagrams.choose(asked(question), then, otherwise)

    return row


def formulas(asked: Callable[[int], Formula], diagrams: Diagrams) -> Callable[[Diagram], Formula]:
    """What diagrams of truth values say, as formulas in which a level is what is `asked`; equal parts are shared."""

    @cache
    def formula(diagram: Diagram) -> Formula:
        if diagrams.is_terminal(diagram):
            return TRUE if diagrams.value(diagram) else FALSE
        level, low, high = diagrams.split(diagram)
        here, yes, no = asked(level), formula(high), formula(low)
        if_so = here if yes == TRUE else And(here, yes)
        if_not = Not(here) if no == TRUE else And(Not(here), no)
        if no == FALSE:
            return if_so
        if yes == FALSE:
            return if_not
        if yes == TRUE:
            return Or(here, no)
        return Or(Not(here), yes) if no == TRUE else Or(if_so, if_not)

    return formula
