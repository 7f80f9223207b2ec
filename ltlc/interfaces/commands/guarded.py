"""`ltlc run --guard`: the guards of a file, solved, to be tried on a recording."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from ltlc.analysis.guards.solution import TooManyPlacesError, solve
from ltlc.compiler import Compiled
from ltlc.interfaces.api.prepare import Prepared
from ltlc.interfaces.commands.common import unusable
from ltlc.interfaces.commands.progress import saying
from ltlc.monitoring.guarding.recording import Guarding, Solved
from ltlc.specification.arenas import Property, arena_of, conditions_held, is_in_game, together
from ltlc.specification.expressions import Field
from ltlc.specification.guards import Guard
from ltlc.specification.specification import PropertySpecification, Specification

WITHOUT = ("evidence", "cut", "results", "summary", "engine")
"""The options that are about a recording as it is, or about many."""


def guarding_of(prepared: Prepared, options: argparse.Namespace) -> Guarding | int:
    """The guards of what was `prepared`, or the exit code."""
    specification = prepared.specification
    if not specification.guards:
        return unusable(f"--guard: {specification.source.name} has no guard")
    if reason := _not_followed(specification):
        return unusable(f"--guard: {reason}")
    try:
        with saying("solving the guards", options.quiet):
            return Guarding(specification, solved(specification, prepared.compiled))
    except TooManyPlacesError as error:
        return unusable(f"--guard: the game of the guards {error}")


def solved(specification: Specification, compiled: Sequence[Compiled]) -> list[Solved]:
    """The guards of `specification`, those together that share properties. Raises TooManyPlacesError."""
    properties = [Property(each.specification, each.formula, each.monitor) for each in compiled]
    found = []
    for guards in together(specification.guards, specification.properties):
        arena = arena_of(guards, properties)
        conditions = conditions_held(guards, specification.properties)
        found.append(Solved(guards, arena, solve(arena).region(), conditions))
    return found


def refused_beside(options: argparse.Namespace) -> str | None:
    """The option that cannot be combined with `--guard`, if one was given."""
    return next((f"--{name}" for name in WITHOUT if getattr(options, name)), None)


def _not_followed(specification: Specification) -> str | None:
    """What keeps the guards from being tried, if something does."""
    for each in specification.properties:
        if is_in_game(each, specification.guards) and each.openings():
            return f"`{each.label}` reads a value at an opening, which is not followed yet"
        for guard in specification.guards:
            if guard.fallbacks and (name := _array_of(guard, each)):
                return f"`{each.label}` reads the array `{name}`, and it is not known what a fallback has there"
    return None


def _array_of(guard: Guard, of: PropertySpecification) -> str | None:
    """An array of what `guard` sends that a property reads."""
    arrays = (signal for signal in of.signals() if signal.type.element is not None)
    sent = (s.name for s in arrays if isinstance(s.definition, Field) and s.definition.topic == guard.out)
    return next(sent, None)
