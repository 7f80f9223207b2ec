"""Robustness by columns beside rtamt: equal numbers where both can say a property, and how long they take.

    OPENBLAS_NUM_THREADS=1 python -m benchmarks.robustness --peers SITE-PACKAGES [--rows N] [--steps N] [--rounds N]

All is in one process and one run; a figure is the median over rounds that go around in turn, CPU time. rtamt evaluates
the whole signal at once, over the first `--steps` steps, at 1 Hz, whose numbers have to be those of ltlc; ltlc takes
all rows. Both start from columns: arrays here, lists there. In dense time rtamt, like ltlc, reads when samples came;
in discrete time a bound is a number of samples.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks.columns import Judged, Prepared, Signals, medians
from ltlc.inputs.recordings.blocks import Block, Samples
from ltlc.monitoring.columns.measuring import Measuring
from ltlc.runtime.session import Session

SECOND = 10**9

ROWS = 65_536
"""A block of a recording has so many."""


class Case(NamedTuple):
    """A property, and what it is in STL, as rtamt reads it."""

    name: str
    ltlc: str
    stl: str


CASES = (
    Case("always", "never v > 2", "always(v <= 2)"),
    Case("response", "always (v > 1.5 implies eventually w < 0.2)", "always((v >= 1.5) implies eventually(w <= 0.2))"),
    Case("until", "until w > 1.9, always v < 1.9", "(v <= 1.9) until (w >= 1.9)"),
    Case("within 1 s", "always (v > 1.5 implies eventually w < 0.2 within 1 s)",
         "always((v >= 1.5) implies eventually[0:1](w <= 0.2))"),
    Case("within 100 s", "always (v > 1.5 implies eventually w < 0.2 within 100 s)",
         "always((v >= 1.5) implies eventually[0:100](w <= 0.2))"),
    Case("for 100 s", "always v < 1.5 for 100 s", "always[0:100](v <= 1.5)"),
    Case("since", "always (v > 1.5 implies (w > 0.2 since v < 1))",
         "always((v >= 1.5) implies ((w >= 0.2) since (v <= 1)))"),
)  # fmt: skip


def signals(count: int) -> Signals:
    """Two slow waves with noise."""
    i, noise = np.arange(count), np.random.default_rng(1)
    return {
        "v": 1 + np.cos(i / 50) + 0.1 * noise.standard_normal(count),
        "w": 1 + np.cos(i / 50 - 2) + 0.1 * noise.standard_normal(count),
    }


def _block(columns: Signals, part: slice) -> Block:
    numbers = np.arange(len(columns["v"]))[part]
    samples = {name: Samples(numbers - numbers[0], values[part]) for name, values in columns.items()}
    return Block(numbers * SECOND, samples, {})


def measured(judged: Judged, columns: Signals) -> Callable[[], Sequence[float]]:
    """The robustness at each step."""
    count = len(columns["v"])
    blocks = [_block(columns, slice(start, start + ROWS)) for start in range(0, count, ROWS)]

    def measure() -> Sequence[float]:
        measuring = Measuring(Session(judged.plan), judged.compiled, judged.prepared)
        for block in blocks:
            measuring.take(block)
        [curve] = measuring.curves((count - 1) * SECOND).values()
        assert not curve.reason, curve.reason
        return curve.margins  # type: ignore[return-value]

    return measure


def discrete(case: Case, columns: Signals) -> Callable[[], Sequence[float]]:
    """The same by rtamt, in discrete time."""
    import rtamt

    specification = _specified(rtamt.StlDiscreteTimeSpecification(), case, columns)
    data = {"time": list(range(len(columns["v"]))), **{name: values.tolist() for name, values in columns.items()}}
    return lambda: [margin for _, margin in specification.evaluate(data)]


def dense(case: Case, columns: Signals) -> Callable[[], Sequence[Sequence[float]]]:
    """The same by rtamt, in dense time: a time and a number wherever the number changes."""
    import rtamt

    specification = _specified(rtamt.StlDenseTimeSpecification(), case, columns)
    data = [[name, [[*each] for each in enumerate(values.tolist())]] for name, values in columns.items()]
    return lambda: specification.evaluate(*data)


def _specified(specification: Any, case: Case, columns: Signals) -> Any:
    for name in (*columns, "out"):
        specification.declare_var(name, "float")
    specification.spec = f"out = {case.stl}"
    specification.parse()
    return specification


def _at_steps(changes: Sequence[Sequence[float]], count: int) -> Sequence[float]:
    """A number for each step."""
    times, margins = np.array(changes).T
    return margins[times.searchsorted(np.arange(count), "right") - 1]  # type: ignore[no-any-return]


def ready(way: Callable[[], object]) -> Prepared:
    """Nothing has to be made ready."""
    return lambda: way


def compare(case: Case, rows: int, steps: int, rounds: int) -> bool:
    """Whether ltlc and rtamt in discrete time have the same numbers; with a line that says how long all take."""
    columns = signals(rows)
    first = {name: values[:steps] for name, values in columns.items()}
    judged = Judged([case.ltlc], list(columns))
    ours, ways = measured(judged, first)(), {"dense": dense(case, first), "discrete": discrete(case, first)}
    are_equal = {
        "discrete": np.array_equal(np.asarray(ours), np.asarray(ways["discrete"]())),
        "dense": np.array_equal(np.asarray(ours), _at_steps(ways["dense"](), steps)),  # type: ignore[arg-type]
    }
    took = medians(
        {"ltlc": ready(measured(judged, columns)), **{name: ready(way) for name, way in ways.items()}}, rounds
    )
    ns = took["ltlc"] / rows
    slow = [f"{took[name] / steps:,.0f} | {took[name] / steps / ns:,.0f}" for name in ways]
    equal = ", ".join(name for name, is_equal in are_equal.items() if is_equal) or "NO"
    print(f"| {case.name} | {equal} | {ns:.1f} | {' | '.join(slow)} |", flush=True)
    return are_equal["discrete"]


def main() -> int:
    """Compare and time all cases; 1 if numbers differ."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--peers", type=Path, required=True, metavar="SITE-PACKAGES")
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--steps", type=int, default=2000)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    sys.path.append(str(options.peers))
    print("| property | equal to rtamt in | ltlc, ns a step | rtamt, dense time | times | discrete time | times |")
    print("|---|---|---|---|---|---|---|")
    found = [compare(case, options.rows, options.steps, options.rounds) for case in CASES]
    return 0 if all(found) else 1


if __name__ == "__main__":
    sys.exit(main())
