"""The families of the Timescales benchmark that ltlc can say, beside reelay: the verdict at each row, larger bounds.

    python -m benchmarks.timescales [--peers SITE-PACKAGES] [--rows N] [--rounds N]
    python -m benchmarks.timescales --agree N [--peers SITE-PACKAGES] [--seed N]

Formulas are those of Ulus, Timescales: A Benchmark Generator for MTL Monitoring Tools (RV 2019), with rows a second
apart. They speak of rows only; `new` says that, for ltlc's past is that of signals. `SAID` has six families; `UNSAID`
are those with a lower bound in the past, for which a monitor in continuous time would have to keep everything that
happened within it (LTL308). The recordings are made anew here: each holds at every row but the last.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from benchmarks.columns import Judged, Prepared, columns_over, medians
from ltlc.assurance.programs import load
from ltlc.backends import emit
from ltlc.backends.python import standalone_classes
from ltlc.inputs.recordings.blocks import Block, Samples
from ltlc.runtime.session import Session
from ltlc.semantics.verdicts import Verdict

SECOND = 1_000_000_000
Recorded = Mapping[str, NDArray[np.bool_]]
Part = tuple[int, str, str]
"""So many rows, in which these signals are true, those are either, and others are false."""
Course = Callable[[random.Random, int], list[Part]]


@dataclass(frozen=True)
class Family:
    """A formula for one bound `{b}`, in s, as reelay and ltlc have it, without the `historically` around it.

    mtl: in reelay's syntax
    ltlc: the property, `always` included
    repeats: one round of a recording for which it holds
    ends: after which it does not, at the last row
    """

    mtl: str
    ltlc: str
    repeats: Course
    ends: Course

    @property
    def names(self) -> list[str]:
        """The signals."""
        return [name for name in "pqr" if f"{{{name}}}" in self.mtl]


def recurring(chance: random.Random, bound: int) -> list[Part]:
    """`q`, then `p` again and again in time, then `r`."""
    found: list[Part] = [(1, "q", "")]
    for _ in range(chance.randint(1, 7)):
        found += [(chance.randint(1, bound) - 1, "", ""), (1, "p", "")]
    return [*found, (chance.randint(1, bound) - 1, "", ""), (1, "r", ""), (chance.randrange(bound), "", "")]


SINCE_Q = "always (new q and once (new q and q) within {b} s implies (new q implies %s) since (new q and q))"
SAID = {
    "AbsentAQ": Family(
        "(once[:{b}] {q}) -> ((not {p}) since {q})",
        SINCE_Q % "not p",
        lambda chance, b: [(1, "q", ""), (b, "", ""), (b, "", "p")],
        lambda chance, b: [(1, "q", ""), (b - 1, "", ""), (1, "p", "")],
    ),
    "AbsentBR": Family(
        "{r} -> (historically[:{b}] (not {p}))",
        "always (new r and r implies not once (new p and p) within {b} s)",
        lambda chance, b: [(b, "", "p"), (b, "", ""), (1, "r", "")],
        lambda chance, b: [(1, "p", ""), (b - 1, "", ""), (1, "r", "")],
    ),
    "AlwaysAQ": Family(
        "(once[:{b}] {q}) -> ({p} since {q})",
        SINCE_Q % "p",
        lambda chance, b: [(1, "pq", ""), (b, "p", ""), (b, "", "p")],
        lambda chance, b: [(1, "pq", ""), (b - 1, "p", ""), (1, "", "")],
    ),
    "AlwaysBR": Family(
        "{r} -> (historically[:{b}] {p})",
        "always (new r and r implies not once (new p and not p) within {b} s)",
        lambda chance, b: [(b, "", "p"), (b, "p", ""), (1, "pr", "")],
        lambda chance, b: [(1, "", ""), (b - 1, "p", ""), (1, "pr", "")],
    ),
    "RecurGLB": Family(
        "once[:{b}] {p}",
        "always (new p implies once (new p and p) within {b} s)",
        lambda chance, b: [(1, "p", ""), (chance.randint(1, b) - 1, "", "")],
        lambda chance, b: [(1, "p", ""), (b + 1, "", "")],
    ),
    "RecurBQR": Family(
        "({r} and not {q} and once {q}) -> ((once[:{b}] ({p} or {q})) since {q})",
        "always (new r and r and not q and once (new q and q)"
        " implies (new q implies once (new p and (p or q)) within {b} s) since (new q and q))",
        recurring,
        lambda chance, b: [(1, "q", ""), (b + 1, "", ""), (1, "r", "")],
    ),
}
UNSAID = {
    "AbsentBQR": "({r} and not {q} and once {q}) -> ((not {p}) since[{a}:{b}] {q})",
    "AlwaysBQR": "({r} and not {q} and once {q}) -> ({p} since[{a}:{b}] {q})",
    "RespondGLB": "({s} -> once[{a}:{b}] {p}) and not (not {s} since[{b}:] {p})",
    "RespondBQR": "({r} and not {q} and once {q})"
    " -> ((({s} -> once[{a}:{b}] {p}) and not (not {s} since[{b}:] {p})) since {q})",
}


def judged(family: Family, bound: int) -> Judged:
    """The property for one bound."""
    return Judged([family.ltlc.format(b=bound)], family.names)


def recorded(family: Family, bound: int, rows: int, chance: random.Random) -> Recorded:
    """At least so many rows for which it holds, then some of which the last violates it."""
    parts: list[Part] = []
    count = 0
    while count < rows:
        more = family.repeats(chance, bound)
        parts += more
        count += sum(each for each, _, _ in more)
    parts += family.ends(chance, bound)
    return {name: _column(name, parts, chance) for name in family.names}


def _column(name: str, parts: list[Part], chance: random.Random) -> NDArray[np.bool_]:
    counts = [count for count, _, _ in parts]
    values = np.repeat([name in true for _, true, _ in parts], counts)
    either = np.repeat([name in free for _, _, free in parts], counts)
    drawn = np.random.default_rng(chance.getrandbits(32)).random(len(values)) < 0.5
    return np.where(either, drawn, values)


def random_rows(family: Family, rows: int, chance: random.Random) -> Recorded:
    """Rows of any values, each signal true as often as chance has it."""
    often = {name: chance.choice((0.05, 0.2, 0.5, 0.8, 0.95)) for name in family.names}
    return {name: np.array([chance.random() < share for _ in range(rows)]) for name, share in often.items()}


def block(columns: Recorded) -> Block:
    """Rows a second apart."""
    rows = np.arange(len(next(iter(columns.values()))))
    return Block(rows * SECOND, {name: Samples(rows, values) for name, values in columns.items()}, {})


def emitted(of: Judged, names: list[str]) -> Callable[[Recorded], int | None]:
    """Steps a new monitor of the emitted class a row at a time; gives the row from which on it is violated."""
    [written] = standalone_classes(of.compiled, "props.txt")
    step = load(emit("python", of.compiled, of.specification), "emitted")[written.name](0).step
    order = [names.index(told.name) if told.name in names else len(names) for _, told in written.parameters]

    def violated(columns: Recorded) -> int | None:
        first = None
        for row, values in enumerate(zip(*(columns[name].tolist() for name in names), strict=True)):
            given = (*values, True)
            if step(row * SECOND, *[given[place] for place in order]).value == "violated" and first is None:
                first = row
        return first

    return violated


def violated_at(session: Session) -> int | None:
    """The row from which on the property is violated."""
    [track] = session.tracks
    return track.decided_at.time // SECOND if track.verdict is Verdict.VIOLATED and track.decided_at else None


def values_of(family: Family, bound: int, columns: Recorded, mtl: str = "historically({})") -> Iterator[bool]:
    """What reelay shows at each row: by default whether the formula has held so far."""
    import reelay

    formula = family.mtl.format(b=bound, **{name: f"{{{name}}}" for name in family.names})
    monitor = reelay.discrete_timed_monitor(pattern=mtl.format(formula), semantics="boolean", condense=False)
    for row in zip(*(columns[name].tolist() for name in family.names), strict=True):
        yield monitor.update(dict(zip(family.names, row, strict=True)))["value"]


def agree(count: int, seed: int) -> None:
    """Compare verdicts at each row, on so many recordings a family: by columns, by rows, emitted, and reelay's."""
    for name, family in SAID.items():
        chance, violated = random.Random(f"{name} {seed}"), 0
        for bound in range(1, 7):
            ours = judged(family, bound)
            for _ in range(-(-count // 6)):
                columns = random_rows(family, 60, chance)
                first = next((row for row, value in enumerate(values_of(family, bound, columns)) if not value), None)
                session = ours.session()
                session.take(block(columns))
                by_rows = violated_at(ours.by_rows(block(columns)))
                found = violated_at(session.session), by_rows, emitted(ours, family.names)(columns)
                if found != (first,) * 3:
                    sys.exit(f"{name}, bound {bound}: reelay {first}; by columns, by rows, emitted {found}: {columns}")
                violated += first is not None
        print(
            f"{name}: {6 * -(-count // 6)} recordings of 60 rows, {violated} of them violated: all the same", flush=True
        )


def beside_reelay(rows: int, rounds: int) -> None:
    """Bounds ×1, ×10, ×100 on recordings of so many rows; the emitted class and reelay take a row at a time."""
    bounds = (10, 100, 1000)
    heads = [f"{way} ×{bound // 10}" for way in ("columns", "emitted", "reelay") for bound in bounds]
    print(f"| ns a row | {' | '.join(heads)} |\n|{'---|' * 10}")
    for name, family in SAID.items():
        found: dict[str, float] = {}
        for bound in bounds:
            columns = recorded(family, bound, rows, random.Random(name))
            whole = block(columns)
            ours = judged(family, bound)
            session = ours.session()
            session.take(whole)
            assert violated_at(session.session) == len(whole.times) - 1
            ways: dict[str, Prepared] = {
                f"columns ×{bound // 10}": columns_over(ours, whole),
                f"emitted ×{bound // 10}": _stepping(ours, family, columns),
                f"reelay ×{bound // 10}": partial(partial, _taken, family, bound, columns),
            }
            found |= {way: time / len(whole.times) for way, time in medians(ways, rounds).items()}
        print(f"| {name} | {' | '.join(f'{found[head]:,.0f}' for head in heads)} |", flush=True)


def _stepping(of: Judged, family: Family, columns: Recorded) -> Prepared:
    return lambda: partial(emitted(of, family.names), columns)


def _taken(family: Family, bound: int, columns: Recorded) -> None:
    deque(values_of(family, bound, columns), 0)


def main() -> None:
    """Print a table in Markdown, or compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--peers", metavar="SITE-PACKAGES", help="a further folder to import reelay from")
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--agree", type=int, metavar="N", help="only compare verdicts, on N recordings of each family")
    parser.add_argument("--seed", type=int, default=0, help="of the recordings of --agree")
    options = parser.parse_args()
    if options.peers:
        sys.path.append(options.peers)
    if options.agree is not None:
        agree(options.agree, options.seed)
    else:
        beside_reelay(options.rows, options.rounds)


if __name__ == "__main__":
    main()
