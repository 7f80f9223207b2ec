"""Milliseconds from a formula to its monitor, by both constructions, on patterns from the literature.

    python -m benchmarks.translation [--nested N]

The patterns are those that Spot generates: DAC (Dwyer, Avrunin and Corbett 1998), EH (Etessami and Holzmann 2000) and
HKRSS (Holeček et al. 2004); `nested` are N random properties of the language, four keywords deep. Every pair of
monitors is compared; a difference ends the program.
"""

from __future__ import annotations

import argparse
import random
import statistics
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import reduce
from importlib import import_module
from time import perf_counter

from ltlc.automata import Budget, Task, translate, translate_all, translate_by_progression
from ltlc.semantics import ltl, properties
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.ltl import Atom, Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import Property

FAMILIES = ("DAC", "EH", "HKRSS")


@dataclass(frozen=True)
class Measured:
    """What one formula cost, in milliseconds, and how large its monitor is."""

    by_spot: float
    by_progression: float
    states: int


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--nested", type=int, default=100, help="how many random properties")
    count = arguments.parse_args().nested
    translate(ltl.TRUE, Alphabet(()))  # imports Spot
    print(
        f"{'formulas':>20} {'Spot: median':>14} {'largest':>9} {'progression: median':>21} {'largest':>9} {'states':>7}"
    )
    for family in FAMILIES:
        report(family, [core(f) for f in spot_patterns(family)])
    report("nested", [encode(p, EPISODE) for p in random_properties(count)])
    print(f"\n100 properties in children, all different: {hundred_in_children():.0f} ms")
    print(f"import ltlc.automata: {import_time():.0f} ms more than a bare interpreter")


def report(name: str, formulas: list[Formula]) -> None:
    rows = [measure(formula) for formula in formulas]
    spot_times, progression_times = [r.by_spot for r in rows], [r.by_progression for r in rows]
    print(
        f"{f'{name} ({len(rows)})':>20} {statistics.median(spot_times):14.2f} {max(spot_times):9.2f} "
        f"{statistics.median(progression_times):21.2f} {max(progression_times):9.2f} {max(r.states for r in rows):7}"
    )


def measure(formula: Formula) -> Measured:
    alphabet = Alphabet(ltl.atoms(formula))
    by_spot, first = timed(translate, formula, alphabet)
    by_progression, second = timed(translate_by_progression, formula, alphabet)
    if first != second:
        sys.exit(f"the constructions differ on {formula}")
    return Measured(by_spot, by_progression, len(first.verdicts))


def timed(
    construction: Callable[[Formula, Alphabet], Monitor], formula: Formula, alphabet: Alphabet
) -> tuple[float, Monitor]:
    """The least of three times in milliseconds, and the monitor."""
    times = []
    for _ in range(3):
        start = perf_counter()
        monitor = construction(formula, alphabet)
        times.append((perf_counter() - start) * 1000)
    return min(times), monitor


def spot_patterns(family: str) -> Iterable[object]:
    generator = import_module("spot.gen")
    patterns: Iterable[object] = generator.ltl_patterns(getattr(generator, f"LTL_{family}_PATTERNS"))
    return patterns


def core(formula: object) -> Formula:
    """A formula of Spot's in core LTL."""
    operands = [core(operand) for operand in formula]  # type: ignore[attr-defined]
    name: str = formula.kindstr()  # type: ignore[attr-defined]
    match name:
        case "tt":
            return ltl.TRUE
        case "ff":
            return ltl.FALSE
        case "ap":
            return Atom(formula.ap_name())  # type: ignore[attr-defined]
        case "And" | "Or":
            return reduce(getattr(ltl, name), operands)
        case "Equiv":
            return ltl.And(ltl.implies(*operands), ltl.implies(*reversed(operands)))
        case _:
            return CONSTRUCTORS[name](*operands)


CONSTRUCTORS: dict[str, Callable[..., Formula]] = {
    "Not": ltl.Not,
    "X": ltl.Next,
    "F": ltl.eventually,
    "G": ltl.globally,
    "U": ltl.Until,
    "W": ltl.weak_until,
    "R": ltl.release,
    "M": ltl.strong_release,
    "Implies": ltl.implies,
}


def random_properties(count: int, depth: int = 4) -> Iterator[Property]:
    draw = random.Random(2026)
    for _ in range(count):
        yield random_property(draw, depth)


def random_property(draw: random.Random, depth: int) -> Property:
    def event() -> Atom:
        return Atom(draw.choice("abcdef"))

    if depth == 0:
        return properties.Throughout(event())
    body = random_property(draw, depth - 1)
    match draw.randrange(8):
        case 0:
            return properties.Always(body)
        case 1:
            return properties.Never(body)
        case 2:
            return properties.Eventually(body)
        case 3:
            return properties.After(event(), body)
        case 4:
            return properties.Until(event(), body)
        case 5:
            return properties.And(body, random_property(draw, depth - 1))
        case _:
            return properties.AfterUntil(event(), event(), body)


def hundred_in_children() -> float:
    """Milliseconds for 100 properties of different shapes, under a budget."""
    formulas = {encode(p, EPISODE): None for p in random_properties(400, depth=2)}
    tasks = [Task(formula, Alphabet(ltl.atoms(formula))) for formula in list(formulas)[:100]]
    start = perf_counter()
    translate_all(tasks, Budget())
    return (perf_counter() - start) * 1000


def import_time() -> float:
    return interpreter_time("import ltlc.automata") - interpreter_time("")


def interpreter_time(program: str) -> float:
    """The least of ten times of a new interpreter that runs `program`, in milliseconds."""
    times = []
    for _ in range(10):
        start = perf_counter()
        subprocess.run([sys.executable, "-c", program], check=True)
        times.append((perf_counter() - start) * 1000)
    return min(times)


if __name__ == "__main__":
    main()
