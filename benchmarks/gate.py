"""What share of wrong monitors, encodings and emitted code the gate catches: `python -m benchmarks.gate [SECONDS]`.

A mutant counts if it changes some verdict of some run; the others are not wrong. In time that is decided nanosecond by
nanosecond, with bounds of a few: `python -m benchmarks.gate time [COUNT]`, for so many mutants of each kind.
"""

from __future__ import annotations

import random
import sys
import time
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import TypeVar
from unittest import mock

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from code_mutants import code_mutants, difference
from exact_time import RunsOf
from hypothesis import HealthCheck, Phase, given, settings
from mutants import differ, formula_mutants, monitor_mutants
from replaying import judged
from strategies import properties
from support import compiled
from test_assurance_time import KINDS, Kind, is_noticed, program_of
from timed import compiled as compiled_in_time
from timed_mutants import MOST, Judged, class_text, clock_mutants, clocks_differ, code_differs
from timed_mutants import differ as runs_differ

from ltlc.assurance.certify import NotCertified
from ltlc.assurance.cross_check import cross_check
from ltlc.assurance.exactness import checked_certificate
from ltlc.assurance.programs import Standalone, load
from ltlc.assurance.replay import Deviation
from ltlc.assurance.runs import Mismatch
from ltlc.automata import Budget, translate
from ltlc.backends import emit
from ltlc.backends.python import standalone_classes
from ltlc.base.source import Source
from ltlc.compiler import Compiled, compile_specification
from ltlc.frontend.language import load_text
from ltlc.semantics.encodings import ENCODINGS, EPISODE
from ltlc.semantics.ltl import Atom
from ltlc.semantics.properties import After, AfterUntil, Always, Eventually, Now, Property, Until
from ltlc.semantics.trackers import trackers_of
from ltlc.semantics.words import all_letters

T = TypeVar("T")
SECOND = 10**9
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
                missed.append(difference(text, mutant))
    return count, missed


def wrong_in_time(count: int) -> None:
    """Wrong monitors, wrong clocks under the right monitor, and wrong code, of properties of every kind with clocks."""
    share = -(-count // len(KINDS))
    for kind, make in KINDS.items():
        for name, mutants in IN_TIME.items():
            found = list(islice(mutants(make), share))
            missed = [text for is_caught, text in found if not is_caught]
            print(f"{name} of {kind}: {len(found)} wrong, {len(found) - len(missed)} caught", flush=True)
            for line in missed:
                print(f"  not: {line}", flush=True)


def wrong_timed_monitors(make: Kind) -> Iterator[tuple[bool, str]]:
    """By certificate or cross-check."""
    small, large = compiled_in_time(make(3)), compiled_in_time(make(SECOND))
    right = RunsOf(small.formula, MOST)
    for other in shuffled(monitor_mutants(large.monitor)):
        mutant = Judged(right, replace(other, atoms=small.monitor.atoms))
        if runs_differ(Judged(right, small.monitor), mutant, right.letters):
            yield any(caught(replace(large, monitor=other))), str(other)


def wrong_clocks(make: Kind) -> Iterator[tuple[bool, str]]:
    """By the cross-check: certificate and monitor are made of the same clocks."""
    small, large = compiled_in_time(make(3)), compiled_in_time(make(SECOND))
    for short, long in shuffled(zip(clock_mutants(small.formula), clock_mutants(large.formula), strict=True)):
        if clocks_differ(small, short):
            with mock.patch("ltlc.assurance.walks.trackers_of", lambda _, found=long: found):
                yield is_noticed(large), str(set(long) - set(trackers_of(large.formula)))


def wrong_timed_code(make: Kind) -> Iterator[tuple[bool, str]]:
    """By the replay."""
    small, large = compiled_in_time(make(3)), compiled_in_time(make(SECOND))
    texts = [class_text(each) for each in (small, large)]
    for short, long in shuffled(zip(*(code_mutants(text, "Emitted") for text in texts), strict=True)):
        if code_differs(small, short):
            yield isinstance(judged(large, program_of(large, long)), Deviation), difference(texts[1], long)


IN_TIME = {"monitors": wrong_timed_monitors, "clocks": wrong_clocks, "emitted code": wrong_timed_code}


def shuffled(mutants: Iterable[T]) -> list[T]:
    found = list(mutants)
    random.Random(0).shuffle(found)
    return found


def report(name: str, outcomes: Iterator[tuple[bool, bool]]) -> None:
    results = list(outcomes)
    certificate, cross, either = (sum(map(f, results)) for f in (lambda r: r[0], lambda r: r[1], any))
    print(f"{name}: {len(results)} wrong, {either} caught ({certificate} by certificate, {cross} by cross-check)")


def main() -> None:
    if sys.argv[1:2] == ["time"]:
        wrong_in_time(int(sys.argv[2]) if len(sys.argv) > 2 else 300)
        return
    report("monitors", wrong_monitors(float(sys.argv[1]) if len(sys.argv) > 1 else 60.0))
    report("equations of encodings", wrong_equations())
    count, missed = wrong_code()
    print(f"emitted code: {count} changes, {count - len(missed)} caught; not caught:")
    for line in missed:
        print(f"  {line}")


if __name__ == "__main__":
    main()
