"""Which atoms can hold together when all of them compare one value with constants: found by trying values."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise

from ltlc.analysis.bounds import Interval, bounds
from ltlc.analysis.groups import type_of
from ltlc.semantics.words import Letter
from ltlc.specification.atoms import Atom, Comparison, Condition, Relation, operands
from ltlc.specification.cells import samples
from ltlc.specification.evaluation import Value, is_true, letter
from ltlc.specification.expressions import (
    Boolean,
    Call,
    Current,
    Expression,
    Input,
    New,
    Number,
    Past,
    Slope,
    String,
    ValueType,
)

Values = dict[Input, Value]
"""A value for each input."""

MOST_DIGITS = 17


def valuations(atoms: Sequence[Atom]) -> dict[Letter, Values] | None:
    """The sets of `atoms` that hold for some value, each with such a value.

    None if `atoms` compare anything but one value, or the smallest or largest of one array, with constants.
    """
    terms = {term for atom in atoms for term in _terms(atom.condition)}
    if len(terms) != 1:
        return None
    term = terms.pop()
    source = _source(term)
    if source is None:
        return None
    found: dict[Letter, Values] = {}
    for value in _candidates(atoms, term, source):
        values: Values = {source: value}
        valuation = letter(tuple(atoms), values)
        if valuation is not None:
            found.setdefault(valuation, values)
    return found


def _terms(condition: Condition) -> Iterator[Expression]:
    """What `condition` compares, constants left out."""
    for operand in operands(condition):
        if not isinstance(operand, Number | String | Boolean):
            yield operand


def _source(term: Expression) -> Input | None:
    """The input that `term` is, or the array of which it is the smallest or largest element."""
    match term:
        case Current() | Past() | Slope() | New():
            return term
        case Call(_, (Current() | Past() as array,)) if array.signal.type is ValueType.NUMBERS:
            return array
        case _:
            return None


def _candidates(atoms: Sequence[Atom], term: Expression, source: Input) -> Iterator[Value]:
    """Values of `source` among which every valuation of `atoms` shows, simple ones first."""
    match type_of(source):
        case ValueType.BOOLEAN:
            yield from (False, True)
        case ValueType.STRING:
            yield from _strings(atoms)
        case ValueType.NUMBER:
            yield from _numbers(atoms, bounds(term))
            yield from _doubles(atoms, bounds(term), lambda number: {source: number})
        case ValueType.NUMBERS:
            yield from ((number,) for number in _numbers(atoms, bounds(term)))
            yield from ((double,) for double in _doubles(atoms, bounds(term), lambda number: {source: (number,)}))


def _doubles(atoms: Sequence[Atom], interval: Interval, values: Callable[[float], Values]) -> list[float]:
    """A double for each valuation that one in `interval` gives, infinities and what is rounded included.

    With `cells.samples` these are all: the conditions change as it demands, by the lemma of `specification.alphabet`.
    """
    conditions = [lambda number, c=atom.condition: is_true(c, values(number)) for atom in atoms]
    constants = [e.value for atom in atoms for e in operands(atom.condition) if isinstance(e, Number)]
    return [double for double in samples(conditions, constants, interval.low) if double <= interval.high]


def _strings(atoms: Sequence[Atom]) -> Iterator[str]:
    """Every constant that is compared with, and one that is not."""
    constants = [e.value for atom in atoms for e in operands(atom.condition) if isinstance(e, String)]
    other = next(name for name in (f"other{n or ''}" for n in range(len(constants) + 1)) if name not in constants)
    yield other
    yield from dict.fromkeys(constants)


def _numbers(atoms: Sequence[Atom], interval: Interval) -> list[float]:
    """A number in each gap between thresholds, then the thresholds, as far as they are in `interval`.

    Before all, the numbers that are to be equalled: where one fits, it says most.
    """
    thresholds = {t for atom in atoms for t in _thresholds(atom.condition) if _inside(t, interval)}
    points = sorted(thresholds | {end for end in (interval.low, interval.high) if math.isfinite(end)})
    equalled = [n for atom in atoms for n in _equalled(atom.condition) if _inside(n, interval)]
    return [*equalled, *sorted(_between(points, interval), key=abs), *points]


def _equalled(condition: Condition) -> Iterator[float]:
    """The constants that `condition` compares with for equality."""
    if isinstance(condition, Comparison) and condition.relation is Relation.EQUAL:
        yield from (side.value for side in (condition.left, condition.right) if isinstance(side, Number))


def _inside(number: float, interval: Interval) -> bool:
    return math.isfinite(number) and interval.low <= number <= interval.high


def _between(points: Sequence[float], interval: Interval) -> Iterator[float]:
    """A simple number in each gap between `points`, and beyond them where `interval` goes on."""
    if not points:
        yield 0.0
        return
    for low, high in pairwise(points):
        yield simplest_between(low, high)
    if interval.low == -math.inf:
        yield simplest_between(points[0] - max(1.0, abs(points[0])), points[0])
    if interval.high == math.inf:
        yield simplest_between(points[-1], points[-1] + max(1.0, abs(points[-1])))


def _thresholds(condition: Condition) -> Iterator[float]:
    """The numbers at which the truth of `condition` can change."""
    if not isinstance(condition, Comparison):
        return
    for side, sign in ((condition.right, 1.0), (condition.left, -1.0)):
        if isinstance(side, Number):
            yield side.value
            yield side.value + sign * condition.margin
            yield side.value - sign * condition.margin


def simplest_between(low: float, high: float) -> float:
    """A number with few digits strictly between `low` and `high`; their middle if they are neighbours."""
    middle = low + (high - low) / 2
    for digits in range(-3, MOST_DIGITS):
        rounded = round(middle, digits)
        if low < rounded < high:
            return rounded
    return middle
