"""Looks for damaged recordings that break `ltlc run`.

    python -m benchmarks.damage [--seconds N] [--seed N] [--journal FILE]
    python -m benchmarks.damage --count [--journal FILE]
    python -m benchmarks.damage --again SEED [--keep FOLDER]

Each seed is a small bag, a table, JSON lines or what a campaign keeps, in which bytes, numbers, records, cells or
messages are changed (`tests/damaging.py`), judged in a process of its own. A traceback, an exit code that says
anything else than what is printed, more than 20 s of a CPU or more than 1 GB count as broken. What was tried is kept
in a journal, a line for each seed, so that a hunt that was stopped goes on. Exit code 1 if something broke.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from time import monotonic
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from damaging import damaged, problem_with

JOURNAL = Path(__file__).parents[1] / "build" / "damage.jsonl"


def main() -> int:
    """Hunt, or say what was found."""
    parser = argparse.ArgumentParser(description="Look for damaged recordings that break `ltlc run`.")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0, help="the first seed")
    parser.add_argument("--journal", type=Path, default=JOURNAL)
    parser.add_argument("--count", action="store_true", help="only say what was tried")
    parser.add_argument("--again", type=int, metavar="SEED", help="only one seed")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="with --again: write its files to this folder")
    options = parser.parse_args()
    if options.again is not None:
        return again(options.again, options.keep)
    if not options.count:
        hunt(options.journal, options.seed, options.seconds)
    return counted(options.journal)


def again(seed: int, keep: Path | None) -> int:
    """Show what is wrong with one seed."""
    case = damaged(seed)
    if keep is not None:
        case.save(keep)
    problem = problem_with(case)
    print(f"{' '.join(case.arguments)}\n{problem or 'as it should be'}")
    return 1 if problem else 0


def hunt(journal: Path, first: int, seconds: float) -> None:
    """Try seeds that the journal has not, until the time is over."""
    journal.parent.mkdir(parents=True, exist_ok=True)
    done, end = {line["seed"] for line in lines(journal)}, monotonic() + seconds
    for seed in (seed for seed in count(first) if seed not in done):
        if monotonic() > end:
            return
        case = damaged(seed)
        problem = problem_with(case)
        with journal.open("a") as file:
            file.write(json.dumps({"seed": seed, "form": case.arguments[2], "problem": problem}) + "\n")
        if problem:
            print(f"seed {seed}: {' '.join(case.arguments)}\n{problem}", flush=True)


def lines(journal: Path) -> Iterator[dict[str, Any]]:
    """What the journal has."""
    if journal.exists():
        yield from map(json.loads, journal.read_text().splitlines())


def counted(journal: Path) -> int:
    """Say what was tried, and what broke."""
    tried = list(lines(journal))
    broke = [line["seed"] for line in tried if line["problem"]]
    forms = ", ".join(f"{number} {form}" for form, number in sorted(Counter(line["form"] for line in tried).items()))
    print(f"{len(tried)} damaged recordings ({forms}); {len(broke)} broke: {', '.join(map(str, broke)) or 'none'}")
    return 1 if broke else 0


if __name__ == "__main__":
    sys.exit(main())
