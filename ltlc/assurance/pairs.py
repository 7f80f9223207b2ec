"""The pairs in which a control and its monitor can be at the same time. Untrusted.

`ltlc.semantics.following` has the last word on whether the control follows the monitor.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import product
from typing import NamedTuple

from ltlc.assurance.controls import control_of
from ltlc.compiler import Compiled
from ltlc.semantics.control import Control, Followed, Outcome, Pair, Way
from ltlc.semantics.diagrams import Diagram, Diagrams, of_predicate, rows
from ltlc.semantics.ltl import FALSE, TRUE, And, Atom, Formula, Not, Or, atoms
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.reset_machine import Clocks, ResetMachine
from ltlc.semantics.timed_atoms import Age
from ltlc.semantics.trackers import Case, Phase, State


def uncovered(compiled: Compiled) -> str | None:
    """Why it cannot be checked that the control of `compiled` follows its monitor; None if it can.

    Values at openings that a clock step takes are no part of a control, nor are ages and counts, which no outcome sets.
    """
    if any(outcome.taken for outcome in compiled.machine.outcomes):
        return "it takes values at openings at clock steps"
    if any(clock.age is not None for clock in compiled.machine.clocks):
        return "it asks for ages, which messages renew between steps"
    if any(clock.occurrences is not None for clock in compiled.machine.clocks):
        return "it counts, which no outcome does"
    return None


def followed(compiled: Compiled, assumption: Formula) -> Followed | None:
    """The control of `compiled`, with its pairs over the letters that satisfy `assumption`; None if not covered."""
    if uncovered(compiled) is not None:
        return None
    control = control_of(compiled)
    return Followed(control, pairs_of(control, compiled.formula, compiled.monitor, assumption))


def pairs_of(control: Control, formula: Formula, monitor: Monitor, assumption: Formula) -> tuple[Pair, ...]:
    """Every pair to which runs lead over letters of `assumption`, from the initial states on."""
    return tuple(_Search(control, formula, monitor, assumption).pairs())


class _Place(NamedTuple):
    """A pair, but for what is known of the last letter."""

    state: int
    judged: int
    stand: tuple[State, ...] = ()
    looks_again: bool = False


class _Search:
    """The levels of its diagrams are those of atoms, by name, and of clocks, by number."""

    def __init__(self, control: Control, formula: Formula, monitor: Monitor, assumption: Formula) -> None:
        self.control, self.monitor = control, monitor
        self.time = ResetMachine(formula)
        self.timed = [name for tracker in self.time.trackers for name in tracker.atoms]
        self.timed += [news.name for news in self.time.news]
        self.diagrams = Diagrams()
        self.levels: dict[str | int, int] = {}
        self.allowed = self.of(assumption)
        branches = [(asked, if_not, if_so) for asked, if_so, if_not in control.branches]
        self.of_way = rows(self.diagrams, branches, self.asking, control.outcomes.__getitem__)
        self.of_target = rows(self.diagrams, monitor.decisions, lambda atom: self.asking(monitor.atoms[atom]))
        self.reached: dict[_Place, Diagram] = {}
        self.todo: list[_Place] = []

    def level(self, asked: str | int) -> int:
        """The level of an atom, or of whether a clock is late."""
        return self.levels.setdefault(asked, len(self.levels))

    def asking(self, asked: str | int) -> Diagram:
        """Where that is so."""
        return self.diagrams.variable(self.level(asked))

    def of(self, predicate: Formula) -> Diagram:
        """The letters with `predicate`."""
        levels = {name: self.level(name) for name in atoms(predicate)}
        return of_predicate(predicate, self.diagrams, levels)

    def pairs(self) -> Iterator[Pair]:
        """What is reached, with the last letters by which it is."""
        if self.is_permanent(0):
            self.reach(_Place(0, 0), self.diagrams.true)
        else:
            self.go_on(_Place(0, 0, self.time.initial.states), self.allowed, is_first=True)
        done: dict[_Place, Diagram] = {}
        while self.todo:
            place = self.todo.pop()
            held = self.reached[place]
            if self.is_permanent(place.judged):
                self.go_on_for_good(place)
            elif place not in done:
                self.go_on(place, self.allowed)
            if not self.is_permanent(place.judged) and not self.time.is_trivial and done.get(place) != held:
                self.go_on(place, self.held(held), by_time=True)
            done[place] = held
        for place, held in self.reached.items():
            is_known = self.diagrams.choose(self.allowed, held, self.diagrams.true) != self.diagrams.true
            yield Pair(*place, self.predicate(held) if is_known else TRUE)

    def is_permanent(self, judged: int) -> bool:
        return self.monitor.verdicts[judged].is_permanent

    def reach(self, place: _Place, letters: Diagram) -> None:
        """`place` can come about by `letters`."""
        found = self.diagrams.disjunction(self.reached.get(place, self.diagrams.false), letters)
        if self.reached.get(place) != found:
            self.reached[place] = found
            self.todo.append(place)

    def held(self, letters: Diagram) -> Diagram:
        """The letters a nanosecond after `letters`, whatever is then of time, and no news."""
        held = self.diagrams.conjunction(letters, self.allowed)
        for news in self.time.news:
            held = self.diagrams.conjunction(held, self.diagrams.negation(self.of(news)))
        return held

    def go_on_for_good(self, place: _Place) -> None:
        """The verdict is permanent: no clock runs."""
        never = {self.level(clock): False for clock in range(len(self.control.first_due))}
        step = self.diagrams.given(never, self.of_way(self.control.stances[place.state].step))
        for row in (step, self.diagrams.terminal(Outcome(place.state))):
            self.reach_all(self.together(self.allowed, row, place.judged), ())

    def go_on(self, place: _Place, letters: Diagram, is_first: bool = False, by_time: bool = False) -> None:
        """Whatever the trackers may do after `place`, by `letters`: at a step, or because time passes."""
        clocks = Clocks(is_first, place.stand)
        stance = self.control.stances[place.state]
        for among, cases in self.time.side_by_side(clocks, letters, self.narrowed):
            if not (is_first or by_time) and self.time.passing(clocks, cases):
                continue
            states = tuple(case.state for case in cases)
            for late in product(*self.may_be_late(place.stand, cases, is_first or by_time)):
                way: Way | None = stance.step
                if by_time:
                    way = stance.clock_step if place.looks_again or any(late) else None
                row = self.diagrams.terminal(Outcome(place.state)) if way is None else self.of_way(way)
                row = self.diagrams.given({self.level(clock): is_late for clock, is_late in enumerate(late)}, row)
                self.reach_all(self.together(among, row, place.judged), states)

    def together(self, letters: Diagram, row: Diagram, judged: int) -> Diagram:
        """For `letters`, the outcomes of `row` with the states of the monitor after `judged`; None for all others."""
        nowhere = self.diagrams.terminal(None)
        both = self.diagrams.combine(_both, row, self.of_target(self.monitor.edges[judged]))
        return self.diagrams.choose(letters, both, nowhere)

    def reach_all(self, together: Diagram, states: tuple[State, ...]) -> None:
        """What letters lead to, by outcome and state of the monitor; the trackers are then in `states`."""
        for each in self.diagrams.values(together):
            if each is not None:
                outcome, judged = each
                letters = self.diagrams.combine(lambda other, each=each: other == each, together)
                is_over = self.is_permanent(judged)
                told = self.diagrams.true if is_over or self.time.is_trivial else self.apart_from_time(letters)
                self.reach(_Place(outcome.state, judged, () if is_over else states, outcome.again), told)

    def apart_from_time(self, letters: Diagram) -> Diagram:
        """`letters`, whatever is of time and news."""
        for name in self.timed:
            sides = (self.diagrams.given({self.level(name): answer}, letters) for answer in (False, True))
            letters = self.diagrams.disjunction(*sides)
        return letters

    def may_be_late(
        self, stand: tuple[State, ...], cases: tuple[Case, ...], has_time: bool
    ) -> Iterator[Iterable[bool]]:
        """For each clock, whether it can be past its due time."""
        for tracker, state, case in zip(self.time.trackers, stand, cases, strict=True):
            if tracker.bounds:
                counts = tracker.is_running(state) or (isinstance(tracker.subject, Age) and state.phase is Phase.FIRST)
                known = case.passed is None or case.passed > state.passed
                yield (False,) if not (has_time and counts) else (True, False) if case.passed is None else (known,)

    def narrowed(self, letters: Diagram, predicate: Formula) -> Diagram | None:
        found = self.diagrams.conjunction(letters, self.of(predicate))
        return None if found == self.diagrams.false else found

    def predicate(self, letters: Diagram) -> Formula:
        """`letters` as a state predicate."""
        names = {level: name for name, level in self.levels.items() if isinstance(name, str)}
        known: dict[Diagram, Formula] = {self.diagrams.false: FALSE, self.diagrams.true: TRUE}

        def visit(node: Diagram) -> Formula:
            if node not in known:
                level, low, high = self.diagrams.split(node)
                known[node] = _choice(Atom(names[level]), visit(high), visit(low))
            return known[node]

        return visit(letters)


def _both(outcome: Outcome, judged: int) -> tuple[Outcome, int]:
    return outcome, judged


def _choice(atom: Formula, if_so: Formula, if_not: Formula) -> Formula:
    """`if_so` where `atom` holds, `if_not` where it does not."""
    if if_so == TRUE:
        return atom if if_not == FALSE else Or(atom, if_not)
    if if_not == TRUE:
        return Not(atom) if if_so == FALSE else Or(Not(atom), if_so)
    if if_not == FALSE:
        return And(atom, if_so)
    if if_so == FALSE:
        return And(Not(atom), if_not)
    return Or(And(atom, if_so), And(Not(atom), if_not))
