"""The families of the Timescales benchmark mean on rows what their formulas do; their recordings end as they should."""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest

from benchmarks.timescales import SAID, Recorded, block, emitted, judged, random_rows, recorded, violated_at

Held = Callable[[int], bool]
"""Whether something holds at a row."""


def once(within: int, held: Held) -> Held:
    """At a row, or at one of so many before."""
    return lambda row: any(held(k) for k in range(max(0, row - within), row + 1))


def since(left: Held, right: Held) -> Held:
    """The right at some row, and the left at each after it."""
    return lambda row: any(right(k) and all(left(j) for j in range(k + 1, row + 1)) for k in range(row + 1))


def _true(columns: Recorded, name: str) -> Held:
    return lambda row: bool(columns[name][row])


def formula(name: str, bound: int, columns: Recorded) -> Held:
    """The formula of a family, by the definition of MTL over rows a second apart."""
    p, q, r = (_true(columns, name) for name in "pqr")
    no_p: Held = lambda row: not p(row)  # noqa: E731
    between: Held = lambda row: r(row) and not q(row) and once(row, q)(row)  # noqa: E731
    formulas: dict[str, Held] = {
        "AbsentAQ": lambda row: not once(bound, q)(row) or since(no_p, q)(row),
        "AbsentBR": lambda row: not r(row) or not once(bound, p)(row),
        "AlwaysAQ": lambda row: not once(bound, q)(row) or since(p, q)(row),
        "AlwaysBR": lambda row: not r(row) or not once(bound, no_p)(row),
        "RecurGLB": once(bound, p),
        "RecurBQR": lambda row: not between(row) or since(once(bound, lambda k: p(k) or q(k)), q)(row),
    }
    return formulas[name]


@pytest.mark.parametrize("name", SAID)
def test_a_family_is_violated_where_its_formula_first_is(name: str) -> None:
    chance, firsts = random.Random(name), set()
    for bound in (1, 4):
        ours = judged(SAID[name], bound)
        for _ in range(12):
            columns = random_rows(SAID[name], 25, chance)
            holds = formula(name, bound, columns)
            first = next((row for row in range(25) if not holds(row)), None)
            session = ours.session()
            session.take(block(columns))
            assert violated_at(session.session) == first
            assert violated_at(ours.by_rows(block(columns))) == first
            assert emitted(ours, SAID[name].names)(columns) == first
            firsts.add(first)
    assert len(firsts) > 2


@pytest.mark.parametrize("name", SAID)
def test_a_recording_of_a_family_is_violated_at_its_last_row(name: str) -> None:
    columns = recorded(SAID[name], 7, 300, random.Random(name))
    holds = formula(name, 7, columns)
    rows = len(columns["p"])
    assert [row for row in range(rows) if not holds(row)] == [rows - 1]
    session = judged(SAID[name], 7).session()
    session.take(block(columns))
    assert violated_at(session.session) == rows - 1
