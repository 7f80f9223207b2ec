"""The bounds on time in a property: where they stand, and what the property would be without one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from ltlc.analysis.wording import all_parts, part_at, with_part
from ltlc.dataclass import dataclass
from ltlc.semantics import ltl
from ltlc.semantics.durations import Nanoseconds, duration_text
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import Always, And, Implies, Now, Property, Throughout, Within
from ltlc.semantics.timed_atoms import Age, Historically, Once, Since
from ltlc.specification import timed
from ltlc.specification.specification import Path


@dataclass(frozen=True, slots=True)
class TimeBound:
    """A bound of `duration` on the part at `path`; `unbounded` is the property without it, None where it needs one."""

    path: Path
    duration: Nanoseconds
    unbounded: Property | None


def with_bound(property_: Property, path: Path, duration: Nanoseconds) -> Property:
    """`property_` with a bound of `duration` in place of the one at `path`."""
    part = part_at(property_, path)
    if isinstance(part, Within):
        return _with(property_, path, Within(duration, part.body))
    atom: Any = part.predicate if isinstance(part, Now | Throughout) else part
    field = {Historically: "lasting", Age: "most"}.get(type(atom), "within")
    other: Any = replace(atom, name=f"{atom.name}, but {duration_text(duration)}", **{field: duration})
    return _with(property_, path, type(part)(other) if isinstance(part, Now | Throughout) else other)


@dataclass(frozen=True, slots=True)
class Interval:
    """What each instant with `trigger`, written at `path`, begins: within `duration`, `body`."""

    path: Path
    trigger: Formula
    duration: Nanoseconds
    body: Property


def intervals(property_: Property) -> Iterator[Interval]:
    """The intervals that triggers begin in `property_`, those of the same trigger one after the other."""
    for path, part in all_parts(property_):
        if isinstance(part, Always):
            yield from _begun(part.operand, (*path, 0), None)


def _begun(node: Property, path: Path, trigger: tuple[Path, Formula] | None) -> Iterator[Interval]:
    match node:
        case And(left, right):
            yield from _begun(left, (*path, 0), trigger)
            yield from _begun(right, (*path, 1), trigger)
        case Implies(Now(premise), body):
            both = ltl.And(trigger[1], premise) if trigger else premise
            yield from _begun(body, (*path, 1), ((*path, 0), both))
        case Within(duration, body) if trigger:
            yield Interval(*trigger, duration, body)


def time_bounds(property_: Property) -> Iterator[TimeBound]:
    """The bounds of `property_` but for intervals, those of the past included, in the order of the text."""
    for path, part in sorted(all_parts(property_), key=lambda each: each[0]):
        if isinstance(part, Within) and not part.start:
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
