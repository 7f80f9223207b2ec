"""What comparing lowered machines with their monitors takes, and refuses: `python -m benchmarks.lowering [RUNS]`.

Every field of every machine of the documentation's properties, and of some for each feature, is changed to all that it
might be instead. A change that is not refused has to be harmless: on RUNS drawn runs (20) the machine does what it did.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from lowered import cases, shown
from machine_mutants import mutants

from ltlc.assurance.lowered.equality import Equal, compare
from ltlc.assurance.lowered.letters import Judged
from ltlc.automata.folding import fold
from ltlc.program.properties import machine_of


def spent(work: Callable[[], object]) -> float:
    """Milliseconds of a CPU, the median of five."""
    found = []
    for _ in range(5):
        before = time.process_time()
        work()
        found.append((time.process_time() - before) * 1e3)
    return median(found)


def main(runs: int) -> None:
    """Print what lowering and comparing take, and what became of the changes of each kind."""
    lowering, comparing = list[float](), list[float]()
    tried, same, other = Counter[str](), Counter[str](), Counter[str]()
    for machine, of, _ in cases():
        judged = Judged(of.specification, of.formula, of.monitor)
        folded = fold(of.formula, of.specification.alphabet, of.monitor, of.specification.scopes())
        lowering.append(spent(partial(machine_of, of.specification, folded)))
        comparing.append(spent(partial(compare, machine, judged)))
        for what, mutant in mutants(machine):
            tried[what] += 1
            if isinstance(compare(mutant, judged), Equal):
                is_same = all(shown(mutant, machine, seed) == shown(machine, machine, seed) for seed in range(runs))
                (same if is_same else other)[what] += 1
    for name, found in (("lowering", lowering), ("comparing", comparing)):
        print(f"{name}: {median(found):.2f} ms, at most {max(found):.1f}; {len(found)} properties")
    print("| changed | changes | refused | harmless | accepted though it does something else |\n|---|---|---|---|---|")
    for what, count in sorted(tried.items()):
        print(f"| {what} | {count:,} | {count - same[what] - other[what]:,} | {same[what]} | {other[what]} |")
    total, harmless, wrong = tried.total(), same.total(), other.total()
    print(f"| all | {total:,} | {total - harmless - wrong:,} | {harmless} | {wrong} |")


if __name__ == "__main__":
    main(*(map(int, sys.argv[1:]) if len(sys.argv) > 1 else [20]))
