"""Expressions at all steps at once: the same values, to the bit, as at one step after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import assert_never

import numpy as np

from ltlc.inputs.recordings.blocks import Array, Places
from ltlc.monitoring.columns.arrays import ByStep, Views, changes, combined, pieces, products, sums
from ltlc.monitoring.columns.bits import Mask
from ltlc.monitoring.columns.functions import ROWS
from ltlc.monitoring.columns.series import Given, Steps, UnsupportedError
from ltlc.program import expressions as p
from ltlc.program.types import BOOL
from ltlc.runtime import sampling
from ltlc.semantics import ltl
from ltlc.specification.expressions import MOST_COMBINATIONS
from ltlc.specification.wire import EXACT, as_double

Column = Array | np.float64 | bool | str
"""A value for each step, or one for all."""


def wanted_of(read: p.Held | p.Recent | p.Slope | p.News) -> sampling.Wanted:
    """What is read of a signal, as the runtime calls it."""
    match read:
        case p.Held(signal, ago):
            return sampling.Input(signal, ago)
        case p.Recent(signal, ago):
            return sampling.Recent(signal, ago)
        case p.Slope(signal):
            return sampling.Slope(signal)
        case p.News(signal):
            return sampling.New(signal)
        case _:
            assert_never(read)


def value(expression: p.Expression, steps: Steps) -> Column:
    """The single value `expression` at `steps`. Raises UnsupportedError."""
    with np.errstate(all="ignore"):
        return _value(expression, steps)


def _value(expression: p.Expression, steps: Steps) -> Column:
    """What is computed is kept, but for conditions: of these, bits are."""
    match expression:
        case p.Literal(bool() | str() as constant):
            return constant
        case p.Literal(int() as number) if as_double(number) != number:
            raise UnsupportedError("an integer that is not a double")
        case p.Literal(number):
            return np.float64(number)
        case p.Apply() if expression.type == BOOL:
            return _applied(expression, steps)
    if expression not in steps.known:
        steps.known[expression] = _computed(expression, steps)
    found: Column = steps.known[expression]
    return found


def _computed(
    expression: p.Held | p.Recent | p.Slope | p.News | p.Kept | p.Slice | p.Each | p.Count | p.Apply, steps: Steps
) -> Column:
    match expression:
        case p.Held() | p.Slope() | p.News():
            return as_doubles(steps.column(wanted_of(expression)))
        case p.Apply():
            return _applied(expression, steps)
        case p.Count():
            return _counted(expression, steps)
        case p.Recent() | p.Slice() | p.Each() | p.Kept():
            raise KeyError(expression)
        case _:
            assert_never(expression)


def as_doubles(column: Array) -> Array:
    """Integers as doubles, which compare as they do, unless they are large."""
    if column.dtype.kind not in "iu":
        return column
    if len(column) and (column.max() > EXACT or column.min() < -EXACT):
        raise UnsupportedError("integers that are not doubles")
    return column.astype(np.float64)


def _applied(applied: p.Apply, steps: Steps) -> Column:
    """A primitive by its row in the table; of arrays, computed once of each."""
    row = ROWS.get(applied.primitive)
    if row is None:
        raise UnsupportedError(f"the {applied.primitive.value}")
    *others, last = applied.arguments
    if not last.type.is_array:
        found: Column = row(*(_value(argument, steps) for argument in applied.arguments))
        return found
    at = arrays_at(last, steps)
    if others:
        views = at.arrays.taken(at.numbers)
        beside: Array = row(*(_value(other, steps) for other in others), as_doubles(views.packed()), views.lengths)
        return beside
    parts = (at.arrays[part] for part in pieces(at.arrays.lengths))
    of_each: Array = np.concatenate([np.empty(0), *(row(as_doubles(part.packed()), part.lengths) for part in parts)])
    return of_each.take(at.numbers)


def arrays_at(array: p.Expression, steps: Steps) -> ByStep:
    """An array, or a part of one, at each of `steps`."""
    if array not in steps.known:
        if isinstance(array, p.Slice):
            steps.known[array] = arrays_at(array.array, steps).part(array.start, array.stop)
        else:
            assert isinstance(array, p.Held | p.Recent)
            wanted = wanted_of(array)
            assert isinstance(wanted, sampling.Input | sampling.Recent)
            steps.known[array] = steps.arrays(wanted)
    found: ByStep = steps.known[array]
    return found


def _counted(count: p.Count, steps: Steps) -> Array:
    """The value of `count`."""

    def of(elements: Given, sizes: Places) -> Array:
        return sums(np.broadcast_to(_value(count.guard, elements), len(elements)), sizes)

    found = over_elements(count.lists, singles(count.guard), steps, of)
    return found > 0 if count.is_any else found


def over_elements(
    lists: Sequence[Sequence[p.Expression]],
    beside: Iterable[p.Expression],
    steps: Steps,
    of: Callable[[Given, Places], Array],
) -> Array:
    """What `of` makes of all combinations of elements of `lists`, once where everything that it reads stays the same.

    It gets the elements of several steps, after one another, and how many there are of each; with the single values
    `beside` them.
    """
    arrays = {array: arrays_at(array, steps) for of_list in lists for array in of_list}
    columns = {single: np.asarray(_value(single, steps)) for single in dict.fromkeys(beside)}
    if len(arrays) == 1 and not columns:
        [only] = arrays.values()
        return _of_elements(lists, dict.fromkeys(arrays, only.arrays), columns, steps, of).take(only.numbers)
    is_new = np.logical_or.reduce(
        [changes(each) for each in (*(by.numbers for by in arrays.values()), *columns.values())]
    )
    at = np.flatnonzero(is_new)
    views = {array: by.arrays.taken(by.numbers[at]) for array, by in arrays.items()}
    here = {single: column[at] for single, column in columns.items()}
    found: Array = _of_elements(lists, views, here, steps, of).take(is_new.cumsum() - 1)
    return found


def singles(guard: p.Expression) -> Iterator[p.Expression]:
    """What the guard of a count compares elements with: the largest parts that read signals and are no conditions."""
    match guard:
        case p.Literal() | p.Each():
            return
        case p.Apply(_, arguments) if guard.type == BOOL or any(isinstance(part, p.Each) for part in p.parts(guard)):
            for argument in arguments:
                yield from singles(argument)
        case _:
            yield guard


def _of_elements(
    lists: Sequence[Sequence[p.Expression]],
    views: Mapping[p.Expression, Views],
    columns: Mapping[p.Expression, Array],
    steps: Steps,
    of: Callable[[Given, Places], Array],
) -> Array:
    """The same of arrays that belong together, one after the other; `columns` of single values have one for each."""
    lengths = [np.minimum.reduce([views[array].lengths for array in of_list]) for of_list in lists]
    sizes = lengths[0] if len(lengths) == 1 else products(lengths, MOST_COMBINATIONS)

    def of_part(part: slice) -> Array:
        rows, total = [each[part] for each in lengths], int(sizes[part].sum())
        indexes = combined(rows, sizes[part]) if len(rows) > 1 else []
        known: dict[p.Expression, Array] = {}
        for number, of_list in enumerate(lists):
            for array in of_list:
                view = Views(views[array].elements, rows[number], views[array].starts[part])
                found = view.at(indexes[number], sizes[part]) if indexes else view.packed()
                known[p.Each(array)] = as_doubles(found)
        known |= {single: column[part].repeat(sizes[part]) for single, column in columns.items()}
        return of(Given(steps.columns, steps.base, steps.first, known, count=total), sizes[part])

    found: Array = np.concatenate([np.empty(0), *map(of_part, pieces(sizes))])
    return found


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
        case _:
            raise TypeError(f"not a state predicate: {formula}")


def not_numbers(guards: Iterable[p.Expression], steps: Steps) -> Mask | None:
    """Where one of the `guards` is NaN; None where none is."""
    masks = [mask for guard in guards if (mask := _not_a_number(guard, steps)) is not None]
    return np.logical_or.reduce(masks) if masks else None


def _not_a_number(side: p.Expression, steps: Steps) -> Mask | None:
    key = "NaN", side
    if key not in steps.known:
        found = np.asarray(value(side, steps))
        has_nan = found.size and np.isnan(np.max(found))
        steps.known[key] = np.isnan(found) if has_nan else None
    mask: Mask | None = steps.known[key]
    return mask
