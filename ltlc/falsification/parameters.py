"""What a search may change of a simulation: parameters, and inputs over time; as text, `speed=0.2..1.5`."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from decimal import Decimal
from itertools import product

from ltlc.dataclass import dataclass
from ltlc.falsification.assignment import Assignment, Course, Scalar, at, merged

RESERVED = ("parameters", "recording", "seconds", "job")
"""What a command gets by these names is something else."""

MOST_POINTS = 1000
"""Control points of an input: more than any search can change one by one."""

RESOLUTION = 1_000_000
"""So many values of a range of numbers are told apart, so that they have few digits."""


@dataclass(frozen=True, slots=True)
class Reals:
    """Decimal numbers from `low` to `high`."""

    low: float
    high: float
    default: float

    def at(self, place: float) -> float:
        """The number at `place`: 0 is the lowest, 1 the highest."""
        digits = math.ceil(math.log10(RESOLUTION / (self.high - self.low)))
        return min(max(round(self.low + place * (self.high - self.low), digits), self.low), self.high)

    def place(self, value: Scalar) -> float:
        """Where `value` is."""
        return (float(value) - self.low) / (self.high - self.low)

    def __len__(self) -> int:
        """How many are told apart."""
        return RESOLUTION


@dataclass(frozen=True, slots=True)
class Integers:
    """Whole numbers from `low` to `high`."""

    low: int
    high: int
    default: int

    def at(self, place: float) -> int:
        """The number at `place`: each has an equal part of what is between 0 and 1."""
        return self.low + min(int(place * len(self)), len(self) - 1)

    def place(self, value: Scalar) -> float:
        """The middle of the part of `value`."""
        return (int(value) - self.low + 0.5) / len(self)

    def __len__(self) -> int:
        return self.high - self.low + 1


@dataclass(frozen=True, slots=True)
class Choices:
    """One of these `words`, of which the first is the default."""

    words: tuple[str, ...]

    @property
    def default(self) -> str:
        """The first word."""
        return self.words[0]

    def at(self, place: float) -> str:
        """The word at `place`: each has an equal part of what is between 0 and 1."""
        return self.words[min(int(place * len(self)), len(self) - 1)]

    def place(self, value: Scalar) -> float:
        """The middle of the part of `value`."""
        return (self.words.index(str(value)) + 0.5) / len(self)

    def __len__(self) -> int:
        return len(self.words)


Domain = Reals | Integers | Choices


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter, with values of `domain`; an input, if it has `points`, at which its value may change."""

    name: str
    domain: Domain
    points: int = 0


@dataclass(frozen=True, slots=True)
class Space:
    """All assignments to `parameters`; the simulation is asked to run for `seconds`, if that is not None.

    A point of it has a coordinate from 0 to 1 for each parameter, and for each control point of an input.
    """

    parameters: tuple[Parameter, ...]
    seconds: float | None = None

    @property
    def dimension(self) -> int:
        """How many coordinates a point has."""
        return sum(1 for _ in self._coordinates())

    @property
    def size(self) -> int:
        """How many assignments are told apart."""
        return math.prod(len(each.domain) for each in self._coordinates())

    def defaults(self) -> Assignment:
        """Everything as it is by default."""
        values: dict[str, Scalar | Course] = {
            each.name: ((0.0, each.domain.default),) if each.points else each.domain.default for each in self.parameters
        }
        return Assignment(values, self.seconds)

    def point(self, assignment: Assignment) -> tuple[float, ...]:
        """The point that assigns the same; of an input, where its control points are."""
        found: list[float] = []
        for each in self.parameters:
            value = assignment.values[each.name]
            scalars = [at(value, time) for time in self.times(each)] if isinstance(value, tuple) else [value]
            found += [each.domain.place(scalar) for scalar in scalars]
        return tuple(found)

    def times(self, input_: Parameter) -> list[float]:
        """When the control points of an input are, in s, equally far apart."""
        assert self.seconds is not None
        return [round(self.seconds * k / input_.points, 9) for k in range(input_.points)]

    def assignment(self, point: Sequence[float]) -> Assignment:
        """What a point assigns."""
        numbers, values = iter(point), dict[str, Scalar | Course]()
        for each in self.parameters:
            if not each.points:
                values[each.name] = each.domain.at(next(numbers))
            else:
                values[each.name] = merged(tuple((time, each.domain.at(next(numbers))) for time in self.times(each)))
        return Assignment(values, self.seconds)

    def all(self) -> Iterator[Assignment]:
        """All assignments."""
        axes = [[(k + 0.5) / len(each.domain) for k in range(len(each.domain))] for each in self._coordinates()]
        return map(self.assignment, product(*axes))

    def _coordinates(self) -> Iterator[Parameter]:
        return (each for each in self.parameters for _ in range(each.points or 1))


