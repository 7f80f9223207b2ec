"""Seconds that `ltlc check` takes, process and all: one property, the paper's examples, and large files.

    python benchmarks/check.py [--repeat N]

The goals on two cores: one property 0.3 s; the paper's examples, in one file, 1 s; 100 properties on 40 shared signals
10 s. On a busy machine look at the seconds of a CPU, which children share. The last file has 200 properties and a
budget of 5 s: it must end, and say what was not decided.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

EXAMPLES = Path(__file__).parent.parent / "tests" / "fixtures" / "check"
PAPER = ("stop_sign", "speeding", "more_of_the_readme", "rotation_by_history")
ONE = "stop: after_until robot.distance.sign < 1, robot.distance.sign > 1, eventually robot.velocity =={0.01} 0\n"
FORMS = (
    "never {a} and {b}",
    "always ({a} implies eventually {b})",
    "after {a}, {b} or {c}",
    "after_until {a}, {b}, eventually {c}",
    "until {a}, {b}",
    "eventually {a} and {b}",
    "always ({a} or {b} or {c})",
    "after_until {a}, {b}, {c}",
    "always (after {a}, eventually ({b} or {c}))",
    "after {a}, until {b}, {c}",
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=3, help="the smallest time of so many is shown")
    repeat = parser.parse_args().repeat
    paper = "\n".join((EXAMPLES / f"{name}.txt").read_text(encoding="utf-8-sig") for name in PAPER)
    files = {
        "one property": (ONE, "30"),
        "the paper's examples": (paper, "30"),
        "100 properties, 40 signals": (random_file(100, 40, seed=0), "30"),
        "200 properties, 5 s": (random_file(200, 40, seed=1), "5"),
    }
    print(f"{'file':>28} {'properties':>10} {'seconds':>8} {'of a CPU':>10}  findings")
    for name, (text, budget) in files.items():
        report(name, text, budget, repeat)


def report(name: str, text: str, budget: str, repeat: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "props.txt"
        path.write_text(text, encoding="utf-8")
        command = [sys.executable, "-m", "ltlc.cli", "check", "--format", "json", "--budget", budget, str(path)]
        times, processor = [], []
        for _ in range(repeat):
            start, before = perf_counter(), os.times()
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            after = os.times()
            times.append(perf_counter() - start)
            processor.append(sum(after[2:4]) - sum(before[2:4]))
    found = json.loads(done.stdout)
    counts: dict[str, int] = {}
    for diagnostic in found["diagnostics"]:
        counts[diagnostic["name"]] = counts.get(diagnostic["name"], 0) + 1
    summary = ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items()))
    print(f"{name:>28} {len(found['properties']):>10} {min(times):>8.2f} {min(processor):>10.2f}  {summary}")


def random_file(properties: int, signals: int, seed: int) -> str:
    """A specification with thresholds on shared signals."""
    chance = random.Random(seed)

    def atom() -> str:
        return f"s{chance.randrange(signals)} {chance.choice('<>')} {chance.randrange(1, 10)}"

    lines = [f"decl s{k} /topic{k} Float64.data" for k in range(signals)]
    lines += [f"p{k}: " + chance.choice(FORMS).format(a=atom(), b=atom(), c=atom()) for k in range(properties)]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
