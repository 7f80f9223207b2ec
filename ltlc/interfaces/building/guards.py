"""The regions of a specification's guards, for its certificates."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.analysis.guards.solution import TooManyPlacesError, solve
from ltlc.compiler import Compiled
from ltlc.semantics.region_text import GuardEntry, is_ordered
from ltlc.specification.arenas import Property, arena_of, is_in_game, together
from ltlc.specification.guards import Guard
from ltlc.specification.specification import Specification


class NoRegionError(Exception):
    """The region of a guard cannot be written, and why."""


def guard_entries(specification: Specification, compiled: Sequence[Compiled]) -> list[GuardEntry]:
    """The regions of all guards; those of `compiled` are numbered in their order. Raises NoRegionError."""
    sets = together(specification.guards, specification.properties)
    return [_entry(guards, specification, compiled) for guards in sets]


def _entry(guards: tuple[Guard, ...], specification: Specification, compiled: Sequence[Compiled]) -> GuardEntry:
    arena = arena_of(guards, [Property(each.specification, each.formula, each.monitor) for each in compiled])
    name = guards[0].out
    try:
        region = solve(arena).region()
    except TooManyPlacesError as error:
        raise NoRegionError(f"the guard of {name} {error}") from None
    if is_ordered(region):
        raise NoRegionError(
            f"what the guard of {name} lets through rests on the order in which clocks of a property pass their "
            "bounds, of which certificates do not speak"
        )
    numbers = (number for number, each in enumerate(compiled) if is_in_game(each.specification, guards))
    lines = tuple((specification.source.position(guard.span.start).line, guard.raw, guard.out) for guard in guards)
    return GuardEntry(lines, specification.lead, arena, region, tuple(numbers))
