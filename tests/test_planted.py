"""Every room of ltlc has tests that are named for it, and faults can be planted in each."""

from __future__ import annotations

import ast
import json
from itertools import islice
from pathlib import Path

import pytest
from coverage import CoverageData

from benchmarks.planted.faults import faults
from benchmarks.planted.recording import Recorded
from benchmarks.planted.rooms import ROOMS, files, named_for

INSIDE = files()


def test_every_room_of_the_tree_has_tests_that_are_named_for_it() -> None:
    assert sorted(INSIDE) == sorted(ROOMS)
    assert [room for room in ROOMS if not named_for(room)] == []


@pytest.mark.parametrize("room", ROOMS)
def test_every_pattern_of_a_room_matches_a_file_of_tests(room: str) -> None:
    folder = Path(__file__).parent
    assert [pattern for pattern in ROOMS[room].split() if not list(folder.glob(pattern))] == []


@pytest.mark.parametrize("room", ROOMS)
def test_faults_can_be_planted_in_every_room_and_each_changes_what_is_there(room: str) -> None:
    planted = [fault for path in INSIDE[room][:3] for fault in islice(faults(room, path), 15)]
    assert planted
    for fault in planted:
        assert fault.right != fault.wrong
        if fault.path.suffix == ".py":
            ast.parse(fault.text)


def test_the_tests_that_run_a_line_are_those_recorded_for_it_here_or_in_a_child(tmp_path: Path) -> None:
    """A recording that was cut off while it was written is omitted."""
    recorded = {
        "t.py::a": {"ltlc/x.py": [1, 2]},
        "t.py::b (call)": {str(tmp_path / "whole/ltlc/x.py"): [2, 3]},
        "t.py::failed": {"ltlc/x.py": [2]},
    }
    for number, (test, lines) in enumerate(recorded.items()):
        data = CoverageData(basename=str(tmp_path / f"lines.{number}"))
        data.set_context(test)
        data.add_lines(lines)
    (tmp_path / "lines.broken").write_bytes((tmp_path / "lines.0").read_bytes()[:5000])
    outcomes = {"t.py::a": "passed", "t.py::b": "passed", "t.py::failed": "failed"}
    times = [json.dumps([test, 0.1, outcome]) for test, outcome in outcomes.items()]
    (tmp_path / "times-t.jsonl").write_text("\n".join(times))
    found = Recorded(tmp_path)
    assert found.running(Path("ltlc/x.py"), range(1, 2)) == {"t.py::a"}
    assert found.running(Path("ltlc/x.py"), range(2, 3)) == {"t.py::a", "t.py::b"}
    assert found.running(Path("ltlc/x.py"), range(3, 4)) == {"t.py::b"}
    assert found.running(Path("ltlc/y.py"), range(3, 4)) == set()
