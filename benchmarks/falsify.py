"""How many simulations find a fault of the robot in `examples/falsify`: by `ltlc falsify`, and by uniform draws.

    python -m benchmarks.falsify --seeds 7 --simulations 300 [FAULT…]

Those of the search count, not those of shrinking. A search that finds nothing counts as one more than it may make.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

import ltlc
from ltlc.falsification.parameters import space_of

EXAMPLES = Path(__file__).parents[1] / "examples" / "falsify"
sys.path.insert(0, str(EXAMPLES))
robot = import_module("robot")
PROPERTIES = EXAMPLES / "robot.txt"


def searched(fault: int, most: int, seed: int) -> int:
    """How many simulations `ltlc falsify` makes until a property is violated."""
    seen = []

    def simulate(given: Mapping[str, Any]) -> list[dict[str, Any]]:
        if given in seen:
            raise RuntimeError("what was found is simulated again, so that it can be shrunk")
        seen.append(given)
        rows: list[dict[str, Any]] = robot.simulate(given, fault)
        return rows

    found = ltlc.falsify(PROPERTIES, simulate, robot.PARAMETERS, simulations=most, seed=seed)
    return int(found.document()["simulations"]) if found.violated is not None else most + 1


def drawn(fault: int, most: int, seed: int) -> int:
    """The same where all parameters are drawn uniformly."""
    space, rng = space_of(robot.PARAMETERS, (), None), np.random.default_rng(seed)
    for count in range(1, most + 1):
        given = space.assignment(rng.random(space.dimension).tolist()).document()
        if ltlc.run(PROPERTIES, robot.simulate(given, fault)).violations:
            return count
    return most + 1


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a table with the medians."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("faults", nargs="*", type=int, default=range(1, len(robot.FAULTS)))
    parser.add_argument("--seeds", type=int, default=7)
    parser.add_argument("--simulations", type=int, default=300)
    options = parser.parse_args(arguments)
    print("| fault | ltlc falsify | found | uniform draws | found |\n|---|---|---|---|---|")
    for fault in options.faults:
        cells = []
        for search in (searched, drawn):
            counts = [search(fault, options.simulations, seed) for seed in range(options.seeds)]
            found, middle = sum(count <= options.simulations for count in counts), median(counts)
            cells += [f"{middle:g}" if middle <= options.simulations else f"> {options.simulations}"]
            cells += [f"{found} of {options.seeds}"]
        print(f"| {fault}: {robot.FAULTS[fault]} | {' | '.join(cells)} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
