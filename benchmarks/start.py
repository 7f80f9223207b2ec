"""What commands take to start: `python -m benchmarks.start [--before TREE] [--rounds N]`.

Whole processes that write bytecode, taking turns, medians: `ltlc run` of one property on an MCAP file of 67 messages,
`ltlc check` of that property, `ltlc build` of one with a bound on time, `ltlc --version`, and beside them what Python,
numpy and spot take by themselves.
`--before` is another tree of the project, to compare this one with.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

from mcap.writer import CompressionType

from benchmarks.bags import messages, write_mcap

HERE = Path(__file__).parents[1]
PROPERTY = "decl odom /odom Odometry.pose.pose.position\nstep: never odom.x - @{odom.x, -1} > 5\n"
TIMED = """decl scan /scan LaserScan.ranges
always (min(scan) < 0.3 implies eventually min(scan) > 0.5 within 2 s)
"""
ALONE = {"python": ["-c", ""], "import numpy": ["-c", "import numpy"], "import spot": ["-c", "import spot"]}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--before", type=Path, help="another tree of the project")
    parser.add_argument("--rounds", type=int, default=10)
    options = parser.parse_args()
    trees = {"before": options.before.resolve(), "now": HERE} if options.before else {"now": HERE}
    with tempfile.TemporaryDirectory() as folder:
        commands = prepared(Path(folder))
        runs = [(name, arguments, "now", HERE) for name, arguments in ALONE.items()]
        runs += [(name, arguments, *tree) for name, arguments in commands.items() for tree in trees.items()]
        taken: dict[tuple[str, str], list[tuple[float, float]]] = {}
        for each in range(options.rounds + 1):
            for name, arguments, label, tree in runs:
                found = seconds(arguments, tree)
                if each:  # the first round writes the bytecode
                    taken.setdefault((name, label), []).append(found)
    print("| | tree | CPU s | wall s |\n|---|---|---|---|")
    for (name, label), each_time in taken.items():
        processor, wall = (statistics.median(column) for column in zip(*each_time, strict=True))
        print(f"| {name} | {label} | {processor:.2f} | {wall:.2f} |")


def prepared(folder: Path) -> dict[str, list[str]]:
    """The commands, on files that are made in `folder`."""
    specification, timed, bag = folder / "small.txt", folder / "timed.txt", folder / "small.mcap"
    timed.write_text(TIMED, encoding="utf-8")
    specification.write_text(PROPERTY, encoding="utf-8")
    write_mcap(bag, messages(22), CompressionType.ZSTD)
    ltlc = ["-m", "ltlc"]
    return {
        "ltlc --version": [*ltlc, "--version"],
        "ltlc check": [*ltlc, "check", str(specification)],
        "ltlc run": [*ltlc, "run", str(specification), str(bag)],
        "ltlc build": [*ltlc, "build", str(timed), "-o", str(folder / "timed.py")],
    }


def seconds(arguments: list[str], tree: Path) -> tuple[float, float]:
    """Of the CPU, and on the clock, of Python with `arguments`, in `tree`, from where it imports ltlc."""
    environment = {name: each for name, each in os.environ.items() if not name.startswith("PYTHON")}
    command = [sys.executable, *arguments]
    start, before = perf_counter(), os.times()
    done = subprocess.run(command, cwd=tree, env=environment, capture_output=True, text=True, check=False)
    wall, after = perf_counter() - start, os.times()
    if done.returncode:
        sys.exit(f"{' '.join(arguments)} ended with {done.returncode}: {done.stderr}")
    return sum(after[2:4]) - sum(before[2:4]), wall


if __name__ == "__main__":
    main()
