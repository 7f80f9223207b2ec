"""The regions of a specification's guards, for its certificates, and their programs, for what is emitted."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.analysis.guards.solution import TooManyPlacesError, solve
from ltlc.assurance.lowered.equality import compare
from ltlc.assurance.lowered.letters import Judged
from ltlc.assurance.lowered.resting import difference_from
from ltlc.assurance.reading.outcomes import Difference
from ltlc.compiler import Compiled
from ltlc.program.guards import GuardProgram, guard_program
from ltlc.program.resting import NotToldError, Placed
from ltlc.semantics.region_text import GuardEntry
from ltlc.specification.arenas import Property, arena_of, conditions_held, is_in_game, together
from ltlc.specification.guards import Guard
from ltlc.specification.specification import Specification


class NoRegionError(Exception):
    """The region of a guard cannot be written, and why."""


def guard_entries(specification: Specification, compiled: Sequence[Compiled]) -> list[GuardEntry]:
    """The regions of all guards; those of `compiled` are numbered in their order. Raises NoRegionError."""
    sets = together(specification.guards, specification.properties)
    return [_entry(guards, specification, compiled) for guards in sets]


def guard_programs(
    specification: Specification, compiled: Sequence[Compiled], entries: Sequence[GuardEntry]
) -> list[GuardProgram]:
    """The programs of all guards, whose regions are in `entries`. Raises NoRegionError."""
    sets = together(specification.guards, specification.properties)
    return [_program(*each, compiled) for each in zip(sets, entries, strict=True)]


def _program(guards: tuple[Guard, ...], entry: GuardEntry, compiled: Sequence[Compiled]) -> GuardProgram:
    parts = {number: (compiled[number].specification, _placed(compiled[number])) for number in entry.properties}
    try:
        return guard_program(guards, entry.lead, entry.arena, entry.region, parts)
    except NotToldError as error:
        raise NoRegionError(f"the guard of {guards[0].out} cannot be run: {error}") from None


def _placed(compiled: Compiled) -> Placed:
    found = compare(compiled.machine, Judged(compiled.specification, compiled.formula, compiled.monitor))
    if isinstance(found, Difference):
        raise NoRegionError(f"the lowered machine of `{compiled.specification.label}` does not match its monitor")
    return Placed(compiled.machine, found.places)


def difference(program: GuardProgram, entry: GuardEntry, compiled: Sequence[Compiled]) -> Difference | None:
    """What a program says otherwise than the region in `entry`; None: nothing."""
    properties = [compiled[number] for number in entry.properties]
    conditions = conditions_held(program.guards, [each.specification for each in properties])
    return difference_from(entry.arena, entry.region, conditions, list(map(_placed, properties)), program.resting)


def _entry(guards: tuple[Guard, ...], specification: Specification, compiled: Sequence[Compiled]) -> GuardEntry:
    arena = arena_of(guards, [Property(each.specification, each.formula, each.monitor) for each in compiled])
    try:
        region = solve(arena).region()
    except TooManyPlacesError as error:
        raise NoRegionError(f"the guard of {guards[0].out} {error}") from None
    numbers = (number for number, each in enumerate(compiled) if is_in_game(each.specification, guards))
    lines = tuple((specification.source.position(guard.span.start).line, guard.raw, guard.out) for guard in guards)
    return GuardEntry(lines, specification.lead, arena, region, tuple(numbers))
