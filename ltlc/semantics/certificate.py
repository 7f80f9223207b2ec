"""Certificates for monitors and their checker: a verdict rests on this page, not on the compiler.

Coq: `proofs/Certificate.v`, with the same names, and the proof that an accepted certificate may be believed:
`certified` and `certified_exactly` in `proofs/Infinite.v`. This is the same algorithm in Python.
"""

from __future__ import annotations

from dataclasses import dataclass

from ltlc.semantics.conditions import FALSE_CONDITION, Bound, Condition, Conditions, Memory
from ltlc.semantics.lasso import truth_at_positions
from ltlc.semantics.ltl import And, Formula, Not, Or, Truth, Until
from ltlc.semantics.monitor import Monitor, Target
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso

DEPTH = 200
"""How many case distinctions may be nested: no certificate can make the checker recurse deeper."""

WORK = 64_000_000
"""How much work may be spent on one certificate: the sum of the sizes of the conditions that cases are made of.

It suffices for patrolling of 7 places (`always eventually` of each; 17 million, 7 times as much for each further one),
16 sightings in order (`eventually a and eventually b and …`; 63 million) and 6 `after_until` inside one another (37
million). Of 400 random properties (nesting to 3, to 12 atoms) the hardest took 0.2 million. All of it lasts 20 s.
"""


@dataclass(frozen=True, slots=True)
class Level:
    """Formulas that no infinite word satisfies. Coq: `level`.

    Without an eventuality, every step leads from them to the levels after it. With one, each of them implies it, but a
    step that satisfies its right side leads to the levels after, any other to those or to the level itself.
    """

    eventuality: Until | None
    members: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Certificate:
    """Why the verdicts of `monitor` are those of `formula` on every run over letters that satisfy `assumption`.

    `annotations[q]`: whatever run leads to state q, what remains to be satisfied after it is one of these; empty where
    the verdict of q is permanent. `levels` say why what remains there cannot be satisfied (or fail).
    `witnesses[q]` are infinite words: for each annotation of q one that satisfies it and one that does not.
    """

    formula: Formula
    assumption: Formula
    monitor: Monitor
    annotations: tuple[tuple[Formula, ...], ...]
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
    if not possible(certificate.assumption, depth) or not checker.is_right():
        return Answer(certified=False, exact=False, met=checker.memory.met)
    return Answer(certified=True, exact=checker.is_exact())


def possible(assumption: Formula, depth: int = DEPTH) -> bool:
    """Whether a letter is found that satisfies `assumption`: if there is none, a certificate speaks of nothing.

    Coq: `possible`.
    """
    conditions = Conditions()
    letter = conditions.atoms_for(depth, conditions.unfold(assumption))
    return conditions.fold(assumption, lambda part, below: truth_at_positions(part, below, Lasso((), (letter,))))[0]


