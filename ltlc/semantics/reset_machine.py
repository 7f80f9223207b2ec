"""The reset machine: which words of letters are runs in time, without times.

An atom that a clock is late is not free: it holds only after its bound has passed, then until the clock is reset. The
machine runs all trackers of a formula side by side and lets each clock pass its next bound whenever time could: at an
instant at which the letter is held. Infinite words are fair: time goes on forever, so a clock that runs passes its
bounds or is reset, and there is no end of instants at which the letter is held.

News is over, and `previously` catches up, a nanosecond after a step: a clock that has just started passes no bound
before that.

For a formula whose one clock is that of bounds, its fair words are the timed runs (Coq: `one_clock_words_are_runs`).
Otherwise it has more words than those: it knows nothing of the order in which clocks that run side by side pass their
bounds, nor that the letter is held when one does, which operators of the past with bounds could tell.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import cached_property
from typing import Generic, NamedTuple, TypeVar

from ltlc.dataclass import dataclass
from ltlc.semantics.ltl import TRUE, And, Atom, Formula, Not, Or, conjunction
from ltlc.semantics.timed_atoms import Clock, Previously, news_of, timed_atoms
from ltlc.semantics.trackers import Case, Phase, Scope, State, scopes_around, trackers_of

Letters = TypeVar("Letters")
"""However the user of the machine writes down a set of letters."""

Narrowed = Callable[[Letters, Formula], Letters | None]
"""Those of some letters in which a predicate holds; None if there is none, as far as is known."""


class Clocks(NamedTuple):
    """A state of the reset machine: whether nothing has been read yet, and the state of each tracker.

    `begun` are the trackers, by number, whose clock has run for no time: since it started, no letter could be held.
    """

    is_first: bool
    states: tuple[State, ...]
    begun: frozenset[int] = frozenset()


WITHOUT_CLOCKS = Clocks(False, ())
"""The only state of the machine of a formula without trackers."""


@dataclass(frozen=True, slots=True)
class Move(Generic[Letters]):
    """By any of `letters` to `target`; a step in the fairness sets `fair`. `cases` are what the trackers do."""

    letters: Letters
    target: Clocks
    fair: frozenset[int]
    cases: tuple[Case, ...] = ()


class ResetMachine:
    """The reset machine of the timed atoms in `formula`; one state and all letters, if there are none.

    A word is that of a run in time only if it has moves from `initial` on, and those of each of the fairness sets 0 to
    `sets` - 1 recur. It keeps track of `scopes`, too.
    """

    def __init__(self, formula: Formula, scopes: Iterable[Clock] = ()) -> None:
        self.trackers = trackers_of(formula, scopes)
        self.news = news_of(formula)
        self._around = scopes_around(self.trackers)
        self._timed = [k for k, tracker in enumerate(self.trackers) if tracker.bounds]
        self.initial = Clocks(bool(self.trackers), tuple(tracker.initial for tracker in self.trackers))
        self.is_trivial = not self.trackers and not self.news
        self.sets = 0 if self.is_trivial else len(self._timed) + 1
        # Of one clock of bounds; then a lasso shows that an outcome is possible, otherwise `plays` has to.
        self.words_are_runs = len(self._timed) <= 1 and all(
            isinstance(self.trackers[k].subject, Clock) for k in self._timed
        )

    def moves(self, clocks: Clocks, letters: Letters, narrowed: Narrowed[Letters]) -> Iterator[Move[Letters]]:
        """What may come after `clocks`, among `letters`: no two moves have a letter in common."""
        if self.is_trivial:
            yield Move(letters, clocks, frozenset())
            return
        for among, cases in self.side_by_side(clocks, letters, narrowed):
            states = tuple(case.state for case in cases)
            fair = frozenset(n for n, k in enumerate(self._timed) if self._goes_on(k, cases[k]))
            passing = self.passing(clocks, cases)
            held = narrowed(among, self._settled) if passing.isdisjoint(clocks.begun) else None
            if held is not None:
                yield Move(held, Clocks(False, states), fair | {len(self._timed)}, cases)
            rest = None if passing else narrowed(among, Not(self._settled))
            if rest is not None:
                begun = frozenset(k for k, case in enumerate(cases) if self._has_begun(k, clocks, case))
                yield Move(rest, Clocks(False, states, begun), fair, cases)

    @cached_property
    def _settled(self) -> Formula:
        """The letters that can be held: no news, and `previously` has caught up.

        Where its operand is of the past itself, time alone may change that: there, nothing is demanded.
        """
        operands = [
            (tracker.subject, tracker.subject.operand)
            for tracker in self.trackers
            if isinstance(tracker.subject, Previously) and not timed_atoms(tracker.subject.operand)
        ]
        caught_up = (Or(And(before, now), And(Not(before), Not(now))) for before, now in operands)
        return conjunction([*map(Not, self.news), *caught_up])

    def _goes_on(self, k: int, case: Case) -> bool:
        """Whether the clock is not one that has yet to pass a bound, or has just been reset."""
        return case.starts or not self.trackers[k].is_running(case.state)

    def _has_begun(self, k: int, clocks: Clocks, case: Case) -> bool:
        """Whether the clock has run for no time after an instant at which none passes, and is to do so."""
        runs_out = self.trackers[k].is_running(case.state) and self.trackers[k].bounds[0] > 0
        return runs_out and (starts(clocks.states[k], case) or k in clocks.begun)

    def passing(self, clocks: Clocks, cases: tuple[Case, ...]) -> set[int]:
        """The trackers whose clock passes a bound, which takes time."""
        return {
            k
            for k, (tracker, state, case) in enumerate(zip(self.trackers, clocks.states, cases, strict=True))
            if tracker.is_running(state) and case.passed is not None and case.passed > state.passed
        }

    def side_by_side(
        self, clocks: Clocks, letters: Letters, narrowed: Narrowed[Letters]
    ) -> list[tuple[Letters, tuple[Case, ...]]]:
        """What all trackers may do together, and by which letters."""
        found: list[tuple[Letters, tuple[Case, ...]]] = [(letters, ())]
        for k, tracker in enumerate(self.trackers):
            further = []
            for among, cases in found:
                outer = self._around[k]
                around = Scope(True, clocks.is_first) if outer is None else cases[outer].scope
                for case in tracker.cases(clocks.states[k], around):
                    fitting = narrowed(among, _predicate(case, tracker.atoms))
                    if fitting is not None:
                        further.append((fitting, (*cases, case)))
            found = further
        return found


def starts(state: State, case: Case) -> bool:
    """Whether time is counted from this instant on, or from the one before at which it held still."""
    return case.starts or state.phase is Phase.HELD


def _predicate(case: Case, atoms: tuple[str, ...]) -> Formula:
    """What has to hold in a letter for `case`, of a tracker that decides `atoms`."""
    decided = (Atom(atom) if atom in case.holding else Not(Atom(atom)) for atom in atoms)
    return conjunction([*([] if case.guard == TRUE else [case.guard]), *decided])
