"""The worked examples of properties of each id in `docs/language.md` find what they are there for."""

from __future__ import annotations

import json
import re
from pathlib import Path
from textwrap import dedent
from typing import Any

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
    {"time": 61, "goal": ["b"], "status": [4]},
]
"""A goal that vanishes, a part that is fixed too late, a joint overloaded for 2 s, and a track lost nearby."""

VIOLATED = {"ends": ["a"], "kept": ["a"], "fixed": ["arm"], "weak": ["elbow"], "lost": [7]}


def test_each_worked_example_names_the_ids_that_violate_it(tmp_path: Path) -> None:
    (text,) = re.findall(
        r"^\*\*Worked examples\.\*\*[^\n]*\n(?:\S[^\n]*\n)*\n((?: {4}[^\n]*\n|\n)+)", PAGE, re.MULTILINE
    )
    path = tmp_path / "drive.jsonl"
    path.write_text("".join(f"{json.dumps(row)}\n" for row in ROWS), encoding="utf-8")
    document = json.loads(run(*from_text(dedent(text)), path).json())
    found = {each["label"]: [one["id"] for one in each["each"]["violated"]] for each in document["properties"]}
    assert found == VIOLATED
