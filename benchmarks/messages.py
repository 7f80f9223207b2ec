"""Nanoseconds a message beside properties on other topics: a node's session, `ltlc.monitor`, and their setup.

    python benchmarks/messages.py [--properties N ...] [--rounds N]

One property reads one topic, whose messages are judged; the others read a topic each and are untimed, have clocks, or
are watchdogs. Each figure is the least of the rounds, in CPU time. `dict` is an update of a dictionary and a look-up.
"""

from __future__ import annotations

import argparse
import platform
from collections.abc import Callable
from functools import partial
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


def least(run: Callable[[], object], rounds: int) -> int:
    """Nanoseconds of `run`."""
    found = []
    for _ in range(rounds):
        start = thread_time_ns()
        run()
        found.append(thread_time_ns() - start)
    return min(found)


def begun(plan: Plan) -> ByRows:
    """Judges a session in which each topic has had a message."""
    session = Session(plan)
    rows = ByRows(session)
    for topic in session.messages:
        rows.message(0, topic, [0.5])
    return rows


def in_session(plan: Plan, rounds: int) -> float:
    """Nanoseconds a message."""
    rows = begun(plan)
    values = [0.5]

    def run() -> None:
        for time in _times(rows.session.time):
            rows.message(time, "/o", values)

    return least(run, rounds) / MESSAGES


def in_monitor(text: str, rounds: int) -> float:
    """Nanoseconds a row of `ltlc.monitor` with one value."""
    monitor = ltlc.monitor(text)
    signals = [line.split()[1] for line in text.splitlines() if line.startswith("decl")]
    monitor.step(dict.fromkeys(signals, 0.5), 0.0)
    row, last = {"o": 0.5}, 0

    def run() -> None:
        nonlocal last
        for time in _times(last):
            monitor.step(row, time / 1e9)
        last = time

    return least(run, rounds) / MESSAGES


def _times(last: int | None) -> range:
    """When the next messages come."""
    first = (last or 0) + PERIOD
    return range(first, first + MESSAGES * PERIOD, PERIOD)


def in_dict(rounds: int) -> float:
    """Nanoseconds of one update and one look-up."""
    values = {"o": 0.5, "p": 1.0}

    def run() -> None:
        for _ in range(MESSAGES):
            values["o"] = 0.5
            values["p"]

    return least(run, rounds) / MESSAGES


def main() -> None:
    """Print a table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--properties", type=int, nargs="+", default=[0, 100, 1_000], metavar="N")
    parser.add_argument("--rounds", type=int, default=30)
    options = parser.parse_args()
    print(f"{platform.python_implementation()} {platform.python_version()}; dict {in_dict(options.rounds):.0f} ns\n")
    print("| others | how many | session, ns a message | `ltlc.monitor`, ns a row | setup, ms | first messages, ms |")
    print("|---|---|---|---|---|---|")
    for kind in OTHERS:
        for count in options.properties:
            text = specification(kind, count)
            plan = plan_of(text)
            in_time = f"{in_session(plan, options.rounds):,.0f} | {in_monitor(text, options.rounds):,.0f}"
            setup, first = (least(partial(make, plan), 5) / 1e6 for make in (Session, begun))
            print(f"| {kind} | {count:,} | {in_time} | {setup:,.1f} | {first - setup:,.1f} |", flush=True)


if __name__ == "__main__":
    main()
