"""`each` by columns: what is reported of all ids is what rows find, whatever the blocks."""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
from columns_support import state
from each_by_definition import HEAD, ONE_TOPIC, TWO_TOPICS, Row, random_rows
from effort import share_of
from stepping import from_text

from ltlc.backends.python.load import load_plan
from ltlc.inputs.recordings.blocks import Block, blocks_of
from ltlc.inputs.recordings.rows import Column
from ltlc.inputs.recordings.rows import Row as Rows
from ltlc.monitoring.columns import elements
from ltlc.monitoring.columns.ids import Numbers, runs_of
from ltlc.monitoring.columns.prepared import Prepared, prepare_all
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Plan, Session
from ltlc.specification.expressions import ValueType

COLUMNS = {name: Column(ValueType.NUMBER) for name in ("id", "kind", "dist", "fid", "prog", "v")}
COLUMNS["stop"] = Column(ValueType.BOOLEAN)


def cut(chance: random.Random, rows: Sequence[Row], names: Sequence[str]) -> list[Block]:
    """Blocks of one row and more."""
    taken = [Rows(time, {k: v for k, v in values.items() if k in names}) for time, _, values in rows]
    size = chance.choice([1, 2, 5, 20, len(rows)])
    columns = {name: COLUMNS[name] for name in names}
    return [block for first in range(0, len(rows), size) for block in blocks_of(taken[first : first + size], columns)]


@cache
def planned(text: str) -> tuple[Plan, Sequence[Prepared]]:
    """What rows and columns are judged by; once for all runs."""
    compiled, specification = from_text(HEAD + text)
    return load_plan(compiled, specification), prepare_all(compiled, specification.source)


def both(text: str, rows: Sequence[Row], chance: random.Random, *, reads: bool = False) -> tuple[Session, ByBlocks]:
    """A session row by row, and one by columns, which is read after each block if one `reads`."""
    plan, prepared = planned(text)
    reference = ByRows(Session(plan))
    fast = ByBlocks(Session(plan), prepared)
    names = [signal.name for signal in plan.signals if signal.name in COLUMNS]
    for block in cut(chance, rows, names):
        for time, of, values, topics in block.rows(set(names)):
            reference.samples(time, of, values, topics)
        fast.take(block)
        assert not reads or fast.session.time == reference.session.time
    until = rows[-1][0] + chance.choice([0, 10, 100])
    for session in (reference.session, fast.session):
        ByRows(session).advance(until)
    return reference.session, fast


WITH_OTHERS = (
    "always (kind == 1 implies eventually v < 1)",
    "never (kind == 1 and v > 2)",
    "always (kind == 1 implies eventually stop within 20 ns)",
    "always (new stop implies eventually kind == 2 within 30 ns)",
    "always (v > 1 implies eventually kind == 1 within 12 ns)",
    "always (kind == 2 implies once v > 2 within 30 ns)",
    "until stop, never kind == 2",
    "always (kind == 1 implies eventually (stop and v > 1))",
)
"""Properties of what is in messages with an id, and of what is in others."""

CASES = [*((text, "id") for text in (*ONE_TOPIC, *WITH_OTHERS)), *((text, "id, fid") for text in TWO_TOPICS)]


@pytest.mark.parametrize(("text", "keys"), CASES)
def test_what_columns_find_of_all_ids_is_what_rows_find(text: str, keys: str) -> None:
    chance = random.Random(f"{text} {keys}")
    for _ in range(share_of(20)):
        rows = random_rows(chance, chance.randint(1, 80), chance.sample(range(12), chance.randint(1, 8)))
        reference, fast = both(f"p: each g of {keys}: {text}", rows, chance)
        assert state(fast.session) == state(reference)


@pytest.mark.parametrize(
    "parts",
    [
        [[3.0, 5.0, 3.0], [4.0, -2.0, 5.0], []],
        [[3.0, 1e18, 3.0], [0.5, 1e18]],
        [[1.0, 2.0], [float(1 << 40), 2.0]],
        [["b", "a"], ["a", "c"]],
        [[True, False], [True]],
    ],
)
def test_an_id_keeps_its_number_and_each_has_another(parts: list[list[object]]) -> None:
    numbers, known = Numbers(), dict[object, int]()
    for part in parts:
        for id_, number in zip(part, numbers.of(np.array(part)).tolist(), strict=True):
            assert known.setdefault(id_, number) == number
    assert {numbers.id(number): number for number in known.values()} == known
    assert sorted(known.values()) == list(range(len(known)))
    assert set(numbers.ids()) == known.keys()


