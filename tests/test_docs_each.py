"""The worked examples of properties of each id in `docs/language.md` find what they are there for."""

from __future__ import annotations

import json
import re
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest
from stepping import from_text

from ltlc.monitoring.judging.run import run

PAGE = (Path(__file__).parents[1] / "docs/language.md").read_text(encoding="utf-8")

ROWS: list[dict[str, Any]] = [
    {"time": 0, "goal": ["a", "b"], "status": [1, 2]},
    {"time": 1, "part": ["arm", "base"], "level": [2, 0]},
    {"time": 2, "track": [7, 8], "x": [1.0, 3.0], "y": [0.5, 0.0]},
    {"time": 3, "goal": ["b"], "status": [4]},
    {"time": 4, "joint": ["elbow", "wrist"], "effort": [-50.0, 3.0]},
    {"time": 5, "track": [], "x": [], "y": []},
    {"time": 6, "joint": ["elbow", "wrist"], "effort": [-45.0, 60.0]},
    {"time": 6.5, "part": ["arm"], "level": [0]},
    {"time": 7, "joint": ["elbow", "wrist"], "effort": [1.0, 2.0]},
    {"time": 8, "node": "planner", "logged": 40},
    {"time": 8, "node": "driver", "logged": 20},
    {"time": 61, "goal": ["b"], "status": [4]},
]
"""A goal vanishes, a part is fixed too late, a joint overloaded for 2 s, a track lost nearby, an error logged."""

VIOLATED = {"ends": ["a"], "kept": ["a"], "fixed": ["arm"], "weak": ["elbow"], "lost": [7], "quiet": ["planner"]}


RECORDED = Path(__file__).parents[2] / "shared" / "data" / "bags" / "tb3_kf"
(EXAMPLES,) = re.findall(
    r"^\*\*Worked examples\.\*\*[^\n]*\n(?:\S[^\n]*\n)*\n((?: {4}[^\n]*\n|\n)+)", PAGE, re.MULTILINE
)


def judged(recording: Path, *more: str) -> dict[str, Any]:
    """What is found of each worked example, and of `more` properties, in a recording."""
    document = json.loads(run(*from_text("\n".join([dedent(EXAMPLES), *more])), recording).json())
    return {each["label"]: each["each"] for each in document["properties"]}


def test_each_worked_example_names_the_ids_that_violate_it(tmp_path: Path) -> None:
    path = tmp_path / "drive.jsonl"
    path.write_text("".join(f"{json.dumps(row)}\n" for row in ROWS), encoding="utf-8")
    found = {label: [one["id"] for one in each["violated"]] for label, each in judged(path).items()}
    assert found == VIOLATED


@pytest.mark.skipif(not RECORDED.is_dir(), reason="there are no recordings of others in ../shared/data")
def test_each_node_of_the_log_of_a_real_recording_is_judged_by_itself() -> None:
    """Its /rosout has 17 messages of two nodes, none of which logs an error, and both of which fall silent."""
    found = judged(RECORDED, "speaks: each n of node: always age(logged) <= 10 s")
    assert {label: (each["messages"], each["ids"]) for label, each in found.items() if each["ids"]} == {
        "quiet": (17, 2),
        "speaks": (17, 2),
    }
    assert not found["quiet"]["violated"]
    assert [one["id"] for one in found["speaks"]["violated"]] == ["rosbag2_player", "rosbag2_recorder"]
