"""An exact oracle for verdicts in time: all runs of a property with short bounds, nanosecond by nanosecond.

A situation is what clocks and the past make of a run so far, with the times of the clocks as integers up to where they
make no difference any more. In each, a step may come, or a nanosecond may pass with the letter held; time goes on for
ever. Whether some continuation satisfies the formula is decided on the product with a Büchi automaton of it, to which
time means nothing. The reset machine, which has no times, is not used.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Iterable
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple, TypeVar

from timed import ordinary_atoms

from ltlc.automata.queries import buchi
from ltlc.semantics import finite
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.ltl import And, Atom, Formula, Next, Not, Or, Truth, Until, atoms
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.timed_atoms import Age, Previously, news_of
from ltlc.semantics.trackers import ALWAYS, Phase, Scope, State, Tracker, scopes_around, trackers_of
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter, all_letters

Node = TypeVar("Node", bound=Hashable)

Graph = dict[Node, list[tuple[Node, frozenset[str]]]]
"""Where edges lead from each node, and with which marks."""

FULFILS, TIME = "fulfils", "time"
"""Marks of edges: a run is fair if each recurs."""


class Situation(NamedTuple):
    """The state of each tracker, how long ago its clock was started, and the letter that is held."""

    states: tuple[State, ...]
    since: tuple[int | None, ...]
    held: Letter


class TooManyError(Exception):
    """There are more situations than the oracle looks at."""


@dataclass(frozen=True, slots=True)
class Findings:
    """Of `judged` situations of a monitor, in how many a permanent verdict is wrong, or is missing.

    What is missing is counted where the letter is settled: how much of a nanosecond's news or of what `previously` has
    not caught up with is to come before a clock runs out, the letters do not tell.
    """

    judged: int
    wrong: int
    missing: int


class RunsOf:
    """All runs of `formula`: from each situation, the letters that may come, with where they lead."""

    def __init__(self, formula: Formula, most: int, trackers: tuple[Tracker, ...] | None = None) -> None:
        self.trackers = trackers_of(formula) if trackers is None else trackers
        self._around = scopes_around(self.trackers)
        self._news = frozenset(each.name for each in news_of(formula))
        self.letters = all_letters([*ordinary_atoms(formula), *self._news])
        self._most = most
        self.starts = [
            self._after(self._before(since), signals, 0, True)
            for since in product(*map(self._ages, self.trackers))
            for signals in self.letters
        ]
        self._known: dict[Situation, list[tuple[Letter, Situation, bool]]] = {}

    def _ages(self, tracker: Tracker) -> Iterable[int | None]:
        """The session may be older than the run."""
        return range(tracker.bounds[-1] + 2) if isinstance(tracker.subject, Age) else (None,)

    def is_settled(self, situation: Situation, letter: Letter) -> bool:
        """Whether only a clock changes `letter`, which led to `situation`: no news, and `previously` has caught up."""
        return self._news.isdisjoint(letter) and all(
            (tracker.atoms[0] in letter) == (state == ALWAYS)
            for tracker, state in zip(self.trackers, situation.states, strict=True)
            if isinstance(tracker.subject, Previously)
        )

    def _before(self, since: tuple[int | None, ...]) -> Situation:
        return Situation(tuple(tracker.initial for tracker in self.trackers), since, frozenset())

    def first(self, signals: Letter, age: int) -> tuple[Letter, Situation]:
        """The first step, in a session that began `age` nanoseconds before."""
        since = tuple(age if isinstance(tracker.subject, Age) else None for tracker in self.trackers)
        return self._after(self._before(since), signals, 0, True)

    def after(self, situation: Situation, signals: Letter | None) -> tuple[Letter, Situation]:
        """A step at once, or (None) a nanosecond with the letter held."""
        held = situation.held - self._news
        return self._after(situation, held, 1) if signals is None else self._after(situation, signals, 0)

    def edges(self, situation: Situation) -> list[tuple[Letter, Situation, bool]]:
        """The letters after `situation`, with whether time passes."""
        if situation not in self._known:
            if len(self._known) == self._most:
                raise TooManyError
            steps = [(*self.after(situation, signals), False) for signals in self.letters]
            self._known[situation] = [*steps, (*self.after(situation, None), True)]
        return self._known[situation]

    def _after(
        self, situation: Situation, signals: Letter, passed: int, is_first: bool = False
    ) -> tuple[Letter, Situation]:
        """The instant with `signals`, `passed` nanoseconds later."""
        letter, scopes, states, since = signals, list[Scope](), list[State](), list[int | None]()
        for k, tracker in enumerate(self.trackers):
            outer, age = self._around[k], situation.since[k]
            around = Scope(True, is_first) if outer is None else scopes[outer]
            if situation.states[k].phase is Phase.HELD:
                age = 0  # what is counted from held up to the instant before
            age = None if age is None else age + passed
            over = sum(age is not None and age > bound for bound in tracker.bounds)
            (case,) = (
                case
                for case in tracker.cases(situation.states[k], around)
                if case.passed in (None, over) and finite.holds(case.guard, (letter,))
            )
            counts = case.state.phase is Phase.RUNNING and bool(tracker.bounds)
            scopes.append(case.scope)
            states.append(case.state)
            since.append(0 if counts and case.starts else min(age or 0, tracker.bounds[-1] + 1) if counts else None)
            letter = letter - set(tracker.atoms) | set(case.holding)
        return letter, Situation(tuple(states), tuple(since), signals)


class Continuations:
    """Which runs go on so that they satisfy a formula, whose timed atoms are ordinary atoms here."""

    def __init__(self, formula: Formula, runs: RunsOf) -> None:
        plain = _plain(formula)
        self._buchi = buchi(plain, Alphabet(atoms(plain)))
        self._runs = runs
        graph: Graph[tuple[Situation, int]] = {}
        todo = [(start, edge // 2) for letter, start in runs.starts for edge in self._edges(0, letter)]
        while todo:
            situation, state = node = todo.pop()
            if node not in graph:
                graph[node] = [
                    ((after, edge // 2), frozenset([FULFILS] * (edge % 2) + [TIME] * passes))
                    for letter, after, passes in runs.edges(situation)
                    for edge in self._edges(state, letter)
                ]
                todo.extend(target for target, _ in graph[node])
        self._fair = with_fair_paths(graph, (FULFILS, TIME))

    def _edges(self, state: int, letter: Letter) -> frozenset[int]:
        letters = self._buchi.letters
        successors = self._buchi.successors[state]
        found: frozenset[int] = letters.diagrams.evaluate(successors, lambda level: letters.atoms[level] in letter)
        return found

    def after(self, states: frozenset[int], letter: Letter) -> frozenset[int]:
        """Where the automaton may be after `letter`."""
        return frozenset(edge // 2 for state in states for edge in self._edges(state, letter))

    def exist(self, situation: Situation, states: frozenset[int]) -> bool:
        """Whether some run goes on from there and satisfies the formula."""
        return any((situation, state) in self._fair for state in states)


def with_fair_paths(graph: Graph[Node], marks: Iterable[str]) -> set[Node]:
    """The nodes from which a path leads on which each of `marks` recurs (Emerson and Lei 1986)."""
    before: dict[Node, list[Node]] = defaultdict(list)
    for node, edges in graph.items():
        for target, _ in edges:
            before[target].append(node)
    live = set(graph)
    while True:
        count = len(live)
        for mark in marks:
            todo = [node for node in live if any(mark in found and to in live for to, found in graph[node])]
            reaching = set(todo)
            while todo:
                more = [node for node in before[todo.pop()] if node in live and node not in reaching]
                reaching.update(more)
                todo.extend(more)
            live = reaching
        if len(live) == count:
            return live


def judge(formula: Formula, monitor: Monitor, most: int = 3000) -> Findings:
    """`monitor` of `formula` in every situation that some run leads to. Raises TooManyError beyond `most` of them."""
    runs = RunsOf(formula, most)
    can, fail = Continuations(formula, runs), Continuations(Not(formula), runs)
    wrong = missing = 0
    seen = set()
    start = frozenset([0])
    todo = [
        (situation, letter, can.after(start, letter), fail.after(start, letter), monitor.step(0, letter))
        for letter, situation in runs.starts
    ]
    while todo:
        here = todo.pop()
        if here in seen:
            continue
        seen.add(here)
        situation, last, satisfying, failing, state = here
        verdict = monitor.verdicts[state]
        possible = {can.exist(situation, satisfying), not fail.exist(situation, failing)}
        wrong += verdict.is_permanent and possible != {verdict is Verdict.SATISFIED}
        missing += not verdict.is_permanent and runs.is_settled(situation, last) and possible != {True, False}
        if not verdict.is_permanent:
            todo += [
                (after, letter, can.after(satisfying, letter), fail.after(failing, letter), monitor.step(state, letter))
                for letter, after, _ in runs.edges(situation)
            ]
    return Findings(len(seen), wrong, missing)


def _plain(formula: Formula) -> Formula:
    """`formula` with atoms that are names only."""
    match formula:
        case Atom(name):
            return Atom(name)
        case Not(operand) | Next(operand):
            return type(formula)(_plain(operand))
        case And(left, right) | Or(left, right) | Until(left, right):
            return type(formula)(_plain(left), _plain(right))
        case Truth():
            return formula
