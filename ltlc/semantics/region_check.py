"""The checker of a guard's region: whatever comes, the guards come to rest again.

Coq: `proofs/GuardCheck.v`, with the same names, and the proof that nothing leaves guards with an accepted region that
violates what they keep: `accepted_guard`. This is the same algorithm in Python, on diagrams that share their parts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from ltlc.semantics import diagrams as decision_diagrams
from ltlc.semantics.arenas import Arena, Effect, Joint, Outcome, Part, Place, Sent, Standing, Ticks, standing
from ltlc.semantics.diagrams import Diagram, Diagrams
from ltlc.semantics.ltl import Formula
from ltlc.semantics.region_reader import RegionRead, Spot
from ltlc.semantics.reset_machine import Clocks, Move
from ltlc.semantics.trackers import Case

Letter = Mapping[str, Diagram]
"""A letter that is known in parts: what each condition is, in terms of what held before and what came anew."""


class Way(NamedTuple):
    """Where a step leads, by the letters of `context`; which clocks pass a bound on it, and which it leaves alone."""

    context: Diagram
    now: Letter
    joint: Joint
    passing: Ticks
    alone: Ticks


def objection(arena: Arena, region: RegionRead) -> str | None:
    """Why `region` is not shown to be closed; None if it is. Coq: `check_guard`."""
    return _Checker(arena, region).objection()


class _Checker:
    def __init__(self, arena: Arena, region: RegionRead) -> None:
        self.arena, self.region = arena, region
        self.diagrams = Diagrams()
        self.asked: dict[tuple[object, ...], Diagram] = {}
        self.before = {atom: self.variable("was", atom) for atom in arena.read}

    def variable(self, *asked: object) -> Diagram:
        """What is asked of a condition before, of one that may be anything after a step, of a property's own atom."""
        return self.asked.setdefault(asked, self.diagrams.variable(len(self.asked)))

    def objection(self) -> str | None:
        """What is wrong first."""
        if self.region.assumption == self.region.diagrams.false:
            return "nothing is found that its assumption allows"
        start = next(iter(self.region.spots))
        possible = self.of_letter(self.before, self.region.assumption)
        if start != self.arena.start or not self.entails(possible, self.of_letter(self.before, self.rest_at(start))):
            return "it may not rest in r0, where it starts"
        found = (
            f"r{number}: {reason}"
            for number, (joint, spot) in enumerate(self.region.spots.items())
            for reason in self.objections_at(joint, spot)
        )
        return next(found, None)

    def objections_at(self, joint: Joint, spot: Spot) -> Iterator[str]:
        """Coq: `check_spot`."""
        if joint.sent is None and (spot.answers or spot.acts):
            yield "it may not send here"
        for topic in self.arena.others:
            ways = self.ways("first", topic, self.heard(topic), joint, self.given_that(spot.rests), self.before)
            if not all(self.into(way, self.answered_at(way.joint)) for way in ways):
                yield f"no answer to a message on {topic}"
        if not all(self.time_is_answered(spot, way) for way in self.in_time(joint, spot)):
            yield "no answer to the passage of time"
        for number, letters in spot.answers.items():
            if not all(self.into(way, self.rest_at(way.joint)) for way in self.sent(number, joint, letters)):
                yield f"it may not rest after {self.arena.fallbacks[number].name}"
        for (passing, number), letters in spot.acts.items():
            both = self.region.diagrams.conjunction(spot.rests, letters)
            if not all(self.act_leads(passing, way) for way in self.sent(number, joint, both)):
                yield f"it may not rest after {self.arena.fallbacks[number].name} ahead"

    def in_time(self, joint: Joint, spot: Spot) -> Iterator[Way]:
        """Every way in which time may go on."""
        return self.ways("first", None, self.heard(None), joint, self.given_that(spot.rests), self.before)

    def sent(self, number: int, joint: Joint, letters: Diagram) -> Iterator[Way]:
        """Every way from `letters` after a fallback. Coq: `sent`."""
        fallback = self.arena.fallbacks[number]
        read, loose = self.arena.read, self.arena.loose
        effect = {a: None if a in loose else fallback.effect[a] if fallback.out in read[a] else a for a in read}
        return self.ways("first", fallback.out, effect, joint, self.given_that(letters), self.before)

    def time_is_answered(self, spot: Spot, way: Way) -> bool:
        """Coq: `time_is_answered`."""
        good = self.of_letter(way.now, self.answered_at(way.joint))
        for (passing, _), letters in spot.acts.items():
            if passing and passing == way.passing:
                good = self.diagrams.disjunction(good, self.of_letter(self.before, letters))
        return self.entails(way.context, good)

    def act_leads(self, passing: Ticks, way: Way) -> bool:
        """Coq: `act_leads`."""
        later = self.ways("second", None, self.heard(None), way.joint, way.context, way.now)
        return self.into(way, self.rest_at(way.joint)) and all(
            self.into(then, self.answered_at(then.joint)) for then in later if passing & way.alone & then.passing
        )

    def rest_at(self, joint: Joint) -> Diagram:
        """Where the guards may rest."""
        return self.region.spots[joint].rests if joint in self.region.spots else self.region.diagrams.false

    def answered_at(self, joint: Joint) -> Diagram:
        """Where they may rest, or have an answer."""
        found = self.rest_at(joint)
        for letters in self.region.spots[joint].answers.values() if joint in self.region.spots else ():
            found = self.region.diagrams.disjunction(found, letters)
        return found

    def heard(self, topic: str | None) -> Effect:
        """What becomes of the conditions at a message with any content, or as time goes on. Coq: `heard`, `hold`."""
        read, loose = self.arena.read, self.arena.loose
        return {atom: None if atom in loose or topic in read[atom] else atom for atom in read}

    def given_that(self, letters: Diagram) -> Diagram:
        """What was held is one of `letters`, and is possible."""
        assumed = self.of_letter(self.before, self.region.assumption)
        return self.diagrams.conjunction(self.of_letter(self.before, letters), assumed)

    def of_letter(self, now: Letter, read: Diagram | None) -> Diagram:
        """What a predicate of the region says of a letter."""
        assert read is not None
        names, region = tuple(self.arena.read), self.region.diagrams
        known: dict[Diagram, Diagram] = {}

        def visit(node: Diagram) -> Diagram:
            if node not in known:
                if region.is_terminal(node):
                    known[node] = self.diagrams.true if region.value(node) else self.diagrams.false
                else:
                    level, low, high = region.split(node)
                    known[node] = self.diagrams.choose(now[names[level]], visit(high), visit(low))
            return known[node]

        return visit(read)

    def entails(self, context: Diagram, good: Diagram) -> bool:
        """Whether all letters of `context` are `good`."""
        return self.diagrams.conjunction(context, self.diagrams.negation(good)) == self.diagrams.false

    def into(self, way: Way, goal: Diagram) -> bool:
        """Whether a way leads to letters of `goal`."""
        return self.entails(way.context, self.of_letter(way.now, goal))

    def ways(
        self, step: str, topic: str | None, effect: Effect, joint: Joint, context: Diagram, before: Letter
    ) -> Iterator[Way]:
        """Every way from a place by a message, or in time, after which the conditions are as `effect` says."""
        now = dict[str, Diagram]()
        for atom, value in effect.items():
            match value:
                case None:
                    now[atom] = self.variable(step, atom)
                case bool(holds):
                    now[atom] = self.diagrams.true if holds else self.diagrams.false
                case name:
                    now[atom] = before[name]
        context = self.diagrams.conjunction(context, self.of_letter(now, self.region.assumption))
        sent_after = [joint.sent] if topic is None else self.arena.sent_after(joint.sent, topic)
        for sent in sent_after:
            start = Way(context, now, Joint(sent, ()), frozenset(), frozenset())
            if context != self.diagrams.false:
                yield from self.parts_ways(step, topic, joint, start)

    def parts_ways(self, step: str, topic: str | None, joint: Joint, way: Way) -> Iterator[Way]:
        """All properties, one after the other; those that are relied on are not violated by the world."""
        number = len(way.joint.standings)
        if number == len(self.arena.parts):
            yield way
            return
        part = self.arena.parts[number]
        for context, at, passing, alone in _One(self, step, topic, number, way.now).ways(joint, way):
            if topic in self.arena.outs or not part.is_assumed or at is not Outcome.VIOLATED:
                to = Joint(way.joint.sent, (*way.joint.standings, at))
                after = Way(context, way.now, to, way.passing | passing, way.alone | alone)
                yield from self.parts_ways(step, topic, joint, after)


