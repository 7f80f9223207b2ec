"""Expressions at all steps at once: the same values, to the bit, as at one step after the other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import assert_never

import numpy as np

from ltlc.columns.arrays import ByStep, Views, changes, pieces, sums
from ltlc.columns.bits import Mask
from ltlc.columns.functions import ROWS
from ltlc.columns.series import Given, Steps, UnsupportedError
from ltlc.program.expressions import (
    Apply,
    Count,
    Each,
    Expression,
    Held,
    Kept,
    Literal,
    News,
    Slice,
    Slope,
    children,
    parts,
    reads_of,
)
from ltlc.recordings.blocks import Array
from ltlc.runtime import sampling
from ltlc.semantics import ltl
from ltlc.specification.wire import EXACT, as_double

Column = Array | np.float64 | bool | str
"""A value for each step, or one for all."""


def wanted_of(read: Held | Slope | News) -> sampling.Wanted:
    """What is read of a signal, as the runtime calls it."""
    match read:
        case Held(signal, ago):
            return sampling.Input(signal, ago)
        case Slope(signal):
            return sampling.Slope(signal)
        case News(signal):
            return sampling.New(signal)
        case _:
            assert_never(read)


def value(expression: Expression, steps: Steps) -> Column:
    """`expression`, which is no array, at `steps`. Raises UnsupportedError."""
    if expression not in steps.known:
        with np.errstate(all="ignore"):
            steps.known[expression] = _value(expression, steps)
    found: Column = steps.known[expression]
    return found


def _value(expression: Expression, steps: Steps) -> Column:
    match expression:
        case Literal(constant):
            return _constant(constant)
        case Held() | Slope() | News():
            return _as_doubles(steps.column(wanted_of(expression)))
        case Apply():
            return _applied(expression, steps)
        case Count():
            return _counted(expression, steps)
        case Slice() | Each() | Kept():
            raise KeyError(expression)
        case _:
            assert_never(expression)


def _constant(value: bool | float | str) -> Column:
    if isinstance(value, bool | str):
        return value
    if isinstance(value, int) and as_double(value) != value:
        raise UnsupportedError("an integer that is no double")
    return np.float64(value)


def _as_doubles(column: Array) -> Array:
    """Integers as doubles, which compare as they do, unless they are large."""
    if column.dtype.kind not in "iu":
        return column
    if len(column) and (column.max() > EXACT or column.min() < -EXACT):
        raise UnsupportedError("integers that are no doubles")
    return column.astype(np.float64)


def _applied(applied: Apply, steps: Steps) -> Column:
    """A primitive by its row in the table; of arrays, computed once of each."""
    row = ROWS.get(applied.primitive)
    if row is None:
        raise UnsupportedError(f"the {applied.primitive.value}")
    first = applied.arguments[0]
    if not first.type.is_array:
        found: Column = row(*(value(argument, steps) for argument in applied.arguments))
        return found
    at = arrays_at(first, steps)
    of_each: Array = row(_as_doubles(at.arrays.packed()), at.arrays.lengths)
    return of_each.take(at.numbers)


def arrays_at(array: Expression, steps: Steps) -> ByStep:
    """An array, or a part of one, at each of `steps`."""
    if array not in steps.known:
        if isinstance(array, Slice):
            steps.known[array] = arrays_at(array.array, steps).part(array.start, array.stop)
        else:
            assert isinstance(array, Held)
            steps.known[array] = steps.arrays(sampling.Input(array.signal, array.ago))
    found: ByStep = steps.known[array]
    return found


def _counted(count: Count, steps: Steps) -> Array:
    """What `count` says of elements of arrays, computed once where all that it reads stays the same."""
    arrays = [arrays_at(array, steps) for array in count.arrays]
    columns = {single: np.asarray(value(single, steps)) for single in dict.fromkeys(_singles(count.guard))}
    if len(arrays) == 1 and not columns:
        return _counts(count, [arrays[0].arrays], columns, steps).take(arrays[0].numbers)
    is_new = np.logical_or.reduce([changes(each) for each in (*(by.numbers for by in arrays), *columns.values())])
    at = np.flatnonzero(is_new)
    views = [by.arrays.taken(by.numbers[at]) for by in arrays]
    here = {single: column[at] for single, column in columns.items()}
    counts: Array = _counts(count, views, here, steps).take(is_new.cumsum() - 1)
    return counts


def _singles(guard: Expression) -> Iterator[Expression]:
    """The largest parts of the guard of a count that read signals, but no element."""
    if not any(isinstance(part, Each) for part in parts(guard)):
        yield from (guard,) if any(True for _ in reads_of(guard)) else ()
    elif not isinstance(guard, Each):
        for child in children(guard):
            yield from _singles(child)


def _counts(count: Count, arrays: Sequence[Views], columns: Mapping[Expression, Array], steps: Steps) -> Array:
    """The same of `arrays` that belong together, one after the other; `columns` of single values have one for each."""
    lengths = np.minimum.reduce([each.lengths for each in arrays])

    def of(part: slice) -> Array:
        known: dict[Expression, Array] = {
            Each(array): _as_doubles(Views(each.elements, lengths[part], each.starts[part]).packed())
            for array, each in zip(count.arrays, arrays, strict=True)
        }
        known |= {single: column[part].repeat(lengths[part]) for single, column in columns.items()}
        given = Given(steps.columns, steps.base, steps.first, known, int(lengths[part].sum()))
        return sums(np.broadcast_to(value(count.guard, given), len(given)), lengths[part])

    counts: Array = np.concatenate([np.empty(0), *map(of, pieces(lengths))])
    return counts > 0 if count.is_any else counts


def predicate(formula: ltl.Formula, holds: dict[str, Mask]) -> Mask | np.bool_:
    """A state predicate where its atoms hold at these places."""
    match formula:
        case ltl.Truth():
            return np.True_
        case ltl.Atom(name):
            return holds[name]
        case ltl.Not(operand):
            return ~predicate(operand, holds)
        case ltl.And(left, right):
            return predicate(left, holds) & predicate(right, holds)
        case ltl.Or(left, right):
            return predicate(left, holds) | predicate(right, holds)
    raise TypeError(f"not a state predicate: {formula}")


def not_numbers(sides: Iterable[Expression], steps: Steps) -> Mask | None:
    """Where one of `sides`, which are numbers, is NaN; None where none is."""
    masks = [mask for side in sides if (mask := _not_a_number(side, steps)) is not None]
    return np.logical_or.reduce(masks) if masks else None


def _not_a_number(side: Expression, steps: Steps) -> Mask | None:
    key = "NaN", side
    if key not in steps.known:
        found = np.broadcast_to(np.asarray(value(side, steps), np.float64), len(steps))
        has_nan = found.size and np.isnan(np.max(found))
        steps.known[key] = np.isnan(found) if has_nan else None
    mask: Mask | None = steps.known[key]
    return mask
