"""What does not change along a guarded run: the arena, its region, and where samples stand."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from ltlc.dataclass import dataclass
from ltlc.runtime import sampling
from ltlc.runtime.plays import Play
from ltlc.runtime.sampling import Input, Sampler, Value, Wanted, Window
from ltlc.runtime.session import Plan
from ltlc.semantics import finite
from ltlc.semantics.arenas import Arena, Joint, Part, Place, Region
from ltlc.semantics.ltl import FALSE, Formula
from ltlc.semantics.reset_machine import Clocks
from ltlc.semantics.timed_atoms import Clock
from ltlc.semantics.words import Letter, letters_over
from ltlc.specification.arrivals import waited_for
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import is_nan, truth
from ltlc.specification.expressions import Current, New, Opening, Past, Read, Recent, Slope, operands, reads
from ltlc.specification.guards import Guard
from ltlc.specification.specification import PropertySpecification, topics_of

NOTHING: Mapping[Read, Value] = {}


@dataclass(frozen=True)
class Asked:
    """A condition, what it reads, and where the values of that stand; of a value at an opening the current one."""

    atom: Atom
    window: Window
    wanted: tuple[Read, ...]

    @property
    def is_at_opening(self) -> bool:
        """Whether it reads a value at an opening."""
        return any(isinstance(read, Opening) for read in self.wanted)

    def values(self, known: list[Value]) -> dict[Read, Value]:
        """The values of what it reads."""
        pairs = zip(self.wanted, self.window.values(known), strict=True)
        return {read: _before_any(read) if value is None else value for read, value in pairs}

    def answer(self, known: list[Value], kept: Mapping[Read, Value] = NOTHING) -> bool | Nan | None:
        """Whether it holds, with the values that were `kept`; None if one has not come, NAN if it is not a number."""
        values = self.values(known)
        if None in values.values():
            return None
        if kept and any(map(is_nan, values.values())):
            return NAN
        found = truth(self.atom.condition, {**values, **kept} if kept else values)
        return NAN if found is None else found


class Nan:
    """What a condition is that compares what is not a number."""


NAN = Nan()


@dataclass(frozen=True)
class PartPlan:
    """What a part reads: the conditions that are its atoms, what makes a step of it, what it waits for.

    Of the values at openings that it reads, `openings` has the clocks of the scopes, and `at_openings` the conditions.
    """

    part: Part
    atoms: frozenset[str]
    window: Window
    waits: Window
    openings: Mapping[Opening, Clock]
    at_openings: Mapping[str, Asked]

    def begins_with(self, known: list[Value]) -> bool:
        """Whether all that it waits for has a value."""
        return all(value is not None for value in self.waits.values(known))


FindPlay = Callable[[Joint, Letter, frozenset[str], Mapping[Read, Value]], Play | None]
"""The play that guards avoid which do not rest at a joint place, where some atoms hold, some are unknown, and what is
read has these values."""


@dataclass(frozen=True)
class Solved:
    """Guards that share properties: what they were solved on, where they may rest, and their conditions."""

    guards: tuple[Guard, ...]
    arena: Arena
    region: Region
    conditions: Mapping[str, Atom]
    find_play: FindPlay


class Arrangement:
    """What does not change along a run: what was `solved`, and where the samples of a plan stand."""

    def __init__(self, solved: Solved, properties: Mapping[str, PropertySpecification], plan: Plan) -> None:
        """`properties` are the parts of the arena by their labels."""
        self.arena, self.region, self.find_play = solved.arena, solved.region, solved.find_play
        arena, conditions = solved.arena, solved.conditions
        self._clocks: dict[tuple[int, Clocks, Letter], Clocks] = {}
        self._resting: dict[tuple[Joint, Letter, frozenset[str]], bool] = {}
        of_parts = [properties[part.label] for part in arena.parts]
        asked = [_reads_of(atom) for atom in conditions.values()]
        inputs = [wanted_of(read) for read in (*(r for own in asked for r in own), *_all_inputs(of_parts))]
        self.sampler = Sampler(plan.signals, inputs)
        window = self.sampler.window
        self.asked = {
            name: Asked(atom, window(map(wanted_of, own)), own)
            for (name, atom), own in zip(conditions.items(), asked, strict=True)
        }
        self.plans = [self._plan(part, each) for part, each in zip(arena.parts, of_parts, strict=True)]
        self.awaited = window(
            wanted_of(read)
            for each in of_parts
            if waited_for(each)
            for read in waited_for(each)
            if set(topics_of(read.signal)).isdisjoint(arena.outs)
        )
        self.spoken = frozenset[str]().union(*(p.topics for p in arena.parts if p.waits)).difference(arena.outs)

    def _plan(self, part: Part, of: PropertySpecification) -> PartPlan:
        values = frozenset(name for name in part.monitor.atoms if name in self.asked)
        window = self.sampler.window
        return PartPlan(
            part,
            values,
            window(map(wanted_of, of.inputs())),
            window(map(wanted_of, waited_for(of))),
            of.openings(),
            {name: self.asked[name] for name in values if self.asked[name].is_at_opening},
        )

    def clocks_after(self, k: int, at: Place, letter: Letter) -> Clocks:
        """The clocks of part k once `letter` has come where it is `at`."""
        key = (k, at.clocks, letter)
        if key not in self._clocks:
            (move,) = self.arena.parts[k].time.moves(
                at.clocks, letter, lambda held, p: held if finite.holds(p, (held,)) else None
            )
            self._clocks[key] = move.target
        return self._clocks[key]

    def rests(self, joint: Joint, letter: Letter, unknown: frozenset[str]) -> bool:
        """Whether guards may rest at `joint`, where atoms hold as in `letter`, whatever the `unknown` ones are."""
        key = (joint, letter, unknown)
        if key not in self._resting:
            self._resting[key] = self._holds_in_all(self.region.rests.get(joint, FALSE), letter, unknown)
        return self._resting[key]

    def _holds_in_all(self, formula: Formula, letter: Letter, unknown: frozenset[str]) -> bool:
        whole = (letter | some for some in letters_over(sorted(unknown)))
        return all(finite.holds(formula, (each,)) for each in whole if self.arena.alphabet.allows(each))


def _before_any(read: Read) -> Value:
    """What is read before there is a sample, if that is something."""
    constant = read.signal.otherwise
    return constant.value if isinstance(read, Current) and constant is not None else None


def _reads_of(atom: Atom) -> tuple[Read, ...]:
    """What a condition reads, and what it has to be known for that."""
    read = [read for operand in operands(atom.condition) for read in reads(operand)]
    return tuple(dict.fromkeys([*read, *(Current(each.signal) for each in read if isinstance(each, Opening))]))


def _all_inputs(properties: Iterable[PropertySpecification]) -> Iterator[Read]:
    return (read for each in properties for read in each.inputs())


def wanted_of(read: Read) -> Wanted:
    """What the runtime calls what is read; a value at an opening is a current one before."""
    match read:
        case Current(signal) | Opening(signal):
            return Input(signal.name)
        case Past(signal, samples):
            return Input(signal.name, samples)
        case Recent(signal, samples):
            return sampling.Recent(signal.name, samples)
        case Slope(signal):
            return sampling.Slope(signal.name)
        case New(signal):
            return sampling.New(signal.name)
