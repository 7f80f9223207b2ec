"""What a property of each id costs by rows, beside the same property without `each`: `python -m benchmarks.each`.

Nanoseconds of CPU time a message, the best of some rounds, by the number of ids, and bytes for each id that is owed
something.
"""

from __future__ import annotations

import argparse
import random
import time
import tracemalloc
from collections.abc import Sequence

from ltlc.automata import Budget
from ltlc.backends.python.load import load_plan
from ltlc.base.source import Source
from ltlc.compiler import compile_specification
from ltlc.frontend.language import load_text
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Plan, Session
from ltlc.semantics.encodings import EPISODE

HEAD = """
decl id   /track sensor_msgs/JoyFeedback.id
decl kind /track sensor_msgs/JoyFeedback.type
decl dist /track sensor_msgs/JoyFeedback.intensity
"""
TEXTS = (
    "always (kind == 1 implies eventually kind == 2)",
    "always (kind == 1 implies eventually kind == 2 within 60 s)",
    "always age(dist) <= 300 s",
)
OPEN = 20_000
"""So many ids are owed something where memory is measured."""

Message = tuple[int, dict[str, float]]


def plan_of(text: str) -> Plan:
    """The plan of a property."""
    specification, found = load_text(Source("props.txt", f"{HEAD}p: {text}"))
    assert specification is not None, found
    compiled, _ = compile_specification(specification, EPISODE, Budget())
    return load_plan(compiled, specification)


def messages(ids: int, count: int) -> list[Message]:
    """Messages of that many ids, of which one in twenty begins something, and one in twenty ends it."""
    chance, now, found = random.Random(ids), 0, []
    for _ in range(count):
        now += chance.randint(500_000, 1_500_000) // max(1, ids // 1000)
        kind = chance.choices((0.0, 1.0, 2.0), (18, 1, 1))[0]
        found.append((now, {"id": float(chance.randrange(ids)), "kind": kind, "dist": 5.0}))
    return found


def nanoseconds(plan: Plan, given: Sequence[Message], rounds: int) -> float:
    """CPU time a message."""
    best = float("inf")
    for _ in range(rounds):
        rows = ByRows(Session(plan))
        fields = rows.session.fields["/track"]
        listed = [(now, [values[name] for name in fields]) for now, values in given]
        start = time.process_time_ns()
        for now, values in listed:
            rows.message(now, "/track", values)
        best = min(best, (time.process_time_ns() - start) / len(listed))
    return best


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
    options = parser.parse_args()
    for text in TEXTS:
        whole, sliced = plan_of(text), plan_of(f"each g of id: {text}")
        for ids in (10, 1_000, 100_000):
            given = messages(ids, options.messages)
            one, each = (nanoseconds(plan, given, options.rounds) for plan in (whole, sliced))
            print(f"{ids:7,} ids: {one:6,.0f} ns without each, {each:6,.0f} with it, for {text}", flush=True)
    print(f"{bytes_an_id(plan_of(f'each g of id: {TEXTS[1]}')):,.0f} bytes an id, for {TEXTS[1]}")


if __name__ == "__main__":
    main()