def space_of(parameters: Sequence[str], inputs: Sequence[str], seconds: float | None) -> Space:
    """What these texts declare. Raises ValueError, whose text says what is wrong."""
    found = (*map(parameter, parameters), *map(input_, inputs))
    if not found:
        raise ValueError("nothing can be changed: declare a parameter, such as speed=0.2..1.5")
    names = [each.name for each in found]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise ValueError(f"`{twice}` is declared twice")
    if inputs and seconds is None:
        raise ValueError("how long a simulation runs is not given, so the times of inputs are unknown")
    if seconds is not None and not 0 < seconds < math.inf:
        raise ValueError(f"a simulation cannot run for {seconds:g} seconds")
    return Space(found, seconds)


_DECLARED = re.compile(r"(?P<name>[A-Za-z_/][\w./]*)(?P<int>:int)?=(?P<values>[^@]*)(@(?P<points>.*))?", re.DOTALL)
_EXAMPLE = "write speed=0.2..1.5, speed=0.2..0.5..1.5 with a default, boxes:int=0..5, or floor=dry,wet"


def parameter(text: str) -> Parameter:
    """A parameter that stays the same during a run. Raises ValueError."""
    match = _declared(text)
    if match["points"] is not None:
        raise ValueError(f"`{match['name']}` has control points, so it is an input, not a parameter")
    return Parameter(match["name"], _domain(match))


def input_(text: str) -> Parameter:
    """An input that changes during a run: `throttle=0..1@8` may do so at eight control points. Raises ValueError."""
    match = _declared(text)
    points = match["points"] or ""
    if not (points.isascii() and points.isdecimal() and 0 < int(points) <= MOST_POINTS):
        name, values = match["name"], match["values"]
        raise ValueError(
            f"the input `{name}` needs a number of control points from 1 to {MOST_POINTS}: write {name}={values}@8"
        )
    return Parameter(match["name"], _domain(match), int(points))


def _declared(text: str) -> re.Match[str]:
    match = _DECLARED.fullmatch(text.strip())
    if match is None:
        raise ValueError(f"`{text}` declares no parameter: {_EXAMPLE}")
    if match["name"] in RESERVED:
        raise ValueError(f"a parameter cannot be called `{match['name']}`, by which a simulation gets something else")
    return match


def _domain(match: re.Match[str]) -> Domain:
    name, values = match["name"], match["values"].strip()
    parts = [part.strip() for part in values.split("..")]
    if match["int"] is None and len(parts) == 1:
        words = tuple(word.strip() for word in values.split(","))
        if len(words) < 2 or not all(words):
            raise ValueError(f"`{name}` has no range and no choices: {_EXAMPLE}")
        if len(set(words)) < len(words):
            raise ValueError(f"`{name}` has the same choice twice: {values}")
        return Choices(words)
    kind, what = (_number, "a number") if match["int"] is None else (_whole, "a whole number")
    numbers = [kind(part) for part in parts]
    if bad := [part for part, number in zip(parts, numbers, strict=True) if number is None]:
        raise ValueError(f"`{bad[0]}` in the range of `{name}` is not {what}: {_EXAMPLE}")
    known = [number for number in numbers if number is not None]
    if len(known) not in (2, 3) or known[0] >= known[-1] or sorted(known) != known:
        raise ValueError(f"the range of `{name}` must go up, with a default between its ends or none: {_EXAMPLE}")
    low, high = known[0], known[-1]
    if not 1e-100 < high - low < 1e100:
        raise ValueError(f"the range of `{name}` is too narrow or too wide to be searched")
    if match["int"] is not None:
        return Integers(int(low), int(high), int(known[1] if len(known) == 3 else (low + high) // 2))
    middle = float((Decimal(repr(low)) + Decimal(repr(high))) / 2)
    return Reals(low, high, float(known[1]) if len(known) == 3 else middle)


def _number(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def _whole(text: str) -> int | None:
    return int(text) if re.fullmatch(r"[+-]?\d{1,15}", text, re.ASCII) else None
