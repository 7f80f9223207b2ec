"""Recordings by columns: beside numpy.max over the same columns, the session row by row, reelay and rtamt; and growth.

    OPENBLAS_NUM_THREADS=1 python -m benchmarks.columns [--peers SITE-PACKAGES] [--rows N] [--rounds N]
    python -m benchmarks.columns --forms [--rows N] [--rounds N]
    python -m benchmarks.columns --agree N [--seed N]

All is in one process and one run; a figure is the median over rounds that go around in turn, CPU time. The five
properties are those of `step.py`; so are the peers, what they are given, and how: one call a sample.
`--forms` times what is said of arrays, at openings, and what is counted. `--agree` draws N specifications and
recordings and compares columns with rows.
"""

from __future__ import annotations

import argparse
import random
import statistics
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from time import process_time_ns

import numpy as np
from numpy.typing import NDArray

from benchmarks import step
from ltlc.automata import Budget
from ltlc.backends.python.load import load_plan
from ltlc.base.source import Source
from ltlc.compiler import compile_specification
from ltlc.frontend.language import load_text
from ltlc.inputs.recordings.blocks import Block, Ragged, Samples
from ltlc.monitoring.columns.prepared import prepare_all
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.semantics.encodings import EPISODE

FIVE = [case.ltlc for case in step.CASES if not case.timed]
Signals = Mapping[str, NDArray[np.float64]]


def signals(kind: str, count: int) -> Signals:
    """As `step.samples`, or slower, or with another letter at every sample and no verdict that changes."""
    i, noise = np.arange(count), np.random.default_rng(1)
    if kind == "every sample":
        side = np.where(i % 2, 1.0, -1.0)
        return {
            "distance": 2 + 1.5 * side + 0.1 * noise.random(count),
            "speed": 1 + 0.95 * side + 0.04 * noise.random(count),
            "battery": 0.52 + 0.4 * side + 0.05 * noise.random(count),
        }
    t = i / {"rare": 1600, "as step.py": 50}[kind]
    return {"distance": 2.5 + 2 * np.cos(t), "speed": 0.95 + 0.95 * np.cos(t - 0.3), "battery": 1 - 0.9 * i / count}


def block(columns: Signals) -> Block:
    """`columns` at 1 kHz."""
    rows = np.arange(len(next(iter(columns.values()))))
    return Block(rows * 1_000_000, {name: Samples(rows, values) for name, values in columns.items()}, {})


class Judged:
    """Properties over columns of doubles; of scans, if `scan` is one; of booleans, if it is `p`, `q` or `r`."""

    def __init__(self, properties: Sequence[str], names: Sequence[str]) -> None:
        fields = {"scan": "sensor_msgs/LaserScan.ranges"} | dict.fromkeys("pqr", "std_msgs/Bool.data")
        declared = "".join(f"decl {name} /{name} {fields.get(name, 'std_msgs/Float64.data')}\n" for name in names)
        specification, _ = load_text(Source("props.txt", declared + "\n".join(properties)))
        assert specification is not None
        self.specification = specification
        self.compiled, _ = compile_specification(specification, EPISODE, Budget(60.0, 1024))
        self.plan = load_plan(self.compiled, specification, names)
        self.prepared = prepare_all(self.compiled, specification.source)

    def session(self) -> ByBlocks:
        """Judges a new session."""
        return ByBlocks(Session(self.plan), self.prepared)

    def by_rows(self, of: Block) -> Session:
        """The same row by row."""
        session = Session(self.plan)
        rows = ByRows(session)
        for time, names, values, topics in of.rows(set(session.sampler.samples)):
            rows.samples(time, names, values, topics)
        return session


Prepared = Callable[[], Callable[[], object]]
"""Makes ready, untimed, what is to be timed."""


def columns_over(judged: Judged, of: Block) -> Prepared:
    """A new session, ready to take the block."""
    return lambda: partial(judged.session().take, of)


def rows_over(judged: Judged, of: Block) -> Prepared:
    """A new session, row by row."""
    return lambda: partial(judged.by_rows, of)


def maxima_over(columns: Signals) -> Prepared:
    """The largest value of each column."""
    return lambda: lambda: [np.max(values) for values in columns.values()]


def medians(ways: Mapping[str, Prepared], rounds: int) -> dict[str, float]:
    """Nanoseconds of each, the median of rounds that go around; the first round, which fills tables, does not count."""
    found: dict[str, list[int]] = {name: [] for name in ways}
    for _ in range(rounds + 1):
        for name, prepare in ways.items():
            way = prepare()
            start = process_time_ns()
            way()
            found[name].append(process_time_ns() - start)
    return {name: statistics.median(times[1:]) for name, times in found.items()}


