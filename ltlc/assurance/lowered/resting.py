"""Where guards may rest by their program, against their region: every joint place, every way of being there.

A joint place is reached in those states of machines that the comparison of these with their monitors has found. There,
the program must ask the conditions what the region does, whatever is not known of them, and it must not rest anywhere
else. Conditions are compared with what `lowered.meaning` says. Nothing is used of what lowered the region.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, product

from ltlc.assurance.lowered.meaning import compared, said, truth
from ltlc.assurance.lowered.truths import Truths
from ltlc.assurance.reading.outcomes import Difference
from ltlc.program.resting import Held, Placed, Resting
from ltlc.runtime.guard_plans import YES, Asked, Asks
from ltlc.semantics.arenas import Arena, Joint, Outcome, Place, Region, Standing
from ltlc.semantics.diagrams import Diagram, Diagrams, of_diagrams, rows
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import operands, reads


def difference_from(
    arena: Arena, region: Region, conditions: Mapping[str, Atom], parts: Sequence[Placed], found: Resting
) -> Difference | None:
    """What `found` says otherwise than the `region` of an arena with these `parts` and `conditions`; None: nothing."""
    for name, held in zip(found.names, found.conditions, strict=True):
        if name not in conditions or not _is_meant(held, conditions[name]):
            return Difference(f"`{name}` is not the condition that is held")
    return _Comparison(arena, parts, found).difference(region)


def _is_meant(held: Held, atom: Atom) -> bool:
    """Whether a condition is known and holds where that of an atom does, and reads the same."""
    truths, condition = Truths(Diagrams()), atom.condition
    undefined = truths.some(map(truths.is_nan, compared(condition)))
    known, d = truths.holds(held.known), truths.diagrams
    found, right = (d.conjunction(known, truths.holds(each)) for each in (held.holds, truth(condition)))
    reads_ = {said(each) for operand in operands(condition) for each in reads(operand)}
    return known == d.negation(undefined) and found == right and set(map(said, held.inputs)) == reads_


class _Comparison:
    """One diagram for all questions; atoms are those of the arena."""

    def __init__(self, arena: Arena, parts: Sequence[Placed], found: Resting) -> None:
        self.arena, self.parts = arena, parts
        self.diagrams = Diagrams()
        self.levels: dict[object, int] = {}
        self.numbers = {name: number for number, name in enumerate(found.names)}
        row = rows(self.diagrams, found.decisions, lambda asked: self.asked(found.questions[asked]), YES.__eq__)
        self.said = row(found.root)

    def asked(self, what: object) -> Diagram:
        """True where that is so: a question, or an atom."""
        return self.diagrams.variable(self.levels.setdefault(what, len(self.levels)))

    def difference(self, region: Region) -> Difference | None:
        """What differs."""
        d, anywhere = self.diagrams, self.diagrams.false
        for joint, formula in region.rests.items():
            if self.arena.outcome(joint) is not None:
                continue
            lost, exists = self._known(d.negation(of_diagrams(formula, d, self.asked))), self._known(d.true)
            for answers in self._ways(joint):
                cube = self._all(self.asked(q) if holds else d.negation(self.asked(q)) for q, holds in answers.items())
                anywhere = d.disjunction(anywhere, cube)
                given = d.given({self.levels[question]: holds for question, holds in answers.items()}, self.said)
                if d.conjunction(exists, given) != d.conjunction(exists, d.negation(lost)):
                    return Difference(f"it does not rest as the region has it: {_shown(answers)}")
        if d.conjunction(self._all(self._exclusive()), d.conjunction(self.said, d.negation(anywhere))) != d.false:
            return Difference("it rests where the region has no place")
        return None

    def _known(self, letters: Diagram) -> Diagram:
        """Where one of `letters` that exist agrees with what is known of the conditions."""
        d = self.diagrams
        found = d.conjunction(letters, of_diagrams(self.arena.alphabet.as_formula(), d, self.asked))
        for name in self.arena.read:
            atom = self.asked(name)
            if name in self.numbers and name not in self.arena.loose:
                known, holds = (self.asked(Asked(asks, self.numbers[name])) for asks in (Asks.KNOWN, Asks.HOLDS))
                agrees = d.disjunction(d.negation(known), d.choose(atom, holds, d.negation(holds)))
                found = d.conjunction(found, agrees)
            sides = (d.given({self.levels[name]: answer}, found) for answer in (False, True))
            found = d.disjunction(*sides)
        return found

    def _ways(self, joint: Joint) -> Iterator[dict[Asked, bool]]:
        """The answers to all questions but those about conditions, with which a joint place is reached."""
        sent = {Asked(Asks.SILENT): joint.sent is None}
        for out, most in enumerate(self.arena.most):
            left = 0 if joint.sent is None else joint.sent[out]
            sent |= {Asked(Asks.SENT, out, n): n == left for n in range(1, most + 1)}
        for ways in product(*(self._states(k, at) for k, at in enumerate(joint.standings))):
            found = dict(sent)
            for k, (part, way) in enumerate(zip(self.parts, ways, strict=True)):
                found[Asked(Asks.WAITS, k)] = way is None
                found |= {Asked(Asks.STANDS, k, state): state == way for state in range(len(part.machine.states))}
            yield found

    def _states(self, k: int, at: Standing) -> Sequence[int | None]:
        """The states of a machine at a place, or None where it has not begun."""
        part = self.parts[k]
        if at is Outcome.WAITING:
            return [None]
        if isinstance(at, Place):
            near = {(state, place) for state, places in part.places.items() for place in places}
            return sorted(
                {q for q, place in near if (place.state, place.clocks.states) == (at.state, at.clocks.states)}
            )
        return [q for q, state in enumerate(part.machine.states) if state.verdict.value == at.value]

    def _exclusive(self) -> Iterator[Diagram]:
        """What is always so of the questions: they have one answer."""
        d = self.diagrams
        for out, most in enumerate(self.arena.most):
            counts = (Asked(Asks.SENT, out, n) for n in range(1, most + 1))
            yield from self._at_most_one([Asked(Asks.SILENT), *counts])
        for k, part in enumerate(self.parts):
            states = [Asked(Asks.WAITS, k), *(Asked(Asks.STANDS, k, q) for q in range(len(part.machine.states)))]
            yield from self._at_most_one(states)
            yield d.negation(self._all(d.negation(self.asked(each)) for each in states))

    def _at_most_one(self, questions: Sequence[Asked]) -> Iterator[Diagram]:
        d = self.diagrams
        for one, other in combinations(map(self.asked, questions), 2):
            yield d.negation(d.conjunction(one, other))

    def _all(self, parts: Iterator[Diagram]) -> Diagram:
        found = self.diagrams.true
        for part in parts:
            found = self.diagrams.conjunction(found, part)
        return found


def _shown(answers: Mapping[Asked, bool]) -> str:
    """The answers that are yes."""
    said = (f"{each.asks.value} {each.of}.{each.number}" for each, holds in answers.items() if holds)
    return ", ".join(said) or "nothing has left"
