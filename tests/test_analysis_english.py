"""Properties in plain English."""
# ruff: noqa: E501  a sentence is one line

from __future__ import annotations

import re

import pytest
from hypothesis import given
from strategies import properties
from studies import number

from ltlc.analysis.english import English
from ltlc.base.source import Source, Span
from ltlc.frontend.language import load_text
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.properties import Property
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import Comparison, Number, Relation
from ltlc.specification.specification import PropertySpecification

DECLARATIONS = (
    "decl x /x Float64.data\ndecl on /on Bool.data\ndecl mode /mode String.data\ndecl scan /scan LaserScan.ranges\n"
)


MORE = f"""{DECLARATIONS}decl goal /goal Float64.data
decl id /a action_msgs/GoalStatusArray.status_list[].goal_info.goal_id
decl status /a action_msgs/GoalStatusArray.status_list[].status
decl spot /spot Point
model robot: position /odom Odometry.pose.pose.position ;
zone kitchen = [(0, 0), (4, 0), (4, 3)]
"""


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "never once new x 4 times within 10 s",
            "There is no moment at which at least 4 messages of x arrived in the last 10 s.",
        ),
        ("always age(spot) <= 1 s", "At every moment, the last message of spot is at most 1 s old."),
        ("always not once new x 1 times", "At every moment, fewer than 1 message of x arrived so far."),
        (
            "always rate(x) >= 3 Hz over 2 s",
            "At every moment, at least 6 messages of x arrived in the last 2 s, or the start was at most 2 s ago.",
        ),
        ("never once on 3 times", "There is no moment at which on became true at least 3 times so far."),
        (
            "never once (new x and x > 1) 3 times within 5 s",
            "There is no moment at which (a message of x arrived and x was more than 1) at least 3 times in the last 5 s.",
        ),
        (
            "each new goal: eventually x > @{goal, opening} within 1 s",
            "For each message of goal: at some moment in the next 1 s, x is more than what goal was at that message.",
        ),
        (
            "each new goal: after on, never x > @{goal, opening}",
            "For each message of goal: once on is true: from then on, x is never more than what goal was when the scope opened.",
        ),
        (
            "each g of id: never (gone id and status == 1)",
            "For each value g of id, in its messages: there is no step at which it is missing in the last id and status of g is exactly 1.",
        ),
        (
            "never count(@{on, -4:}) >= 3",
            "The number of the last 5 samples of on that are true is never at least 3.",
        ),
        (
            "never count(@{x, -4:} > 1 and @{x, -4:} < 2) > 3",
            "The number of the last 5 samples of x for which it is more than 1 and it is less than 2 is never more than 3.",
        ),
        (
            "never once (x > 1 and on) 3 times within 10 s",
            "There is no moment at which it happened at least 3 times in the last 10 s that x was more than 1 and on was true.",
        ),
        ("always all(scan > 0.1)", "At every step, for every element, scan is more than 0.1."),
        ("never all(scan > 0.1)", "There is no step at which for every element, scan is more than 0.1."),
        (
            "always max(@{x, -49:}) - min(@{x, -49:}) < 0.1",
            "At every step, (the largest of the last 50 samples of x) - (the smallest of the last 50 samples of x) is less than 0.1.",
        ),
        ("always mod(x, 3) < 2", "At every step, the remainder of x divided by 3 is less than 2."),
        ("always norm(spot) < 10", "At every step, the length of spot is less than 10."),
        (
            "always spot =={0.5} @{spot, opening}",
            "At every step, spot is within 0.5 of what spot was when the run began.",
        ),
        (
            "after on, spot == @{spot, opening}",
            "Once on is true for the first time: at every step from then on, spot is exactly what spot was when the scope opened.",
        ),
        ("always @{spot, -1} == spot", "At every step, what spot was 1 sample ago is exactly spot."),
        ("always (new spot implies on)", "At every moment, if a message of spot arrives, then on is true."),
        ("each new spot: eventually on", "For each message of spot: at some moment from there on, on is true."),
        ("always nearest(x, scan) < 2", "At every step, the element of scan nearest to x is less than 2."),
        ("always angle_between(x, 1) < 2", "At every step, the angle between x and 1 is less than 2."),
        ("never inside(robot.position, kitchen)", "robot is never inside kitchen."),
        ("never inside(x, x, kitchen)", "The point (x, x) is never inside kitchen."),
        (
            "never distance(robot.position, kitchen) < 1",
            "The distance of robot from kitchen is never less than 1.",
        ),
    ],
)
def test_newer_forms_read_as_a_person_would_say_them(text: str, sentence: str) -> None:
    specification, problems = load_text(Source("p", f"{MORE}{text}"))
    assert specification is not None, problems
    assert English(specification.properties[0]).sentence() == sentence