Own = tuple[Diagram, Standing, Ticks, Ticks]
"""The way of one property, as `Way`."""


class _One:
    """How one step leads one property on."""

    def __init__(self, checker: _Checker, step: str, topic: str | None, number: int, now: Letter) -> None:
        self.checker, self.diagrams = checker, checker.diagrams
        self.step, self.topic, self.number, self.now = step, topic, number, now
        self.part: Part = checker.arena.parts[number]
        self.timed = {atom for tracker in self.part.time.trackers for atom in tracker.atoms}

    def ways(self, joint: Joint, way: Way) -> Iterator[Own]:
        """Coq: `part_ways`."""
        at = joint.standings[self.number]
        match at:
            case Outcome.WAITING:
                for begins in self.beginnings(joint.sent, way.joint.sent):
                    if begins:
                        yield from self.moved(Place(0, self.part.time.initial), way.context)
                    else:
                        yield way.context, at, frozenset(), frozenset()
            case Place() if self.topic is None or self.topic in self.part.topics:
                yield from self.moved(at, way.context)
            case Place():
                yield way.context, at, frozenset(), self.numbered(range(len(self.part.time.trackers)))
            case _:
                yield way.context, at, frozenset(), frozenset()

    def beginnings(self, before: Sent, sent: Sent) -> tuple[bool, ...]:
        if self.topic is None:
            return (False,)
        return self.checker.arena.beginnings(self.part, before, sent, self.topic)

    def numbered(self, trackers: Iterator[int] | range | set[int]) -> Ticks:
        return frozenset((self.number, tracker) for tracker in trackers)

    def atom(self, name: str) -> Diagram:
        """Coq: `part_atom`."""
        if name in self.part.news:
            return self.diagrams.true if self.part.news[name] == self.topic else self.diagrams.false
        if name in self.now and name not in self.timed:
            return self.now[name]
        return self.checker.variable(self.step, self.number, name)

    def narrowed(self, context: Diagram, predicate: Formula) -> Diagram | None:
        """The letters of `context` that satisfy `predicate`; None if there are none."""
        found = self.diagrams.conjunction(context, decision_diagrams.of_diagrams(predicate, self.diagrams, self.atom))
        return None if found == self.diagrams.false else found

    def moved(self, place: Place, context: Diagram) -> Iterator[Own]:
        """Coq: `moved_ways`."""
        time, monitor = self.part.time, self.part.monitor
        assert isinstance(place.clocks, Clocks)
        for move in time.moves(place.clocks, context, self.narrowed):
            passing = time.passing(place.clocks, move.cases)
            if self.may_come(move, passing):
                alone = (n for n, case in enumerate(move.cases) if self.is_left_alone(n, case))
                ticks = self.numbered(passing), self.numbered(alone)
                for state, letters in self.states(monitor.edges[place.state], move.letters):
                    yield letters, standing(self.part, state, move.target), *ticks

    def may_come(self, move: Move[Diagram], passing: set[int]) -> bool:
        """A message takes no time, so no clock passes; as time goes on, the letter is one that can be held."""
        if self.topic is not None:
            return not passing
        return self.part.time.is_trivial or self.part.time.sets - 1 in move.fair

    def is_left_alone(self, tracker: int, case: Case) -> bool:
        return not case.starts or self.part.time.trackers[tracker].bounds[:1] == (0,)

    def states(self, target: int, letters: Diagram) -> Iterator[tuple[int, Diagram]]:
        """Coq: `monitor_ways`."""
        if letters == self.diagrams.false:
            return
        if target >= 0:
            yield target, letters
            return
        atom, low, high = self.part.monitor.decisions[~target]
        asked = self.atom(self.part.monitor.atoms[atom])
        yield from self.states(high, self.diagrams.conjunction(letters, asked))
        yield from self.states(low, self.diagrams.conjunction(letters, self.diagrams.negation(asked)))
