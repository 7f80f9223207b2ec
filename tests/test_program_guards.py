"""Guards as programs: where they may rest is what their region says, in emitted text and along runs."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from math import nan
from typing import ClassVar

import pytest
from effort import share_of, some_of
from guarding import programs

from benchmarks.guarded import CMD, EXAMPLES, SCAN, Driven
from ltlc.assurance.reading.files import written
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.backends import ros2
from ltlc.backends.python.load import load_plan
from ltlc.interfaces.building.guards import difference
from ltlc.monitoring.guarding import recording
from ltlc.monitoring.guarding.arrangement import Arrangement
from ltlc.monitoring.guarding.followed import Followed
from ltlc.program.resting import Held, Resting
from ltlc.runtime.guard_plans import NO, YES, Asks
from ltlc.runtime.guarding import Values
from ltlc.runtime.session import Plan
from ltlc.runtime.watching import Watching


@pytest.mark.parametrize(("number", "name"), [*enumerate(EXAMPLES)], ids=[*EXAMPLES])
def test_a_program_rests_where_its_region_does_and_nowhere_else(number: int, name: str) -> None:
    _, compiled, entries, guards = programs(EXAMPLES[name].text)
    for program, entry in zip(guards, entries, strict=True):
        assert difference(program, entry, compiled) is None
        for wrong in some_of(mutants(program.resting), number):
            assert difference(replace(program, resting=wrong), entry, compiled) is not None, wrong


def mutants(resting: Resting) -> Iterator[Resting]:
    """Each with one decision, one question or one condition that is another; none leads to itself."""
    for number, (asked, low, high) in enumerate(resting.decisions):
        changed = [(asked, high, low), (asked, low, low), (asked, high, high)]
        changed += [(asked, YES if low == NO else NO, high), (asked, low, YES if high == NO else NO)]
        for each in changed:
            decisions = [*resting.decisions]
            decisions[number] = type(decisions[number])(*each)
            yield replace(resting, decisions=tuple(decisions))
    for one, other in pairwise(range(len(resting.questions))):
        questions = [*resting.questions]
        questions[one] = questions[other]
        yield replace(resting, questions=tuple(questions))
    if len(resting.conditions) > 1:
        first, second, *rest = resting.conditions
        yield replace(resting, conditions=(second, first, *rest))
    for number, held in enumerate(resting.conditions):
        conditions = [*resting.conditions]
        conditions[number] = Held(held.inputs, held.known, held.known)
        yield replace(resting, conditions=tuple(conditions))


@pytest.mark.parametrize(("number", "name"), [*enumerate(EXAMPLES)], ids=[*EXAMPLES])
def test_what_a_plan_says_of_a_guard_is_read_back(number: int, name: str) -> None:
    specification, compiled, _, guards = programs(EXAMPLES[name].text)
    code = ros2.emit(compiled, specification, guards)
    of = [each.machine for each in compiled], [each.specification for each in compiled]
    assert all(
        not isinstance(each, Difference) and isinstance(each.read_back(), ReadBack)
        for each in written(code, *of, guards)
    )
    found = [*faults(code)]
    for old, new in [*some_of(found, number), *(each for each in found if RARE in each[0])]:
        assert isinstance(written(code.replace(old, new), *of, guards)[0], Difference), (old, new)


RARE = "Asks.KNOWN"
"""What few plans have."""


def faults(code: str) -> Iterator[tuple[str, str]]:
    """Texts in the part about guards, and others in their place."""
    part = code[code.index("GuardPlan(") :].split("\n\n\n")[0]
    wrong = {
        "lead=1": "lead=2",
        "parts=(0": "parts=(1",
        "most=(": "most=(7, ",
        "rests=-1": "rests=1",
        "(0, -2,": "(0, 1,",
    }
    wrong |= {f"Asks.{one.name}": f"Asks.{other.name}" for one, other in pairwise(Asks)}
    yield from ((old, new) for old, new in wrong.items() if old in part)
    yield part, part.replace("GuardPlan(", "Plan(")
    if "def guard_holds" in code:
        holds = code[code.index("def guard_holds") :].split("\n\n")[0]
        body = holds[holds.index("return ") :]
        yield body, "return True"


class _Beside(Followed):
    """A run by the reference interpreters of the region, beside that by the program of the guard in `plan`."""

    plan: ClassVar[Plan]

    def __init__(self, arrangement: Arrangement, began: int) -> None:
        super().__init__(arrangement, began)
        (own,) = (each for each in self.plan.guards if each.outs == arrangement.arena.outs)
        self.watching = Watching(self.plan, own, began)

    def fork(self) -> _Beside:
        other = object.__new__(type(self))
        vars(other).update(vars(super().fork()))
        other.watching = self.watching.fork()
        return other

    def hear(self, time: int, topic: str, values: Values) -> None:
        super().hear(time, topic, values)
        self.watching.hear(time, topic, values)
        self._compare()

    def hold(self, until: int) -> None:
        super().hold(until)
        if self.watching.time <= until:
            self.watching.hold(until)

    def _compare(self) -> None:
        for name in ("time", "is_blind", "is_silent", "has_begun", "violated", "rests"):
            assert getattr(self.watching, name) == getattr(self, name), name
        # What only the reference waits for changes nothing.
        if self.violated is None and (due := self.watching.due()) is not None:
            assert (self.due() or due) <= due


@pytest.mark.parametrize("name", EXAMPLES)
def test_along_a_run_the_program_rests_where_the_region_has_it(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    specification, compiled, _, guards = programs(EXAMPLES[name].text)
    monkeypatch.setattr(_Beside, "plan", load_plan(compiled, specification, guards=guards), raising=False)
    monkeypatch.setattr(recording, "Followed", _Beside)
    driven = Driven(EXAMPLES[name])
    assert all(sum(driven.run(random.Random(seed), 60).values()) for seed in range(share_of(8)))


MISSING = (
    "near",
    "slew rate",
    "battery low",
    "two fallbacks",
    "two guards",
    "no faster than a share of the first speed",
)


@pytest.mark.parametrize("name", MISSING)
def test_along_a_run_in_which_values_are_missing_the_program_is_where_the_reference_is(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    specification, compiled, _, guards = programs(EXAMPLES[name].text)
    monkeypatch.setattr(_Beside, "plan", load_plan(compiled, specification, guards=guards), raising=False)
    monkeypatch.setattr(recording, "Followed", _Beside)
    values = {
        topic: {signal: [*of, *map(_missing, of)] for signal, of in signals.items()}
        for topic, signals in EXAMPLES[name].values.items()
    }
    driven = Driven(replace(EXAMPLES[name], values=values))
    found = sum((driven.run(random.Random(seed), 40) for seed in range(share_of(20))), Counter[str]())
    assert found["passed"]


def _missing(value: object) -> object:
    """NaN in the place of a number."""
    return (nan,) if isinstance(value, tuple) else nan if isinstance(value, float) else value


def test_a_command_without_a_value_makes_the_program_blind() -> None:
    specification, compiled, _, guards = programs(EXAMPLES["slew rate"].text)
    plan = load_plan(compiled, specification, guards=guards)
    watching = Watching(plan, plan.guards[0], 0)
    speeds, blind = [0.0, 0.1, float("nan"), 0.1, 0.1], [False, False, True, True, False]
    for time, (speed, is_blind) in enumerate(zip(speeds, blind, strict=True)):
        watching.hear(time, "/cmd_vel", {"speed": speed})
        assert watching.is_blind is is_blind


def test_a_program_goes_on_from_a_fork_by_itself() -> None:
    specification, compiled, _, guards = programs(
        f"{CMD}{SCAN}p: never (speed > 5 and once min(scan) < 0.5 3 times within 10 s)"
    )
    plan = load_plan(compiled, specification, guards=guards)
    watching = Watching(plan, plan.guards[0], 0)
    watching.hear(0, "/cmd_vel", {"speed": 6.0})
    watching.hear(1, "/scan", {"scan": (0.1,)})
    other = watching.fork()
    for time, scan in enumerate([0.9, 0.1, 0.9, 0.1], start=2):
        other.hear(time, "/scan", {"scan": (scan,)})
    for time, scan in enumerate([0.9, 0.1], start=6):
        watching.hear(time, "/scan", {"scan": (scan,)})
    assert other.violated == ("p", False)
    assert watching.violated is None
