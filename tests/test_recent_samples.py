"""`@{s, -N:}`, the last samples of a signal as an array: `docs/language.md`, 'Signals'."""

from __future__ import annotations

import math
from random import Random

import pytest
from language_support import codes_of, only_property
from replaying import outcomes
from stepping import ns, session

from ltlc.analysis.atom_words import atom_text
from ltlc.assurance.replay import Replayed
from ltlc.specification.expressions import Recent

DECLARED = """\
decl x /x Float64.data
decl g /g Float64.data
decl n /n Int64.data
decl on /on Bool.data
decl goal /goal PoseStamped.pose.position
decl scan /scan LaserScan.ranges
"""


def test_they_are_the_last_ones_oldest_first_and_a_nan_among_them_makes_no_step() -> None:
    chance = Random(0)
    for last in (1, 2, 4):
        run = session(f"{DECLARED}never any(@{{x, -{last}:}} > 99) and g > 99\n")
        (track,) = run.tracks
        place = [str(wanted) for wanted in track.property.inputs].index(f"@{{x, -{last}:}}")
        sampled: list[float] = []
        run.message(0, "/g", [0.0])
        for time in range(1, 40):
            topic = chance.choice(["/x", "/x", "/g"])
            value = chance.choice([1.0, 2.0, 3.0, 4.0, math.nan if topic == "/x" else 0.0])
            sampled += [value] if topic == "/x" else []
            steps = track.steps
            run.message(ns(float(time)), topic, [value])
            recent = tuple(sampled[-last - 1 :])
            is_step = len(recent) == last + 1 and not any(map(math.isnan, recent))
            assert (track.steps > steps) == is_step
            assert not is_step or track.values[-1][place] == recent


@pytest.mark.parametrize("target", ["ros2", "python"])
@pytest.mark.parametrize(
    "stated",
    [
        "never all(@{x, -2:} == 0) and x < 1",
        "always (max(@{x, -3:}) - min(@{x, -3:}) > 1 implies eventually median(@{n, -1:}) > 2 within 2 s)",
        "after all(@{on, -1:}), never any(@{x, -2:}[1:] > g)",
        "never @{x, -4} > 1 and count(@{x, -2:} > 1) >= 2",
    ],
)
def test_the_replay_finds_nothing_in_what_is_emitted(stated: str, target: str) -> None:
    assert all(isinstance(outcome, Replayed) for outcome in outcomes(DECLARED + stated, target))


def test_samples_of_what_is_computed_are_an_array_too() -> None:
    for what in ("x - g", "x > g", "on"):
        (read,) = only_property(
            f"{DECLARED}never count(@{{{what}, -3:}}{'' if what != 'x - g' else ' > 1'}) > 2"
        ).inputs()
        assert isinstance(read, Recent)
        assert (read.signal.name, read.samples) == (what, 3)


@pytest.mark.parametrize(
    ("expression", "code"),
    [
        ("any(@{x, 0:} > 1)", "LTL211"),
        ("any(@{x, 3:} > 1)", "LTL211"),
        ("any(@{x, -1.5:} > 1)", "LTL211"),
        ("any(@{x, -100000:} > 1)", "LTL211"),
        ("any(@{scan, -3:} > 1)", "LTL210"),
        ("len(@{goal, -3:}) > 1", "LTL210"),
        ("any(@{x, -3:} > @{g, -3:})", "LTL230"),
        ("any(@{x, -3:} > @{x, -2:})", "LTL230"),
        ("any(@{@{x, -1}, -3:} > 1)", "LTL210"),
        ("@{x, -3:} > 1", "LTL205"),
    ],
)
def test_what_makes_no_such_array_is_an_error(expression: str, code: str) -> None:
    assert codes_of(f"{DECLARED}never {expression}") == [code]


@pytest.mark.parametrize(
    ("stated", "said"),
    [
        ("all(@{x, -9:} == 0)", "each of the last 10 samples of x is exactly 0"),
        ("any(@{x, -9:} > 2)", "one of the last 10 samples of x is more than 2"),
        ("all(@{on, -1:})", "each of the last 2 samples of on is true"),
        (
            "all(@{x, -1:} > 1 or @{x, -1:} < 0)",
            "for each of the last 2 samples of x, it is more than 1 or it is less than 0",
        ),
        ("mean(@{x, -4:}) > 2", "the mean of the last 5 samples of x is more than 2"),
    ],
)
def test_in_words_they_are_the_last_samples(stated: str, said: str) -> None:
    (atom,) = only_property(f"{DECLARED}never {stated}").atoms
    assert atom_text(atom, holds=True) == said


def test_in_words_what_is_not_so_of_each_is_not_so_of_one() -> None:
    (every,) = only_property(f"{DECLARED}never all(@{{x, -1:}} > 1)").atoms
    (some,) = only_property(f"{DECLARED}never any(@{{x, -1:}} > 1)").atoms
    assert atom_text(every, holds=False) == "one of the last 2 samples of x is at most 1"
    assert atom_text(some, holds=False) == "none of the last 2 samples of x is more than 1"
