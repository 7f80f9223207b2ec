"""Times reading and judging tables beside `numpy.loadtxt` of the same run as CSV: `python -m benchmarks.tables`.

Four columns, `time` and three signals that random walks make, three properties. *digits* are what is written of each
number: all that a double has, or some decimals. Every way takes its turn in each round; medians, on the clock and of
the CPUs. Imports are done and monitors made before. `--memory ROWS` reads a CSV of so many rows and says how much
memory that took.
"""

from __future__ import annotations

import argparse
import gzip
import json
import resource
import tempfile
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from statistics import median

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from ltlc.automata import Budget
from ltlc.base.source import Source
from ltlc.compiler import compile_specification
from ltlc.frontend.language import load_text
from ltlc.inputs.recordings import open_recording
from ltlc.monitoring.judging.run import Judge
from ltlc.semantics.encodings import EPISODE
from ltlc.specification.expressions import Signal

NAMES = ("distance", "speed", "battery")
TEXT = """decl distance /distance Float64.data
decl speed /speed Float64.data
decl battery /battery Float64.data
never speed > 1e9
always (distance < -1e9 implies eventually speed < 0.1)
after battery < -1e9, never speed > 2
"""
"""Properties that nothing decides before the end, so that the whole run is looked at."""


def main() -> None:
    """Print a table of seconds."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=300_000)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--memory", type=int, metavar="ROWS")
    options = parser.parse_args()
    judge = _made()
    read = partial(_read, signals=judge.signals)
    with tempfile.TemporaryDirectory() as folder:
        if options.memory:
            _memory(Path(folder), options.memory, judge.signals)
            return
        print(f"| {options.rows:,} rows | digits | s | CPU s | times loadtxt | of its CPU |\n|---|---|---|---|---|---|")
        for digits in (None, 9, 3):
            files = _files(Path(folder), options.rows, digits)
            ways: dict[str, Callable[[], object]] = {
                "numpy.loadtxt": partial(np.loadtxt, files["csv"], delimiter=",", skiprows=1)
            }
            ways |= {f"read {kind}": partial(read, path) for kind, path in files.items()}
            ways |= {f"read and judge {kind}": partial(_judge, path, judge) for kind, path in files.items()}
            _compare(ways, digits, options.rounds)


def _compare(ways: Mapping[str, Callable[[], object]], digits: int | None, rounds: int) -> None:
    taken: dict[str, list[tuple[float, float]]] = {name: [] for name in ways}
    for _ in range(rounds):
        for name, way in ways.items():
            taken[name].append(_seconds(way))
    of_numpy = [median(of) for of in zip(*taken["numpy.loadtxt"], strict=True)]
    for name, pairs in taken.items():
        wall, cpu = (median(of) for of in zip(*pairs, strict=True))
        ratios = f"{wall / of_numpy[0]:.2f} | {cpu / of_numpy[1]:.2f}"
        print(f"| {name} | {digits or 'all'} | {wall:.3f} | {cpu:.3f} | {ratios} |", flush=True)


def _columns(rows: int, digits: int | None) -> dict[str, np.ndarray]:
    walks = np.cumsum(np.random.default_rng(1).normal(size=(len(NAMES), rows)), axis=1)
    values = walks if digits is None else walks.round(digits)
    return {"time": 1_700_000_000_000_000_000 + np.arange(rows) * 10_000_000, **dict(zip(NAMES, values, strict=True))}


def _files(folder: Path, rows: int, digits: int | None) -> dict[str, Path]:
    """The same run as each kind of table."""
    columns = _columns(rows, digits)
    write = repr if digits is None else lambda value: f"{value:.{digits}f}"
    times = [f"{time // 10**9}.{time % 10**9 // 10**7:02}" for time in columns["time"].tolist()]
    texts = [[write(value) for value in columns[name].tolist()] for name in NAMES]
    paths = {kind: folder / f"run.{kind}" for kind in ("csv", "csv.gz", "jsonl", "parquet")}
    lines = "".join(",".join(line) + "\n" for line in zip(times, *texts, strict=True))
    content = f"time,{','.join(NAMES)}\n{lines}".encode()
    paths["csv"].write_bytes(content)
    paths["csv.gz"].write_bytes(gzip.compress(content, 1))
    objects = zip(times, *(columns[name].tolist() for name in NAMES), strict=True)
    heads = [json.dumps(name) for name in ("time", *NAMES)]
    with paths["jsonl"].open("w") as file:
        for values in objects:
            file.write("{" + ", ".join(f"{head}: {value}" for head, value in zip(heads, values, strict=True)) + "}\n")
    parquet.write_table(pa.table(columns), paths["parquet"])
    return paths


def _made() -> Judge:
    specification, diagnostics = load_text(Source("props.txt", TEXT))
    assert specification is not None, diagnostics
    return Judge(compile_specification(specification, EPISODE, Budget(30.0, 1024))[0], specification)


def _read(path: Path, signals: Mapping[str, Signal]) -> None:
    for _ in open_recording(path, signals).blocks():
        pass


def _judge(path: Path, judge: Judge) -> None:
    assert judge.judge(path).exit_code != 2


def _seconds(way: Callable[[], object]) -> tuple[float, float]:
    """On the clock, and of the CPUs."""
    clock, cpu = time.perf_counter(), time.process_time()
    way()
    return time.perf_counter() - clock, time.process_time() - cpu


def _memory(folder: Path, rows: int, signals: Mapping[str, Signal]) -> None:
    path = folder / "run.csv"
    part = 100_000
    with path.open("w") as file:
        file.write(f"time,{','.join(NAMES)}\n")
        for first in range(0, rows, part):
            values = np.random.default_rng(first).normal(size=(part, len(NAMES))).tolist()
            file.writelines(f"{first + k},{x!r},{y!r},{z!r}\n" for k, (x, y, z) in enumerate(values))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    _read(path, signals)
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(f"{path.stat().st_size / 2**20:,.0f} MB read; memory from {before / 1024:.0f} to {after / 1024:.0f} MB")


if __name__ == "__main__":
    main()
