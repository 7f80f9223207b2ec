"""The moves of an arena, as diagrams over the letters that are held after them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import reduce
from typing import NamedTuple

from ltlc.automata.machine import valuations
from ltlc.semantics.arenas import Arena, Joint, Outcome, Part, Place, Sending, Sent, Standing, Ticks, standing
from ltlc.semantics.diagrams import Diagram, Diagrams, of_predicate, rows
from ltlc.semantics.ltl import Formula
from ltlc.semantics.reset_machine import Clocks, starts
from ltlc.semantics.trackers import Case, State, Tracker

NO_TICKS: Ticks = frozenset()


class Step(NamedTuple):
    """To a joint place; the clocks that pass a bound on the way, and those that stop or start anew."""

    joint: Joint
    passing: Ticks = NO_TICKS
    fresh: Ticks = NO_TICKS


Steps = Mapping[Step, Diagram]
"""Where a message, or time, may lead, and by which letters after it: more than one step may go by the same letter."""

Good = Callable[[Step], Diagram]
"""By which letters it is good to have taken a step."""


class _Own(NamedTuple):
    """As `Step`, of one part."""

    standing: Standing
    passing: Ticks = NO_TICKS
    fresh: Ticks = NO_TICKS


class Game:
    """The moves between the joint places of `arena`; clocks pass their bounds in any order.

    Levels of diagrams are first the atoms that are held, then the news and the timed atoms, which a move decides.
    """

    def __init__(self, arena: Arena) -> None:
        self.arena = arena
        self.diagrams = Diagrams()
        decided = (a for p in arena.parts for a in (*p.news, *(a for t in p.time.trackers for a in t.atoms)))
        self.atoms = tuple(arena.read)
        names = dict.fromkeys((*self.atoms, *decided))
        self._levels = {name: level for level, name in enumerate(names)}
        groups = (valuations(self.diagrams, self.atoms, group) for group in arena.alphabet.groups)
        self.possible = self.all_of(groups)
        self._rows = [self._rows_of(part) for part in arena.parts]
        self._moves: dict[tuple[int, Clocks], list[_Move]] = {}
        self._own: dict[tuple[int, Place, str | None], dict[_Own, Diagram]] = {}
        self._steps: dict[tuple[Joint, str | None], Steps] = {}

    def _rows_of(self, part: Part) -> Callable[[int], Diagram]:
        atoms = part.monitor.atoms
        return rows(self.diagrams, part.monitor.decisions, lambda asked: self.atom(atoms[asked]))

    def atom(self, name: str) -> Diagram:
        """The letters in which the atom of that name holds."""
        return self.diagrams.variable(self._levels[name])

    def all_of(self, parts: Iterable[Diagram]) -> Diagram:
        """Where all of `parts` are true."""
        return reduce(self.diagrams.conjunction, parts, self.diagrams.true)

    def any_of(self, parts: Iterable[Diagram]) -> Diagram:
        """Where one of `parts` is true."""
        return reduce(self.diagrams.disjunction, parts, self.diagrams.false)

    def exists(self, diagram: Diagram) -> bool:
        """Whether `diagram` is true of some letter that exists."""
        return self.diagrams.conjunction(self.possible, diagram) != self.diagrams.false

    def steps(self, joint: Joint, topic: str | None) -> Steps:
        """Where a message on `topic` leads from `joint`, or time, if there is none, with the letter held."""
        if (joint, topic) not in self._steps:
            self._steps[joint, topic] = self._joint_steps(joint, topic)
        return self._steps[joint, topic]

    def _joint_steps(self, joint: Joint, topic: str | None) -> Steps:
        found: dict[Step, Diagram] = {}
        for sent in [joint.sent] if topic is None else self.arena.sent_after(joint.sent, topic):
            some = {Step(Joint(sent, ())): self.diagrams.true}
            for k, at in enumerate(joint.standings):
                some = self._side_by_side(some, self._of_part(k, at, topic, joint.sent, sent))
            found |= some
        return found

    def _side_by_side(self, some: Steps, own: Mapping[_Own, Diagram]) -> dict[Step, Diagram]:
        found: dict[Step, Diagram] = {}
        for (joint, passing, fresh), letters in some.items():
            for (at, passes, starts_), others in own.items():
                both = self.diagrams.conjunction(letters, others)
                if both != self.diagrams.false:
                    to = Joint(joint.sent, (*joint.standings, at))
                    step = Step(to, passing | passes, fresh | starts_)
                    found[step] = self.diagrams.disjunction(found.get(step, self.diagrams.false), both)
        return found

    def _of_part(self, k: int, at: Standing, topic: str | None, before: Sent, sent: Sent) -> Mapping[_Own, Diagram]:
        """What a message on `topic`, or time, does to part k; so much is `sent` before and after it."""
        part, stays = self.arena.parts[k], {_Own(at): self.diagrams.true}
        if at is Outcome.WAITING and topic is not None:
            first = Place(0, part.time.initial)
            ways = self.arena.beginnings(part, before, sent, topic)
            return (self._moved(k, first, topic) if True in ways else {}) | (stays if False in ways else {})
        if isinstance(at, Outcome) or topic not in (None, *part.topics):
            return stays
        return self._moved(k, at, topic)

    def _moved(self, k: int, place: Place, topic: str | None) -> dict[_Own, Diagram]:
        key = (k, place, topic)
        if key in self._own:
            return self._own[key]
        part, found = self.arena.parts[k], dict[_Own, Diagram]()
        news = {self._levels[name]: of == topic for name, of in part.news.items()}
        for move in self._moves_from(k, place):
            if not move.lasts if topic is None else move.passing:
                continue
            answers = news | move.decided
            letters = self.diagrams.given(answers, move.letters)
            if letters == self.diagrams.false:
                continue
            row = self.diagrams.given(answers, self._rows[k](part.monitor.edges[place.state]))
            for state in self.diagrams.values(row):
                here = self.diagrams.combine(lambda holds, to, state=state: holds and to == state, letters, row)
                if here != self.diagrams.false:
                    forgets = place.clocks.is_first or (topic is not None and topic not in self.arena.outs)
                    own = _own_step(part, state, move, forgets=forgets)
                    found[own] = self.diagrams.disjunction(found.get(own, self.diagrams.false), here)
        self._own[key] = found
        return found

    def _moves_from(self, k: int, place: Place) -> list[_Move]:
        """What the clocks of part k may do after `place`, whatever comes."""
        if (k, place.clocks) in self._moves:
            return self._moves[k, place.clocks]
        part, found = self.arena.parts[k], []
        for move in part.time.moves(place.clocks, self.diagrams.true, self._narrowed):
            holding = {atom for case in move.cases for atom in case.holding}
            decided = {self._levels[a]: a in holding for tracker in part.time.trackers for a in tracker.atoms}
            changed = zip(part.time.trackers, place.clocks.states, move.cases, strict=True)
            fresh = (n for n, (t, s, case) in enumerate(changed) if _is_fresh(t, s, case))
            passing = part.time.passing(place.clocks, move.cases)
            ticks = (frozenset((k, n) for n in some) for some in (passing, fresh))
            lasts = part.time.is_trivial or part.time.sets - 1 in move.fair
            found.append(_Move(move.letters, move.target, decided, lasts, *ticks))
        self._moves[k, place.clocks] = found
        return found

    def _narrowed(self, letters: Diagram, predicate: Formula) -> Diagram | None:
        found = self.diagrams.conjunction(letters, of_predicate(predicate, self.diagrams, self._levels))
        return None if found == self.diagrams.false else found

    def lead_to(self, steps: Steps, good: Good) -> Diagram:
        """The letters by which all of `steps` that are possible are good."""
        d = self.diagrams
        return self.all_of(d.choose(letters, good(step), d.true) for step, letters in steps.items())

    def before_message(self, topic: str | None, good: Diagram) -> Diagram:
        """The letters after which every letter that a message on `topic` can bring, or time, is `good`."""
        changed = self.arena.loose if topic is None else {a for a, of in self.arena.read.items() if topic in of}
        return self._before({a: None if a in changed | self.arena.loose else a for a in self.atoms}, good)

    def after_message(self, topic: str | None, letters: Diagram) -> Diagram:
        """What may be held after a message on `topic`, or after some time, if `letters` were before."""
        for level, atom in enumerate(self.atoms):
            if topic in self.arena.read[atom] or atom in self.arena.loose:
                letters = self.any_of(self.diagrams.given({level: holds}, letters) for holds in (False, True))
        return letters

    def before_fallback(self, fallback: Sending, good: Diagram) -> Diagram:
        """The letters after which sending `fallback` is `good`, whatever the atoms are of which that is not known."""
        return self._before(fallback.effect, good)

    def _before(self, effect: Mapping[str, bool | str | None], good: Diagram) -> Diagram:
        d, known = self.diagrams, dict[Diagram, Diagram]()

        def visit(node: Diagram) -> Diagram:
            if d.is_terminal(node):
                return node
            if node not in known:
                level, low, high = d.split(node)
                match effect[self.atoms[level]]:
                    case None:
                        known[node] = d.conjunction(visit(low), visit(high))
                    case bool(holds):
                        known[node] = visit(high if holds else low)
                    case name:
                        known[node] = d.choose(self.atom(name), visit(high), visit(low))
            return known[node]

        return visit(d.choose(self.possible, good, d.true))


class _Move(NamedTuple):
    """As `Move` of the reset machine: `decided` says of the levels of timed atoms whether they hold.

    Where it `lasts`, its letters can be held.
    """

    letters: Diagram
    target: Clocks
    decided: dict[int, bool]
    lasts: bool
    passing: Ticks
    fresh: Ticks


def _is_fresh(tracker: Tracker, before: State, case: Case) -> bool:
    """Whether its clock stops, or starts anew; not if it passes its bound at once: there would be no end of that."""
    if not tracker.is_running(case.state):
        return True
    return starts(before, case) and tracker.bounds[0] > 0


def _own_step(part: Part, state: int, move: _Move, *, forgets: bool) -> _Own:
    """Where a property begins, and after a message of the world, it does not matter which clocks run anew."""
    at = standing(part, state, move.target)
    if isinstance(at, Outcome):
        return _Own(at, move.passing)
    return _Own(at, move.passing, NO_TICKS if forgets else move.fresh)
