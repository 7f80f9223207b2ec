"""Simpler assignments that violate the same property: each is simulated before it is taken."""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Iterator
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_DOWN, ROUND_HALF_EVEN, Context, Decimal
from typing import Protocol, TypeVar

from ltlc.falsification.assignment import Assignment, Course, Scalar, merged
from ltlc.falsification.parameters import Choices, Domain, Integers, Parameter, Reals, Space

MOST_DIGITS = 4
"""To fewer digits than these a number is rounded, if it is rounded."""

SHORTER = 0.9
"""A run is cut if that leaves this share of it, or less."""


class Found(Protocol):
    """A simulation that violates a property."""

    @property
    def assignment(self) -> Assignment:
        """What it was given."""
        ...

    @property
    def ended(self) -> float | None:
        """How long after its beginning the property was violated, in s, if that is known."""
        ...


Simulation = TypeVar("Simulation", bound=Found)


def shrink(
    found: Simulation,
    space: Space,
    failing: Callable[[Iterator[Assignment]], Simulation | None],
    tried: Container[str],
) -> Simulation:
    """The last of those that are found to fail, each simpler than the one before, the first being `found`.

    `failing` simulates assignments, and gives the first that violates the property; None if none does, or no more may
    be simulated. Those with keys in `tried` were simulated before, and are left out.
    """
    smaller: Simulation | None = found
    while smaller is not None:
        found = smaller
        smaller = failing(_smaller(found, space, tried))
    return found


def _smaller(found: Found, space: Space, tried: Container[str]) -> Iterator[Assignment]:
    """Assignments that are smaller than that which was `found`, each once, but for those that were `tried`."""
    given = set[str]()
    for candidate in simpler(found.assignment, space, found.ended):
        key = candidate.key
        if key not in tried and key not in given and size(candidate, space) < size(found.assignment, space):
            given.add(key)
            yield candidate


def size(assignment: Assignment, space: Space) -> tuple[float, ...]:
    """What is shrunk, in this order.

    How many parameters are not as by default; how many control points inputs have; how long the run is; how many digits
    numbers have, and how far they are from the default.
    """
    changed, points, digits, distance = 0, 0, 0, 0.0
    for parameter in space.parameters:
        value, default = assignment.values[parameter.name], parameter.domain.default
        course = value if isinstance(value, tuple) else ((0.0, value),)
        changed += any(each != default for _, each in course)
        points += len(course) - 1
        for time, each in course:
            digits += _digits(time) + (_digits(each) if each != default else 0)
            distance += abs(parameter.domain.place(each) - parameter.domain.place(default))
    return changed, points, assignment.seconds or 0.0, digits, distance


def simpler(assignment: Assignment, space: Space, ended: float | None) -> Iterator[Assignment]:
    """Assignments that are simpler in one thing, great steps first; the property was violated when `ended` says."""
    values = assignment.values
    for each in space.parameters:
        default = each.domain.default
        yield _with(assignment, each, ((0.0, default),) if each.points else default)
    for each in space.parameters:
        value = values[each.name]
        if isinstance(value, tuple):
            yield from (_with(assignment, each, course) for course in _shorter(value, each.domain.default))
    if assignment.seconds is not None and ended is not None:
        yield from _cut(assignment, ended)
    for each in space.parameters:
        value = values[each.name]
        if not isinstance(value, tuple):
            yield from (_with(assignment, each, number) for number in _rounder(value, each.domain))
            continue
        for n, (time, number) in enumerate(value):
            for rounder in _rounder(number, each.domain):
                yield _with(assignment, each, (*value[:n], (time, rounder), *value[n + 1 :]))
            for earlier in _rounder_times(value, n, assignment.seconds):
                yield _with(assignment, each, (*value[:n], (earlier, number), *value[n + 1 :]))


def _with(assignment: Assignment, parameter: Parameter, value: Scalar | Course) -> Assignment:
    return replace(assignment, values={**assignment.values, parameter.name: value})


def _shorter(course: Course, default: Scalar) -> Iterator[Course]:
    """Courses with fewer control points, or with the default at some: many at a time first."""
    count = len(course)
    while count := count // 2:
        for start in range(0, len(course), count):
            rest = (*course[:start], *course[start + count :])
            if rest and rest != course:
                yield ((0.0, rest[0][1]), *rest[1:])
            part = tuple((time, default) for time, _ in course[start : start + count])
            yield merged((*course[:start], *part, *course[start + count :]))


def _cut(assignment: Assignment, ended: float) -> Iterator[Assignment]:
    """A shorter run, up to where the property was violated, with a part of what follows, or none."""
    assert assignment.seconds is not None
    for share in (1.0, 1.1, 1.5):
        seconds = float(Context(2, ROUND_CEILING).create_decimal(Decimal(repr(ended * share))))
        if 0 < seconds <= assignment.seconds * SHORTER:
            values = {
                name: tuple(step for step in value if step[0] < seconds) if isinstance(value, tuple) else value
                for name, value in assignment.values.items()
            }
            yield Assignment(values, seconds)


def _rounder(value: Scalar, domain: Domain) -> Iterator[Scalar]:
    """Values with fewer digits, and values nearer to the default."""
    match domain:
        case Choices(words):
            yield from words[: words.index(str(value))]
        case Integers(default=default):
            whole = int(value)
            yield from (default + (whole - default) * k // 4 for k in (1, 2, 3))
            yield whole - (1 if whole > default else -1)
        case Reals(low, high, default):
            number = float(value)
            between = [default + (number - default) * share for share in (0.25, 0.5, 0.75, 0.9)]
            rounded = [each for digits in range(1, MOST_DIGITS) for each in _rounded([number, *between], digits)]
            yield from (each for each in rounded if low <= each <= high)


def _rounded(numbers: list[float], digits: int) -> Iterator[float]:
    for number in numbers:
        for rounding in (ROUND_HALF_EVEN, ROUND_DOWN):
            yield float(Context(digits, rounding).create_decimal(Decimal(repr(number))))


def _rounder_times(course: Course, n: int, seconds: float | None) -> Iterator[float]:
    """Times for the control point n, between those beside it, with fewer digits."""
    if n:
        after = course[n + 1][0] if n + 1 < len(course) else math.inf if seconds is None else seconds
        for digits in range(1, MOST_DIGITS):
            yield from (time for time in _rounded([course[n][0]], digits) if course[n - 1][0] < time < after)


def _digits(value: Scalar) -> int:
    """The significant digits of a number; 0 and words have none."""
    if isinstance(value, str) or not value:
        return 0
    return len(Decimal(repr(value)).normalize().as_tuple().digits)
