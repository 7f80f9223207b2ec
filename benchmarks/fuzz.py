"""Looks for input that breaks ltlc: `python -m benchmarks.fuzz [--seconds N] [--seed N] [--keep FOLDER] [TARGET …]`.

Any file and any command line should give an answer or a diagnostic, within bounded time and memory: no traceback. Each
input runs in a process of its own (60 s, 2 GB). What breaks is kept, one folder each, where a test can replay it
(`tests/fixtures/fuzz`); of equal tracebacks one is kept. Exit code 1 if something broke.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections import Counter
from itertools import count
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from fuzzing import TARGETS, Case, broken_by, drawn

BATCH = 10


class Hunt:
    """What was tried of each target, and what broke, by what it broke with."""

    def __init__(self, keep: Path) -> None:
        self.tried: Counter[str] = Counter()
        self.broken: dict[str, Path] = {}
        self._keep = keep

    def batch(self, target: str, seed: int) -> None:
        """Try `BATCH` inputs of `target`."""
        for case in drawn(TARGETS[target], BATCH, seed):
            self._try(target, case)

    def _try(self, target: str, case: Case) -> None:
        self.tried[target] += 1
        problem = broken_by(case)
        if problem is None:
            return
        lines = problem.strip().splitlines()
        signature = "\n".join([line for line in lines if line.startswith("  File")][-1:] + lines[-1:])
        if signature in self.broken:
            return
        folder = self._keep / f"{target}_{len(self.broken) + 1}"
        case.save(folder)
        self.broken[signature] = folder
        print(f"{folder}: {' '.join(case.arguments)}\n{problem}", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description="Look for input that breaks ltlc.")
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=f"of {', '.join(TARGETS)}; default: all")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, default=None, help="where to put what breaks; default: a new folder")
    options = parser.parse_args()
    if unknown := set(options.targets) - set(TARGETS):
        parser.error(f"there is no target {', '.join(sorted(unknown))}")
    hunt = Hunt(options.keep or Path(tempfile.mkdtemp(prefix="broken")))
    end = time.monotonic() + options.seconds
    rounds = ((target, seed) for seed in count(options.seed) for target in options.targets or TARGETS)
    for target, seed in rounds:
        if time.monotonic() > end:
            break
        hunt.batch(target, seed)
    counts = ", ".join(f"{number} {target}" for target, number in hunt.tried.items())
    print(f"{counts}; {len(hunt.broken)} broke (seeds from {options.seed})")
    return 1 if hunt.broken else 0


if __name__ == "__main__":
    sys.exit(main())
