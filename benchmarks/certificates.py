"""Certificates, measured: how many monitors are certified, how long it takes, and whether a wrong one ever is.

    python -m benchmarks.certificates [properties] [corrupted monitors] [seed]

prints a JSON document; `benchmarks/certificates.json` is that of a run with 1000 properties and 10000 monitors.
"""

from __future__ import annotations

import json
import random
import statistics
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from ltlc.assurance.certify import certify
from ltlc.automata import translate
from ltlc.frontend.language import load
from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.certificate import Answer, Certificate, check
from ltlc.semantics.certificate_reader import parse
from ltlc.semantics.certificate_text import Entry, to_text
from ltlc.semantics.encodings import ENCODINGS, EPISODE, encode
from ltlc.semantics.ltl import Atom, Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import Property
from ltlc.semantics.words import all_letters

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))
from cases import Kind
from exact_time import TooManyError, judge
from mutants import differ, monitor_mutants
from timed import Draw, clocks, monitor_of, ordinary_atoms

DEEPEST = 3
MOST_ATOMS = 12
MOST_ATOMS_TO_CORRUPT = 8
"""Whether a changed monitor differs is found out letter by letter."""


def draw_predicate(chance: random.Random, atoms: Sequence[str], depth: int = 2) -> Formula:
    kind = chance.choice(["atom", "atom", "atom", "not", "and", "or"]) if depth else "atom"
    if kind == "atom":
        return Atom(chance.choice(atoms))
    if kind == "not":
        return ltl.Not(draw_predicate(chance, atoms, depth - 1))
    make = ltl.And if kind == "and" else ltl.Or
    return make(draw_predicate(chance, atoms, depth - 1), draw_predicate(chance, atoms, depth - 1))


def draw_property(chance: random.Random, atoms: Sequence[str], depth: int) -> Property:
    if depth == 0:
        leaves: list[type[p.Now | p.Throughout]] = [p.Now, p.Throughout]
        return chance.choice(leaves)(draw_predicate(chance, atoms))
    kind: Kind = chance.choice(
        [p.Not, p.And, p.Or, p.Implies, p.Always, p.Never, p.Eventually, p.After, p.Until, p.AfterUntil, p.AfterUntil]
    )
    if kind in (p.Not, p.Always, p.Never, p.Eventually):
        return kind(draw_property(chance, atoms, depth - 1))
    if kind in (p.And, p.Or, p.Implies):
        return kind(draw_property(chance, atoms, depth - 1), draw_property(chance, atoms, depth - 1))
    events = [draw_predicate(chance, atoms, 1) for _ in range(2 if kind is p.AfterUntil else 1)]
    return kind(*events, draw_property(chance, atoms, depth - 1))


def draw(chance: random.Random) -> Property:
    atoms = [f"p{number}" for number in range(chance.randint(1, MOST_ATOMS))]
    return draw_property(chance, atoms, chance.randint(1, DEEPEST))


def timed(action: Any, *arguments: Any) -> tuple[Any, float]:
    start = time.perf_counter()
    result = action(*arguments)
    return result, 1000 * (time.perf_counter() - start)


def summary(values: Sequence[float]) -> dict[str, float]:
    ordered = sorted(values)
    return {
        "median": round(statistics.median(ordered), 2),
        "p99": round(ordered[int(len(ordered) * 0.99)], 2),
        "largest": round(ordered[-1], 2),
    }


def measure_properties(chance: random.Random, count: int) -> dict[str, Any]:
    answers: dict[str, int] = {"exact": 0, "certified": 0, "not certified": 0}
    made, checked, sizes, read_back = [], [], [], 0
    for _ in range(count):
        property_ = draw(chance)
        encoding = chance.choice(list(ENCODINGS.values()))
        formula = encode(property_, encoding)
        alphabet = Alphabet(ltl.atoms(formula))
        found, spent = timed(certify, formula, alphabet, translate(formula, alphabet))
        made.append(spent)
        if not isinstance(found, Certificate):
            answers["not certified"] += 1
            continue
        answer, spent = timed(check, found)
        checked.append(spent)
        answers["exact" if answer.exact else "certified" if answer.certified else "not certified"] += 1
        text = to_text([Entry("property", 1, property_, encoding.name, found)])
        sizes.append(len(text.encode()))
        read_back += check(parse(text)[0].certificate) == answer
    return {
        "properties": count,
        "answers": answers,
        "milliseconds to make": summary(made),
        "milliseconds to check": summary(checked),
        "bytes as text": summary(sizes),
        "same answer when read back": read_back,
    }


def corrupted(chance: random.Random) -> Iterator[tuple[Certificate, Monitor]]:
    """Certificates, each with a monitor that is not the one it is about and gives another verdict on some run."""
    while True:
        property_ = draw(chance)
        formula = encode(property_, chance.choice(list(ENCODINGS.values())))
        alphabet = Alphabet(ltl.atoms(formula))
        monitor = translate(formula, alphabet)
        certificate = certify(formula, alphabet, monitor)
        if len(monitor.atoms) > MOST_ATOMS_TO_CORRUPT or not isinstance(certificate, Certificate):
            continue
        letters = all_letters(monitor.atoms)
        mutants = list(monitor_mutants(monitor))
        for mutant in chance.sample(mutants, min(len(mutants), 20)):
            if differ(monitor, mutant, letters):
                yield certificate, mutant


