"""What a report says of a violation: the place, the conditions that led to it, what was owed, episodes, the time."""

from __future__ import annotations

from itertools import combinations, product
from typing import Any
from xml.etree import ElementTree

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from stepping import from_text, machines, ns, samples, session, specification

from ltlc.backends.python.load import load_plan
from ltlc.compiler import Compiled
from ltlc.program.expressions import Literal
from ltlc.program.lowering import condition as lowered_condition
from ltlc.program.normal import positive
from ltlc.program.properties import questions, words
from ltlc.runtime import documents, junit, reports
from ltlc.runtime.episodes import Episodes, latest
from ltlc.runtime.properties import Condition, Moment, MonitoredProperty, Scope
from ltlc.runtime.reasons import decisive
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Plan, Session
from ltlc.runtime.times import Scale
from ltlc.semantics import denotation
from ltlc.semantics.ltl import Atom
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Word
from ltlc.specification.evaluation import evaluate, is_true, truth
from ltlc.specification.expressions import Comparison, Past, Relation, operands

AB = "decl a /a std_msgs/Float64.data\ndecl b /b std_msgs/Float64.data\n"


def judged(text: str, *samples_: tuple[float, float]) -> ByRows:
    """A run with a sample each second of a and b, where they are read."""
    run = session(AB + text)
    for time, values in enumerate(samples_):
        read = {name: value for name, value in zip("ab", values, strict=True) if name in run.session.sampler.samples}
        run.samples(ns(time), tuple(read), tuple(read.values()))
    return run


def figure(text: str, *samples_: tuple[float, float]) -> list[str]:
    run = judged(text, *samples_)
    return reports.figure(run.session, run.tracks[0]).splitlines()


def section(lines: list[str], heading: str) -> list[str]:
    """The indented lines below `heading`."""
    below = lines[lines.index(heading) + 1 :]
    return [line.strip() for line in below[: next(k for k, line in enumerate(below) if not line.startswith("  "))]]


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("low: never a > 1\n", "Error at line 3 of props.txt (low):"),
        ("never a > 1\n", "Error at line 3 of props.txt:"),
        ("high: never a > 9\nnever a > 1\n", "Error at line 4 of props.txt:"),
    ],
)
def test_an_error_names_line_file_and_label(text: str, place: str) -> None:
    run = judged(text, (2.0, 0.0))
    assert reports.figure(run.session, run.tracks[-1]).splitlines()[0] == place


def test_the_file_is_named_without_its_folder_as_in_the_node() -> None:
    run = ByRows(Session(load_plan(*from_text(AB + "never a > 1\n", "/home/somebody/props.txt"))))
    run.samples(0, ("a",), (2.0,))
    assert reports.figure(run.session, run.tracks[0]).startswith("Error at line 3 of props.txt:\n")


def test_a_violation_shows_both_sides_of_the_comparison_that_failed() -> None:
    lines = figure("never a - b > 0.5\n", (1.0, 1.0), (2.0, 1.25))
    assert section(lines, "Failing state:") == ["a: 2.0", "b: 1.25"]
    assert section(lines, "Because:") == ["a - b > 0.5: true, 0.75 > 0.5 by 0.25"]


def test_of_a_disjunction_under_never_the_disjunct_that_holds_is_shown() -> None:
    assert section(figure("never (a > 1 or b > 1)\n", (0.0, 2.0)), "Because:") == ["b > 1: true, 2.0 > 1.0 by 1"]


def test_of_a_disjunction_under_always_every_disjunct_is_shown_as_each_had_to_fail() -> None:
    lines = figure("always (a < 1 or b < 1)\n", (3.0, 2.0))
    assert section(lines, "Because:") == [
        "a < 1: false, 3.0 >= 1.0 by 2",
        "b < 1: false, 2.0 >= 1.0 by 1",
    ]


def test_margins_belong_to_the_side_that_they_move() -> None:
    lines = figure("never a >{0.5} b\n", (3.0, 2.0))
    (because,) = section(lines, "Because:")
    assert because.endswith("true, 3.0 > 2.5 by 0.5")


def test_what_was_owed_when_the_property_was_violated_is_named() -> None:
    lines = figure("after_until a > 1, a < 0, eventually b == 7\n", (2.0, 0.0), (2.0, 0.0), (-1.0, 7.0))
    assert "Unmet since +0 s (step 0): eventually b == 7" in lines


def test_a_violation_tells_the_inner_episode_as_well_as_the_outermost() -> None:
    text = "after_until a > 1, a < 0, (after_until b > 1, b < 0, eventually a == 7)\n"
    run = judged(text, (0.0, 2.0), (2.0, 0.0), (2.0, 2.0), (2.0, -1.0))
    assert reports.figure(run.session, run.tracks[0]).splitlines()[-2:] == [
        "The episode opened at +1 s (step 1).",
        "Inside it, that of `after_until b > 1, b < 0` opened at +2 s (step 2).",
    ]
    decided = documents.property_report(run.session, run.tracks[0])["decided_at"]
    assert decided["episode_opened"] == {
        "step": 1,
        "time": 1.0,
        "time_ns": ns(1),
        "offset": 1.0,
        "by_time": False,
    }
    assert [opening["step"] for opening in decided["episodes_opened"]] == [1, 2]


