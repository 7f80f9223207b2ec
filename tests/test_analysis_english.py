"""Properties in plain English."""
# ruff: noqa: E501  a sentence is one line

from __future__ import annotations

import re

import pytest
from hypothesis import given
from strategies import properties
from studies import number

from ltlc.analysis.english import English
from ltlc.language import load_text
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.properties import Property
from ltlc.source import Source, Span
from ltlc.specification.atoms import Atom, Comparison, Relation
from ltlc.specification.expressions import Number
from ltlc.specification.specification import PropertySpecification

DECLARATIONS = (
    "decl x /x Float64.data\ndecl on /on Bool.data\ndecl mode /mode String.data\ndecl scan /scan LaserScan.ranges\n"
)


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
            "There is a step at which x is more than 5; before that, at every step, x is more than x 1 sample ago.",
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
        ("always eventually on", "At every step, this holds: at some step from there on, on is true."),
        ("always (on implies x > 1)", "At every step, if on is true, then x is more than 1."),
        (
            "eventually robot.position =={0.1} door.position",
            "At some step, robot.position is within 0.1 of door.position.",
        ),
        ("always robot.position != door.position", "At every step, robot.position is not exactly door.position."),
        (
            "eventually always never (on and eventually x > 1)",
            "At some step, this holds: at every step from there on, this holds: at no step from there on does this hold: "
            "on is true, and at some step from there on, x is more than 1.",
        ),
        (
            "always (on implies ((always x > 1) and (eventually x > 2)) or never x > 3)",
            "At every step, if on is true, then either (at every step from there on, x is more than 1, and at some step "
            "from there on, x is more than 2), or at no step from there on: x is more than 3.",
        ),
        ("never abs(x) > 2", "At no step: the absolute value of x is more than 2."),
        ("always min(scan) > 0.3", "At every step, the smallest of scan is more than 0.3."),
        ("never x >{0.5} 2", "At no step: x is more than 2.5."),
    ],
)
def test_a_property_reads_as_a_sentence(text: str, sentence: str) -> None:
    specification, diagnostics = load_text(Source("props.txt", DECLARATIONS + text))
    assert specification is not None, [d.message for d in diagnostics]
    assert English(specification.properties[0]).sentence() == sentence


ATOMS = ("speed", "load")


@given(properties(ATOMS))
def test_the_words_of_any_property_are_well_joined(property_: Property) -> None:
    atoms = tuple(Atom(a, Comparison(number(a), Relation.GREATER, Number(1.0)), Span(0, 0)) for a in ATOMS)
    alphabet = Alphabet(ATOMS, ())
    sentence = English(PropertySpecification("p", 1, Span(0, 0), "", property_, atoms, alphabet, {})).sentence()
    assert not re.search(r"\b(\w+)[ ,:;]+\1\b", sentence, re.IGNORECASE), sentence
    assert not re.search(r"  | [,:;.)]|\( |[,:;] ?[,:;.]", sentence), sentence
    depths = [sentence[:k].count("(") - sentence[:k].count(")") for k in range(len(sentence) + 1)]
    assert min(depths) == depths[-1] == 0, sentence
