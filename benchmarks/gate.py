"""What share of wrong monitors, encodings and emitted code the gate catches: `python benchmarks/gate.py [SECONDS]`.

A mutant counts if it changes some verdict of some run; the others are not wrong.
"""

from __future__ import annotations

import ast
import random
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from code_mutants import code_mutants
from hypothesis import HealthCheck, Phase, given, settings
from mutants import differ, formula_mutants, monitor_mutants
from replaying import judged
from strategies import properties
from support import compiled

from ltlc.assurance.certify import NotCertified
from ltlc.assurance.cross_check import Mismatch, cross_check
from ltlc.assurance.gate import checked_certificate
from ltlc.assurance.programs import Standalone, load
from ltlc.assurance.replay import Deviation
from ltlc.automata import Budget, translate
from ltlc.backends import emit
from ltlc.backends.python import standalone_classes
from ltlc.compiler import Compiled, compile_specification
from ltlc.language import load_text
from ltlc.semantics.encodings import ENCODINGS, EPISODE
from ltlc.semantics.ltl import Atom
from ltlc.semantics.properties import After, AfterUntil, Always, Eventually, Now, Property, Until
from ltlc.semantics.words import all_letters
from ltlc.source import Source

TEXT = """
after_until robot.distance.sign < 1, robot.distance.sign > 1, eventually robot.velocity =={0.01} 0
never robot.velocity >{0.1} 2.0
never robot.position.x - @{robot.position.x, -2} > 0.2
after robot.velocity > 1, eventually 1 / robot.velocity > 3 or sqrt(robot.position.x) > 1
until robot.distance.sign < 1, robot.velocity < 1
"""


def caught(mutant: Compiled) -> tuple[bool, bool]:
    """Whether the certificate, and whether the cross-check, refuses `mutant`."""
    return isinstance(checked_certificate(mutant), NotCertified), isinstance(cross_check(mutant), Mismatch)


def wrong_monitors(seconds: float) -> Iterator[tuple[bool, bool]]:
    """Changed outputs, edges and initial states of the monitors of random properties."""
    found: list[Property] = []

    @settings(max_examples=400, derandomize=True, database=None, deadline=None, phases=[Phase.generate],
              suppress_health_check=list(HealthCheck))  # fmt: skip
    @given(properties(depth=2))
    def collect(property_: Property) -> None:
        found.append(property_)

    collect()
    end = time.monotonic() + seconds
    chance = random.Random(0)
    while time.monotonic() < end:
        right = compiled(chance.choice(found), chance.choice(list(ENCODINGS.values())))
        letters = all_letters(right.monitor.atoms)
        mutants = [m for m in monitor_mutants(right.monitor) if differ(right.monitor, m, letters)]
        for mutant in chance.sample(mutants, min(10, len(mutants))):
            yield caught(replace(right, monitor=mutant))


def wrong_equations() -> Iterator[tuple[bool, bool]]:
    """Changed formulas of the three scopes under each encoding.

    The certificate is about the monitor of the changed formula, so only the cross-check can notice.
    """
    x, y, z = Atom("x"), Atom("y"), Atom("z")
    for body in (Eventually(Now(z)), Always(Now(z))):
        for property_ in (After(x, body), Until(x, body), AfterUntil(x, y, body)):
            for encoding in ENCODINGS.values():
                right = compiled(property_, encoding)
                for formula in formula_mutants(right.formula):
                    monitor = translate(formula, right.specification.alphabet)
                    if differ(right.monitor, monitor, all_letters(right.specification.alphabet.atoms)):
                        yield caught(replace(right, formula=formula, monitor=monitor))


def wrong_code() -> tuple[int, list[str]]:
    """How many changes there are of emitted code, and those that the replay does not notice."""
    specification, _ = load_text(Source("props.txt", TEXT))
    assert specification is not None
    properties_, _ = compile_specification(specification, EPISODE, Budget())
    text = emit("python", properties_, specification)
    count, missed = 0, []
    for each, written in zip(properties_, standalone_classes(properties_, "props.txt"), strict=True):
        for mutant in code_mutants(text, written.name):
            module = load(mutant, "mutant")
            count += 1
            if not isinstance(judged(each, Standalone(module[written.name], written.parameters)), Deviation):
                changed = zip(ast.unparse(ast.parse(text)).splitlines(), mutant.splitlines(), strict=True)
                missed.append(next(new.strip() for old, new in changed if old != new))
    return count, missed


def report(name: str, outcomes: Iterator[tuple[bool, bool]]) -> None:
    results = list(outcomes)
    certificate, cross, either = (sum(map(f, results)) for f in (lambda r: r[0], lambda r: r[1], any))
    print(f"{name}: {len(results)} wrong, {either} caught ({certificate} by certificate, {cross} by cross-check)")


def main() -> None:
    report("monitors", wrong_monitors(float(sys.argv[1]) if len(sys.argv) > 1 else 60.0))
    report("equations of encodings", wrong_equations())
    count, missed = wrong_code()
    print(f"emitted code: {count} changes, {count - len(missed)} caught; not caught:")
    for line in missed:
        print(f"  {line}")


if __name__ == "__main__":
    main()