@pytest.mark.parametrize("most", [3, 1 << 17, 1 << 23, 1 << 25])
def test_messages_of_one_id_stand_together_in_their_order(most: int) -> None:
    chance = np.random.default_rng(most)
    numbers = chance.integers(0, most, 500)
    numbers[1::7] = numbers[0]
    among = np.flatnonzero(chance.random(500) < 0.8)
    runs = runs_of(numbers, among)
    expected = sorted(among.tolist(), key=lambda message: numbers[message])
    assert runs.order.tolist() == expected
    assert runs.numbers.repeat(runs.lengths).tolist() == numbers[expected].tolist()
    assert [len(runs.run(place)) for place in range(len(runs.numbers))] == runs.lengths.tolist()


def test_what_is_not_sliced_by_columns_is_named_by_timing() -> None:
    chance = random.Random(0)
    _, fast = both("p: each g of id: never dist < v", random_rows(chance, 20, [1]), chance)
    assert set(fast.ways[0].because) == {"conditions on messages with an id and on others"}


@pytest.mark.parametrize("text", ["never kind == 2", "always (kind == 1 implies eventually kind == 2 within 9 ns)"])
def test_a_session_that_was_read_goes_on(text: str) -> None:
    chance = random.Random(1)
    for _ in range(5):
        rows = random_rows(chance, 60, [1, 2, 3])
        reference, fast = both(f"p: each g of id: {text}", rows, chance, reads=True)
        assert state(fast.session) == state(reference)


def measured(rows: Sequence[Row]) -> list[Row]:
    """Those without NaN."""
    return [row for row in rows if not any(value != value for value in row[2].values())]


ONE = ("never kind == 2", "always (kind == 1 implies eventually kind == 2 within 9 ns)")


@pytest.mark.parametrize("text", [*ONE, *WITH_OTHERS])
def test_most_that_is_said_of_what_messages_have_goes_by_columns(text: str) -> None:
    chance = random.Random(0)
    rows = measured(random_rows(chance, 60, [1, 2, 3]))
    _, fast = both(f"p: each g of id: {text}", rows, chance)
    assert not fast.ways[0].because


@pytest.mark.parametrize(
    "text", ["always (kind == 1 implies age(dist) <= 30 ns)", "never (age(dist) > 9 ns and kind > 1)"]
)
def test_a_clock_step_of_a_slice_judges_the_values_of_its_last_step(text: str) -> None:
    chance = random.Random(text)
    for _ in range(share_of(20)):
        rows = random_rows(chance, 60, [1, 2, 3])
        reference, fast = both(f"p: each g of id: {text}", rows, chance)
        assert state(fast.session) == state(reference)


@pytest.mark.parametrize(
    ("text", "last", "order"),
    [
        ("always (kind == 1 implies eventually kind == 2 within 9 ns)", {"id": 1.0, "kind": 0.0}, [3, 5, 7]),
        ("never (kind == 1 and v > 2)", {"v": 3.0}, [7, 3, 5]),
    ],
)
def test_ids_that_time_decides_at_once_are_named_in_their_order_and_by_a_message_as_they_began(
    text: str, last: dict[str, float], order: list[int]
) -> None:
    rows: list[Row] = [(0, "/odom", {"v": 0.0})]
    rows += [(0, "/track", {"id": number, "kind": 1.0}) for number in (7.0, 3.0, 5.0)]
    rows.append((90, "/track" if "id" in last else "/odom", last))
    session, fast = both(f"p: each g of id: {text}", rows, random.Random(0))
    assert not fast.ways[0].because
    for one in (session, fast.session):
        (slices,) = one.sliced
        assert list(slices.ids.violated) == order


def test_time_may_open_an_obligation_after_the_last_message_of_a_block() -> None:
    rows: list[Row] = [(0, "/track", {"id": 1.0, "dist": 1.0}), (90, "/odom", {"v": 0.0})]
    for seed in range(8):
        text = "p: each g of id: always (age(dist) > 30 ns implies eventually new dist)"
        reference, fast = both(text, rows, random.Random(seed))
        assert not fast.ways[0].because
        found = [(one.tracks[0].open_since, one.sliced[0].owed()[0].since.time) for one in (fast.session, reference)]
        assert found[0] == found[1]


def test_many_slices_take_what_they_share_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(elements, "MOST", 20)
    chance = random.Random(2)
    for text in WITH_OTHERS:
        rows = measured(random_rows(chance, 120, range(8)))
        reference, fast = both(f"p: each g of id: {text}", rows, chance)
        assert state(fast.session) == state(reference)
