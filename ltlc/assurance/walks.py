"""Runs in time on which a monitor is judged: letters one after the other, at the times that matter to its clocks.

What changes by itself changes a nanosecond after a bound has passed. So the next letter comes at once, or when a clock
is about to expire: a nanosecond before, at that moment, one after it; or when all clocks have.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from ltlc.compiler import Compiled
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.encodings import bounds
from ltlc.semantics.instants import Instant, Observation, Step, instants, with_past
from ltlc.semantics.properties import Property, predicates
from ltlc.semantics.timed_atoms import (
    Age,
    News,
    PastAtom,
    atoms_within,
    duration_of,
    news_of,
    timed_atoms,
)
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import trackers_of
from ltlc.semantics.words import Letter

LONGEST_WALK = 7
TRIES = 600
"""Walks of which those are kept that show something new."""

ANY_WALKS = 120
"""Walks that are kept in any case."""


class Walk(NamedTuple):
    """The times of steps, the last one that of the end, with the instants that are judged up to each."""

    times: tuple[Nanoseconds, ...]
    session: Nanoseconds
    judged: list[list[Instant]]


class Walks:
    """Walks for the monitor of a property with timed atoms; the same property gives the same ones."""

    def __init__(self, compiled: Compiled) -> None:
        self.monitor = compiled.monitor
        self.news = news_of(compiled.formula)
        self.chance = random.Random(0)
        self._trackers = trackers_of(compiled.formula)
        timed = timed_atoms(compiled.formula)
        self._longest = max((duration_of(atom) or 0 for atom in timed), default=0)
        self._ages = [atom.most for atom in timed if isinstance(atom, Age)]

    def through(self, letters: Sequence[Letter | None]) -> Walk:
        """A walk with `letters` one after the other; None where there is no step, though one is tried."""
        start = self._longest
        session = start - self._gap([0, *(edge for most in self._ages for edge in (most - 1, most, most + 1))])
        run = self.run(session)
        times, judged = [start], []
        for letter in letters:
            judged.append(list(run.hold(times[-1]) if letter is None else run.step(times[-1], letter)))
            times.append(self._later(run, times[-1]))
        judged.append(list(run.hold(times[-1])))
        return Walk(tuple(times), session, judged)

    def run(self, session: Nanoseconds) -> TimedRun:
        """The clocks of the property before the first step."""
        return TimedRun(self._trackers, self.news, session)

    def _gap(self, gaps: Sequence[Nanoseconds]) -> Nanoseconds:
        return max(0, self.chance.choice(gaps))

    def _later(self, run: TimedRun, time: Nanoseconds) -> Nanoseconds:
        due = run.due()
        moments = [time, time + 1] if due is None else [time, due - 2, due - 1, due, due + 1, due + self._longest + 1]
        return max(time, self.chance.choice(moments))

    def new_transitions(self, judged: Iterable[Sequence[Instant]], known: set[tuple[int, Letter]]) -> bool:
        """Whether the monitor takes a transition by a letter that is not `known`; all are added to it."""
        state, before = 0, len(known)
        for instant in (each for some in judged for each in some):
            known.add((state, frozenset(instant)))
            state = self.monitor.step(state, instant)
        return len(known) > before

    def telling(self, letters: Sequence[Letter]) -> Iterator[Observation]:
        """Some walks over `letters`, then others of which each takes a transition that those before do not."""
        known: set[tuple[int, Letter]] = set()
        for number in range(TRIES):
            length = self.chance.randint(1, LONGEST_WALK)
            chosen = [self.with_news(self.chance.choice(letters)) for _ in range(length)]
            times, session, judged = self.through(chosen)
            if self.new_transitions(judged, known) or number < ANY_WALKS:
                yield Observation(tuple(map(Step, times[:-1], chosen)), times[-1], session)

    def with_news(self, letter: Letter) -> Letter:
        """`letter` with any news."""
        return letter.union(each.name for each in self.news if self.chance.random() < 1 / 2)


def word_of(property_: Property, walk: Observation, changes: Iterable[Nanoseconds]) -> tuple[Instant, ...]:
    """The instants of `walk`, by definition, at the times that can matter.

    Those are where a bound has just passed since a step, or since one of `changes`, at which letters change by
    themselves, with the nanoseconds around them. In between nothing changes, and properties are next-free.
    """
    atoms = {atom.name: atom for predicate in predicates(property_) for atom in atoms_within(predicate)}
    past = [atom for atom in atoms.values() if isinstance(atom, PastAtom)]
    durations = [0, *(d for atom in past if (d := duration_of(atom))), *(part.duration for part in bounds(property_))]
    starts = {walk.session, *(step.time for step in walk.steps), *changes}
    times = {start + duration + near for start in starts for duration in durations for near in (-1, 0, 1, 2)}
    times |= {walk.until, *(step.time for step in walk.steps)}
    news = [atom for atom in atoms.values() if isinstance(atom, News)]
    return with_past(instants(walk.steps, walk.until, news, times), past, walk.session)
