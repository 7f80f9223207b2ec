"""How many planted faults `ltlc check` finds: inconsistencies, redundant properties, vacuous parts, dead events.

    python -m benchmarks.analyses [--count N] [--properties N]

Each file has random properties with thresholds on shared signals, among which one fault is planted; its twin has the
same properties without it. Found means that the fault is reported at a planted property; the twin must not have it.
"""

from __future__ import annotations

import argparse
import random
from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

from ltlc.analysis.analyse import analyse
from ltlc.automata import Budget
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.semantics.encodings import EPISODE

SIGNALS = 12
FORMS = (
    "never ({a} and {b})",
    "always ({a} implies eventually {b})",
    "after {a}, eventually {b}",
    "after_until {a}, {b}, eventually {c}",
    "always ({a} or {b} or {c})",
    "eventually ({a} or {b})",
)


@dataclass(frozen=True)
class Plant:
    """Two ways to end a file: with a fault, of which the finding is called `finding`, and without it."""

    finding: str
    faulty: tuple[str, ...]
    sound: tuple[str, ...]


class Chance:
    """Random atoms and properties over the signals s0, s1, …."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)

    def atom(self) -> str:
        """A threshold on one of the signals."""
        return f"s{self._random.randrange(SIGNALS)} {self._random.choice('<>')} {self._random.randrange(1, 9)}"

    def property(self) -> str:
        """A property of one of `FORMS`."""
        return self._random.choice(FORMS).format(a=self.atom(), b=self.atom(), c=self.atom())


def recurrence_in_conflict(chance: Chance) -> Plant:
    a, b = chance.atom(), chance.atom()
    stated = f"always eventually ({a} and {b})"
    return Plant("inconsistent", (stated, f"after x > 5, never {a}", "eventually x > 6"), (stated, f"eventually {a}"))


def triple_in_conflict(chance: Chance) -> Plant:
    a = chance.atom()
    first, second = f"always (x > 5 implies eventually {a})", "eventually x > 6"
    return Plant("inconsistent", (first, second, f"never {a}"), (first, second, f"after y > 5, eventually {a}"))


def chain_in_conflict(chance: Chance) -> Plant:
    a = chance.atom()
    chain = (f"eventually (x > 5 and {a})", *(f"always ({p} > 5 implies {q} > 5)" for p, q in ("xy", "yz", "zw")))
    return Plant("inconsistent", (*chain, "never w > 5"), (*chain, "never w > 6"))


def weaker_copy(chance: Chance) -> Plant:
    a, b = chance.atom(), chance.atom()
    limit = f"after {a}, never x > 5"
    return Plant(
        "redundant", (limit, f"after {a}, never (x > 6 and {b})"), (limit, f"after {a}, never (y > 6 and {b})")
    )


def consequence_of_two(chance: Chance) -> Plant:
    a, b = chance.atom(), chance.atom()
    given = (f"always (x > 5 implies {a})", f"after {b}, x > 6")
    return Plant("redundant", (*given, f"after {b}, {a}"), (*given, f"after {b}, y > 6"))


def same_meaning(chance: Chance) -> Plant:
    a, b = chance.atom(), chance.atom()
    return Plant(
        "equivalent",
        (f"never (({a} and x > 5) or ({b} and x > 5))", f"always (x > 5 implies not ({a} or {b}))"),
        (f"never (({a} and x > 5) or ({b} and x > 5))", f"always (x > 6 implies not ({a} or {b}) and y > 5)"),
    )


def implied_part(chance: Chance) -> Plant:
    a, b = chance.atom(), chance.atom()
    return Plant(
        "vacuous-part",
        (f"after_until x < 1, x > 5, eventually ({a} or (y > 5 and y > 4) or {b})",),
        (f"after_until x < 1, x > 5, eventually ({a} or (y > 5 and z > 4) or {b})",),
    )


def dead_event(chance: Chance) -> Plant:
    a = chance.atom()
    limit = "never (x > 5 and y > 5)"
    return Plant(
        "never-triggered",
        (limit, f"after x > 6 and y > 7, eventually {a}"),
        (limit, f"after x > 6 and y > 3, eventually {a}"),
    )


def deadline_in_conflict(chance: Chance) -> Plant:
    a = chance.atom()
    soon, comes = f"always (x > 5 implies eventually {a} within {{}} s)", "eventually x > 6"
    wait = f"always (x > 5 implies never {a} within 10 s)"
    return Plant("inconsistent", (soon.format(5), wait, comes), (soon.format(15), wait, comes))


def deadline_excluded(chance: Chance) -> Plant:
    a = chance.atom()
    soon = f"always (x > 5 implies eventually {a} within {{}} ms)"
    wait = f"always (x > 6 implies never {a} within 2 s)"
    return Plant("excluded-deadline", (soon.format(200), wait), (soon.format(2500), wait))


def exchanged_bounds(chance: Chance) -> Plant:
    a, b = chance.atom(), chance.atom()
    stated = f"after {a}, within {{}} s, eventually ({b} or x > 5) within {{}} s"
    return Plant("idle-bound", (stated.format(2, 5),), (f"after {a}, eventually ({b} or x > 5) within 5 s",))


def looser_deadline(chance: Chance) -> Plant:
    a, b = chance.atom(), chance.atom()
    stated = f"always (({a} and x > 5) implies eventually {b} within {{}} s)"
    return Plant(
        "redundant", (stated.format(2), stated.format(3)), (stated.format(2), f"always (age(x) <= 3 s or {a})")
    )


PLANTS: tuple[Callable[[Chance], Plant], ...] = (
    recurrence_in_conflict,
    triple_in_conflict,
    chain_in_conflict,
    weaker_copy,
    consequence_of_two,
    same_meaning,
    implied_part,
    dead_event,
    deadline_in_conflict,
    deadline_excluded,
    exchanged_bounds,
    looser_deadline,
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=20, help="files of each kind")
    parser.add_argument("--properties", type=int, default=8, help="random properties in each file")
    arguments = parser.parse_args()
    print(f"{'planted':>22} {'finding':>16} {'found':>8} {'in twins':>9} {'seconds a file':>15}")
    for plant in PLANTS:
        report(plant, arguments.count, arguments.properties)


def report(plant: Callable[[Chance], Plant], count: int, properties: int) -> None:
    found = wrong = 0
    start = perf_counter()
    for seed in range(count):
        chance = Chance(seed)
        planted, others = plant(chance), [chance.property() for _ in range(properties)]
        found += planted.finding in findings(others, planted.faulty)
        wrong += planted.finding in findings(others, planted.sound)
    seconds = (perf_counter() - start) / count / 2
    name = plant.__name__.replace("_", " ")
    print(f"{name:>22} {planted.finding:>16} {found:>4}/{count:<3} {wrong:>5}/{count:<3} {seconds:>15.2f}")


def findings(others: list[str], planted: tuple[str, ...]) -> set[str]:
    """The names of what is found at `planted` properties, as the primary place or as another."""
    declarations = [f"decl {s} /{s} Float64.data" for s in (*(f"s{k}" for k in range(SIGNALS)), *"wxyz")]
    text = "\n".join([*declarations, *others, *planted])
    source = Source("planted", text)
    specification, diagnostics = load_text(source)
    if specification is None:
        raise ValueError(f"{diagnostics[0].message}\n{text}")
    first = len(text) - len("\n".join(planted))
    report = analyse(specification, EPISODE, Budget(30.0, 1024))
    return {
        d.name
        for d in report.diagnostics
        if any(label and label.span.start >= first for label in (d.primary, *d.secondary))
    }


if __name__ == "__main__":
    main()
