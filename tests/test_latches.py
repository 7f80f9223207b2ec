"""`@{s, when p}`, the value that a signal had when p last held: `docs/language.md`, 'Values when something held'."""

from __future__ import annotations

import math
from collections.abc import Callable
from random import Random
from typing import Any

import pytest
from language_support import codes_of, compiled, findings, only_property
from replaying import outcomes
from stepping import from_text, ns, session

from ltlc.analysis.atom_words import atom_text
from ltlc.assurance.reading.files import written
from ltlc.assurance.reading.outcomes import Difference
from ltlc.assurance.replay import Replayed
from ltlc.backends import emit, python
from ltlc.backends.spelling import NotInTargetError

DECLARATIONS = """\
decl x /x Float64.data
decl g /g Float64.data
decl m /m String.data
"""
Values = dict[str, Any]
CONDITIONS: dict[str, Callable[[Values, str], bool]] = {
    "new m": lambda now, topic: topic == "/m",
    "g > 1": lambda now, topic: now["g"] > 1,
    "not g > 1": lambda now, topic: not now["g"] > 1,
    "new g and g == 2": lambda now, topic: topic == "/g" and now["g"] == 2,
    'm == "a" and x > 1': lambda now, topic: now["m"] == "a" and now["x"] > 1,
    "x > @{x, -1}": lambda now, topic: now["x"] > now["before"],
}


def by_definition(condition: str, messages: list[tuple[str, Any]]) -> list[Any]:
    """What is latched of x after each message, None before there is anything."""
    now: Values = {}
    latched, found = None, []
    for topic, value in messages:
        name = topic[1:]
        if name == "x" and "x" in now:
            now["before"] = now["x"]
        now[name] = value
        needed = {"x", *(name for name in ("g", "m") if f"{name} " in f"{condition} ".replace(f"new {name}", ""))}
        needed |= {"before"} if "@" in condition else set()
        known = needed <= now.keys() and not any(now[n] != now[n] for n in needed)
        if known and CONDITIONS[condition](now, topic):
            latched = now["x"]
        found.append(latched)
    return found


