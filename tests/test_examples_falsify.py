"""The MuJoCo robot of the examples: it keeps its properties without a fault, and faults are found and shrunk."""

from __future__ import annotations

import json
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

import ltlc
from ltlc.falsification.parameters import space_of

pytest.importorskip("mujoco", reason="needs MuJoCo: install ltlc[simulation]")

EXAMPLES = Path(__file__).parent.parent / "examples" / "falsify"
PROPERTIES = EXAMPLES / "robot.txt"


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(EXAMPLES)
    return import_module("robot")


@pytest.mark.parametrize("fault", [1, 3])
def test_a_fault_is_found_and_shrunk_to_parameters_that_violate(robot: Any, fault: int) -> None:
    """Which property is violated first depends on how a machine rounds."""
    found = ltlc.falsify(PROPERTIES, partial(robot.simulate, fault=fault), robot.PARAMETERS, simulations=300)
    assert found.violated is not None
    assert found.parameters is not None
    again = ltlc.run(PROPERTIES, robot.simulate(found.parameters, fault))
    assert found.violated in {each.label for each in again.violations}


def test_the_robot_without_a_fault_keeps_its_properties(robot: Any) -> None:
    found = ltlc.falsify(PROPERTIES, partial(robot.simulate, fault=0), robot.PARAMETERS, simulations=20)
    assert (found.violated, found.exit_code) == (None, 0)


def test_the_example_is_a_command_as_the_page_calls_it(robot: Any, tmp_path: Path) -> None:
    defaults = space_of(robot.PARAMETERS, (), None).defaults().document()
    parameters, recording = tmp_path / "parameters.json", tmp_path / "recording.csv"
    parameters.write_text(json.dumps(defaults), encoding="utf-8")
    robot.main(["0", str(parameters), str(recording)])
    assert ltlc.run(PROPERTIES, recording).verdicts == ltlc.run(PROPERTIES, robot.simulate(defaults, 0)).verdicts
