"""The table of functions in numpy: what columns find of conditions on edge values, against the reference for values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from random import Random
from typing import Any

import numpy as np
import pytest
from columns_support import DECLARATIONS, Drawn, judged
from conditions_support import EVERY, ROUNDS, conditions, hostile, wanted

from ltlc.base.source import Span
from ltlc.inputs.recordings.blocks import Block, Samples, packed
from ltlc.inputs.recordings.rows import Column, Row
from ltlc.monitoring.columns.atoms import bits_of, comparisons, lowered_atoms, prepare
from ltlc.monitoring.columns.bits import unpack
from ltlc.monitoring.columns.functions import ROWS
from ltlc.monitoring.columns.series import Columns, Steps, UnsupportedError
from ltlc.monitoring.columns.values import not_numbers, wanted_of
from ltlc.program.expressions import Kept
from ltlc.program.functions import Primitive
from ltlc.program.lowering import read
from ltlc.program.properties import guards
from ltlc.runtime.sampling import Reading, Sampler
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import truth
from ltlc.specification.expressions import Condition, Read
from ltlc.specification.wire import EXACT

Values = Mapping[Read, Any]

REFUSED = {
    "i64 == 9007199254740993": "an integer that is not a double",
    "u64 > 18446744073709551614": "an integer that is not a double",
    "min(ids) == 9007199254740993": "an integer that is not a double",
    "any(nearest(scan, xs) > x)": "an array",
}
"""Conditions that go row by row: no column of doubles has the constant, or a whole array is asked for each element."""


def has_large(values: Values) -> bool:
    """Whether an integer is among them, or in an array, that may be no double."""
    each = (one for value in values.values() for one in (value if isinstance(value, tuple) else (value,)))
    return any(isinstance(one, int) and abs(one) > EXACT for one in each)


def by_columns(what: Condition, rows: Sequence[Values]) -> list[bool | None] | str:
    """Whether a condition holds in each of the `rows`, None where something that it compares is NaN; why not, if so."""
    atoms = [Atom("atom", what, Span(0, 0))]
    (atom,) = lowered_atoms(atoms)
    steps = steps_of(wanted(what), rows)
    try:
        prepare(comparisons([atom]), steps)
        holds = unpack(bits_of(atom, steps), len(rows)).tolist()
        undefined = not_numbers(guards(map(read, wanted(what)), atoms), steps)
    except UnsupportedError as error:
        return str(error)
    is_nan = [False] * len(rows) if undefined is None else undefined.tolist()
    return [None if nan else held for nan, held in zip(is_nan, holds, strict=True)]


def steps_of(reads: Sequence[Read], rows: Sequence[Values]) -> Steps:
    """A step for each of the `rows`."""
    every = np.arange(len(rows))
    samples, readings = {}, []
    for each in reads:
        kind = Column(each.signal.type, each.signal.numbers)
        samples[each.signal.name] = Samples(every, packed([values[each] for values in rows], kind))
        type_ = kind.type.value.replace("number", "integer") if kind.numbers.is_wide else kind.type.value
        readings.append(Reading(each.signal.name, each.signal.name, type_))
    inputs = [wanted_of(each) for each in map(read, reads) if not isinstance(each, Kept)]
    return Columns(Block(every, samples, {}), Sampler(readings, inputs), readings).steps(inputs)


def by_definition(what: Condition, rows: Sequence[Values]) -> list[bool | None]:
    """The same, by the reference for values."""
    return [truth(what, values) for values in rows]


@pytest.mark.parametrize("text", EVERY)
def test_columns_find_of_a_condition_what_the_reference_says(text: str) -> None:
    """Or they refuse it: constants that are no doubles, and blocks with integers that are none."""
    chance = Random(text)
    for what in conditions(text):
        rows = [hostile(what, chance) for _ in range(ROUNDS)]
        small, large = [each for each in rows if not has_large(each)], [each for each in rows if has_large(each)]
        assert by_columns(what, small) == (REFUSED.get(text) or by_definition(what, small))
        if large and text not in REFUSED:
            assert by_columns(what, large) in ("integers that are not doubles", by_definition(what, large))


def test_every_primitive_has_a_row_in_numpy() -> None:
    assert set(ROWS) == set(Primitive)


def test_a_property_that_needs_a_primitive_without_a_row_goes_row_by_row(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(ROWS, Primitive.SQRT)
    rows = [Row(n * 10**8, {"v": float(n), "w": 0.0}) for n in range(9)]
    _, fast = judged(Drawn(DECLARATIONS + "p: never sqrt(v) > 2\nq: never v > 4\n", [rows]))
    assert [list(way.because) for way in fast.ways] == [["the square root"], []]
