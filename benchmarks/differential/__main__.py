"""Differential testing of all that ltlc makes of a specification, against a reference written from the definition.

    nice -n 19 python -m benchmarks.differential [--seconds N] [--seed N] [--every N] [--having TEXT] [--journal FILE]
    python -m benchmarks.differential --count [--journal FILE]
    python -m benchmarks.differential --again SEED [--having TEXT] [--keep FOLDER]
    python -m benchmarks.differential --each [--seconds N] [--seed N] [--every N] [--journal FILE] [--again SEED]

Each seed is a specification of ten properties and twelve recordings of it, or, with `--each`, a property of each id or
of each message, and six recordings. What was compared is kept in a journal, a line for each seed, so that a campaign
that was stopped goes on, and several can share one (`--seed 0 --every 2`, `--seed 1 --every 2`). `--again` makes what
differs small, and prints it as a specification and a table. Exit code 1 if something differs.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import monotonic
from typing import Any

from benchmarks.differential import each
from benchmarks.differential.campaign import Difference, Outcome, outcome, seeds
from benchmarks.differential.fixtures import save, table
from benchmarks.differential.shrink import again, shrunk

ROOT = Path(__file__).parents[2]
SHOWN = 12
"""So many differences of a seed are in the journal; `--again SEED` finds all."""

JOURNAL = ROOT / "build" / "differential.jsonl"


def main() -> int:
    """Run the campaign, or say what it has compared."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0, help="the first seed")
    parser.add_argument("--every", type=int, default=1, help="take each of so many seeds, the others are another's")
    parser.add_argument("--having", default="", metavar="TEXT", help="only properties in whose text this is")
    parser.add_argument("--each", action="store_true", help="properties of each id and of each message")
    parser.add_argument("--journal", type=Path)
    parser.add_argument("--count", action="store_true", help="only say what has been compared")
    parser.add_argument("--again", type=int, metavar="SEED", help="only one seed, and make small what differs")
    parser.add_argument(
        "--keep", type=Path, metavar="FOLDER", help="with --again: write what differs to it, as fixtures"
    )
    options = parser.parse_args()
    if options.each and (options.having or options.keep):
        parser.error("--having and --keep are for properties of whole runs")
    judged = each.outcome if options.each else partial(outcome, having=options.having)
    if options.again is not None:
        found, anew = judged(options.again).differences, each.again if options.each else again
        return show(found, partial(shrunk, anew=anew), options.keep, f"seed_{options.again}")
    options.journal = options.journal or JOURNAL.with_stem("differential_each" if options.each else JOURNAL.stem)
    if not options.count:
        hunt(options, judged)
    return count(options.journal)


def hunt(options: argparse.Namespace, judged: Callable[[int], Outcome]) -> None:
    """Take seeds that the journal has not, until the time is over."""
    options.journal.parent.mkdir(parents=True, exist_ok=True)
    done = {line["seed"] for line in lines(options.journal)}
    end, commit = monotonic() + options.seconds, _commit()
    for seed in seeds(options.seed, options.every, done):
        if monotonic() > end:
            return
        line = {"seed": seed, "commit": commit, **document(judged(seed))}
        with options.journal.open("a") as file:
            file.write(json.dumps(line) + "\n")


def _commit() -> str:
    done = subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    return done.stdout.strip()


def document(of: Outcome) -> dict[str, Any]:
    """An outcome as the journal has it."""
    shown = [{"way": d.way, "property": _line(d), "problem": d.problem[:200]} for d in of.differences[:SHOWN]]
    different = Counter(each.way for each in of.differences)
    numbers = {"steps": of.steps, "runs": of.runs, "early": of.early, "late": of.late, "different": different}
    return {**numbers, "differences": shown}


def _line(of: Difference) -> str:
    label = of.label.split("[")[0]
    settings = [line for line in of.text.splitlines() if line.startswith("_")]
    mine = [line for line in of.text.splitlines() if label and line.startswith(f"{label}:")]
    return "; ".join([*settings, *mine])


def lines(journal: Path) -> list[dict[str, Any]]:
    """What the journal has; a last line that was cut off is none."""
    found = []
    for line in journal.read_text().splitlines() if journal.exists() else []:
        try:
            found.append(json.loads(line))
        except json.JSONDecodeError:
            continue
    return found


def count(journal: Path) -> int:
    """Print what has been compared; 1 if something differs."""
    steps, runs, different, known = Counter[str](), Counter[str](), Counter[str](), lines(journal)
    for line in known:
        steps.update(line["steps"])
        runs.update(line["runs"])
        different.update(line["different"])
    print("| way | properties on recordings | steps | that differ |\n|---|---|---|---|")
    for way, number in steps.most_common():
        print(f"| {way} | {runs[way]:,} | {number:,} | {different[way]:,} |")
    early, late = sum(line["early"] for line in known), sum(line["late"] for line in known)
    print(f"\n{len(known):,} seeds, {steps.total():,} steps; {early:,} verdicts earlier, {late:,} a nanosecond later")
    commits = Counter(line["commit"] for line in known)
    print(f"commits: {', '.join(f'{commit} ({number})' for commit, number in commits.items())}")
    for line in known:
        for one in line["differences"]:
            print(f"seed {line['seed']}, {one['way']}: {one['property']}: {one['problem'][:120]}")
    return 1 if different else 0


def show(
    differences: list[Difference], smaller: Callable[[Difference], Difference], keep: Path | None, name: str
) -> int:
    """Print what differs as a specification and a table, one case for each property, and write it to `keep`."""
    seen: set[tuple[str, str]] = set()
    for one in differences:
        if (one.label, one.text) in seen:
            continue
        seen.add((one.label, one.text))
        small = smaller(one)
        print(f"== {small.way}, from {small.since} until {small.until}: {small.problem}\n{small.text}")
        print(table(small))
        if keep is not None:
            save(small, keep, f"{name}_{len(seen)}")
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
