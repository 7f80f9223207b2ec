"""What a property of each id costs beside the same property without `each`: `python -m benchmarks.each`.

Nanoseconds of CPU time a message, the best of some rounds, by the number of ids: by rows, and by columns in one block
and in blocks as recordings are read in. And bytes for each id that is owed something. Garbage is searched for as
rarely as in the processes of `ltlc`, or with `--library` as often as Python does.
"""

from __future__ import annotations

import argparse
import gc
import random
import time
import tracemalloc
from collections.abc import Iterator, Sequence

import numpy as np

from ltlc.automata import Budget
from ltlc.backends.python.load import load_plan
from ltlc.base.source import Source
from ltlc.cli import ALLOCATIONS
from ltlc.compiler import compile_specification
from ltlc.frontend.language import load_text
from ltlc.inputs.recordings.blocks import ROWS, Block, Samples
from ltlc.monitoring.columns.prepared import Prepared, prepare_all
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Plan, Session
from ltlc.semantics.encodings import EPISODE

HEAD = """
decl id   /track sensor_msgs/JoyFeedback.id
decl kind /track sensor_msgs/JoyFeedback.type
decl dist /track sensor_msgs/JoyFeedback.intensity
decl v    /odom std_msgs/Float64.data
"""
TEXTS = (
    "always (kind == 1 implies eventually kind == 2)",
    "always (kind == 1 implies eventually kind == 2 within 60 s)",
    "always age(dist) <= 300 s",
)
WITH_OTHERS = ("never (kind == 1 and v > 4)", "always (kind == 1 implies eventually v < 1)")
"""What is read on `/odom` is in no message with an id: each of these is a step of all ids."""
NEW = ("always (new kind implies eventually kind == 2 within 60 s)", "each new kind: eventually kind == 2 within 60 s")
"""The same property, said of all messages and of each."""
OPEN = 20_000
"""So many ids are owed something where memory is measured."""

Message = tuple[int, dict[str, float]]


def plan_of(text: str) -> tuple[Plan, list[Prepared]]:
    """The plan of a property, and what columns need of it."""
    specification, found = load_text(Source("props.txt", f"{HEAD}p: {text}"))
    assert specification is not None, found
    compiled, _ = compile_specification(specification, EPISODE, Budget())
    return load_plan(compiled, specification), prepare_all(compiled, specification.source)


def messages(ids: int, count: int) -> list[Message]:
    """Messages of that many ids, of which one in twenty begins something, and one in twenty ends it."""
    chance, now, found = random.Random(ids), 0, []
    for _ in range(count):
        now += chance.randint(500_000, 1_500_000) // max(1, ids // 1000)
        kind = chance.choices((0.0, 1.0, 2.0), (18, 1, 1))[0]
        found.append((now, {"id": float(chance.randrange(ids)), "kind": kind, "dist": 5.0}))
    return found


def nanoseconds(plan: Plan, given: Sequence[Message]) -> float:
    """CPU time a message."""
    rows = ByRows(Session(plan))
    fields = rows.session.fields["/track"]
    listed = [(now, [values[name] for name in fields]) for now, values in given]
    start = time.process_time_ns()
    for now, values in listed:
        rows.message(now, "/track", values)
    return (time.process_time_ns() - start) / len(listed)


def answered(period: int, count: int) -> list[Message]:
    """Messages a millisecond apart, of which each of this period answers all those before."""
    kinds = (2.0 if n % period == period - 1 else 0.0 for n in range(count))
    return [(n * 1_000_000, {"id": 0.0, "kind": kind, "dist": 5.0}) for n, kind in enumerate(kinds)]


def beside(plans: Sequence[Plan], given: Sequence[Message], rounds: int) -> list[float]:
    """CPU time a message of each plan, the best of some rounds in each of which come all."""
    found = [[nanoseconds(plan, given) for plan in plans] for _ in range(rounds)]
    return [min(each) for each in zip(*found, strict=True)]


