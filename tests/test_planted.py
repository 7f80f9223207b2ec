"""Every room of ltlc has tests that are named for it, and faults can be planted in each."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from benchmarks.planted.faults import faults
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
    planted = [fault for path in INSIDE[room][:3] for fault in list(faults(room, path))[:50]]
    assert planted
    for fault in planted:
        assert fault.right != fault.wrong
        if fault.path.suffix == ".py":
            ast.parse(fault.text)
