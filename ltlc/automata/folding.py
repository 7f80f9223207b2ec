"""Folding: a monitor and the clocks of its atoms, made into one machine that asks and sets them.

The monitor reads atoms that clocks and the past decide; the trackers say how. Side by side they are a machine over the
other atoms and a question for each clock, whether its next bound has passed: what runs on a robot. Letters that no run
has in a state do not matter there, which makes it small.

What is counted may change at any instant, by a step or by time; its atom stays one of the machine.

The clock of an age is not set, only asked, at every instant. That a message has come, from which ages count, is no
atom of the machine: an age that is no longer late shows it; otherwise it does not matter.

Of a property that is judged from a mark on, the machine can put the mark itself: where it begins, and where it begins
anew, at the instant after each violation. Then a copy of the monitor that has seen no mark goes along.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any, NamedTuple

from ltlc.automata.machine import (
    Leap,
    Letter,
    Letters,
    Machine,
    decided,
    explore,
    first_possible,
    join_compatible,
    minimise,
    read_by,
    runs_in_time,
    valuations,
)
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.diagrams import Diagram, Diagrams, of_predicate
from ltlc.semantics.ltl import TRUE, And, Formula, Not, Or, conjunction
from ltlc.semantics.monitor import Monitor, Target
from ltlc.semantics.reset_machine import Clocks, ResetMachine
from ltlc.semantics.timed_atoms import Age, Clock, Previously, counts_of, messages_of, news_of, timed_atoms
from ltlc.semantics.timed_monitor import Action, AgeDue, Effect, Outcome, TimedMonitor, timeless
from ltlc.semantics.trackers import Case, Phase, State, Tracker, clocks_around, outer_clock
from ltlc.semantics.verdicts import Verdict

BY_TIME = "by time"
"""The question whether an instant is a clock step."""


class Joint(NamedTuple):
    """A state of the monitor and, unless its verdict is permanent, where the clocks are.

    `stale` are the scopes, by number, that have closed, and at whose opening no value has been taken since. The monitor
    would be in the state `unmarked` if no mark had been put; at the next instant it is put if `is_marked`.
    """

    state: int
    clocks: Clocks | None
    stale: frozenset[int] = frozenset()
    unmarked: int = 0
    is_marked: bool = False


class Shown(NamedTuple):
    """What a state shows: its verdict, and which scopes are not open."""

    verdict: Verdict
    closed: tuple[int, ...]


class Deeds(NamedTuple):
    """What is done on the way to a state; see `Outcome`."""

    actions: tuple[Action, ...] = ()
    again: bool = False
    taken: tuple[int, ...] = ()


Scopes = Mapping[Clock, Collection[str]]
"""The scopes at whose opening values are taken, numbered as they come, with the atoms that read these values."""


def fold(
    formula: Formula, alphabet: Alphabet, monitor: Monitor, scopes: Scopes | None = None, mark: str | None = None
) -> TimedMonitor:
    """What runs: `monitor`, of `formula` over the letters of `alphabet`, together with its clocks.

    With a `mark`, an atom of a formula with timed atoms that is of no interest before it holds, the machine says itself
    where that is, and goes on after a violation.
    """
    if not timed_atoms(formula) and not scopes:
        return timeless(monitor)
    return _Folder(formula, alphabet, monitor, scopes or {}, mark).folded()


class _Folder:
    """The levels of its diagrams are the atoms that remain, the questions, and the atoms that are decided.

    There is a question for each clock and, where clock steps can take values, whether an instant is one.
    """

    def __init__(
        self, formula: Formula, alphabet: Alphabet, monitor: Monitor, scopes: Scopes, mark: str | None
    ) -> None:
        self.monitor = monitor
        self.mark = () if mark is None else (mark,)
        self.time = ResetMachine(formula, scopes)
        subjects = [tracker.subject for tracker in self.time.trackers]
        self.scopes = [subjects.index(scope) for scope in scopes]
        self.readers = list(scopes.values())
        self.around = [
            frozenset(n for n, k in enumerate(self.scopes) if subjects[k] in list(clocks_around(scope))[1:])
            for scope in scopes
        ]
        self.messages = messages_of(subjects)
        self.counts = tuple(each.name for each in counts_of(formula))
        self.arrivals = news_of(formula)
        self.news = tuple(each for each in self.arrivals if each.name not in self.messages)
        self.takes_clock_steps = bool(timed_atoms(formula))
        self.clocks = [k for k, tracker in enumerate(self.time.trackers) if tracker.bounds]
        decided_atoms = [atom for tracker in self.time.trackers for atom in tracker.atoms]
        read = read_by(formula, alphabet)
        self.atoms = tuple(atom for atom in read.atoms if atom not in (*decided_atoms, *self.messages, *self.mark))
        self.questions = tuple(f"clock {number}" for number in range(len(self.clocks)))
        self.by_time = (BY_TIME,) if self.takes_clock_steps and scopes else ()
        names = (*self.atoms, *self.questions, *self.by_time, *self.messages, *self.mark, *decided_atoms)
        self.levels = {name: level for level, name in enumerate(names)}
        self.diagrams = Diagrams()
        self.rows = [self._row(edge) for edge in monitor.edges]
        self.possible = self.diagrams.true
        for group in read.groups:
            self.possible = self.diagrams.conjunction(self.possible, valuations(self.diagrams, names, group))
        self.before_mark = {self.levels[name]: False for name in (*self.mark, *self._late())}
        told = self._whatever(self.messages, self.possible)
        self.letters = Letters(names, self.diagrams, told, runs_in_time(TRUE, names, self.diagrams))

    def folded(self) -> TimedMonitor:
        """The joint machine, as small as joining states makes it."""
        clocks = None if self.monitor.verdicts[0].is_permanent else self.time.initial
        initial = Joint(0, clocks, is_marked=bool(self.mark))
        whole = explore(self.letters, initial, self._step, self._shown)
        machine = join_compatible(minimise(whole))
        outcomes: dict[Outcome, int] = {}

        def number(leap: Leap) -> int:
            deeds: Any = leap.actions
            return outcomes.setdefault(Outcome(leap.state, *deeds), len(outcomes))

        rows = self._at_steps(machine) + (self._at_clock_steps(machine) if self.takes_clock_steps else [])
        edges, decisions = decided(self.diagrams, rows, number)
        count = len(machine.outputs)
        return TimedMonitor(
            self.atoms,
            tuple(shown.verdict for shown in machine.outputs),
            edges[:count],
            edges[count:],
            decisions,
            tuple(outcomes),
            tuple(self._age(self.time.trackers[k]) for k in self.clocks),
            tuple(shown.closed for shown in machine.outputs),
        )

    def _shown(self, joint: Joint) -> Shown:
        return Shown(self.monitor.verdicts[joint.state], tuple(self._closed(joint.clocks)))

    def _closed(self, clocks: Clocks | None) -> Iterator[int]:
        """The scopes that are not open; once the verdict is permanent, that does not matter."""
        for number, k in enumerate(self.scopes):
            if clocks is not None and clocks.states[k].phase is not Phase.RUNNING:
                yield number

    def _at_steps(self, machine: Machine) -> list[Diagram]:
        """Clock steps come before steps, so no clock that is set is past due; before the first, none is."""
        is_step = {self.levels[name]: False for name in self.by_time}
        answers = is_step | {self.levels[question]: False for question in self._of_set_clocks()}
        first, *rest = machine.successors
        return [self.diagrams.given(is_step, first), *(self.diagrams.given(answers, row) for row in rest)]

    def _at_clock_steps(self, machine: Machine) -> list[Diagram]:
        """At a clock step the letter is the one that led to the state, without its news.

        Some clock is due then, a message has renewed an age, or a count has changed.
        """
        is_clock_step = {self.levels[name]: True for name in self.by_time}
        answers = is_clock_step | {self.levels[each.name]: False for each in self.news}
        leaps = [leap for row in machine.successors for leap in self.diagrams.values(row) if isinstance(leap, Leap)]
        by_itself = self.messages or self.counts or any(self._looks_again(leap) for leap in leaps)
        is_due = self.diagrams.terminal(bool(by_itself))
        for question in self.questions:
            is_due = self.diagrams.disjunction(is_due, self.diagrams.variable(self.levels[question]))
        nowhere = self.diagrams.terminal(Letter.IMPOSSIBLE)
        rows = []
        for state, row in enumerate(machine.successors):
            possible = self.diagrams.conjunction(is_due, self._held_letters(machine, state))
            held = self.diagrams.choose(possible, self.diagrams.given(answers, row), nowhere)
            rows.append(self.diagrams.terminal(Leap(state, Deeds())) if held == nowhere else held)
        return rows

    def _of_set_clocks(self) -> Iterator[str]:
        for question, k in zip(self.questions, self.clocks, strict=True):
            if not self._is_age(k):
                yield question

    def _is_age(self, k: int) -> bool:
        return isinstance(self.time.trackers[k].subject, Age)

    def _looks_again(self, leap: Leap) -> bool:
        deeds: Any = leap.actions
        return bool(deeds.again)

    def _held_letters(self, machine: Machine, state: int) -> Diagram:
        """The letters with which an instant leaves `state`, news, counts and clocks aside."""
        leaps = (leap for row in machine.successors for leap in self.diagrams.values(row) if isinstance(leap, Leap))
        aside = [*(each.name for each in self.news), *self.counts, *self.questions, *self.by_time]
        found = self.diagrams.false
        for leap in dict.fromkeys(leap for leap in leaps if leap.state == state):
            deeds: Any = leap.actions
            anew = [name for number in deeds.taken for name in self.readers[number] if name in self.levels]
            for row in machine.successors:
                here = self.diagrams.combine(lambda target, leap=leap: target == leap, row)
                found = self.diagrams.disjunction(found, self._whatever([*aside, *anew], here))
        return found

    def _whatever(self, names: Iterable[str], letters: Diagram) -> Diagram:
        """`letters`, with any answer for the atom of this name."""
        for name in names:
            sides = (self.diagrams.given({self.levels[name]: answer}, letters) for answer in (False, True))
            letters = self.diagrams.disjunction(*sides)
        return letters

    def _age(self, tracker: Tracker) -> AgeDue | None:
        if self.monitor.verdicts[0].is_permanent or not isinstance(tracker.subject, Age):
            return None
        return AgeDue(tracker.subject.news.name, tracker.bounds[0])

    def _row(self, target: Target) -> Diagram:
        """A target of the monitor as a diagram whose values are states."""
        if target >= 0:
            return self.diagrams.terminal(target)
        atom, low, high = self.monitor.decisions[~target]
        holds = self.diagrams.variable(self.levels[self.monitor.atoms[atom]])
        return self.diagrams.choose(holds, self._row(high), self._row(low))

    def _step(self, joint: Joint) -> Diagram:
        """Where an instant leads: the values are leaps, and `IMPOSSIBLE` where no run has such an instant."""
        if joint.clocks is None:
            return self.diagrams.terminal(Leap(joint, Deeds()))
        row = self.diagrams.terminal(Letter.IMPOSSIBLE)
        for letters, cases in self.time.side_by_side(joint.clocks, self.diagrams.true, self._narrowed):
            holding = {atom for case in cases for atom in case.holding}
            answers = {self.levels[atom]: atom in holding for tracker in self.time.trackers for atom in tracker.atoms}
            guard = self._asking(joint.clocks, cases, self.diagrams.given(answers, letters))
            after = self.diagrams.given(answers, self._step_or_clock_step(joint, cases))
            row = self.diagrams.choose(guard, after, row)
        nowhere = self.diagrams.terminal(Letter.IMPOSSIBLE)
        marked = {self.levels[name]: joint.is_marked for name in self.mark}
        row = self.diagrams.given(marked, self.diagrams.choose(self.possible, row, nowhere))
        return self._unless_messages(row)

    def _late(self) -> Iterator[str]:
        """The atoms of clocks that start with the mark at the earliest."""
        return (atom for tracker in self.time.trackers if isinstance(tracker.subject, Clock) for atom in tracker.atoms)

    def _is_violated(self, state: int) -> bool:
        return self.monitor.verdicts[state] is Verdict.VIOLATED

    def _unless_messages(self, row: Diagram) -> Diagram:
        """`row` where no message has come, as far as that is possible."""
        for name in self.messages:
            without, with_one = (self.diagrams.given({self.levels[name]: came}, row) for came in (False, True))
            row = self.diagrams.combine(first_possible, without, with_one)
        return row

    def _narrowed(self, letters: Diagram, predicate: Formula) -> Diagram | None:
        found = self.diagrams.conjunction(letters, of_predicate(predicate, self.diagrams, self.levels))
        return None if found == self.diagrams.false else found

    def _asking(self, clocks: Clocks, cases: tuple[Case, ...], guard: Diagram) -> Diagram:
        """`guard` where each clock answers as its tracker's case says; the one of an age is asked in any case."""
        for question, k in zip(self.questions, self.clocks, strict=True):
            state, case = clocks.states[k], cases[k]
            if self._is_age(k):
                late = self.diagrams.variable(self.levels[question])
                guard = self.diagrams.conjunction(guard, self.diagrams.negation(late) if case.holding else late)
            elif self.time.trackers[k].is_running(state) and case.passed is not None:
                passes = self.diagrams.variable(self.levels[question])
                answer = passes if case.passed > state.passed else self.diagrams.negation(passes)
                guard = self.diagrams.conjunction(guard, answer)
        return guard

    def _step_or_clock_step(self, joint: Joint, cases: tuple[Case, ...]) -> Diagram:
        """Where the monitor goes from `joint`: at a clock step, it first takes the values at openings that it has to.

        At a step from a state in which a scope is not open, they are taken by themselves.
        """
        assert joint.clocks is not None
        if not self.by_time:
            return self._after(joint, cases, frozenset())
        phases = [(joint.clocks.states[k].phase, cases[k].state.phase) for k in self.scopes]
        is_open = [(before is Phase.RUNNING, after is Phase.RUNNING) for before, after in phases]
        closing = frozenset(n for n, (before, after) in enumerate(is_open) if before and not after)
        opening = frozenset(n for n, (before, after) in enumerate(is_open) if after and not before)
        opening_stale = joint.stale & opening
        taken = frozenset(n for n in opening_stale if not self.around[n] & opening_stale)
        if taken:
            anew = joint._replace(stale=joint.stale - taken)
            held = self.diagrams.terminal(Leap(anew, Deeds(taken=tuple(sorted(taken)))))
        else:
            held = self._after(joint, cases, (joint.stale | closing) - opening)
        by_time = self.diagrams.variable(self.levels[BY_TIME])
        return self.diagrams.choose(by_time, held, self._after(joint, cases, closing))

    def _after(self, joint: Joint, cases: tuple[Case, ...], stale: frozenset[int]) -> Diagram:
        """Where the monitor goes from `joint`, with all that is done on the way."""
        assert joint.clocks is not None
        before, clocks = joint.clocks, Clocks(False, tuple(case.state for case in cases))
        actions = tuple(self._actions(before, cases))
        stops = tuple(self._stops(before))

        def leap(state: int, settled: bool, unmarked: int) -> Leap:
            if self.mark and self._is_violated(state):
                return self._anew(state, before, cases, unmarked)
            if self.monitor.verdicts[state].is_permanent:
                return Leap(Joint(state, None), Deeds(stops))
            return Leap(Joint(state, clocks, stale, unmarked), Deeds(actions, not settled))

        row = self.rows[joint.unmarked if joint.is_marked else joint.state]
        unmarked = self.diagrams.terminal(0)
        if self.mark:
            unmarked = self.diagrams.given(self.before_mark, self.rows[joint.unmarked])
        return self.diagrams.combine(leap, row, self._settled(), unmarked)

    def _anew(self, state: int, before: Clocks, cases: tuple[Case, ...], unmarked: int) -> Leap:
        """After a violation: only the past goes on. The next instant comes a nanosecond later."""
        begun = tuple(
            case._replace(state=tracker.initial) if outer_clock(tracker.subject) else case
            for tracker, case in zip(self.time.trackers, cases, strict=True)
        )
        every = frozenset(range(len(self.scopes)))
        clocks = Clocks(False, tuple(case.state for case in begun))
        joint = Joint(state, clocks, every, unmarked, is_marked=True)
        return Leap(joint, Deeds(tuple(self._actions(before, begun)), again=True))

    def _settled(self) -> Diagram:
        """True for the letters that no further nanosecond changes by itself."""
        subjects = (tracker.subject for tracker in self.time.trackers)
        caught_up = (
            Or(And(past, past.operand), And(Not(past), Not(past.operand)))
            for past in subjects
            if isinstance(past, Previously)
        )
        return of_predicate(conjunction([*map(Not, self.arrivals), *caught_up]), self.diagrams, self.levels)

    def _runs(self, k: int, state: State) -> bool:
        """Whether it is a clock that is set, a bound of which is yet to pass."""
        return self.time.trackers[k].is_running(state) and not self._is_age(k)

    def _actions(self, clocks: Clocks, cases: tuple[Case, ...]) -> Iterator[Action]:
        for number, k in enumerate(self.clocks):
            tracker, before, case = self.time.trackers[k], clocks.states[k], cases[k]
            if not self._runs(k, case.state):
                if self._runs(k, before):
                    yield Action(number, Effect.STOP, 0)
            elif case.starts:
                yield Action(number, Effect.START, tracker.bounds[0])
            elif before.phase is Phase.HELD:
                yield Action(number, Effect.RELEASE, tracker.bounds[0])
            elif case.state.passed > before.passed:
                gained = tracker.bounds[case.state.passed] - tracker.bounds[before.passed]
                yield Action(number, Effect.EXTEND, gained)

    def _stops(self, clocks: Clocks) -> Iterator[Action]:
        """Once the verdict is permanent, no clock runs."""
        for number, k in enumerate(self.clocks):
            if self._runs(k, clocks.states[k]):
                yield Action(number, Effect.STOP, 0)
