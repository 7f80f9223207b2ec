"""Properties with clocks over boolean signals, and runs with times: drawn at random for the tests of time."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence

from cases import Kind
from support import compiled as compiled_over

from ltlc.automata import translate
from ltlc.base.source import Source
from ltlc.compiler import Compiled
from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.denotation import satisfies
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.instants import Instant, Observation, Step, instants, with_past
from ltlc.semantics.ltl import Atom, Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import (
    Age,
    Historically,
    News,
    Occurred,
    Once,
    PastAtom,
    Previously,
    Since,
    TimedAtom,
    atoms_within,
)
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import trackers_of
from ltlc.semantics.words import Letter
from ltlc.specification.specification import Specification

X, Y, Z = Atom("x"), Atom("y"), Atom("z")
ARRIVAL, MESSAGE = News("new n"), News("message on n")
MARK = News("new n (this one)")
"""What opens an instance."""

NEWS = (ARRIVAL, MESSAGE, MARK)
_EVENTS: dict[Kind, int] = {p.After: 1, p.Until: 1, p.AfterUntil: 2}
SIGNALS = ("x", "y", "z", ARRIVAL.name, MESSAGE.name)


def message_of(news: News) -> News:
    """What ages of the signal count from that `news` is of."""
    return News(news.name.replace("new ", "message on "))


class Draw:
    """What a generator makes: the same seed, the same properties and runs."""

    def __init__(self, seed: int | random.Random, news: Sequence[News] = (ARRIVAL,), may_count: bool = False) -> None:
        self.chance = seed if isinstance(seed, random.Random) else random.Random(seed)
        self._news = news
        self._may_count = may_count

    def run(self, signals: Sequence[str] = SIGNALS, most: int = 6) -> Observation:
        """A run of 1 to `most` steps, some of them at one time."""
        time, steps = 0, []
        for _ in range(self.chance.randint(1, most)):
            steps.append(Step(time, frozenset(name for name in signals if self.chance.random() < 1 / 2)))
            time += self.chance.choice((0, 1, 1, 2, 3, 5))
        return Observation(tuple(steps), self.chance.randint(steps[-1].time, time), -self.chance.randint(0, 3))

    def property(self, depth: int = 2, most_clocks: int = 2) -> Property:
        """A property with bounds and atoms of the past, whose trackers count up to `most_clocks` times."""
        while True:
            past = self.past()
            self._predicates: list[Formula] = [X, Y, Z, ltl.Not(X), ltl.And(X, ltl.Not(Z)), ltl.Or(Y, Z), *past, *past]
            found = self._anchored(self.chance.randint(0, depth))
            if clocks(found) <= most_clocks:
                return found

    def past(self) -> list[Atom]:
        """Up to two atoms of the past, of which the second may be over the first."""
        found: list[Atom] = []
        for number in range(self.chance.randint(0, 2)):
            operands: list[Formula] = [X, Y, Z, ltl.Not(X), ltl.And(X, Y), *self._news, *found]
            p, q = (self.chance.choice(operands) for _ in range(2))
            name, bound = f"past {number}", self.chance.choice((None, 1, 2, 3))
            news = self.chance.choice(self._news)
            kinds: tuple[TimedAtom, ...] = (
                Previously(name, p),
                Once(name, p, bound),
                Historically(name, p, bound),
                Since(name, p, q, bound),
                Age(name, message_of(news), self.chance.randint(0, 3)),
                news,
            )
            found.append(self.chance.choice((*kinds, *self._counts(name, bound))))
        return found

    def _counts(self, name: str, bound: int | None) -> list[Occurred]:
        """Counts of what begins, and of messages."""
        if not self._may_count:
            return []
        times, news = self.chance.randint(1, 3), self.chance.choice(self._news)
        begins, comes = self.chance.choice((X, ltl.Not(Y), ltl.And(X, Y))), self.chance.choice((news, ltl.And(news, X)))
        is_presumed = bound is not None and self.chance.random() < 1 / 3
        return [Occurred(name, begins, times, bound, True), Occurred(name, comes, times, bound, False, is_presumed)]

    def _predicate(self) -> Formula:
        return self.chance.choice(self._predicates)

    def _now(self) -> Property:
        return p.Now(self._predicate())

    def _duration(self) -> int:
        """Short, since the denotation takes nanosecond by nanosecond."""
        return self.chance.randint(1, 4)

    def _untimed(self, depth: int) -> Property:
        if depth == 0:
            kinds: list[type[p.Now | p.Throughout]] = [p.Now, p.Throughout]
            return self.chance.choice(kinds)(self._predicate())
        return self._keyword([p.Always, p.Eventually, p.Never, p.Not, p.And], lambda: self._untimed(depth - 1))

    def _keyword(self, kinds: Sequence[type[Property]], body: Callable[[], Property]) -> Property:
        """A keyword with what it needs: one of `kinds` or a scope."""
        kind: Kind = self.chance.choice([*kinds, p.After, p.Until, p.AfterUntil])
        if kind in (p.And, p.Or, p.Implies):
            return kind(body(), body())
        if kind is p.Within:
            return self._within(body())
        events = _EVENTS.get(kind, 0)
        return kind(*(self._predicate() for _ in range(events)), body())

    def _within(self, body: Property) -> Property:
        """A bound, or an interval, at an anchor."""
        duration = self._duration()
        return p.Within(duration, body, self.chance.choice((0, 0, self.chance.randrange(duration))))

    def _bounded(self) -> Property:
        """One bound or two, in the places where one clock each is enough."""
        ways: tuple[Sequence[Kind], ...] = ((p.Eventually,), (p.Never, p.Always))
        within: list[Property] = [p.Within(self._duration(), self.chance.choice(kinds)(self._now())) for kinds in ways]
        both: Property = self.chance.choice([*within, p.And(*within)])
        return self.chance.choice(
            [
                self._within(self._untimed(self.chance.randint(0, 2))),
                p.Always(both),
                p.Always(p.Implies(self._now(), both)),
                self._untimed(1),
            ]
        )

    def _anchored(self, depth: int) -> Property:
        if depth == 0:
            return self._bounded()
        return self._keyword([p.Not, p.Within, p.And, p.Or, p.Implies], lambda: self._anchored(depth - 1))


def clocks(property_: Property) -> int:
    """How many trackers of `property_` count time."""
    return sum(bool(tracker.bounds) for tracker in trackers_of(encode(property_, EPISODE)))


def past_of(property_: Property) -> list[PastAtom]:
    """The atoms of the past that decide `property_`, each after those that decide it."""
    found = {a.name: a for predicate in p.predicates(property_) for a in atoms_within(predicate)}
    return [atom for atom in found.values() if isinstance(atom, PastAtom)]


def ordinary_atoms(formula: Formula) -> tuple[str, ...]:
    """The atoms that decide `formula` and that no clock decides."""
    return tuple(atom.name for atom in atoms_within(formula) if not isinstance(atom, TimedAtom))


def word_of(property_: Property, run: Observation, counts: Sequence[Occurred] = ()) -> tuple[Instant, ...]:
    """All instants of `run`, by definition, with the atoms of the past, and the `counts` that atoms are."""
    names = {count.name for count in counts}
    steps = tuple(Step(step.time, step.letter - names) for step in run.steps)
    return with_past(instants(steps, run.until, NEWS), [*counts, *past_of(property_)], run.session)


def holds(property_: Property, run: Observation, counts: Sequence[Occurred] = ()) -> bool:
    """Whether `run` satisfies `property_`, some of whose atoms are `counts`, by definition."""
    return satisfies(word_of(property_, run, counts), property_)


def letters_of(formula: Formula, run: Observation, counts: Sequence[Occurred] = ()) -> list[Letter]:
    """The letters at the steps and clock steps of `run`, with all timed atoms of `formula`."""
    timed = TimedRun(trackers_of(formula), [ARRIVAL, MARK], run.session, counts=counts)
    found = [instant for step in run.steps for instant in timed.step(*step)]
    return [*found, *timed.hold(run.until)]


def monitor_of(property_: Property) -> Monitor:
    """The monitor of `property_` over free atoms."""
    formula = encode(property_, EPISODE)
    return translate(formula, Alphabet(ordinary_atoms(formula)))


def compiled(property_: Property, label: str = "p") -> Compiled:
    """`property_` over free atoms."""
    return compiled_over(property_, alphabet=Alphabet(ordinary_atoms(encode(property_, EPISODE))), label=label)


def specification(of: Sequence[Compiled], rate: float | None = None) -> Specification:
    return Specification(Source("props.txt", ""), tuple(c.specification for c in of), (), rate)
