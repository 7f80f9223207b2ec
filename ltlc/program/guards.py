"""The lowered program of guards that share properties: what they keep, and where they may rest."""

from __future__ import annotations

from collections.abc import Mapping

from ltlc.dataclass import dataclass
from ltlc.program.resting import Placed, Resting, resting
from ltlc.semantics.arenas import Arena, Region
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.arenas import conditions_held
from ltlc.specification.arrivals import waited_for
from ltlc.specification.expressions import Input
from ltlc.specification.guards import Guard
from ltlc.specification.specification import PropertySpecification, topics_of


@dataclass(frozen=True, slots=True)
class GuardProgram:
    """What runs of `guards`, which share properties and act `lead` before a deadline.

    `kept` and `assumed` are those properties, by their numbers among all; the parts of the arena in their order. They
    are silent until each of the topics `spoken` has, and what is `awaited` has a value; on each topic that they send
    on, messages are counted up to `most`.
    """

    guards: tuple[Guard, ...]
    lead: Nanoseconds
    parts: tuple[int, ...]
    assumed: frozenset[int]
    spoken: tuple[str, ...]
    awaited: tuple[Input, ...]
    most: tuple[int, ...]
    resting: Resting


def guard_program(
    guards: tuple[Guard, ...],
    lead: Nanoseconds,
    arena: Arena,
    region: Region,
    parts: Mapping[int, tuple[PropertySpecification, Placed]],
) -> GuardProgram:
    """The program of `guards` with this `region`; `parts` are the arena's, by their numbers. Raises NotToldError."""
    properties = [of for of, _ in parts.values()]
    awaited = dict.fromkeys(
        wanted for of in properties for wanted in waited_for(of) if set(topics_of(wanted.signal)).isdisjoint(arena.outs)
    )
    waiting = frozenset[str]().union(*(part.topics for part in arena.parts if part.waits))
    placed = [each for _, each in parts.values()]
    return GuardProgram(
        guards,
        lead,
        tuple(parts),
        frozenset(number for number, (of, _) in parts.items() if of.is_assumed),
        tuple(topic for topic in arena.others if topic in waiting),
        tuple(awaited),
        arena.most,
        resting(arena, region, conditions_held(guards, properties), placed),
    )