def blocks_of(given: Sequence[Message], size: int) -> Iterator[Block]:
    """The messages in blocks of this size."""
    times = np.array([now for now, _ in given])
    columns = {name: np.array([values[name] for _, values in given]) for name in given[0][1]}
    for first in range(0, len(given), size):
        part = slice(first, first + size)
        rows = np.arange(len(times[part]))
        yield Block(times[part], {name: Samples(rows, column[part]) for name, column in columns.items()}, {})


def with_others(block: Block, changes: int) -> Block:
    """The rows of a block, so many of which are messages on `/odom` instead, each with another value than the last."""
    is_other = np.zeros(len(block.times), np.bool_)
    is_other[:: len(is_other) // changes] = True
    others, rows = np.flatnonzero(is_other), np.flatnonzero(~is_other)
    samples = {name: Samples(rows, np.asarray(of.values)[rows]) for name, of in block.samples.items()}
    return Block(block.times, {**samples, "v": Samples(others, np.where(np.arange(len(others)) % 2, 3.0, 0.5))}, {})


def by_columns(plan: Plan, prepared: Sequence[Prepared], blocks: Sequence[Block], rounds: int) -> float:
    """CPU time a message."""
    best = float("inf")
    for _ in range(rounds):
        judge = ByBlocks(Session(plan), prepared)
        start = time.process_time_ns()
        for block in blocks:
            judge.take(block)
        best = min(best, time.process_time_ns() - start)
    return best / sum(len(block.times) for block in blocks)


def bytes_an_id(plan: Plan) -> float:
    """Memory for each id that is owed something."""
    rows = ByRows(Session(plan))
    fields = rows.session.fields["/track"]
    tracemalloc.start()
    for number in range(OPEN):
        rows.message(number, "/track", [float(number) if name == "id" else 1.0 for name in fields])
    found = tracemalloc.get_traced_memory()[0] / OPEN
    tracemalloc.stop()
    return found


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--messages", type=int, default=50_000)
    parser.add_argument("--columns", type=int, default=1_000_000, help="so many messages by columns")
    parser.add_argument("--library", action="store_true", help="in a process of others")
    options = parser.parse_args()
    if not options.library:
        gc.freeze()
        gc.set_threshold(ALLOCATIONS)
    for text in TEXTS:
        plans = [plan_of(f"{head}{text}") for head in ("", "each g of id: ")]
        for ids in (10, 1_000, 100_000):
            given = messages(ids, options.messages)
            figures = {"by rows": beside([plan for plan, _ in plans], given, options.rounds)}
            given = messages(ids, options.columns)
            for name, size in (("in one block", len(given)), (f"in blocks of {ROWS:,}", ROWS)):
                blocks = list(blocks_of(given, size))
                figures[name] = [by_columns(*each, blocks, options.rounds) for each in plans]
            print(f"{ids:7,} ids, {text}")
            for name, (whole, sliced) in figures.items():
                print(f"    {name}: {whole:,.0f} ns without each, {sliced:,.0f} with it", flush=True)
    [block] = blocks_of(messages(1_000, options.columns), options.columns)
    mixed = with_others(block, max(1, options.columns // 1000))
    parts = [mixed.part(first, first + ROWS) for first in range(0, len(mixed.times), ROWS)]
    for text in WITH_OTHERS:
        row = by_columns(*plan_of(f"each g of id: {text}"), parts, options.rounds)
        print(f"1,000 ids, one row of 1,000 on /odom, {text}: {row:,.0f} ns a row by columns", flush=True)
    for period in (1, 10, 100):
        given = answered(period, options.messages // 5)
        whole, each = beside([plan_of(text)[0] for text in NEW], given, options.rounds)
        print(f"{NEW[1]}, answered each {period} messages: {whole:,.0f} ns as always, {each:,.0f} with it", flush=True)
    plan, _ = plan_of(f"each g of id: {TEXTS[1]}")
    print(f"{bytes_an_id(plan):,.0f} bytes an id, for {TEXTS[1]}")


if __name__ == "__main__":
    main()