class _Checker:
    def __init__(self, certificate: Certificate, depth: int, work: int) -> None:
        self.certificate = certificate
        self.monitor = certificate.monitor
        self.depth = depth
        self.conditions = Conditions()
        self.memory = Memory(work)
        self.allowed = self.conditions.unfold(certificate.assumption)
        self.dead = self.conditions.later_any(all_members(certificate.levels))

    def is_right(self) -> bool:
        """Coq: `check`."""
        return (
            self.levels_are_dead(self.certificate.levels)
            and self.settles(0, self.conditions.later(self.certificate.formula))
            and all(self.state_is_right(state) for state in range(len(self.monitor.verdicts)))
        )

    def levels_are_dead(self, levels: tuple[Level, ...]) -> bool:
        """No infinite word satisfies a formula of `levels`. Coq: `levels_are_dead`, `levels_are_dead_sound`."""
        below = FALSE_CONDITION
        for position in reversed(range(len(levels))):
            level = levels[position]
            here = self.conditions.later_any(level.members)
            if not all(self.member_is_dead(level, here, below, member) for member in level.members):
                return False
            below = self.conditions.later_any(all_members(levels[position:]))
        return True

    def member_is_dead(self, level: Level, here: Condition, below: Condition, member: Formula) -> bool:
        """Coq: `member_is_dead`, `member_is_dead_sound`."""
        conditions = self.conditions
        now = conditions.conjunction(self.allowed, conditions.unfold(member))
        if level.eventuality is None:
            return self.follows(now, below)
        goal = conditions.unfold(level.eventuality.right)
        return (
            self.follows(conditions.later(member), conditions.later(level.eventuality))
            and self.follows(conditions.conjunction(now, goal), below)
            and self.follows(
                conditions.conjunction(now, conditions.negation(goal)), conditions.disjunction(here, below)
            )
        )

    def follows(self, condition: Condition, conclusion: Condition) -> bool:
        return self.conditions.follows(self.depth, condition, conclusion, self.memory)

    def settles(self, state: int, remaining: Condition) -> bool:
        """Whether it is right to be in `state` when `remaining` has to be satisfied. Coq: `settles`."""
        match self.monitor.verdicts[state]:
            case Verdict.VIOLATED:
                return self.follows(remaining, self.dead)
            case Verdict.SATISFIED:
                return self.follows(self.conditions.negation(remaining), self.dead)
        return any(
            self.conditions.equivalent(self.depth, remaining, self.conditions.later(annotation), self.memory)
            for annotation in self.certificate.annotations[state]
        )

    def covers(self, fuel: int, target: Target, allowed: Condition, remaining: Condition) -> bool:
        """Whether every letter that is `allowed` leads from `target` to a state where it is right to be.

        Coq: `covers`, `covers_sound`.
        """
        if allowed == FALSE_CONDITION:
            return True
        node = self.conditions.node(remaining)
        if not self.memory.descend(fuel) or not self.memory.spend(self.conditions.node(allowed).weight + node.weight):
            return False
        claim = (target, allowed, remaining)
        known = self.memory.known.get(claim)
        if known is not None:
            return known
        if target < 0:
            decision = self.monitor.decisions[~target]
            atom, low, high = self.monitor.atoms[decision.atom], decision.low, decision.high
            answer = self.covers_both(fuel - 1, atom, low, high, allowed, remaining)
        elif node.first_atom is not None:
            answer = self.covers_both(fuel - 1, node.first_atom, target, target, allowed, remaining)
        else:
            answer = self.settles(target, remaining)
        self.memory.known[claim] = answer
        return answer

    def covers_both(
        self, fuel: int, atom: str, low: Target, high: Target, allowed: Condition, remaining: Condition
    ) -> bool:
        """The letters with `atom`, which go on to `high`, and those without, which go on to `low`."""
        fact = self.conditions.fact_of_atom(atom)
        assign = self.conditions.assign
        return self.covers(fuel, high, assign(fact, True, allowed), assign(fact, True, remaining)) and self.covers(
            fuel, low, assign(fact, False, allowed), assign(fact, False, remaining)
        )

    def state_is_right(self, state: int) -> bool:
        """Coq: `state_is_right`, `state_is_right_sound`."""
        verdict, edge = self.monitor.verdicts[state], self.monitor.edges[state]
        if verdict.is_permanent:
            return edge >= 0 and self.monitor.verdicts[edge] is verdict
        return all(
            self.conditions.fold(annotation, _on_empty_word) == verdict.holds
            and self.covers(self.depth, edge, self.allowed, self.conditions.unfold(annotation))
            for annotation in self.certificate.annotations[state]
        )

    def is_exact(self) -> bool:
        """Coq: `exact`."""
        return all(
            all(self.is_allowed(word) for word in words) and all(self.is_open(words, f) for f in formulas)
            for words, formulas in zip(self.certificate.witnesses, self.certificate.annotations, strict=True)
        )

    def is_allowed(self, word: Lasso) -> bool:
        """Every letter of `word` satisfies the assumption. Coq: `is_allowed`."""
        return all(self.truth(self.certificate.assumption, word))

    def is_open(self, words: tuple[Lasso, ...], formula: Formula) -> bool:
        """One of `words` satisfies `formula` and one does not. Coq: `is_open`."""
        return {self.truth(formula, word)[0] for word in words} == {True, False}

    def truth(self, formula: Formula, word: Lasso) -> list[bool]:
        """The truth of `formula` at each position of `word`. Coq: `truth`, `truth_correct`."""
        return self.conditions.fold(formula, lambda part, below: truth_at_positions(part, below, word))


def all_members(levels: tuple[Level, ...]) -> list[Formula]:
    """The formulas of all `levels`. Coq: `all_members`."""
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
    return False
