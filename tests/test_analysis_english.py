"""Properties in plain English."""
# ruff: noqa: E501  a sentence is one line

from __future__ import annotations

import pytest

from ltlc.analysis.english import English
from ltlc.language import load_text
from ltlc.source import Source

DECLARATIONS = "decl x /x Float64.data\ndecl on /on Bool.data\ndecl mode /mode String.data\n"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("never robot.velocity > 2", "At no step: the speed of robot is more than 2."),
        ("x < 1", "At every step, x is less than 1."),
        ("eventually x =={0.1} 2", "At some step, x is within 0.1 of 2."),
        ("eventually not x > 1 or on", "At some step, x is at most 1 or on is true."),
        (
            "always (on implies eventually x > 1)",
            "At every step, if on is true, then at some step from there on, x is more than 1.",
        ),
        (
            'after mode == "go", always x > 0',
            'Once mode is "go" for the first time: at every step from then on, x is more than 0.',
        ),
        (
            "until x > 5, x > @{x, -1}",
            "There is a step at which x is more than 5; before it, at every step, x is more than x 1 sample ago.",
        ),
        (
            "after_until robot.distance.sign < 1, robot.distance.sign > 2, eventually robot.velocity =={0.01} 0",
            "In each episode that opens when the distance from robot to sign is less than 1 and lasts until the distance "
            "from robot to sign is more than 2: at some step, the speed of robot is within 0.01 of 0.",
        ),
        (
            "(always x > 1 and on) and never x > 3",
            "At every step, x is more than 1 and on is true, and at no step: x is more than 3.",
        ),
        ("never (x > 1 or on) and x < 5", "At no step: (x is more than 1 or on is true) and x is less than 5."),
        ("always eventually on", "From every step on: at some step from there on, on is true."),
        ("always (on implies x > 1)", "At every step, if on is true, then x is more than 1."),
        (
            "eventually robot.position =={0.1} door.position",
            "At some step, robot.position is within 0.1 of door.position.",
        ),
        ("always robot.position != door.position", "At every step, robot.position is not exactly door.position."),
        ("never x >{0.5} 2", "At no step: x is more than 2.5."),
    ],
)
def test_a_property_reads_as_a_sentence(text: str, sentence: str) -> None:
    specification, diagnostics = load_text(Source("props.txt", DECLARATIONS + text))
    assert specification is not None, [d.message for d in diagnostics]
    assert English(specification.properties[0]).sentence() == sentence
