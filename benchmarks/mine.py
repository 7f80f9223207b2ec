"""How long `ltlc mine` takes: seconds of CPU and on the clock, and looks at recordings.

    python -m benchmarks.mine [--recordings 10] [--rows 100000]

Drives of random accelerations at 100 Hz, speeds within 2 m/s, and a stop now and then. Each property is sought by
itself, then all at once; beside it stands what judging all recordings once takes, with values in the places of `?`.
"""

from __future__ import annotations

import argparse
import os
import random
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from ltlc.automata import Budget
from ltlc.compiler import compile_specification
from ltlc.frontend.language import load
from ltlc.monitoring.judging.run import Judge
from ltlc.monitoring.mining import template
from ltlc.monitoring.mining.mine import mine
from ltlc.semantics.encodings import EPISODE

DECLARATIONS = "decl speed /odom Odometry.twist.twist.linear.x\ndecl scan /scan LaserScan.range_min\n"

PROPERTIES = {
    "absence": ("never speed > ?", "2.5"),
    "response": ("always (scan < 0.2 implies eventually speed < 0.1 within ?)", "10 min"),
    "past": ("never speed - @{speed, -1} > ?", "1"),
}


def main() -> None:
    """Print a row for each property, and one for all together."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--recordings", type=int, default=10)
    parser.add_argument("--rows", type=int, default=100_000)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        paths = [drive(Path(folder, f"{k}.csv"), k, options.rows) for k in range(options.recordings)]
        print(f"{options.recordings} recordings of {options.rows:,} rows, load {os.getloadavg()[0]:.1f}")
        print("| property | looks | mine, s of CPU | on the clock | judging once, s of CPU |")
        print("|---|---|---|---|---|")
        for name, (text, value) in PROPERTIES.items():
            row(Path(folder), name, [text], [value], paths)
        texts, values = zip(*PROPERTIES.values(), strict=True)
        row(Path(folder), "all three", texts, values, paths)


def drive(path: Path, seed: int, rows: int) -> Path:
    """A recording at `path`."""
    chance, speed, lines = random.Random(seed), 0.0, ["time,speed,scan"]
    for number in range(rows):
        is_halt = number % 1000 > 900 or number == rows - 1
        speed = 0.0 if is_halt else max(-2.0, min(2.0, speed + chance.gauss(0, 0.02)))
        near = 5 * chance.random() + (0.0 if number % 1000 > 800 else 0.5)
        lines.append(f"{number * 0.01:.2f},{speed!r},{near!r}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def row(folder: Path, name: str, texts: Sequence[str], values: Sequence[str], paths: Sequence[Path]) -> None:
    """Measure one set of properties."""
    sought, filled = folder / "sought.txt", folder / "filled.txt"
    sought.write_text(DECLARATIONS + "".join(f"{text}\n" for text in texts), encoding="utf-8")
    pairs = zip(texts, values, strict=True)
    filled.write_text(DECLARATIONS + "".join(f"{t.replace('?', v)}\n" for t, v in pairs), encoding="utf-8")
    found, _ = template.load(sought, [])
    assert found is not None
    looks = []
    used, passed = measured(lambda: looks.append(mine(found, paths, Budget()).looks))
    once, _ = measured(lambda: judge(filled, paths))
    print(f"| {name} | {looks[0]} | {used:.1f} | {passed:.1f} | {once:.1f} |", flush=True)


def judge(path: Path, recordings: Sequence[Path]) -> None:
    """What `ltlc run` does with each recording."""
    specification, _ = load(path)
    assert specification is not None
    compiled, _ = compile_specification(specification, EPISODE, Budget())
    for recording in recordings:
        Judge(compiled, specification).judge(recording)


def measured(work: Callable[[], object]) -> tuple[float, float]:
    """Seconds of CPU and on the clock."""
    used, passed = time.process_time(), time.monotonic()
    work()
    return time.process_time() - used, time.monotonic() - passed


if __name__ == "__main__":
    main()
