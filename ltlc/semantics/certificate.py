"""Certificates for monitors and their checker: a verdict rests on this page, not on the compiler.

Coq: `proofs/Certificate.v` and `Moves.v`, with the same names, and the proof that an accepted certificate may be
believed: `certified` and `certified_exactly` in `proofs/InTime.v`. This is the same algorithm in Python.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from typing import NamedTuple

from ltlc.dataclass import dataclass
from ltlc.semantics import finite
from ltlc.semantics.conditions import (
    FALSE_CONDITION,
    TRUE_CONDITION,
    Bound,
    Condition,
    Conditions,
    FormulaNumber,
    Memory,
)
from ltlc.semantics.lasso import truth_at_positions
from ltlc.semantics.ltl import And, Formula, Not, Or, Truth, Until, atoms
from ltlc.semantics.monitor import Monitor, Target
from ltlc.semantics.plays import Plays
from ltlc.semantics.reset_machine import Clocks, Move, ResetMachine
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso, Word

DEPTH = 200
"""How many case distinctions may be nested: no certificate can make the checker recurse deeper."""

WORK = 64_000_000
"""How much work may be spent on one certificate: the sum of the sizes of the conditions that cases are made of.

It suffices for patrolling of 7 places (`always eventually` of each; 17 million, 7 times as much for each further one),
16 sightings in order (`eventually a and eventually b and …`; 63 million) and 6 `after_until` inside one another (37
million). Of 400 random properties (nesting to 3, to 12 atoms) the hardest took 0.2 million. All of it lasts 20 s.
"""


class Place(NamedTuple):
    """What remains to be satisfied by the rest of a run, and where the clocks are; without clocks, always the same."""

    clocks: Clocks
    remains: Formula


Progress = Until | int | None
"""What cannot go on forever without: an eventuality, or a fairness set of the reset machine."""


@dataclass(frozen=True, slots=True)
class Level:
    """Places from which no run in time satisfies what remains. Coq: `level`.

    Without `progress`, every step leads from them to the levels after it. With an eventuality, each of them implies it,
    but a step that satisfies its right side leads to the levels after, any other to those or to the level itself. So do
    the steps in a fairness set, and those that are not.
    """

    progress: Progress
    members: tuple[Place, ...]


@dataclass(frozen=True, slots=True)
class Certificate:
    """Why the verdicts of `monitor` are those of `formula` on every run over letters that satisfy `assumption`.

    `annotations[q]`: whatever run leads to state q, its place after it is one of these; empty where the verdict of q is
    permanent. `levels` say why what remains there cannot be satisfied (or fail). `witnesses[q]` are infinite words: for
    each annotation of q a run in time that satisfies what remains, and one that does not.
    """

    formula: Formula
    assumption: Formula
    monitor: Monitor
    annotations: tuple[tuple[Place, ...], ...]
    levels: tuple[Level, ...]
    witnesses: tuple[tuple[Lasso, ...], ...]


@dataclass(frozen=True, slots=True)
class Answer:
    """What the checker found.

    `certified`: the verdicts are right, theorem `certified`. `exact`: and none that could be permanent is 'presumably',
    theorem `certified_exactly`. Not certified does not mean wrong: the certificate does not show it, or not within the
    bound that was `met`.
    """

    certified: bool
    exact: bool
    met: Bound | None = None


def check(certificate: Certificate, depth: int = DEPTH, work: int = WORK) -> Answer:
    """Whether `certificate` shows that its monitor is right. Coq: `check` and `exact`."""
    checker = _Checker(certificate, depth, work)
    with suppress(_TooMuchWorkError):
        if possible(certificate.assumption, depth) and checker.is_well_defined() and checker.is_right():
            return Answer(certified=True, exact=checker.is_exact())
    return Answer(certified=False, exact=False, met=checker.memory.met)


def possible(assumption: Formula, depth: int = DEPTH) -> bool:
    """Whether a letter is found that satisfies `assumption`: if there is none, a certificate speaks of nothing.

    Coq: `possible`.
    """
    conditions = Conditions()
    letter = conditions.atoms_for(depth, conditions.unfold(assumption))
    return conditions.fold(assumption, lambda part, below: truth_at_positions(part, below, Lasso((), (letter,))))[0]


class _TooMuchWorkError(Exception):
    """There are more ways for time to go on than may be looked at."""


class _Checker:
    def __init__(self, certificate: Certificate, depth: int, work: int) -> None:
        self.certificate = certificate
        self.monitor = certificate.monitor
        self.depth = depth
        self.conditions = Conditions()
        self.memory = Memory(work)
        self.allowed = self.conditions.unfold(certificate.assumption)
        self.time = ResetMachine(certificate.formula)
        self.plays = Plays(self.time, self.spend)
        self.dead = self.somewhere(all_members(certificate.levels))
        self.known_moves: dict[Clocks, tuple[list[Move[Condition]], int]] = {}
        self.known_truth: dict[Lasso, dict[FormulaNumber, list[bool]]] = {}

    def somewhere(self, places: Iterable[Place]) -> dict[Clocks, Condition]:
        """For each state of the clocks, that what remains in one of `places` with it has to be satisfied."""
        remaining: dict[Clocks, list[Formula]] = {}
        for clocks, formula in places:
            remaining.setdefault(clocks, []).append(formula)
        return {clocks: self.conditions.later_any(formulas) for clocks, formulas in remaining.items()}

    def moves(self, clocks: Clocks) -> list[Move[Condition]]:
        """How time can go on by the letters that exist, at the same cost each time. Coq: `each_move`."""
        if clocks not in self.known_moves:
            before = self.memory.budget
            moves = list(self.time.moves(clocks, self.allowed, self.narrowed))
            self.known_moves[clocks] = (moves, before - self.memory.budget)
            return moves
        moves, cost = self.known_moves[clocks]
        self.spend(cost)
        return moves

    def narrowed(self, letters: Condition, predicate: Formula) -> Condition | None:
        """Those of `letters` that satisfy `predicate`. Coq: `narrowed`."""
        found = self.conditions.conjunction(letters, self.conditions.unfold(predicate))
        self.spend(self.conditions.node(found).weight)
        return None if found == FALSE_CONDITION else found

    def spend(self, cost: int) -> None:
        """Take `cost` from what is left of the work that may be done."""
        if not self.memory.spend(cost):
            raise _TooMuchWorkError

    def is_well_defined(self) -> bool:
        """Nothing is assumed of the atoms that time decides. Coq: `well_defined`, with what the reader sees to here."""
        timed = {atom.name for atom in self.time.news}.union(*(tracker.atoms for tracker in self.time.trackers))
        return timed.isdisjoint(atoms(self.certificate.assumption))

    def is_right(self) -> bool:
        """Coq: `check`."""
        return (
            self.levels_are_dead(self.certificate.levels)
            and self.settles(0, self.time.initial, self.conditions.later(self.certificate.formula))
            and all(self.state_is_right(state) for state in range(len(self.monitor.verdicts)))
        )

    def levels_are_dead(self, levels: tuple[Level, ...]) -> bool:
        """No run in time goes on from a place of `levels`. Coq: `levels_are_dead`, `levels_are_dead_shows`."""
        below: dict[Clocks, Condition] = {}
        for position in reversed(range(len(levels))):
            level = levels[position]
            here = self.somewhere(level.members)
            if not all(self.member_is_dead(level, here, below, member) for member in level.members):
                return False
            below = self.somewhere(all_members(levels[position:]))
        return True

    def member_is_dead(
        self, level: Level, here: dict[Clocks, Condition], below: dict[Clocks, Condition], member: Place
    ) -> bool:
        """Coq: `member_is_dead`, `member_is_dead_shows`."""
        conditions = self.conditions
        if not self.must_come(level.progress, member):
            return False
        unfolded = conditions.unfold(member.remains)
        for move in self.moves(member.clocks):
            now = conditions.conjunction(move.letters, unfolded)
            after = below.get(move.target, FALSE_CONDITION)
            same = conditions.disjunction(here.get(move.target, FALSE_CONDITION), after)
            progresses = self.progresses(level.progress, move)
            if not (
                self.follows(conditions.conjunction(now, progresses), after)
                and self.follows(conditions.conjunction(now, conditions.negation(progresses)), same)
            ):
                return False
        return True

    def must_come(self, progress: Progress, member: Place) -> bool:
        """Whether every run from `member` that satisfies what remains has a step that progresses. Coq: `must_come`."""
        match progress:
            case None:
                return True
            case Until():
                return self.follows(self.conditions.later(member.remains), self.conditions.later(progress))
            case _:
                return progress < self.time.sets

    def progresses(self, progress: Progress, move: Move[Condition]) -> Condition:
        """That a step by `move` is one of those that cannot stay away forever. Coq: `coming`."""
        match progress:
            case None:
                return TRUE_CONDITION
            case Until(_, goal):
                return self.conditions.unfold(goal)
            case fair_set:
                return TRUE_CONDITION if fair_set in move.fair else FALSE_CONDITION

    def follows(self, condition: Condition, conclusion: Condition) -> bool:
        return self.conditions.follows(self.depth, condition, conclusion, self.memory)

    def settles(self, state: int, clocks: Clocks, remaining: Condition) -> bool:
        """Whether it is right to be in `state` when `remaining` has to be satisfied. Coq: `settles`."""
        dead = self.dead.get(clocks, FALSE_CONDITION)
        match self.monitor.verdicts[state]:
            case Verdict.VIOLATED:
                return self.follows(remaining, dead)
            case Verdict.SATISFIED:
                return self.follows(self.conditions.negation(remaining), dead)
            case _:
                pass
        return any(
            place.clocks == clocks
            and self.conditions.equivalent(self.depth, remaining, self.conditions.later(place.remains), self.memory)
            for place in self.certificate.annotations[state]
        )

    def covers(self, fuel: int, target: Target, clocks: Clocks, allowed: Condition, remaining: Condition) -> bool:
        """Whether every letter that is `allowed` leads from `target` to a state where it is right to be.

        Coq: `covers`, `covers_shows`.
        """
        if allowed == FALSE_CONDITION:
            return True
        node = self.conditions.node(remaining)
        if not self.memory.descend(fuel) or not self.memory.spend(self.conditions.node(allowed).weight + node.weight):
            return False
        claim = (target, clocks, allowed, remaining)
        known = self.memory.known.get(claim)
        if known is not None:
            return known
        if target < 0:
            decision = self.monitor.decisions[~target]
            atom, low, high = self.monitor.atoms[decision.atom], decision.low, decision.high
            answer = self.covers_both(fuel - 1, atom, low, high, clocks, allowed, remaining)
        elif node.first_atom is not None:
            answer = self.covers_both(fuel - 1, node.first_atom, target, target, clocks, allowed, remaining)
        else:
            first = self.conditions.node(allowed).first_atom
            answer = self.settles(target, clocks, remaining) or (
                first is not None and self.covers_both(fuel - 1, first, target, target, clocks, allowed, remaining)
            )
        self.memory.known[claim] = answer
        return answer

    def covers_both(
        self, fuel: int, atom: str, low: Target, high: Target, clocks: Clocks, allowed: Condition, remaining: Condition
    ) -> bool:
        """The letters with `atom`, which go on to `high`, and those without, which go on to `low`."""
        fact = self.conditions.fact_of_atom(atom)
        assign = self.conditions.assign
        return all(
            self.covers(fuel, target, clocks, assign(fact, value, allowed), assign(fact, value, remaining))
            for target, value in ((high, True), (low, False))
        )

    def state_is_right(self, state: int) -> bool:
        """Coq: `state_is_right`, `state_is_right_shows`."""
        verdict, edge = self.monitor.verdicts[state], self.monitor.edges[state]
        if verdict.is_permanent:
            return edge >= 0 and self.monitor.verdicts[edge] is verdict
        return all(
            self.conditions.fold(place.remains, _on_empty_word) == verdict.holds
            and all(
                self.covers(self.depth, edge, move.target, move.letters, self.conditions.unfold(place.remains))
                for move in self.moves(place.clocks)
            )
            for place in self.certificate.annotations[state]
        )

    def is_exact(self) -> bool:
        """Coq: `exact`."""
        return all(
            all(self.is_allowed(word) for word in words) and all(self.is_open(words, place) for place in places)
            for words, places in zip(self.certificate.witnesses, self.certificate.annotations, strict=True)
        )

    def is_allowed(self, word: Lasso) -> bool:
        """Every letter of `word` satisfies the assumption. Coq: `is_allowed`."""
        return all(self.truth(self.certificate.assumption, word))

    def is_open(self, words: tuple[Lasso, ...], place: Place) -> bool:
        """Of the runs from `place` among `words`, one satisfies what remains and one does not. Coq: `is_open`."""
        sides = [[word for word in words if self.truth(place.remains, word)[0] is holds] for holds in (True, False)]
        return all(self.is_possible(side, place.clocks) for side in sides)

    def is_possible(self, words: list[Lasso], clocks: Clocks) -> bool:
        """Whether some run goes on from `clocks` as one of `words`."""
        if self.time.words_are_runs:
            return any(is_run(self.time, clocks, word) for word in words)
        return self.plays.suffice(words, clocks)

    def truth(self, formula: Formula, word: Lasso) -> list[bool]:
        """The truth of `formula` at each position of `word`. Coq: `truth`, `truth_correct`."""
        known = self.known_truth.setdefault(word, {})
        return self.conditions.fold(formula, lambda part, below: truth_at_positions(part, below, word), known)


def is_run(time: ResetMachine, clocks: Clocks, word: Lasso) -> bool:
    """Whether `word` is a fair word of `time` from `clocks` on, its loop leading back to itself. Coq: `is_run`."""
    start, _ = _after(time, clocks, word.stem)
    end, fair = _after(time, start, word.loop)
    return end is not None and end == start and len(fair) == time.sets


def _after(time: ResetMachine, clocks: Clocks | None, word: Word) -> tuple[Clocks | None, frozenset[int]]:
    """Where the clocks are after `word`, None if that is no run, and the fairness sets that it has steps in."""
    fair: frozenset[int] = frozenset()
    for letter in word:
        one: Word = (letter,)
        move = None if clocks is None else next(time.moves(clocks, one, _among), None)
        if move is None:
            return None, fair
        clocks, fair = move.target, fair | move.fair
    return clocks, fair


def _among(letters: Word, predicate: Formula) -> Word | None:
    """`letters`, which is one letter, if `predicate` holds in it."""
    return letters if finite.holds(predicate, letters) else None


def all_members(levels: tuple[Level, ...]) -> list[Place]:
    """The places of all `levels`. Coq: `all_members`."""
    return [member for level in levels for member in level.members]


def _on_empty_word(formula: Formula, parts: list[bool]) -> bool:
    """`finite.holds(formula, ())`, from the values of its parts."""
    match formula:
        case Truth():
            return True
        case Not():
            return not parts[0]
        case And():
            return parts[0] and parts[1]
        case Or():
            return parts[0] or parts[1]
        case _:
            return False
