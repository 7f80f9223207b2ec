"""`each` by columns: what is reported of all ids is what rows find, whatever the blocks."""

from __future__ import annotations

import random
from collections.abc import Sequence

import pytest
from columns_support import state
from each_by_definition import HEAD, ONE_TOPIC, TWO_TOPICS, Row, random_rows

from ltlc.automata import Budget
from ltlc.backends.python.load import load_plan
from ltlc.base.source import Source
from ltlc.compiler import compile_specification
from ltlc.frontend.language import load_text
from ltlc.inputs.recordings.blocks import Block, blocks_of
from ltlc.inputs.recordings.rows import Column
from ltlc.inputs.recordings.rows import Row as Rows
from ltlc.monitoring.columns.prepared import prepare_all
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.semantics.encodings import EPISODE
from ltlc.specification.expressions import ValueType

COLUMNS = {name: Column(ValueType.NUMBER) for name in ("id", "kind", "dist", "fid", "prog", "v")}
COLUMNS["stop"] = Column(ValueType.BOOLEAN)


def cut(chance: random.Random, rows: Sequence[Row], names: Sequence[str]) -> list[Block]:
    """Blocks of one row and more."""
    taken = [Rows(time, {k: v for k, v in values.items() if k in names}) for time, _, values in rows]
    size = chance.choice([1, 2, 5, 20, len(rows)])
    columns = {name: COLUMNS[name] for name in names}
    return [block for first in range(0, len(rows), size) for block in blocks_of(taken[first : first + size], columns)]


def both(text: str, rows: Sequence[Row], chance: random.Random) -> tuple[Session, ByBlocks]:
    """A session row by row, and one by columns."""
    specification, found = load_text(Source("props.txt", HEAD + text))
    assert specification is not None, found
    compiled, _ = compile_specification(specification, EPISODE, Budget())
    plan = load_plan(compiled, specification)
    reference = ByRows(Session(plan))
    fast = ByBlocks(Session(plan), prepare_all(compiled, specification.source))
    names = [signal.name for signal in plan.signals if signal.name in COLUMNS]
    for block in cut(chance, rows, names):
        for time, of, values, topics in block.rows(set(names)):
            reference.samples(time, of, values, topics)
        fast.take(block)
    until = rows[-1][0] + chance.choice([0, 10, 100])
    for session in (reference.session, fast.session):
        ByRows(session).advance(until)
    return reference.session, fast


CASES = [*((text, "id") for text in ONE_TOPIC), *((text, "id, fid") for text in TWO_TOPICS)]


@pytest.mark.parametrize(("text", "keys"), CASES)
def test_what_columns_find_of_all_ids_is_what_rows_find(text: str, keys: str) -> None:
    chance = random.Random(f"{text} {keys}")
    for _ in range(40):
        rows = random_rows(chance, chance.randint(1, 80), chance.sample(range(12), chance.randint(1, 8)))
        reference, fast = both(f"p: each g of {keys}: {text}", rows, chance)
        assert state(fast.session) == state(reference)
