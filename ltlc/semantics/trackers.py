"""Trackers: how the atoms of time and of the past follow, instant by instant, from a state and at most one clock.

A tracker reads the letter of an instant, in which the atoms that decide its own already are, and how many of its bounds
have passed on its clock. `cases` is its whole definition: what may happen at an instant, as cases that exclude one
another. A run with times takes the case that its clock tells (`timed_run`); the reset machine, which knows no times,
may take each of them (`reset_machine`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import field
from enum import Enum
from typing import NamedTuple

from ltlc.dataclass import dataclass
from ltlc.semantics import finite
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import TRUE, Formula, Not, conjunction
from ltlc.semantics.timed_atoms import (
    AfterOpened,
    Age,
    Beginning,
    Clock,
    EpisodeOpened,
    FirstOpen,
    Historically,
    LastTrigger,
    Late,
    Once,
    Previously,
    Since,
    UntilScope,
    atoms_within,
)
from ltlc.semantics.words import Letter


class Phase(Enum):
    """What a tracker is doing."""

    __hash__ = object.__hash__  # that of an Enum is a function in Python, and states are looked up all the time

    IDLE = "idle"
    """Nothing is timed."""
    FIRST = "first"
    """Nothing has been read yet."""
    RUNNING = "running"
    """Time is counted."""
    HELD = "held"
    """What it counts from holds still: time is counted from the last instant at which it does."""
    ALWAYS = "always"
    """What it waited for has come, and no clock takes that back."""


class State(NamedTuple):
    """A phase, and how many bounds have passed on the clock."""

    phase: Phase
    passed: int = 0


class Scope(NamedTuple):
    """Whether the scope that a clock belongs to is open at an instant, and whether it opens at this very one."""

    is_open: bool
    is_fresh: bool


CLOSED = Scope(False, False)


class Case(NamedTuple):
    """Where `guard` holds and `passed` bounds have passed (None: in any case), `holding` are the atoms that hold.

    `starts` says that the clock is at 0 at this instant; `scope` is that of the scope that the clock measures.
    """

    guard: Formula
    holding: tuple[str, ...]
    state: State
    passed: int | None = None
    starts: bool = False
    scope: Scope = CLOSED


IDLE, HELD, ALWAYS, STARTED = State(Phase.IDLE), State(Phase.HELD), State(Phase.ALWAYS), State(Phase.RUNNING)


@dataclass(frozen=True, slots=True)
class Tracker:
    """The tracker of an atom of the past, or of a clock with all the bounds on it, in ascending order.

    `atoms` are the names that it decides: that of the past atom, or one for each bound.
    """

    subject: Previously | Once | Historically | Since | Age | Clock
    atoms: tuple[str, ...]
    bounds: tuple[Nanoseconds, ...] = ()
    _known: dict[tuple[State, Scope, Letter, int], tuple[Case, Letter]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )
    """What `step` has found: runs ask the same again and again."""

    @property
    def initial(self) -> State:
        """The state before the first instant."""
        return State(Phase.FIRST) if isinstance(self.subject, Historically | Age) else IDLE

    def is_running(self, state: State) -> bool:
        """Whether some bound is yet to pass."""
        return state.phase is Phase.RUNNING and state.passed < len(self.bounds)

    def step(self, state: State, around: Scope, letter: Letter, passed: int) -> tuple[Case, Letter]:
        """What happens at an instant with `letter` at which so many bounds have passed, and its letter then."""
        given = state, around, letter, passed
        if (known := self._known.get(given)) is None:
            (case,) = (
                case
                for case in self.cases(state, around)
                if case.passed in (None, passed) and finite.holds(case.guard, (letter,))
            )
            known = self._known[given] = case, letter.difference(self.atoms).union(case.holding)
        return known

    def cases(self, state: State, around: Scope) -> list[Case]:
        """What may happen at an instant after `state`; `around` is the scope that the clock belongs to."""
        match self.subject:
            case Previously(_, operand):
                holding = self.atoms if state == ALWAYS else ()
                return [Case(operand, holding, ALWAYS), Case(Not(operand), holding, IDLE)]
            case Once(_, operand, _):
                return [self._held(operand), *self._once(Not(operand), state)]
            case Historically(_, operand, _):
                return [*self._historically(operand, state), Case(Not(operand), (), IDLE)]
            case Since(_, kept, start, _):
                after = conjunction([Not(start), kept])
                lost = Case(conjunction([Not(start), Not(kept)]), (), IDLE)
                return [self._held(start), *self._once(after, state), lost]
            case Age(_, news, _):
                return [Case(news, self.atoms, STARTED, starts=True), *self._not_late(Not(news), state)]
            case Beginning():
                return self._scope(TRUE, None, state, around)
            case _ if not around.is_open:
                return [Case(TRUE, (), IDLE)]
            case AfterOpened(_, event):
                return self._scope(event, None, state, around)
            case UntilScope(_, event):
                return self._until(event, state, around)
            case EpisodeOpened(_, opening, closing):
                return self._scope(conjunction([opening, Not(closing)]), closing, state, around)
            case FirstOpen(_, trigger, goal):
                return self._first_open(trigger, goal, IDLE if around.is_fresh else state)
            case LastTrigger(_, trigger):
                return self._last_trigger(trigger, IDLE if around.is_fresh else state)
            case _:
                raise TypeError(f"not a tracker's: {self.subject!r}")

    def _held(self, guard: Formula) -> Case:
        """What is counted from holds."""
        return Case(guard, self.atoms, HELD if self.bounds else ALWAYS, starts=bool(self.bounds))

    def _once(self, guard: Formula, state: State) -> Iterator[Case]:
        """It does not hold now, but may have held within the bound."""
        match state.phase:
            case Phase.ALWAYS:
                yield Case(guard, self.atoms, ALWAYS)
            case Phase.HELD:
                yield Case(guard, self.atoms, STARTED, passed=0)
            case Phase.RUNNING:
                yield Case(guard, self.atoms, STARTED, passed=0)
                yield Case(guard, (), IDLE, passed=1)
            case _:
                yield Case(guard, (), IDLE)

    def _historically(self, operand: Formula, state: State) -> Iterator[Case]:
        """`operand` holds; the bound is a nanosecond less than the duration, which has to be reached, not passed."""
        if not self.bounds:
            so_far = state.phase in (Phase.FIRST, Phase.ALWAYS)
            yield Case(operand, self.atoms, ALWAYS) if so_far else Case(operand, (), IDLE)
        elif state.phase is not Phase.RUNNING:
            yield Case(operand, (), STARTED, starts=True)
        else:
            for passed in self._may_have_passed(state):
                yield Case(operand, self.atoms[:passed], State(Phase.RUNNING, passed), passed)

    def _not_late(self, guard: Formula, state: State) -> Iterator[Case]:
        """No news: the age is at most the bound until that has passed; the session may be older than the run."""
        for passed in self._may_have_passed(state):
            yield Case(guard, self.atoms[passed:], State(Phase.RUNNING, passed), passed)

    def _may_have_passed(self, state: State) -> tuple[int, ...]:
        """How many bounds may have passed: clock steps come before a second one could."""
        return (state.passed, state.passed + 1) if state.passed < len(self.bounds) else (state.passed,)

    def _running(self, guard: Formula, state: State, scope: Scope = CLOSED) -> Iterator[Case]:
        """The clock runs on."""
        for passed in self._may_have_passed(state):
            yield Case(guard, self.atoms[:passed], State(Phase.RUNNING, passed), passed, scope=scope)

    def _scope(self, opens: Formula, closes: Formula | None, state: State, around: Scope) -> list[Case]:
        """A scope that opens with `opens`, and closes with `closes` or with the scope around it."""
        if state.phase is Phase.RUNNING and not around.is_fresh:
            if closes is None:
                return list(self._running(TRUE, state, Scope(True, False)))
            return [*self._running(Not(closes), state, Scope(True, False)), Case(closes, (), IDLE)]
        return [Case(opens, (), STARTED, starts=True, scope=Scope(True, True)), Case(Not(opens), (), IDLE)]

    def _until(self, event: Formula, state: State, around: Scope) -> list[Case]:
        """The scope is open from where that around it opens, up to `event`; it has no bounds of its own."""
        if not around.is_fresh and state != STARTED:
            return [Case(TRUE, (), IDLE)]
        return [Case(event, (), IDLE), Case(Not(event), (), STARTED, scope=Scope(True, around.is_fresh))]

    def _first_open(self, trigger: Formula, goal: Formula, state: State) -> list[Case]:
        """An obligation is late before the letter is read, so that a goal that comes late does not help."""
        if state.phase is not Phase.RUNNING:
            opens = conjunction([trigger, Not(goal)])
            return [Case(opens, (), STARTED, starts=True), Case(Not(opens), (), IDLE)]
        settled = [Case(goal, self.atoms[:passed], IDLE, passed) for passed in self._may_have_passed(state)]
        return [*settled, *self._running(Not(goal), state)]

    def _last_trigger(self, trigger: Formula, state: State) -> list[Case]:
        """A trigger counts at once, whether or not the last one was late."""
        now = Case(trigger, (), HELD, starts=True)
        match state.phase:
            case Phase.HELD:
                return [now, Case(Not(trigger), (), STARTED, passed=0)]
            case Phase.RUNNING:
                return [now, *self._running(Not(trigger), state)]
            case _:
                return [now, Case(Not(trigger), (), IDLE)]


def trackers_of(formula: Formula, scopes: Iterable[Clock] = ()) -> tuple[Tracker, ...]:
    """The trackers of the timed atoms of `formula`, and of `scopes`, each after those that decide what it reads."""
    past: list[Tracker] = []
    clocks: dict[Clock, dict[Nanoseconds, str]] = {}
    for scope in scopes:
        for each in reversed(list(clocks_around(scope))):
            clocks.setdefault(each, {})
    for atom in atoms_within(formula):
        match atom:
            case Previously():
                past.append(Tracker(atom, (atom.name,)))
            case Once(within=bound) | Since(within=bound) | Age(most=bound):
                past.append(Tracker(atom, (atom.name,), () if bound is None else (bound,)))
            case Historically(lasting=duration):
                past.append(Tracker(atom, (atom.name,), () if duration is None else (duration - 1,)))
            case Late(name, clock, bound):
                for each in reversed(list(clocks_around(clock))):
                    clocks.setdefault(each, {})
                clocks[clock][bound] = name
            case _:
                pass
    return (*past, *(_clock_tracker(clock, bounds) for clock, bounds in clocks.items()))


def clocks_around(clock: Clock) -> Iterator[Clock]:
    """`clock`, then those of the scopes around it, to the beginning of the run."""
    around: Clock | None = clock
    while around is not None:
        yield around
        around = outer_clock(around)


def outer_clock(subject: object) -> Clock | None:
    """The clock of the scope around; None for the beginning of the run and for atoms of the past."""
    match subject:
        case AfterOpened(outer) | UntilScope(outer) | EpisodeOpened(outer) | FirstOpen(outer) | LastTrigger(outer):
            return outer
        case _:
            return None


def _clock_tracker(clock: Clock, bounds: dict[Nanoseconds, str]) -> Tracker:
    ordered = sorted(bounds)
    return Tracker(clock, tuple(bounds[bound] for bound in ordered), tuple(ordered))


def scopes_around(trackers: Iterable[Tracker]) -> list[int | None]:
    """For each tracker, the index of the one whose scope is around it."""
    index = {tracker.subject: k for k, tracker in enumerate(trackers)}
    return [None if (outer := outer_clock(subject)) is None else index[outer] for subject in index]