def test_an_inner_episode_of_an_earlier_outer_one_is_not_told() -> None:
    text = "after_until a > 1, a < 0, ((after_until b > 1, b < 0, a < 9) and eventually a == 7)\n"
    run = judged(text, (2.0, 2.0), (7.0, 0.0), (-1.0, 0.0), (2.0, 0.0), (-1.0, 0.0))
    failure = run.tracks[0].decided_at
    assert failure is not None
    assert [opening.step for opening in failure.opened] == [3]


@given(st.lists(st.frozensets(st.sampled_from("abcd")), max_size=8).map(tuple), st.booleans())
def test_the_latest_episodes_are_those_of_the_definition(word: Word, bounded: bool) -> None:
    """Of `after_until a, b, (after_until c, d, …)`, or `after c` inside, by the definition of episodes."""
    a, b, c, d = map(Atom, "abcd")
    closes = (lambda letter: "d" in letter) if bounded else None
    inner = Scope("inner", lambda letter: "c" in letter, closes, None if bounded else 1)
    scope = Episodes(Scope("outer", lambda letter: "a" in letter, lambda letter: "b" in letter, inner=(inner,)))
    for step, letter in enumerate(word):
        scope.step(step, step, [letter])
    outer = denotation.episodes(word, a, b)
    expected = []
    if outer:
        start, end = outer[-1]
        expected.append(("outer", start))
        segment = word[start:end]
        inside = [s for s, _ in denotation.episodes(segment, c, d)] if bounded else _first(segment, "c")
        expected += [("inner", start + s) for s in inside[-1:]]
    assert scope.count == len(outer)
    assert [(opening.scope, opening.step) for opening in latest([scope])] == expected


def _first(word: Word, atom: str) -> list[int]:
    return [step for step, letter in enumerate(word) if atom in letter][:1]


def described(compiled: Compiled) -> MonitoredProperty:
    plan: Plan = load_plan([compiled], specification([compiled]))
    return plan.properties[0]


def letter_of(compiled: Compiled, asked: dict[str, bool]) -> frozenset[str]:
    """The letter in which those that are asked are so: others are the same, their opposite, or of no matter."""
    by, found = questions(compiled.specification), set()
    for atom in compiled.specification.atoms:
        expression, holds = positive(lowered_condition(atom.condition))
        question = by[expression]
        truth = (
            expression.value if isinstance(expression, Literal) else asked.get(question.name, False) == question.holds
        )
        found |= {atom.name} if truth == holds else set()
    return frozenset(found)


@settings(max_examples=75, suppress_health_check=[HealthCheck.filter_too_much])  # few machines are ever violated
@given(machines(), st.data())
def test_the_reasons_of_a_violation_suffice_and_each_is_needed(compiled: Compiled, data: st.DataObject) -> None:
    """By flipping all other conditions: the successor stays; and with one reason fewer it does not."""
    monitor, asked = compiled.monitor, words(compiled.specification, compiled.machine).atoms
    assume(Verdict.VIOLATED in monitor.verdicts)
    assume(len(compiled.machine.states) == len(monitor.verdicts))  # the others are left out: nothing leads to them
    state = data.draw(st.integers(0, len(monitor.verdicts) - 1))
    holds = data.draw(st.lists(st.booleans(), min_size=len(asked), max_size=len(asked)))
    found = [Condition(name, truth) for name, truth in zip(asked, holds, strict=True)]
    property_ = described(compiled)
    reasons = [found[n] for n in decisive(property_, property_.edges[state], holds)]

    def successors(fixed: dict[str, bool]) -> set[int]:
        valuations = (dict(zip(asked, v, strict=True)) | fixed for v in product([False, True], repeat=len(holds)))
        return {monitor.step(state, letter_of(compiled, valuation)) for valuation in valuations}

    fixed = {reason.text: reason.holds for reason in reasons}
    assert all(reason in found for reason in reasons)
    valuation = {condition.text: condition.holds for condition in found}
    assert successors(fixed) == {monitor.step(state, letter_of(compiled, valuation))}
    for fewer in combinations(fixed.items(), max(0, len(fixed) - 1)):
        assert not reasons or len(successors(dict(fewer))) > 1


