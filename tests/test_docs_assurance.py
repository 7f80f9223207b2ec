"""What `docs/assurance.md` says that exact certificates do not cover: its examples are certified, and are late."""

from __future__ import annotations

import re
from pathlib import Path
from random import Random
from typing import Any

import pytest

import ltlc
from ltlc.assurance.exactness import checked_certificate
from ltlc.automata import Budget
from ltlc.base.source import Source
from ltlc.compiler import Compiled, compile_specification
from ltlc.frontend.language import load_text
from ltlc.semantics.certificate import Certificate
from ltlc.semantics.encodings import EPISODE

DECLARATIONS = """decl d /d Float64.data
decl e /e Float64.data
decl n /n UInt8.data
decl scan /scan LaserScan.ranges
decl mode /mode std_msgs/String.data
decl last /last std_msgs/String.data
decl docked /docked Bool.data
model robot: velocity /odom Odometry.twist.twist.linear ;
"""
TEXT = (Path(__file__).parent.parent / "docs" / "assurance.md").read_text(encoding="utf-8")
SECTION = TEXT.partition("## What exact does not cover")[2].partition("\n## ")[0]
EXAMPLES = [
    example for row in re.findall(r"^\|.*\|(.*)\|$", SECTION, re.MULTILINE) for example in re.findall(r"`([^`]*)`", row)
]
AT_A_RATE = re.search(r"`(eventually [^`]*within 500 ms)`", SECTION)


def compiled(property_: str, settings: str = "") -> Compiled:
    specification, _ = load_text(Source("example", f"{DECLARATIONS}{settings}\n{property_}\n"))
    assert specification is not None, property_
    (found,), _ = compile_specification(specification, EPISODE, Budget())
    return found


def rows(seed: int) -> list[dict[str, Any]]:
    """Values of all signals, then now and then of some, as small as the constants of the examples are."""
    random = Random(seed)
    found = []
    for time in range(40):
        numbers = {name: random.choice([-1.0, 0.5, 1.5, 2.5, 4.0, 6.0]) for name in ("d", "e")}
        values: dict[str, Any] = {
            **numbers,
            "n": random.choice([0, 200, 255]),
            "scan": [random.choice([-1.0, 0.5, 1.5, 2.5]) for _ in range(random.randint(1, 5))],
            "mode": random.choice("ab"),
            "last": random.choice("ab"),
            "docked": random.random() < 0.3,
            **{f"robot.velocity.{axis}": random.choice([-4.0, 0.0, 0.5, 4.0]) for axis in "xyz"},
        }
        kept = values if not time else {name: value for name, value in values.items() if random.random() < 0.5}
        if any(name.startswith("robot") for name in kept):
            kept |= {name: value for name, value in values.items() if name.startswith("robot")}
        found.append({"time": float(time), **kept})
    return found


def test_each_row_has_an_example() -> None:
    assert len(EXAMPLES) == 13


@pytest.mark.parametrize("property_", EXAMPLES)
def test_an_example_is_certified_exactly_and_no_run_satisfies_it_which_is_not_reported_at_once(property_: str) -> None:
    assert isinstance(checked_certificate(compiled(property_)), Certificate)
    drives = [rows(seed) for seed in range(30)]
    begun = ltlc.run_each(f"{DECLARATIONS}p: {property_}", [drive[:2] for drive in drives])
    assert {run["p"].verdict for run in begun} >= {ltlc.Verdict.PRESUMABLY_VIOLATED}
    ended = ltlc.run_each(f"{DECLARATIONS}p: {property_}", drives)
    assert {run["p"].verdict for run in ended} <= {ltlc.Verdict.PRESUMABLY_VIOLATED, ltlc.Verdict.VIOLATED}


def test_what_a_rate_excludes_is_reported_when_the_bound_is_over() -> None:
    assert AT_A_RATE
    assert isinstance(checked_certificate(compiled(AT_A_RATE.group(1), "_rate_ = 1")), Certificate)
    runs = ltlc.run_each(f"{DECLARATIONS}_rate_ = 1\np: {AT_A_RATE.group(1)}", map(rows, range(30)))
    decided = [run["p"].decided for run in runs]
    assert {each and each.time for each in decided} == {500_000_001}
