"""Nanoseconds a message beside properties on other topics: a node's session, `ltlc.monitor`, and their setup.

    python -m benchmarks.messages [--properties N ...] [--rounds N]

One property reads one topic, whose messages are judged; the others read a topic each and are untimed, have clocks, or
are watchdogs. In each round come 2,000 messages to the session, as many rows to `ltlc.monitor`, and as many updates of
a dictionary with look-ups, in CPU time; figures are medians, and times those of the dictionary in the same round.
"""

from __future__ import annotations

import argparse
import platform
from collections.abc import Callable, Sequence
from functools import partial
from operator import truediv
from statistics import median
from time import thread_time_ns

import ltlc
from ltlc.automata import Budget
from ltlc.backends.python.load import load_plan
from ltlc.base.source import Source
from ltlc.compiler import compile_specification
from ltlc.frontend.language import load_text
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Plan, Session
from ltlc.semantics.encodings import EPISODE

OTHERS = {
    "untimed": "never o{0} > 2",
    "with a clock": "always (o{0} < 1 implies eventually o{0} > 2 within 2 s)",
    "a watchdog": "always age(o{0}) <= 2000 s",
}

MESSAGES = 2_000
PERIOD = 10_000_000


def specification(kind: str, count: int) -> str:
    """One property, and `count` of a kind on other topics."""
    numbers = ["", *range(count)]
    declared = [f"decl o{n} /o{n} std_msgs/Float64.data" for n in numbers]
    return "\n".join([*declared, "never o > 2", *(OTHERS[kind].format(n) for n in numbers[1:])])


def plan_of(text: str) -> Plan:
    """What is monitored."""
    found, _ = load_text(Source("props.txt", text))
    assert found is not None
    return load_plan(compile_specification(found, EPISODE, Budget(30.0, 1024))[0], found)


def nanoseconds(run: Callable[[], object]) -> int:
    """The CPU time of `run`."""
    start = thread_time_ns()
    run()
    return thread_time_ns() - start


def begun(plan: Plan) -> ByRows:
    """Judges a session in which each topic has had a message."""
    session = Session(plan)
    rows = ByRows(session)
    for topic in session.messages:
        rows.message(0, topic, [0.5])
    return rows


def in_session(plan: Plan) -> Callable[[], None]:
    """Judges messages, as a node does."""
    rows = begun(plan)
    values = [0.5]

    def run() -> None:
        for time in _times(rows.session.time):
            rows.judge(time, "/o", values)

    return run


def in_monitor(text: str) -> Callable[[], None]:
    """Steps `ltlc.monitor` with one value."""
    monitor = ltlc.monitor(text)
    signals = [line.split()[1] for line in text.splitlines() if line.startswith("decl")]
    monitor.step(dict.fromkeys(signals, 0.5), 0.0)
    row, last = {"o": 0.5}, 0

    def run() -> None:
        nonlocal last
        for time in _times(last):
            monitor.step(row, time / 1e9)
        last = time

    return run


def _times(last: int | None) -> range:
    """When the next messages come."""
    first = (last or 0) + PERIOD
    return range(first, first + MESSAGES * PERIOD, PERIOD)


def in_dict() -> None:
    """Updates a dictionary, and looks up."""
    values = {"o": 0.5, "p": 1.0}
    for _ in range(MESSAGES):
        values["o"] = 0.5
        values["p"]


def told(found: Sequence[int], beside: Sequence[int]) -> str:
    """Nanoseconds a message, and how many times a dictionary's that is."""
    times = median(map(truediv, found, beside))
    return f"{median(found) / MESSAGES:,.0f} | {times:.1f}"


def main() -> None:
    """Print a table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--properties", type=int, nargs="+", default=[0, 100, 1_000], metavar="N")
    parser.add_argument("--rounds", type=int, default=30)
    options = parser.parse_args()
    print(f"{platform.python_implementation()} {platform.python_version()}\n")
    print("| others | how many | session, ns | times | `ltlc.monitor`, ns | times | setup, ms | first messages, ms |")
    print("|---|---|---|---|---|---|---|---|")
    for kind in OTHERS:
        for count in options.properties:
            text = specification(kind, count)
            plan = plan_of(text)
            runs = (in_dict, in_session(plan), in_monitor(text))
            rounds = [[nanoseconds(run) for run in runs] for _ in range(options.rounds)]
            dict_, session, monitor = zip(*rounds, strict=True)
            setup, first = (min(nanoseconds(partial(make, plan)) for _ in range(5)) / 1e6 for make in (Session, begun))
            shown = f"{told(session, dict_)} | {told(monitor, dict_)} | {setup:,.1f} | {first - setup:,.1f}"
            print(f"| {kind} | {count:,} | {shown} |", flush=True)


if __name__ == "__main__":
    main()
