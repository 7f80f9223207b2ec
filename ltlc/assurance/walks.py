"""Runs in time on which a monitor is judged: letters one after the other, at the times that matter to its clocks.

What changes by itself changes a nanosecond after a bound has passed. So the next letter comes at once, or when a clock
is about to expire: at the last nanosecond before, at that moment, one after it; or when all clocks have. Of several
durations each is taken from the last letter as well, whatever the clocks say: so two clocks come to expire one just
before the other, and a clock that should run and does not is noticed.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from functools import cached_property, lru_cache
from itertools import combinations
from typing import NamedTuple, Protocol

from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.encodings import bounds
from ltlc.semantics.instants import Instant, Observation, Step, instants, with_past
from ltlc.semantics.ltl import Atom
from ltlc.semantics.properties import Property, predicates
from ltlc.semantics.timed_atoms import (
    Age,
    News,
    PastAtom,
    atoms_within,
    counts_of,
    duration_of,
    messages_of,
    news_that_counts,
    timed_atoms,
)
from ltlc.semantics.timed_run import Retake, TimedRun, as_held
from ltlc.semantics.trackers import trackers_of
from ltlc.semantics.words import Letter
from ltlc.specification.expressions import New

MOST_WALKS = 1200
"""Walks of which each shows something new."""

RIVALS = 4
"""From so many places drawn, the one goes on that is most unlike those that have."""

MOST_CHOICES = 16
"""How many letters are tried in one place."""

LONGEST_WALK = 7
"""How many letters a walk has that is drawn at random."""


class Heard(frozenset[str]):
    """Messages that make no step, since nothing can be judged yet or something is NaN: ages count from them."""


Reading = Callable[[], Sequence[Letter | None]]
"""What comes after what has been judged: the letters of steps, None where something is NaN, and what is `Heard`."""


class Taking(Protocol):
    """What takes values at openings along a run, and so has a say in its letters."""

    def note(self, instant: Instant) -> None:
        """The run goes on with `instant`."""

    def clock_step(self, instant: Instant, judged: Callable[[Letter], Instant]) -> Instant:
        """What the next clock step is; see `Retake`."""
        ...


class Walk(NamedTuple):
    """The times of steps, the last one that of the end, with the instants that are judged up to each."""

    times: tuple[Nanoseconds, ...]
    session: Nanoseconds
    judged: list[list[Instant | None]]


@dataclass(frozen=True)
class Place:
    """Where a walk has led: the clocks, and the state of the monitor."""

    walk: Observation
    run: TimedRun
    state: int

    @cached_property
    def clocks(self) -> Hashable:
        """The state, of each clock whether it expires at the next nanosecond, and which of two does first.

        It makes a difference as well whether the other one follows a nanosecond later.
        """
        moments = [moment for _, moment in self.run.dues()]
        apart = tuple(max(-2, min(2, one - other)) for one, other in combinations(moments, 2))
        return self.state, tuple(moment == self.walk.until + 1 for moment in moments), apart

    @cached_property
    def situation(self) -> Hashable:
        """All that matters of a place."""
        return self.clocks, self.run.letter, *self.run.states, self.run.time == self.walk.until


class Walks:
    """Walks for the monitor of a property with timed atoms; the same property gives the same ones."""

    def __init__(self, compiled: Compiled) -> None:
        self.monitor = compiled.monitor
        self.counts = counts_of(compiled.formula)
        self.news = news_that_counts(compiled.formula)
        self.arrivals = _arrivals(compiled, self.news)
        self.messages = messages_of(timed_atoms(compiled.formula))
        self.chance = random.Random(0)
        self._trackers = trackers_of(compiled.formula)
        timed = timed_atoms(compiled.formula)
        self._longest = max((duration_of(atom) or 0 for atom in timed), default=0)
        self._durations = (0, *durations(compiled.specification.property))
        # Of a single duration its clock tells as much; clocks of several may expire one just before the other.
        self._several = self._durations if len(self._durations) > 2 else ()
        self._ages = [atom.most for atom in timed if isinstance(atom, Age)]

    def run(self, session: Nanoseconds, retake: Retake = as_held) -> TimedRun:
        """The clocks of the property before the first step."""
        return TimedRun(self._trackers, self.news, session, retake, self.counts)

    def telling(self, letters: Sequence[Letter]) -> Iterator[Observation]:
        """Walks over `letters` of which each ends with something new: by a letter or by time, from a situation.

        Of few letters, these are all that there is, up to `MOST_WALKS`.
        """
        choices = [letter | news for letter in letters for news in self._all_news()]
        open_places, known = list(self._starts()), set[Hashable]()
        gone_on = Counter[Hashable]()
        while open_places and len(known) < MOST_WALKS:
            some = self.chance.sample(range(len(open_places)), min(len(open_places), RIVALS))
            place = open_places.pop(min(some, key=lambda number: gone_on[open_places[number].clocks]))
            gone_on[place.clocks] += 1
            here = place.situation
            for after in self._onward(place, self.chance.sample(choices, min(len(choices), MOST_CHOICES))):
                shown = (here, after.situation, *self._elapsed(place, after))
                if shown not in known and not self._goes_without_saying(place, after):
                    known.add(shown)
                    open_places.append(after)
                    yield after.walk

    def _goes_without_saying(self, place: Place, after: Place) -> bool:
        """A permanent verdict stays as it is."""
        before, now = (self.monitor.verdicts[each.state] for each in (place, after))
        return bool(place.walk.steps) and before.is_permanent and before is now

    def _elapsed(self, place: Place, after: Place) -> Iterator[Hashable]:
        """How long ago the last three steps are, beside the durations of the property: whatever the clocks say.

        Where there are ages, the beginning of the session as well.
        """
        session = [place.walk.session] if self._ages else []
        for time in (*session, *(step.time for step in place.walk.steps[-3:])):
            elapsed = after.walk.until - time
            passed = sum(elapsed > each for each in self._durations)
            yield passed, elapsed in self._durations, elapsed + 1 in self._several

    def _all_news(self) -> Iterator[Letter]:
        arrivals = self.arrivals.values()
        sets = (some for count in range(len(arrivals) + 1) for some in combinations(arrivals, count))
        return (frozenset[str]().union(*some) for some in sets)

    def _starts(self) -> Iterator[Place]:
        """Before the first step, in sessions that are older than the run by what matters to ages."""
        start = self._longest + 1
        for gap in sorted({0, *(max(0, most + side) for most in self._ages for side in (-1, 0, 1))}):
            yield Place(Observation((), start, start - gap), self.run(start - gap), 0)

    def _onward(self, place: Place, letters: Iterable[Letter]) -> Iterator[Place]:
        """The next letter comes at once, or the last one is held for a while."""
        walk = place.walk
        for letter in letters:
            run = place.run.fork()
            state = self._state(place.state, run.step(walk.until, letter))
            yield Place(walk._replace(steps=(*walk.steps, Step(walk.until, letter))), run, state)
        yield from self._renewed(place)
        for until in self._waits(place):
            run = place.run.fork()
            state = self._state(place.state, run.hold(until))
            yield Place(walk._replace(until=until), run, state)

    def _renewed(self, place: Place) -> Iterator[Place]:
        """Messages come that make no step; not where the letter is to change by itself, which they would hide."""
        walk, is_over = place.walk, place.run.due() != place.walk.until + 1
        for heard in {Heard(news & self.messages) for news in self._all_news()} if is_over else ():
            run = place.run.fork()
            state = self._state(place.state, run.hear(walk.until, heard))
            if heard and walk.steps:
                yield Place(walk._replace(steps=(*walk.steps, Step(walk.until, heard))), run, state)

    def _state(self, state: int, judged: Iterable[Instant]) -> int:
        for instant in judged:
            state = self.monitor.step(state, instant)
        return state

    def _waits(self, place: Place) -> list[Nanoseconds]:
        """Up to when the last letter may be held: around what the clocks say, and what the property says of it."""
        if not place.walk.steps:
            return []
        now = place.walk.until
        near = {moment + side for _, moment in place.run.dues() for side in (-1, 0, 1)}
        near |= {place.walk.steps[-1].time + each + side for each in self._several for side in (-1, 0, 1)}
        return sorted({moment for moment in near if moment > now} | {now + 1, now + self._longest + 2})

    def walk(self, told: Observation, further: Sequence[Reading], taking: Taking | None = None) -> Walk:
        """`told`, then `further` steps after random waits."""
        run = self.run(told.session, as_held if taking is None else taking.clock_step)

        def noted(instants_: Iterable[Instant]) -> Iterator[Instant]:
            for instant in instants_:
                if taking is not None:
                    taking.note(instant)
                yield instant

        times = [*(step.time for step in told.steps), told.until]
        judged: list[list[Instant | None]] = [
            [*([None] if isinstance(step.letter, Heard) else []), *noted(taken(run, step))] for step in told.steps
        ]
        for reading in further:
            judged.append([*noted(run.hold(times[-1]))])
            for letter in reading():
                judged[-1] += [None] if letter is None else noted(taken(run, Step(times[-1], letter)))
            times.append(self._later(run, times[-1]))
        judged.append([*noted(run.hold(times[-1]))])
        return Walk(tuple(times), told.session, judged)

    def at_random(self, further: Sequence[Reading], taking: Taking | None = None) -> Walk:
        """A walk of these steps one after the other."""
        return self.walk(self.chance.choice(list(self._starts())).walk, further, taking)

    def _later(self, run: TimedRun, time: Nanoseconds) -> Nanoseconds:
        edges = [moment + side for _, moment in run.dues() for side in (-2, -1, 0, 1, self._longest + 1)]
        return max(time, self.chance.choice([time, *(edges or [time + 1, time + self._longest + 2])]))

    def told(self, letter: Letter) -> set[New]:
        """What tells of the messages of which `letter` has news."""
        return {wanted for wanted, news in self.arrivals.items() if not letter.isdisjoint(news)}

    def with_news(self, letter: Letter) -> Letter:
        """`letter` with any news."""
        return letter.union(*(news for news in self.arrivals.values() if self.chance.random() < 1 / 2))


def taken(run: TimedRun, step: Step) -> Iterator[Instant]:
    """The instants up to `step`, whose letter may be what is `Heard`."""
    return run.hear(*step) if isinstance(step.letter, Heard) else run.step(*step)


def _arrivals(compiled: Compiled, news: Iterable[News]) -> dict[New, Letter]:
    """Of what tells of messages, which `news` there is of these."""
    found: dict[New, Letter] = {}
    for each in news:
        wanted = compiled.specification.arrival(each.name)
        found[wanted] = found.get(wanted, frozenset[str]()) | {each.name}
    return found


def word_of(property_: Property, walk: Observation, changes: Iterable[Nanoseconds]) -> tuple[Instant, ...]:
    """The instants of `walk`, by definition, at the times that can matter.

    Those are where a bound has just passed since a step, or since one of `changes`, at which letters change by
    themselves, with the nanoseconds around them. In between nothing changes, and properties are next-free.
    """
    atoms = timed_in(property_)
    past = [atom for atom in atoms if isinstance(atom, PastAtom)]
    starts = {walk.session, *(step.time for step in walk.steps), *changes}
    counted = (0, *durations(property_))
    times = {start + duration + near for start in starts for duration in counted for near in (-1, 0, 1, 2)}
    times |= {walk.until, *(step.time for step in walk.steps)}
    news = [atom for atom in atoms if isinstance(atom, News)]
    steps = _as_steps(walk.steps, frozenset(each.name for each in news))
    return with_past(instants(steps, walk.until, news, times), past, walk.session)


def _as_steps(steps: Iterable[Step], news: Letter) -> list[Step]:
    """`steps` with the letter that is held where messages make none."""
    found: list[Step] = []
    for time, letter in steps:
        held = found[-1].letter - news if isinstance(letter, Heard) else frozenset[str]()
        found.append(Step(time, held | letter))
    return found


@lru_cache  # it is asked of each run
def timed_in(property_: Property) -> tuple[Atom, ...]:
    """The atoms of the past and of news that `property_` is written with, each after those that decide it.

    Before them come those that decide what is counted.
    """
    parts = list(predicates(property_))
    parts = [*(count.operand for part in parts for count in counts_of(part)), *parts]
    return (*{atom.name: atom for part in parts for atom in atoms_within(part)}.values(),)


@lru_cache
def durations(property_: Property) -> tuple[Nanoseconds, ...]:
    """The durations that `property_` is written with, each once, in ascending order."""
    past = (duration_of(atom) for atom in timed_in(property_) if isinstance(atom, PastAtom))
    within = (each for part in bounds(property_) for each in (part.start, part.duration))
    return tuple(sorted({each for each in (*within, *past) if each}))