def test_what_only_stands_for_the_message_of_an_instance_is_not_explained() -> None:
    specification, _ = load_text(Source("p", f"{MORE}each new goal: eventually x > @{{goal, opening}}"))
    assert specification is not None
    (atom,) = English(specification.properties[0]).atoms()
    assert atom == ("x > @{goal, opening}", "x is more than what goal was at that message")


def test_an_age_is_explained_rather_than_the_messages_from_which_it_counts() -> None:
    specification, _ = load_text(Source("p", f"{MORE}always (age(x) <= 1.5 s or x < 1)"))
    assert specification is not None
    assert English(specification.properties[0]).atoms() == [
        ("x < 1", "x is less than 1"),
        ("age(x) <= 1.5 s", "the last message of x is at most 1.5 s old"),
    ]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("never robot.velocity > 2", "The speed of robot is never more than 2."),
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
            "never @{x > 5 and on, -2} or not @{x > 5, -1}",
            "There is no step at which 2 samples ago x was more than 5 and on was true or 1 sample ago x was at most 5.",
        ),
        (
            "after_until robot.distance.sign < 1, robot.distance.sign > 2, eventually robot.velocity =={0.01} 0",
            "In each episode that opens when the distance from robot to sign is less than 1 and lasts until the distance "
            "from robot to sign is more than 2: at some step, the speed of robot is within 0.01 of 0.",
        ),
        (
            "after_until x > 1, on, always x <= @{x, opening} + 2",
            "In each episode that opens when x is more than 1 and lasts until on is true: at every step, x is at most "
            "(what x was when the scope opened) + 2.",
        ),
        ("always x <= @{x, opening}", "At every step, x is at most what x was when the run began."),
        (
            "(always x > 1 and on) and never x > 3",
            "At every step, x is more than 1 and on is true, and x is never more than 3.",
        ),
        (
            "never (x > 1 or on) and x < 5",
            "There is no step at which (x is more than 1 or on is true) and x is less than 5.",
        ),
        ("always eventually on", "At every step, the following holds: at some step from there on, on is true."),
        ("always (on implies x > 1)", "At every step, if on is true, then x is more than 1."),
        (
            "eventually robot.position =={0.1} door.position",
            "At some step, robot.position is within 0.1 of door.position.",
        ),
        ("always robot.position != door.position", "At every step, robot.position is not exactly door.position."),
        (
            "eventually always never (on and eventually x > 1)",
            "At some step, the following holds: at every step from there on, the following holds: at no step from there on does the following hold: "
            "on is true, and at some step from there on, x is more than 1.",
        ),
        (
            "always (on implies ((always x > 1) and (eventually x > 2)) or never x > 3)",
            "At every step, if on is true, then either (at every step from there on, x is more than 1, and at some step "
            "from there on, x is more than 2), or from there on, x is never more than 3.",
        ),
        ("never abs(x) > 2", "The absolute value of x is never more than 2."),
        ("always min(scan) > 0.3", "At every step, the smallest of scan is more than 0.3."),
        (
            "never any(scan < 0.3 or scan > 9)",
            "There is no step at which for some element, scan is less than 0.3 or scan is more than 9.",
        ),
        ("always all(scan > 0.3)", "At every step, for every element, scan is more than 0.3."),
        (
            "never count(scan[80:100] < 0.3) >= 5",
            "The number of elements for which scan[80:100] is less than 0.3 is never at least 5.",
        ),
        (
            "eventually sum(scan) / len(scan) > 2",
            "At some step, (the sum of scan) / (the length of scan) is more than 2.",
        ),
        ("never sum(scan) > 2", "The sum of scan is never more than 2."),
        ("never x >{0.5} 2", "x is never more than 2.5."),
    ],
)
def test_a_property_reads_as_a_sentence(text: str, sentence: str) -> None:
    assert _sentence(DECLARATIONS + text) == sentence


