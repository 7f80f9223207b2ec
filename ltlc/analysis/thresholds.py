"""Which atoms can hold together when all of them compare one value with constants: found by trying values."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import pairwise
from typing import Any

from ltlc.analysis.bounds import Interval, bounds
from ltlc.base.source import Span
from ltlc.semantics.finite import holds
from ltlc.semantics.words import Letter
from ltlc.specification.atoms import Atom
from ltlc.specification.cells import samples
from ltlc.specification.evaluation import Single, Value, is_true, letter
from ltlc.specification.expressions import (
    Boolean,
    Call,
    Comparison,
    Condition,
    Count,
    Current,
    Element,
    Expression,
    New,
    Number,
    Opening,
    Past,
    Read,
    Relation,
    Slope,
    String,
    ValueType,
    inputs,
    operands,
    value_type,
)
from ltlc.specification.functions import Function
from ltlc.specification.numbers import numbers_of

Values = dict[Any, Value]
"""A value for each input, or for an element."""

MOST_DIGITS = 17

LONGEST = 1000
"""Arrays that have to be longer to be counted are left to z3."""


def valuations(atoms: Sequence[Atom]) -> dict[Letter, Values] | None:
    """The sets of `atoms` that hold for some value, each with such a value.

    None if `atoms` compare anything but one value, or one function or count of one array, with constants.
    """
    terms = {term for atom in atoms for term in _terms(atom.condition)}
    if len(terms) != 1:
        return None
    term = terms.pop()
    source = _source(term)
    candidates = None if source is None else _candidates(atoms, term, source)
    if source is None or candidates is None:
        return None
    found: dict[Letter, Values] = {}
    for value in candidates:
        values: Values = {source: value}
        valuation = letter(tuple(atoms), values)
        if valuation is not None:
            found.setdefault(valuation, values)
    return found


def _terms(condition: Condition) -> Iterator[Expression]:
    """What `condition` compares, constants omitted."""
    for operand in operands(condition):
        if not isinstance(operand, Number | String | Boolean):
            yield operand


def _source(term: Expression) -> Read | Element | None:
    """The input or element that `term` is, or the array that it is a function of."""
    match term:
        case Current() | Past() | Slope() | New() | Opening() | Element():
            return term
        case Call(_, (Current() | Past() as array,)) if term.array is not None:
            return array
        case Count() if len(set(inputs(term))) == len(term.elements) == 1:
            (element,) = term.elements
            return element.array if isinstance(element.array, Current | Past) else None
        case _:
            return None


def _type_of(source: Read | Element) -> ValueType:
    if isinstance(source, Element):
        return value_type(next(inputs(source))).element or ValueType.NUMBER
    return value_type(source)


def _candidates(atoms: Sequence[Atom], term: Expression, source: Read | Element) -> Iterable[Value] | None:
    """Values of `source` among which every valuation of `atoms` shows, simple ones first; None for arrays too long."""
    match _type_of(source), term:
        case ValueType.BOOLEAN, _:
            return (False, True)
        case ValueType.STRING, _:
            return _strings(atoms)
        case ValueType.NUMBER, _:
            return _numbers_of(atoms, term, lambda number: {source: number})
        case _, Count():
            return _counted(atoms, term)
        case _, Call(Function.LEN):
            return _repeated((0.0,), _whole(atoms))
        case _:
            return [(number,) for number in _numbers_of(atoms, term, lambda number: {source: (number,)})]


def _counted(atoms: Sequence[Atom], count: Count) -> list[Value] | None:
    """Arrays of the elements that `count` counts, as many as make a difference."""
    inner = valuations([Atom(name, condition, Span(0, 0)) for name, condition in count.conditions])
    if inner is None:
        return None
    elements: dict[bool, tuple[Single, ...]] = {True: (), False: ()}
    for satisfied, values in inner.items():
        counts = holds(count.predicate, (satisfied,))
        elements[counts] = elements[counts] or tuple(v for v in values.values() if not isinstance(v, tuple))
    return _repeated(elements[True], _whole(atoms), elements[False])


def _repeated(
    elements: tuple[Single, ...], numbers: Sequence[int], others: tuple[Single, ...] = ()
) -> list[Value] | None:
    """`elements` as often as each of `numbers` says, before `others`."""
    return None if numbers[-1] > LONGEST else [elements * number + others for number in numbers]


def _whole(atoms: Sequence[Atom]) -> list[int]:
    """The whole numbers, not negative, among which every valuation of `atoms` shows, in ascending order."""
    cuts = {math.floor(t) for atom in atoms for t in _thresholds(atom.condition) if abs(t) < math.inf}
    return sorted({0, *(cut + more for cut in cuts for more in (-1, 0, 1, 2) if cut + more >= 0)})


def _numbers_of(atoms: Sequence[Atom], term: Expression, values: Callable[[float], Values]) -> Iterator[float]:
    """Numbers that `term` can be: simple ones, then one for each valuation that some give, infinities included.

    With `cells.samples` these are all: the conditions change as it demands, by the lemma of `specification.alphabet`.
    """
    numbers, interval = numbers_of(term), bounds(term)
    yield from map(numbers.nearest, _numbers(atoms, interval))
    conditions = [lambda number, c=atom.condition: is_true(c, values(number)) for atom in atoms]
    constants = [e.value for atom in atoms for e in operands(atom.condition) if isinstance(e, Number)]
    line = numbers.between(max(numbers.least, interval.low), min(numbers.most, interval.high))
    yield from samples(conditions, constants, line)


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
