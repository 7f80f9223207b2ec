"""The bounds on time in a property: where they stand, and what the property would be without one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ltlc.analysis.wording import all_parts, with_part
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import Now, Property, Throughout, Within
from ltlc.semantics.timed_atoms import Age, Historically, Once, Since
from ltlc.specification import timed
from ltlc.specification.specification import Path


@dataclass(frozen=True, slots=True)
class TimeBound:
    """A bound of `duration` on the part at `path`; `unbounded` is the property without it, None where it needs one."""

    path: Path
    duration: Nanoseconds
    unbounded: Property | None


def time_bounds(property_: Property) -> Iterator[TimeBound]:
    """The bounds of `property_`, those of the past included, in the order of the text."""
    for path, part in sorted(all_parts(property_), key=lambda each: each[0]):
        if isinstance(part, Within):
            yield TimeBound(path, part.duration, _with(property_, path, part.body))
        elif isinstance(part, Formula | Now | Throughout):
            yield from _of_the_past(property_, path, part)


def _of_the_past(property_: Property, path: Path, part: Property | Formula) -> Iterator[TimeBound]:
    atom = part.predicate if isinstance(part, Now | Throughout) else part
    match atom:
        case Once(_, operand, int(bound)):
            free: Formula = timed.once(operand, None)
        case Historically(_, operand, int(bound)):
            free = timed.historically(operand, None)
        case Since(_, kept, start, int(bound)):
            free = timed.since(kept, start, None)
        case Age(_, _, bound):
            yield TimeBound(path, bound, None)
            return
        case _:
            return
    replacement = type(part)(free) if isinstance(part, Now | Throughout) else free
    yield TimeBound(path, bound, _with(property_, path, replacement))


def _with(property_: Property, path: Path, part: Property | Formula) -> Property:
    result = with_part(property_, path, part)
    if not isinstance(result, Property):
        raise TypeError(f"not a property: {result!r}")
    return result