@pytest.mark.parametrize("condition", CONDITIONS)
def test_it_is_the_value_at_the_latest_message_at_which_the_condition_held(condition: str) -> None:
    text = f"{DECLARATIONS}never @{{x, when {condition}}} == 99 and new m and new g and x == @{{x, -1}}"
    latch = f"@{{x, when {condition}}}"
    for seed in range(60):
        chance = Random(seed)
        values: dict[str, list[Any]] = {
            "/x": [0.0, 1.0, 2.0, 3.0, math.nan],
            "/g": [1.0, 2.0, 2.0, math.nan],
            "/m": ["a", "b"],
        }
        topics = [chance.choice(sorted(values)) for _ in range(25)]
        messages = [(topic, chance.choice(values[topic])) for topic in topics]
        right = by_definition(condition, messages)
        run = session(text)
        (track,) = run.tracks
        place = [str(wanted) for wanted in track.property.inputs].index(latch)
        for number, (topic, value) in enumerate(messages):
            steps = track.steps
            run.message(ns(float(number // 2)), topic, [value])
            if track.steps > steps:
                assert track.values[-1][place] == right[number], (seed, number, messages)
            elif right[number] is None:
                assert track.verdict.value == "not_started"


def test_with_a_rate_every_tick_is_a_look() -> None:
    run = session(f"_rate_ = 1\n{DECLARATIONS}never x < @{{x, when new m}}")
    for time, topic, value in [
        (0.0, "/m", "a"),
        (0.0, "/x", 5.0),
        (0.5, "/x", 7.0),
        (0.5, "/m", "a"),
        (1.5, "/x", 6.0),
    ]:
        run.message(ns(time), topic, [value])
    run.advance(ns(2.0))
    (track,) = run.tracks
    assert [v.value for v in track.verdicts or ()] == ["presumably_satisfied", "presumably_satisfied", "violated"]


def test_a_latch_of_a_latch_follows_both() -> None:
    run = session(f"{DECLARATIONS}never @{{@{{x, when new m}}, when g > 1}} == 99 and x > 99")
    (track,) = run.tracks
    for number, (topic, value) in enumerate(
        [("/x", 1.0), ("/g", 2.0), ("/m", "a"), ("/x", 3.0), ("/g", 0.0), ("/m", "a")]
    ):
        run.message(ns(float(number)), topic, [value])
    latched = [str(wanted) for wanted in track.property.inputs].index("@{@{x, when new m}, when g > 1}")
    assert [values[latched] for values in track.values] == [1.0, 1.0, 1.0, 1.0]


def test_integers_stay_exact_and_strings_are_latched_as_they_are() -> None:
    text = "decl id /i Int64.data\ndecl m /m String.data\n"
    run = session(f"{text}never id != @{{id, when new m}}\nnever m != @{{m, when id == 9007199254740993}}")
    for topic, value in [("/i", 9007199254740993), ("/m", "a"), ("/i", 9007199254740992)]:
        run.message(0, topic, [value])
    assert [track.verdict.value for track in run.tracks] == ["violated", "presumably_satisfied"]


def test_a_vector_is_latched_by_its_components() -> None:
    found = only_property("decl m /m String.data\nnever robot.position != @{robot.position, when new m}")
    names = {wanted.signal.name for wanted in found.inputs()}
    assert names >= {f"@{{robot.position.{axis}, when new m}}" for axis in "xyz"}


@pytest.mark.parametrize("target", ["ros2"])
@pytest.mark.parametrize("rate", ["", "_rate_ = 5\n"])
@pytest.mark.parametrize("condition", ["new m", "g > 1 and x < 2", 'm == "a" and new m'])
def test_the_replay_of_a_node_finds_nothing(condition: str, rate: str, target: str) -> None:
    text = f"{rate}{DECLARATIONS}always (abs(x - @{{x, when {condition}}}) > 1 implies eventually g > 2 within 2 s)"
    assert all(isinstance(outcome, Replayed) for outcome in outcomes(text, target))


@pytest.mark.parametrize(
    ("right", "wrong"), [("return x <= INFINITY and new_m", "return x <= INFINITY and not new_m"), ("and new_m", "")]
)
def test_the_replay_finds_a_value_that_is_latched_at_other_messages(right: str, wrong: str) -> None:
    text = f"{DECLARATIONS}never abs(x - @{{x, when new m}}) > 1"
    (outcome,) = outcomes(text, "ros2", right, wrong)
    assert not isinstance(outcome, Replayed)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("return x <= INFINITY and new_m", "return x <= INFINITY"),
        ('(Input("x"), New("m")),\n', '(New("m"), Input("x")),\n'),
        ("                x_when_new_m_when,\n", ""),
    ],
)
def test_when_a_node_latches_a_value_is_read_back(right: str, wrong: str) -> None:
    compiled_, whole = from_text(f"{DECLARATIONS}never abs(x - @{{x, when new m}}) > 1")
    text = emit("ros2", compiled_, whole)
    machines, specifications = [each.machine for each in compiled_], [each.specification for each in compiled_]
    (found,) = written(text, machines, specifications)
    assert not isinstance(found, Difference)
    assert right in text
    (found,) = written(text.replace(right, wrong), machines, specifications)
    assert isinstance(found, Difference)


def test_the_target_python_refuses_it_by_name() -> None:
    with pytest.raises(NotInTargetError, match="when"):
        python.emit(*from_text(f"{DECLARATIONS}never x > @{{x, when new m}}"))


@pytest.mark.parametrize(
    "condition",
    [
        "once g > 1",
        "previously new m",
        "age(m) < 1 s",
        "x > @{x, opening}",
        "g > 1 since new m",
        "historically g > 1 for 1 s",
    ],
)
def test_what_looks_back_further_is_no_condition(condition: str) -> None:
    assert codes_of(f"{DECLARATIONS}never x > @{{x, when {condition}}}") == ["LTL231"]


def test_what_is_computed_from_signals_is_latched_and_nothing_else() -> None:
    assert not codes_of(f"{DECLARATIONS}never @{{x + g, when new m}} > 2")
    assert codes_of(f"{DECLARATIONS}never @{{x - @{{x, -1}}, when new m}} > 2") == ["LTL210"]


def test_a_name_may_be_called_so_elsewhere() -> None:
    text = "decl when /w Bool.data\ndecl x /x Float64.data\nafter when, never when and x > @{x, when when}\nalways when"
    assert not findings(text)
    assert [wanted.signal.name for wanted in compiled(text).properties[0].inputs()] == ["when", "x", "@{x, when when}"]


def test_in_words_it_is_the_value_at_that_moment() -> None:
    (atom,) = only_property(f"{DECLARATIONS}never x > @{{x, when new m and g > 1}}").atoms
    assert atom_text(atom, holds=True) == "x is more than x when last a message of m arrived and g was more than 1"