@settings(max_examples=75)
@given(machines(), samples(), samples())
def test_conditions_and_their_sides_are_those_of_the_reference(
    compiled: Compiled, now: dict[Any, Any], before: dict[Any, Any]
) -> None:
    assume(Verdict.VIOLATED in compiled.monitor.verdicts)
    wanted = compiled.specification.inputs()
    values = {i: (before if isinstance(i, Past) else now)[i.signal] for i in wanted}
    conditions = {atom.name: atom.condition for atom in compiled.specification.atoms}
    assume(all(truth(condition, values) is not None for condition in conditions.values()))
    found = described(compiled).conditions(*(values[i] for i in wanted))
    for shown, name in zip(found, words(compiled.specification, compiled.machine).atoms, strict=True):
        condition = conditions[name]
        assert (shown.text, shown.holds) == (name, is_true(condition, values))
        if shown.left is not None:
            left, right = (evaluate(side, values) for side in operands(condition))
            if isinstance(condition, Comparison) and condition.relation is not Relation.EQUAL:
                assert isinstance(right, float | int)
                right += condition.margin
            assert (shown.left, shown.right) == (left, right)


def test_kept_verdicts_have_their_times_also_where_ticks_are_not_done_one_by_one() -> None:
    run = session("_rate_ = 4\n" + AB + "never a > 1\n")
    run.samples(ns(10.0), ("a",), (0.0,))
    run.samples(ns(20.0), ("a",), (0.0,))
    (track,) = run.tracks
    assert track.times == [ns(10 + k / 4) for k in range(40)]
    assert documents.property_report(run.session, track)["times"] == [10 + k / 4 for k in range(40)]
    assert len(track.verdicts or []) == 40


def test_steps_of_different_properties_at_one_instant_have_one_time() -> None:
    run = session(AB + "never a > 1\nnever b > 1\n")
    for time, name, value in ((0.0, "a", 0.0), (0.25, "a", 0.0), (0.5, "b", 0.0)):
        run.samples(ns(time), (name,), (value,))
    run.samples(ns(0.75), ("a", "b"), (2.0, 2.0))
    places = [reports.moment_text(t.decided_at, run.session.scale) for t in run.tracks if t.decided_at is not None]
    assert places == ["+0.75 s (step 2)", "+0.75 s (step 1)"]


@pytest.mark.parametrize(
    ("time", "text"),
    [
        (0, "0 s (step 1)"),
        (300_000_000, "0.3 s (step 1)"),
        (-1, "-0.000000001 s (step 1)"),
        (1763740800_123456789, "1763740800.123456789 s (step 1)"),
    ],
)
def test_absolute_times_are_reported_to_the_nanosecond(time: int, text: str) -> None:
    assert reports.moment_text(Moment(1, time), Scale()) == text


@pytest.mark.parametrize(
    ("time", "text"),
    [
        (0, "+0 s"),
        (300_000_000, "+0.3 s"),
        (15_751_999_600, "+15.752 s"),
        (2_000_000_001, "+2 s"),
        (-500_000_000, "-0.5 s"),
    ],
)
def test_offsets_are_reported_to_the_millisecond(time: int, text: str) -> None:
    zero = 1763740800_123456789
    assert Scale(zero).text(zero + time) == text


@given(st.lists(st.integers(0, 10**10), max_size=4), st.integers(0, 2 * 10**18))
def test_different_times_that_are_shown_together_never_look_alike(offsets: list[int], zero: int) -> None:
    times = {zero + offset for offset in offsets}
    scale = Scale(zero).among(times)
    assert len({scale.text(time) for time in times}) == len(times)
    coarse = {Scale(zero).text(time) for time in times}
    assert scale.digits == 3 or len(coarse) < len(times)


def test_a_violation_a_nanosecond_after_its_episode_opened_shows_the_nanosecond() -> None:
    run = session(AB + "after_until a > 1, a < 0, always age(b) <= 1 ns\n")
    run.samples(0, ("a", "b"), (0.0, 0.0))
    run.samples(ns(2), ("a", "b"), (2.0, 0.0))
    run.advance(ns(3))
    assert reports.figure(run.session, run.tracks[0]).splitlines()[-2:] == [
        "At +2.000000002 s (after step 1).",
        "The episode opened at +2 s (step 1).",
    ]


@pytest.mark.parametrize("text", ["plain", """a "b" and 'c'""", "1 < 2 > 0 & ]]>", "&quot; &amp;"])
def test_a_junit_report_says_each_text_as_it_is(text: str) -> None:
    case = junit.Case(text, "failure", "violated", text, text)
    suite = ElementTree.fromstring(junit.suite_text(text, [case], [text]))
    found = suite.find("testcase")
    assert found is not None
    failure = found.find("failure")
    assert failure is not None
    told = [suite.get("name"), found.get("name"), failure.get("message"), failure.text]
    assert told == [text] * 4
    assert suite.findtext("system-out") == f"{text}\n"


def test_a_verdict_that_fails_is_a_failure_and_one_that_lost_messages_an_error() -> None:
    assert junit.case_element(Verdict.VIOLATED) == junit.case_element(Verdict.VIOLATED, has_lost=True) == "failure"
    assert junit.case_element(Verdict.SATISFIED) is None
    assert junit.case_element(Verdict.SATISFIED, has_lost=True) == "error"


def test_names_of_topics_that_would_be_equal_are_counted_from_two() -> None:
    assert reports.topic_names(["a b", "a_b", "a-b"]) == ["a_b", "a_b_2", "a_b_3"]
