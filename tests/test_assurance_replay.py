"""The replay accepts emitted code that does what its monitor does, and notices code that does not."""

from __future__ import annotations

import ast

import pytest
from code_mutants import code_mutants

from ltlc.assurance.replay import Deviation, Replayed, load, replay, standalone_stepper, starters
from ltlc.automata import Budget
from ltlc.backends import emit
from ltlc.backends.python import standalone_classes
from ltlc.compiler import Compiled, compile_specification
from ltlc.language import load_text
from ltlc.semantics.encodings import EPISODE
from ltlc.source import Source
from ltlc.specification.specification import Specification

PROPERTIES = {
    "stop sign": "after_until robot.distance.sign < 1, robot.distance.sign > 1, eventually robot.velocity == 0",
    "margin": "never robot.velocity >{0.1} 2.0",
    "history": "never robot.position.x - @{robot.position.x, -2} > 0.2",
    "arithmetic": "after robot.velocity > 1, eventually 1 / robot.velocity > 3 or sqrt(robot.position.x) > 1",
    "array": "decl scan /scan LaserScan.ranges\nalways min(scan) > 0.3",
    "string": 'decl mode /mode String.data\nuntil mode == "done", mode != "fault"',
    "boolean": "decl enabled /enabled Bool.data\nafter enabled, eventually not enabled",
}


def compiled_text(text: str) -> tuple[Specification, list[Compiled]]:
    specification, diagnostics = load_text(Source("props.txt", text))
    assert specification is not None, diagnostics
    compiled, problems = compile_specification(specification, EPISODE, Budget())
    assert not problems
    return specification, compiled


@pytest.mark.parametrize("target", ["python", "ros2"])
@pytest.mark.parametrize("text", PROPERTIES.values(), ids=PROPERTIES)
def test_emitted_code_does_what_its_monitor_does(text: str, target: str) -> None:
    specification, compiled = compiled_text(text)
    starts = starters(target, emit(target, compiled, specification), compiled, specification)
    assert starts is not None
    for each, start in zip(compiled, starts, strict=True):
        assert isinstance(replay(each, start), Replayed)


@pytest.mark.parametrize("text", [PROPERTIES["stop sign"], PROPERTIES["margin"]], ids=["stop sign", "margin"])
def test_every_change_of_emitted_code_that_changes_a_verdict_is_caught(text: str) -> None:
    specification, compiled = compiled_text(text)
    emitted = emit("python", compiled, specification)
    (written,) = standalone_classes(compiled, specification.source.name)
    missed = []
    for mutant in code_mutants(emitted, written.name):
        module = load(mutant, "mutant")
        if isinstance(
            replay(compiled[0], lambda m=module: standalone_stepper(m[written.name], written.parameters)), Replayed
        ):
            missed.append(_difference(emitted, mutant))
    assert [line for line in missed if not _changes_no_verdict(line)] == []


def _difference(emitted: str, mutant: str) -> str:
    lines = zip(ast.unparse(ast.parse(emitted)).splitlines(), mutant.splitlines(), strict=True)
    return next(new.strip() for old, new in lines if old != new)


def _changes_no_verdict(line: str) -> bool:
    """Counting invalid steps, and the name or the short cut of a state that nothing leaves."""
    return "self.invalid" in line or line in ("self.state = 4", "if self.state == 4:")


def test_code_that_raises_is_a_deviation_and_not_an_accident() -> None:
    _, (compiled,) = compiled_text(PROPERTIES["margin"])

    def start():
        return lambda sample, values: 1 / 0

    outcome = replay(compiled, start)
    assert isinstance(outcome, Deviation)
    assert outcome.emitted.startswith("ZeroDivisionError")
    assert len(outcome.run) == 1


@pytest.mark.parametrize("target", ["hoa", "dot", "json"])
def test_an_output_that_is_no_code_is_not_replayed(target: str) -> None:
    specification, compiled = compiled_text(PROPERTIES["margin"])
    assert starters(target, emit(target, compiled, specification), compiled, specification) is None