def beside_numpy(rows: int, rounds: int) -> None:
    """The five properties beside numpy.max over their three columns."""
    judged = Judged(FIVE, ("distance", "speed", "battery"))
    print("| letters change | rows | numpy.max, ns a row | columns | times | session, row by row |")
    print("|---|---|---|---|---|---|")
    for kind in ("rare", "as step.py", "every sample"):
        for count in (rows // 10, rows):
            columns = signals(kind, count)
            whole, few = block(columns), block({name: values[:20_000] for name, values in columns.items()})
            ways = {
                "max": maxima_over(columns),
                "columns": columns_over(judged, whole),
            }
            found = medians(ways, rounds)
            slow = medians({"rows": rows_over(judged, few)}, 1)["rows"] / 20_000
            most, ours = found["max"] / count, found["columns"] / count
            print(f"| {kind} | {count:,} | {most:.2f} | {ours:.2f} | {ours / most:.1f} | {slow:,.0f} |", flush=True)


def beside_peers(rows: int, rounds: int) -> None:
    """The five properties beside the peers on the samples of `step.py`."""
    judged, cases = Judged(FIVE, ("distance", "speed", "battery")), [case for case in step.CASES if not case.timed]
    whole = block(signals("as step.py", rows))
    names = [name for name in step.available() if name in ("reelay", "rtamt")]
    ours = [medians({"columns": columns_over(judged, whole)}, 1)["columns"] / rows for _ in range(rounds)]
    peers: dict[str, list[float]] = {name: [] for name in names}
    for _ in range(rounds):
        for name in names:
            peers[name].append(sum(step.nanoseconds(name, case, 1000, 1) for case in cases))
    mine = statistics.median(ours)
    print("\n| the five properties | ns a sample | times columns |\n|---|---|---|")
    print(f"| columns | {mine:.2f} | 1 |")
    for name in names:
        theirs = statistics.median(peers[name])
        print(f"| {name} | {theirs:,.0f} | {theirs / mine:,.0f} |", flush=True)


CLOCKS = (
    "always (distance < 1 implies eventually speed < 0.1 within 2 s)",
    "always (distance < 1 implies never speed > 1.95 within 2 s)",
    "after_until distance < 1, distance > 1, eventually speed < 0.1 within 30 s",
    "always age(speed) <= 200 ms",
    "never historically speed > 1.8 for 2 s",
)
"""Properties with bounds, none of which the signals violate; the clock of the last one comes due at times."""


def clocks(rows: int, rounds: int) -> None:
    """Properties with clocks, each by itself, on three columns."""
    print("\n| rows apart 1 ms | letters change | ns a row | session, row by row |\n|---|---|---|---|")
    for text in CLOCKS:
        names = [name for name in ("distance", "speed", "battery") if name in text]
        judged = Judged([text], names)
        for kind in ("rare", "as step.py"):
            found = {name: values for name, values in signals(kind, rows).items() if name in names}
            few = block({name: values[:20_000] for name, values in found.items()})
            ours = medians({"columns": columns_over(judged, block(found))}, rounds)["columns"] / rows
            slow = medians({"rows": rows_over(judged, few)}, 1)["rows"] / 20_000
            print(f"| `{text}` | {kind} | {ours:.1f} | {slow:,.0f} |", flush=True)


NAMES = tuple("abcdefghij")


def fleet(count: int) -> list[str]:
    """So many properties of four kinds on ten signals."""
    chance, found = random.Random(7), []
    for number in range(count):
        one, other = chance.sample(NAMES, 2)
        low, high = round(chance.uniform(0.05, 0.4), 3), round(chance.uniform(0.6, 0.95), 3)
        forms = (
            f"never {one} > {high + 1}",
            f"always ({one} < {low} implies eventually {other} > {high})",
            f"after_until {one} < {low}, {one} > {high}, eventually {other} > {high}",
            f"after {one} > {high}, never {other} < {-low}",
        )
        found.append(forms[number % 4])
    return found


def growth(rows: int, rounds: int) -> None:
    """Ten properties and a thousand on ten signals; and ten over more and more rows."""
    few, many = Judged(fleet(10), NAMES), Judged(fleet(1000), NAMES)
    chance = np.random.default_rng(5)
    print("\n| 10 signals, a period of | 10 properties, ns a row | 1,000 | times |\n|---|---|---|---|")
    for period in (100_000, 10_000, 1_000, 100):
        i = np.arange(rows)
        whole = block(
            {n: 0.5 + 0.5 * np.cos(i / period * 6.28 * chance.uniform(0.7, 1.4) + k) for k, n in enumerate(NAMES)}
        )
        ways = {"few": columns_over(few, whole), "many": columns_over(many, whole)}
        found = medians(ways, rounds)
        a, b = found["few"] / rows, found["many"] / rows
        print(f"| {period:,} rows | {a:.1f} | {b:,.0f} | {b / a:.1f} |", flush=True)
    print("\n| rows | ns a row |\n|---|---|")
    judged = Judged(FIVE, ("distance", "speed", "battery"))
    for count in (rows // 100, rows // 10, rows, rows * 10):
        whole = block(signals("as step.py", count))
        found = medians({"columns": columns_over(judged, whole)}, rounds)
        print(f"| {count:,} | {found['columns'] / count:.1f} |", flush=True)


SCANNED = ("distance", "speed", "scan")
FORMS = (
    "never min(scan[0:90]) < 0.1",
    "never count(scan[80:100] < 0.15) >= 5",
    "never any(scan - @{scan, -1} > 100)",
    "never any(scan < speed / 100)",
    "after_until distance < 1, distance > 4, always speed <= @{speed, opening} + 2",
    "never once speed > 1.8 300 times within 60 s",
    "always (rate(distance) >= 900 Hz over 1 s)",
)


def scanned(count: int) -> Block:
    """Two signals at 1 kHz, and scans of 360 elements at 10 Hz."""
    rows, ranges = np.arange(count), np.random.default_rng(1).uniform(0.2, 10, (-(-count // 100), 360))
    made = {name: Samples(rows, values) for name, values in signals("as step.py", count).items() if name in SCANNED}
    scans = Samples(rows[::100], Ragged(ranges.reshape(-1), np.full(len(ranges), ranges.shape[1])))
    return Block(rows * 1_000_000, made | {"scan": scans}, {})


def forms(rows: int, rounds: int) -> None:
    """Each form, alone and with a rate, beside the session row by row."""
    whole = scanned(rows)
    few = whole.part(0, 20_000)
    print("| property | columns, ns a row | row by row |\n|---|---|---|")
    for text in (*FORMS, f"_rate_ = 100\n{FORMS[1]}", f"_rate_ = 1000\n{FORMS[1]}"):
        judged = Judged([text], SCANNED)
        ours = medians({"columns": columns_over(judged, whole)}, rounds)["columns"] / rows
        slow = medians({"rows": rows_over(judged, few)}, 1)["rows"] / 20_000
        print(f"| `{text.replace(chr(10), '; ')}` | {ours:,.1f} | {slow:,.0f} |", flush=True)


def agree(count: int, seed: int) -> None:
    """Compare columns with rows on random specifications and recordings."""
    sys.path.append(str(Path(__file__).parents[1] / "tests"))
    from columns_support import Draw, judged, sizes, state

    compared = 0
    ways: dict[str, int] = {}
    for number in range(seed, seed + count):
        drawn = Draw(random.Random(number)).drawn()
        with sizes(random.Random(number)):
            reference, fast = judged(drawn)
        if state(reference) != state(fast.session):
            sys.exit(f"seed {number}: by columns it is not as row by row:\n{drawn.text}")
        for way in fast.ways:
            kind = "rows" if way.because else "tables" if way.forward is not None else "steps where letters change"
            ways[kind] = ways.get(kind, 0) + 1
        compared += len(fast.ways)
    print(f"{compared} properties, all the same; by way: {ways}")


def main() -> None:
    """Print tables in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--peers", metavar="SITE-PACKAGES", help="a further folder to import peers from")
    parser.add_argument("--rows", type=int, default=10_000_000)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--agree", type=int, metavar="N", help="only compare columns with rows, N times")
    parser.add_argument("--seed", type=int, default=0, help="of the first that --agree draws")
    parser.add_argument("--forms", action="store_true", help="only what is said of arrays, and at openings")
    options = parser.parse_args()
    if options.agree is not None:
        agree(options.agree, options.seed)
        return
    if options.forms:
        forms(options.rows // 10, options.rounds)
        return
    if options.peers:
        sys.path.append(options.peers)
    beside_numpy(options.rows, options.rounds)
    beside_peers(options.rows, options.rounds)
    clocks(options.rows // 10, options.rounds)
    growth(options.rows // 10, options.rounds)


if __name__ == "__main__":
    main()
