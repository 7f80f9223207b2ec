"""Times `check` and `build` on files of properties that differ in the robot only: `python -m benchmarks.fleet`.

Each line is a property of `examples/`' kind for one of N robots, written out; and the same by one `forall`. What is
measured is the whole command, in a process of its own, the median of `--runs`, sizes taken in turn.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

RULE = "after_until {0}.distance.stop_sign < 1, {0}.distance.stop_sign > 3, eventually {0}.velocity < 0.01"


def main() -> None:
    """Print a table of seconds."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=[10, 100, 1000])
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        files = dict(_files(Path(folder), options.sizes))
        commands = {
            "check": ["check"],
            "build": ["build", "--budget", "60,2048", "-o", str(Path(folder) / "monitor.py")],
        }
        seconds: dict[tuple[str, str], list[tuple[float, float]]] = {}
        for _ in range(options.runs):
            for name, path in files.items():
                for command, words in commands.items():
                    seconds.setdefault((command, name), []).append(_seconds([*words, str(path)]))
    print("| properties | check, s | of a CPU | build with gate, s | of CPUs |\n|---|---|---|---|---|")
    for name in files:
        shown = (f"{median(of_all):.1f}" for c in commands for of_all in zip(*seconds[c, name], strict=True))
        print(f"| {name} | {' | '.join(shown)} |")


def _files(folder: Path, sizes: list[int]) -> list[tuple[str, Path]]:
    """For each size a file written out and one with `forall`, by what the table calls them."""
    found = []
    for size in sizes:
        robots = [f"robot{k}" for k in range(size)]
        texts = {
            f"{size:,} written out": "".join(f"p{k}: {RULE.format(robot)}\n" for k, robot in enumerate(robots)),
            f"{size:,} by `forall`": f"p: forall r in {{{', '.join(robots)}}}: {RULE.format('r')}\n",
        }
        for number, (name, text) in enumerate(texts.items()):
            path = folder / f"fleet_{size}_{number}.txt"
            path.write_text(text)
            found.append((name, path))
    return found


def _seconds(arguments: list[str]) -> tuple[float, float]:
    """On the clock, and of CPUs, children included."""
    start, before = time.perf_counter(), os.times()
    subprocess.run([sys.executable, "-m", "ltlc", *arguments], check=True, capture_output=True)
    after = os.times()
    used = after.children_user + after.children_system - before.children_user - before.children_system
    return time.perf_counter() - start, used


if __name__ == "__main__":
    main()
