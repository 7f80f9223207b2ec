"""Strategies: a search for words that show an outcome possible in time, in whatever order clocks expire.

Nothing here is trusted: `ltlc.semantics.plays` has the last word.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice
from typing import NamedTuple

from ltlc.assurance.residuals import Residuals
from ltlc.semantics.diagrams import Diagram
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.plays import Plays, Ways
from ltlc.semantics.reset_machine import Clocks, ResetMachine
from ltlc.semantics.words import Lasso, Letter, Word

MOST_SITUATIONS = 5000
"""Of these, plans are made; what lies beyond is not looked at."""

MOST_PLAYS = 600
"""Of one strategy: five clocks may expire side by side in 541 ways."""


class Situation(NamedTuple):
    """Where the clocks are, what remains, and the letter that is held, if it is known."""

    clocks: Clocks
    residual: Diagram
    last: Letter | None


Choice = dict[Letter, Situation]
"""What one decision can lead to."""

Plan = dict[Situation, Word | Choice]
"""What to do in each situation from which an outcome is certain: go round a loop forever, or decide."""


class Strategies:
    """Strategies from the places of one certificate."""

    def __init__(self, residuals: Residuals, time: ResetMachine, places: Iterable[tuple[Clocks, Diagram]]) -> None:
        self._residuals = residuals
        self._time = time
        self._plays = Plays(time, lambda _: None)
        self._choices: dict[Situation, list[Choice]] = {}
        self._steps: dict[tuple[Clocks, Diagram], list[Choice]] = {}
        self._ends: dict[tuple[Clocks, Diagram], dict[bool, Word]] = {}
        self._plans: dict[bool, Plan] = {True: {}, False: {}}
        self._explore([Situation(*place, None) for place in places])
        for plan in self._plans.values():
            self._extend(plan)

    def words(self, clocks: Clocks, residual: Diagram, wanted: bool) -> Iterator[Lasso]:
        """All plays of a strategy with which `residual` is satisfied, or is not, as `wanted`; none if none is found."""
        start = Situation(clocks, residual, None)
        if start in self._plans[wanted]:
            found = list(islice(self._played(self._plans[wanted], start, ()), MOST_PLAYS + 1))
            yield from found if len(found) <= MOST_PLAYS else ()

    def _played(self, plan: Plan, here: Situation, stem: Word) -> Iterator[Lasso]:
        chosen = plan[here]
        if isinstance(chosen, tuple):
            yield Lasso(stem, chosen)
            return
        for letter, target in chosen.items():
            yield from self._played(plan, target, (*stem, letter))

    def _explore(self, todo: list[Situation]) -> None:
        """Find all situations that can come after these, and the loops that plans end with."""
        while todo and len(self._choices) < MOST_SITUATIONS:
            here = todo.pop()
            if here not in self._choices:
                self._choices[here] = list(self._decisions(here))
                todo += [target for choice in self._choices[here] for target in choice.values()]
                for holds, loop in self._endings(here).items():
                    self._plans[holds][here] = loop

    def _extend(self, plan: Plan) -> None:
        """Add each situation in which some decision leads only to those that `plan` has."""
        size = -1
        while size < len(plan):
            size = len(plan)
            for here, choices in self._choices.items():
                certain = (choice for choice in choices if all(each in plan for each in choice.values()))
                if here not in plan and (choice := next(certain, None)):
                    plan[here] = choice

    def _decisions(self, here: Situation) -> Iterator[Choice]:
        yield from self._at_once(here.clocks, here.residual)
        if here.last is not None:
            waits = self._plays.waits(here.clocks, here.last)
            if waits:
                yield self._led(here.residual, waits)

    def _at_once(self, clocks: Clocks, residual: Diagram) -> list[Choice]:
        """A step by a letter of each kind: where it leads differs."""
        if (clocks, residual) not in self._steps:
            found: dict[tuple[Letter, ...], Choice] = {}
            for letter in self._letters(clocks, residual):
                ways = self._plays.at_once(clocks, letter)
                found.setdefault(tuple(ways), self._led(residual, ways))
            self._steps[clocks, residual] = list(found.values())
        return self._steps[clocks, residual]

    def _letters(self, clocks: Clocks, residual: Diagram) -> Iterator[Letter]:
        """Letters of which something else comes; also where clocks run out, for until then the letter may be held."""
        diagrams, left = self._residuals.diagrams, self._residuals.progress(residual)
        for move in self._residuals.moves(self._time, clocks):
            for side in (left, diagrams.negation(left)):
                yield from self._residuals.after_letters(diagrams.conjunction(move.letters, side)).values()

    def _led(self, residual: Diagram, ways: Ways) -> Choice:
        return {
            letter: Situation(move.target, self._residuals.after(residual, letter), letter)
            for letter, move in ways.items()
        }

    def _endings(self, here: Situation) -> dict[bool, Word]:
        """A loop for each outcome with which one can go round forever."""
        place = here.clocks, here.residual
        if place not in self._ends:
            formula, found = self._residuals.formula(here.residual), dict[bool, Word]()
            for loop in self._loops(here):
                found.setdefault(holds_on_lasso(formula, Lasso((), loop)), loop)
                if len(found) == 2:
                    break
            self._ends[place] = found
        return self._ends[place]

    def _loops(self, here: Situation) -> Iterator[Word]:
        """Loops of one or two letters that can go round forever."""
        for first in self._at_once(here.clocks, here.residual):
            for letter, after in first.items():
                follow = [(), *((second,) for choice in self._decisions(after) for second in choice)]
                yield from (loop for rest in follow if self._plays.lasts(here.clocks, loop := (letter, *rest)))