def answer_for(certificate: Certificate, monitor: Monitor) -> list[Answer]:
    """What the checker says of the certificate with another monitor in it, and of one that is made for that monitor."""
    kept = Certificate(
        certificate.formula,
        certificate.assumption,
        monitor,
        certificate.annotations,
        certificate.levels,
        certificate.witnesses,
    )
    made = certify(certificate.formula, Alphabet(monitor.atoms), monitor)
    return [check(kept), *([check(made)] if isinstance(made, Certificate) else [])]


def measure_corrupted(chance: random.Random, count: int) -> dict[str, int]:
    """A verdict that is only less decided than it could be is right, and may be certified, but never as exact."""
    exact = certified = 0
    for (certificate, monitor), _ in zip(corrupted(chance), range(count), strict=False):
        answers = answer_for(certificate, monitor)
        exact += any(answer.exact for answer in answers)
        certified += any(answer.certified for answer in answers)
    return {"monitors": count, "accepted": exact, "certified as right but not exact": certified - exact}


def measure_examples() -> dict[str, dict[str, float | str]]:
    """Every property of `examples/`, in the default encoding; `milliseconds` is to make and check its certificate."""
    found: dict[str, dict[str, float | str]] = {}
    root = Path(__file__).parent.parent
    for path in sorted((root / "examples").rglob("*.txt")):
        specification, _ = load(path)
        for each in specification.properties if specification else ():
            formula = encode(each.property, EPISODE)
            monitor = translate(formula, each.alphabet)
            certificate, making = timed(certify, formula, each.alphabet, monitor)
            answer, checking = timed(check, certificate) if isinstance(certificate, Certificate) else (None, 0.0)
            verdict = "exact" if answer and answer.exact else "not certified exactly"
            name = f"{path.relative_to(root)}: {each.label}"
            found[name] = {"answer": verdict, "milliseconds": round(making + checking, 2)}
    return found


def measure_thirty_atoms() -> dict[str, dict[str, float | bool]]:
    """Thirty atoms that are free, and thirty thresholds of one signal, which have thirty-one letters."""
    names = tuple(f"d > {number}" for number in range(30))
    above = [Atom(name) for name in names]
    opening, closing, aim = map(ltl.disjunction, (above[:10], above[10:20], above[20:]))
    free = p.AfterUntil(opening, closing, p.Eventually(p.Now(aim)))
    in_a_band = ltl.disjunction(ltl.And(above[k], ltl.Not(above[k + 1])) for k in range(0, 29, 2))
    one_signal = p.AfterUntil(above[25], ltl.Not(above[2]), p.Eventually(p.Now(in_a_band)))
    thresholds = Group(names, tuple(frozenset(names[:k]) for k in range(31)))
    found: dict[str, dict[str, float | bool]] = {}
    for title, property_, groups in (("free", free, ()), ("one signal", one_signal, (thresholds,))):
        alphabet = Alphabet(names, groups)
        formula = encode(property_, EPISODE)
        certificate, making = timed(certify, formula, alphabet, translate(formula, alphabet))
        answer, checking = timed(check, certificate)
        found[title] = {"exact": answer.exact, "ms to make": round(making, 1), "ms to check": round(checking, 1)}
    return found


def measure_timed(count: int) -> dict[str, Any]:
    """Properties with up to three clocks; `never late` by an oracle that tries all times, where it can."""
    found: dict[str, Any] = {}
    for seed in range(count):
        property_ = Draw(seed).property(most_clocks=3)
        formula, monitor = encode(property_, EPISODE), monitor_of(property_)
        row = found.setdefault(f"{clocks(property_)} clocks", Counter())
        certificate = certify(formula, Alphabet(ordinary_atoms(formula)), monitor)
        answer = check(certificate) if isinstance(certificate, Certificate) else Answer(False, False)
        row.update(properties=1, certified=answer.certified, exact=answer.exact)
        with suppress(TooManyError):
            findings = judge(formula, monitor, most=600)
            on_time = findings.missing == 0
            row.update({"judged in time": 1, "wrong": findings.wrong > 0, "never late": on_time})
            row.update({"never late, not exact": on_time > answer.exact, "late, exact": answer.exact > on_time})
    return dict(sorted(found.items()))


def main() -> None:
    count, wrong, seed = (*map(int, sys.argv[1:]), *(1000, 10_000, 1)[len(sys.argv) - 1 :])
    chance = random.Random(seed)
    result = {
        "seed": seed,
        "random": measure_properties(chance, count),
        "with clocks": measure_timed(count),
        "examples": measure_examples(),
        "thirty atoms": measure_thirty_atoms(),
        "corrupted": measure_corrupted(chance, wrong),
    }
    print(json.dumps(result, indent=2))


if __name__ == "__main__":
    main()