TIMED = "".join(
    f"decl {name} /{name} Bool.data\n"
    for name in [
        "bumper",
        "stopped",
        "near",
        "far",
        "arrived",
        "localized",
        "heartbeat",
        "estop",
        "moving",
        "alarm",
        "clear",
        "goal_set",
        "step_input",
        "recovering",
        "docked",
        "obstacle",
        "request",
        "reply",
        "goal",
        "result",
    ]
)
TIMED += "".join(f"decl {name} /{name} Float64.data\n" for name in ("tilt", "error", "cmd", "speed"))
TIMED += "decl scan /scan LaserScan.ranges\n"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "always (bumper implies eventually stopped within 100 ms)",
            "At every moment, if bumper is true, then at some moment in the next 100 ms, stopped is true.",
        ),
        (
            "after_until near, far, eventually stopped within 5 s",
            "In each episode that opens when near is true and lasts until far is true: at some moment in the first 5 s, stopped is true.",
        ),
        (
            "after_until near, far, eventually historically stopped for 3 s",
            "In each episode that opens when near is true and lasts until far is true: at some moment, stopped has been true for the last 3 s.",
        ),
        ("always age(scan) <= 200 ms", "At every moment, the last message of scan is at most 200 ms old."),
        ("eventually localized within 10 s", "At some moment in the first 10 s, localized is true."),
        (
            "after goal_set, eventually arrived within 2 min",
            "Once goal_set is true for the first time: at some moment in the next 2 min, arrived is true.",
        ),
        (
            "always eventually heartbeat within 1 s",
            "At every moment, the following holds: at some moment in the next 1 s, heartbeat is true.",
        ),
        (
            "always (estop implies never moving within 5 s)",
            "At every moment, if estop is true, then there is no moment in the next 5 s at which moving is true.",
        ),
        (
            "never historically tilt > 0.3 for 500 ms",
            "There is no moment at which tilt has been more than 0.3 for the last 500 ms.",
        ),
        (
            "always (moving implies once clear within 2 s)",
            "At every moment, if moving is true, then clear has been true at some moment in the last 2 s.",
        ),
        (
            "always (previously alarm and not alarm implies never alarm within 5 s)",
            "At every moment, if alarm was true just before and alarm is false, then there is no moment in the next 5 s at which alarm is true.",
        ),
        (
            "after step_input, within 2 s, eventually always abs(error) < 0.05",
            "Once step_input is true for the first time: considering only the next 2 s: at some moment, the following holds: at every moment from there on, the absolute value of error is less than 0.05.",
        ),
        (
            "after_until historically (cmd > 0 and speed == 0) for 10 s, moving, eventually recovering within 2 s",
            "In each episode that opens when (cmd has been more than 0 and speed has been exactly 0) for the last 10 s and lasts until moving is true: at some moment in the first 2 s, recovering is true.",
        ),
        (
            "until docked, always (obstacle implies eventually stopped within 0.5 s)",
            "There is a moment at which docked is true; before that, at every moment, if obstacle is true, then at some moment in the next 500 ms, stopped is true.",
        ),
        (
            "after request, (never reply within 100 ms) and (eventually reply within 1 s)",
            "Once request is true for the first time: there is no moment in the next 100 ms at which reply is true, and at some moment in the next 1 s, reply is true.",
        ),
        (
            "always (new goal implies eventually new result within 30 s)",
            "At every moment, if a message of goal arrives, then at some moment in the next 30 s, a message of result arrives.",
        ),
        ("initially stopped", "At the first step, stopped is true."),
        ("after near, initially stopped", "Once near is true for the first time: at that step, stopped is true."),
        (
            "until docked, initially not stopped",
            "There is a step at which docked is true; before that, there is a step, and at the first step, stopped is false.",
        ),
        ("always (near implies stopped)", "At every step, if near is true, then stopped is true."),
        ("never once near", "There is no moment at which near has been true at some moment so far."),
        ("always not once near within 2 s", "At every moment, near has been true at no moment in the last 2 s."),
        ("always not previously near", "At every moment, it is not the case that near was true just before."),
        ("always historically near", "At every moment, near has been true at all times so far."),
        (
            "always (near since far within 2 s)",
            "At every moment, near has been true ever since a moment in the last 2 s at which far was true.",
        ),
        (
            "always not (near since new scan)",
            "At every moment, it is not the case that near has been true ever since a moment so far at which a message of scan arrived.",
        ),
        (
            "always previously once near",
            "At every moment, it was the case that (near has been true at some moment so far) just before.",
        ),
        ("always age(scan) >= 1 s", "At every moment, the last message of scan is at least 1 s old."),
        ("always not new scan", "At every moment, no message of scan arrives."),
    ],
)
def test_a_property_of_time_reads_as_a_sentence(text: str, sentence: str) -> None:
    assert _sentence(TIMED + text) == sentence


def _sentence(text: str) -> str:
    specification, diagnostics = load_text(Source("props.txt", text))
    assert specification is not None, [d.message for d in diagnostics]
    return English(specification.properties[0]).sentence()


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
