"""Steps, time and missing data: `docs/language.md`, its last section, statement by statement."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stepping import from_text, ns, session

from ltlc.backends.python.load import load_plan
from ltlc.runtime import documents, junit, reports
from ltlc.runtime.properties import Condition
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.runtime.silence import waiting_for
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict

XY = "decl x /a Odometry.pose.pose.position.x\ndecl y /b Odometry.pose.pose.position.y\n"
SPEED = "decl speed /odom Odometry.twist.twist.linear.x\n"
LOW = XY + "low: never x > 2\n"
BOTH = XY + "both: never x > y\n"


def feed(run: ByRows, *messages: tuple[float, str, Any]) -> ByRows:
    """Messages with one field: time, topic, value."""
    for time, topic, value in messages:
        run.message(ns(time), topic, [value])
    return run


def names(run: ByRows, track: int = 0) -> list[str]:
    verdicts = run.tracks[track].verdicts
    assert verdicts is not None
    return [verdict.value for verdict in verdicts]


def test_a_run_starts_at_the_first_step_at_which_every_signal_has_a_value() -> None:
    run = feed(session(BOTH), (0, "/a", 3.0), (1, "/a", 3.0), (2, "/b", 4.0))
    assert names(run) == ["presumably_satisfied"]


def test_until_then_the_verdict_is_not_started() -> None:
    run = feed(session(BOTH), (0, "/a", 3.0), (1, "/a", 3.0))
    assert run.tracks[0].verdict is Verdict.NOT_STARTED
    assert run.tracks[0].steps == 0


def test_history_counts_for_the_start() -> None:
    run = feed(session(SPEED + "never @{speed, -2} > 1\n"), *((t, "/odom", 5.0) for t in range(2)))
    assert run.tracks[0].verdict is Verdict.NOT_STARTED
    feed(run, (2, "/odom", 0.0))
    assert names(run) == ["violated"]


def test_every_message_on_a_topic_that_the_property_reads_is_a_step() -> None:
    run = feed(session(BOTH), (0, "/a", 1.0), (0, "/b", 2.0), (0, "/b", 2.0), (1, "/a", 1.0))
    assert run.tracks[0].steps == 3


@pytest.mark.parametrize("rate", ["", "_rate_ = 10\n"])
def test_a_message_only_looks_at_the_properties_that_it_concerns(rate: str, monkeypatch: pytest.MonkeyPatch) -> None:
    others = "".join(
        f"decl y{n} /y{n} std_msgs/Float64.data\nnever y{n} > 2\nalways age(y{n}) <= 9 s\n"
        f"eventually y{n} > 2 within 9 s\nafter_until y{n} > 1, y{n} > 2, never previously y{n} > 1\n"
        for n in range(5)
    )
    run = session(rate + XY + "never x > 2\nrises: never x > 9 and previously x > 1.2\n" + others)
    run.begin(0)
    feed(run, *((0.1, topic, 1.0) for topic in run.session.messages), (0.11, "/a", 1.5))
    run.advance(ns(0.12))
    looked: list[set[str]] = []
    held: list[str] = []
    monkeypatch.setattr(Track, "step", _noting(Track.step, lambda track: looked.append(_read(track))))
    monkeypatch.setattr(Track, "hold", _noting(Track.hold, lambda track: held.append(track.property.label)))
    feed(run, (0.15, "/a", 1.0), (0.16, "/a", 1.5))
    run.advance(ns(0.17))
    assert looked == ([] if rate else [{"x"}] * 4)
    assert set(held) == (set() if rate else {"rises"})


def _noting(method: Callable[..., Any], note: Callable[[Any], None]) -> Callable[..., Any]:
    def noting(self: Any, *values: Any) -> Any:
        note(self)
        return method(self, *values)

    return noting


def _read(track: Track) -> set[str]:
    return {wanted.signal for wanted in track.property.inputs}


def test_messages_on_other_topics_are_no_step() -> None:
    run = feed(session(LOW + "other: never y > 2\n"), (0, "/a", 1.0), (0, "/b", 1.0), (1, "/b", 1.0))
    assert [track.steps for track in run.tracks] == [1, 2]


def test_other_signals_hold_their_last_value() -> None:
    run = feed(session(BOTH), (0, "/a", 1.0), (1, "/b", 2.0), (9, "/a", 1.5), (10, "/a", 3.0))
    assert names(run)[-2:] == ["presumably_satisfied", "violated"]


def test_a_message_without_a_sample_of_any_signal_is_no_step() -> None:
    run = feed(session(LOW), (0, "/a", 1.0), (1, "/a", None))
    assert run.tracks[0].steps == 1
    assert run.session.messages["/a"] == 2


def test_with_a_rate_there_is_a_step_every_period_from_the_latest_values() -> None:
    run = feed(
        session("_rate_ = 10\n" + LOW), (0.0, "/a", 1.0), (0.05, "/a", 9.0), (0.08, "/a", 1.0), (0.35, "/a", 9.0)
    )
    assert names(run) == ["presumably_satisfied"] * 4
    run.advance(ns(0.4))
    assert names(run)[4:] == ["violated"]


def test_the_first_tick_is_at_the_first_message_and_sees_all_of_that_time() -> None:
    run = feed(session("_rate_ = 10\n" + BOTH), (5.0, "/a", 1.0), (5.0, "/b", 0.0))
    assert names(run) == []
    run.advance(ns(5.0))
    assert run.tracks[0].decided_at is not None
    assert run.tracks[0].decided_at.time == ns(5)


def test_ticks_do_not_drift() -> None:
    run = feed(session("_rate_ = 30\n" + LOW), (0.0, "/a", 1.0))
    run.advance(ns(100.0))
    assert run.tracks[0].steps == 3001


def test_under_a_rate_every_tick_is_a_sample_of_every_signal() -> None:
    run = feed(session("_rate_ = 1\n" + SPEED + "never @{speed, -1} > 1\n"), (0, "/odom", 5.0))
    run.advance(ns(0))
    assert run.tracks[0].verdict is Verdict.NOT_STARTED
    run.advance(ns(1))
    assert names(run) == ["violated"]


@given(
    st.lists(st.tuples(st.floats(0, 3), st.sampled_from("ab"), st.sampled_from([0.0, 1.0, 3.0, math.nan])), max_size=8)
)
def test_many_small_advances_and_one_large_are_the_same_run(messages: list[tuple[float, str, float]]) -> None:
    text = "_rate_ = 4\n" + BOTH + "always (x > 2 implies eventually y > 2)\nnever @{x, -3} > 2\n"
    plan = load_plan(*from_text(text))
    often, seldom = ByRows(Session(plan, keep_verdicts=True)), ByRows(Session(plan, keep_verdicts=True))
    time = 0.0
    for gap, topic, value in messages:
        while (step := time + 0.25) < time + gap:
            often.advance(ns(step))
            gap -= 0.25
            time = step
        time += gap
        for run in (often, seldom):
            run.message(ns(time), f"/{topic}", [value])
    often.advance(ns(time + 5))
    seldom.advance(ns(time + 5))
    for one, other in zip(often.tracks, seldom.tracks, strict=True):
        assert one.verdicts == other.verdicts
        assert (one.steps, one.invalid, one.open_since) == (other.steps, other.invalid, other.open_since)


def test_a_gap_of_years_in_a_run_with_a_rate_takes_no_time_and_counts_all_its_ticks() -> None:
    run = ByRows(Session(load_plan(*from_text("_rate_ = 1000\n" + LOW))))
    feed(run, (0, "/a", 1.0), (1e8, "/a", 3.0))
    run.advance(ns(1e8))
    assert run.tracks[0].steps == 10**11 + 1
    assert run.tracks[0].verdict is Verdict.VIOLATED


def test_nan_makes_the_sample_invalid_there_is_no_step_and_it_is_counted() -> None:
    run = feed(session(BOTH), (0, "/a", 1.0), (0, "/b", 2.0), (1, "/a", math.nan), (2, "/b", 0.0), (3, "/a", 1.0))
    assert names(run) == ["presumably_satisfied", "violated"]
    assert run.tracks[0].invalid == 2


def test_an_expression_without_a_value_is_no_step() -> None:
    run = feed(session(BOTH.replace("x > y", "x / y > 2")), (0, "/a", 0.0), (0, "/b", 0.0), (1, "/a", 1.0))
    assert names(run) == ["violated"]
    assert run.tracks[0].invalid == 1


def test_infinity_is_a_value() -> None:
    assert names(feed(session(LOW), (0, "/a", -math.inf), (1, "/a", math.inf))) == ["presumably_satisfied", "violated"]


def test_integers_of_messages_become_doubles() -> None:
    run = feed(session(XY + "never x - 9007199254740992 > 0\n"), (0, "/a", 9007199254740993), (1, "/a", 10**400))
    assert names(run) == ["presumably_satisfied", "violated"]


def test_the_run_ends_a_timeout_after_its_first_step() -> None:
    run = feed(session("_timeout_ = 10\n" + BOTH), (0, "/a", 1.0), (5, "/b", 2.0), (15, "/a", 1.0))
    assert not run.session.is_over
    assert feed(run, (15.1, "/a", 3.0)).session.is_over
    assert names(run) == ["presumably_satisfied"] * 2


def test_what_comes_after_the_end_of_a_run_is_not_judged() -> None:
    run = feed(session("_timeout_ = 10\n" + LOW), (0, "/a", 1.0), (15, "/a", 3.0), (16, "/a", 3.0))
    assert names(run) == ["presumably_satisfied"]


def test_the_timeout_is_noticed_without_a_message() -> None:
    run = feed(session("_timeout_ = 10\n" + LOW), (0, "/a", 1.0))
    run.advance(ns(10.5))
    assert run.session.is_over


def test_ticks_end_with_the_timeout() -> None:
    run = feed(session("_timeout_ = 2\n_rate_ = 2\n" + LOW), (0, "/a", 1.0))
    run.advance(ns(100))
    assert run.tracks[0].steps == 5
    assert run.session.is_over


def test_time_that_goes_back_is_refused() -> None:
    with pytest.raises(ValueError, match="goes back"):
        feed(session(LOW), (1, "/a", 1.0), (0.5, "/a", 1.0))


def test_an_open_obligation_has_a_beginning_that_an_answer_ends() -> None:
    text = XY + "answer: always (x > 2 implies eventually y > 2)\n"
    run = feed(session(text), (0, "/a", 0.0), (0, "/b", 0.0), (1, "/a", 3.0), (2, "/a", 0.0))
    [track] = run.tracks
    assert track.open_since is not None
    assert (track.open_since.step, track.open_since.time) == (1, ns(1))
    assert track.property.obligations == ("eventually y > 2",)
    feed(run, (3, "/b", 3.0))
    assert track.open_since is None


EPISODES = XY + "stop: after_until x < 1, x > 2, eventually y < 1\n"


def xs(run: ByRows, *values: float) -> ByRows:
    """Messages on /a, one a second from the time of the last on."""
    start = -1.0 if run.session.time is None else run.session.time
    return feed(run, *((start + 1 + n, "/a", value) for n, value in enumerate(values)))


def test_episodes_are_counted_as_the_language_defines_them() -> None:
    run = xs(feed(session(EPISODES), (0, "/b", 0.0)), 3, 0, 1.5, 0, 3, 0, 0, 3, 3)
    assert run.tracks[0].episodes == 2


def test_a_violation_tells_when_its_episode_opened_and_the_failing_state() -> None:
    run = xs(feed(session(EPISODES), (0, "/b", 5.0)), 3, 0, 1.5, 2.5)
    failure = run.tracks[0].decided_at
    assert failure is not None
    assert (failure.step, failure.time) == (3, ns(4))
    assert failure.values == (("x", 2.5), ("y", 5.0))
    assert [(opening.scope, opening.time) for opening in failure.opened] == [("after_until x < 1, x > 2", ns(2))]


def test_a_property_that_holds_without_an_episode_was_never_triggered() -> None:
    run = xs(feed(session(EPISODES), (0, "/b", 0.0)), 3, 3)
    assert run.tracks[0].never_triggered
    assert not xs(run, 0).tracks[0].never_triggered


def test_a_scope_opens_once_for_after_and_at_every_step_under_always() -> None:
    run = session(XY + "after x > 2, y < 9\nalways (after_until x > 2, x < 1, y < 9)\nnever x > 9\n")
    xs(feed(run, (0, "/b", 0.0)), 3, 3, 0, 3)
    assert [track.episodes for track in run.tracks] == [1, 3, None]


def test_scopes_of_several_conjuncts_add_up() -> None:
    run = xs(feed(session(XY + "(after x > 2, y < 9) and (after x < 1, y < 9)\n"), (0, "/b", 0.0)), 3, 0)
    assert run.tracks[0].episodes == 2


def test_steps_go_on_after_the_decision_and_the_verdict_stays() -> None:
    run = feed(session(LOW), (0, "/a", 3.0), (1, "/a", 1.0), (2, "/a", math.nan))
    assert names(run) == ["violated", "violated"]
    assert (run.tracks[0].steps, run.tracks[0].invalid) == (2, 1)
    assert run.tracks[0].decided_at is not None
    assert run.tracks[0].decided_at.step == 0


def test_each_change_of_verdict_is_returned_once() -> None:
    run = session(LOW)
    changes = [run.message(ns(time), "/a", [x]) for time, x in enumerate((1.0, 1.0, 3.0, 3.0))]
    assert [[(c.previous.value, c.current.value, c.moment.time) for c in found] for found in changes] == [
        [("not_started", "presumably_satisfied", 0)],
        [],
        [("presumably_satisfied", "violated", ns(2))],
        [],
    ]


def test_what_never_spoke_is_told() -> None:
    run = feed(session(BOTH), (0, "/a", 1.0))
    assert waiting_for(run.session, run.tracks[0]) == ["no message on /b"]
    feed(run, (1, "/b", None))
    assert waiting_for(run.session, run.tracks[0]) == ["1 message on /b, but none with a value of y"]


def test_history_that_is_too_short_is_told() -> None:
    run = feed(session(SPEED + "never @{speed, -2} > 1\n"), (0, "/odom", 5.0))
    assert waiting_for(run.session, run.tracks[0]) == ["too few samples for @{speed, -2}"]


def test_an_object_that_a_shared_topic_never_mentions_is_told() -> None:
    run = session("_simulator_ = tf\nnever robot.position.x > 2\n")
    topic = next(iter(run.session.messages))
    run.message(0, topic, [None] * len(run.session.fields[topic]))
    assert waiting_for(run.session, run.tracks[0]) == [f"1 message on {topic}, but none with an entry 'robot'"]


DERIVED = """
object robot /gt Odometry
object sign at (3, 4, 0)
far: never robot.distance.sign < 1
past: never @{robot.distance.sign, -1} < 1
"""


def position(run: ByRows, time: float, **values: float | None) -> ByRows:
    """A message with the fields `robot.position.x` and so on that are given."""
    fields = {name: values.get(name.rpartition(".")[2]) for name in run.session.fields["/gt"]}
    run.message(ns(time), "/gt", list(fields.values()))
    return run


def test_a_derived_signal_has_a_sample_when_one_of_its_parts_has() -> None:
    run = position(session(DERIVED), 0.0, x=0.0)
    assert run.tracks[0].steps == 0
    position(run, 1.0, y=0.0)
    assert run.tracks[0].steps == 1
    position(run, 2.0, x=3.0, y=4.0)
    assert names(run, 0) == ["presumably_satisfied", "violated"]
    assert names(run, 1) == ["presumably_satisfied"]
    position(run, 3.0, x=0.0)
    assert names(run, 1) == ["presumably_satisfied", "violated"]


def test_what_was_computed_some_samples_ago_is_of_the_samples_of_all_that_is_in_it() -> None:
    run = session(XY + "never @{x - y, -2} == 99 and x > 99\n")
    (track,) = run.tracks
    feed(
        run,
        (0, "/a", 1.0),
        (1, "/b", 2.0),
        (2, "/a", 7.0),
        (2, "/a", 9.0),
        (3, "/b", 5.0),
        (4, "/a", math.nan),
        (5, "/a", 0.0),
    )
    place = [str(wanted) for wanted in track.property.inputs].index("@{x - y, -2}")
    assert [values[place] for values in track.values] == [-1.0, 5.0, 4.0]
    assert track.monitor.invalid == 1


def test_whether_a_predicate_held_some_samples_ago_leaves_out_samples_that_are_nan() -> None:
    run = session(XY + "never @{x > 1 and not y > 1, -1} and x > 99\n")
    (track,) = run.tracks
    feed(run, (0, "/a", 2.0), (1, "/b", 0.0), (2, "/a", math.nan), (3, "/a", 0.0), (4, "/b", 2.0), (5, "/a", 2.0))
    place = [str(wanted) for wanted in track.property.inputs].index("@{x > 1 and not y > 1, -1}")
    assert [values[place] for values in track.values] == [True, False, False]


def test_the_speed_of_a_place_that_only_tells_its_position_is_a_difference_quotient() -> None:
    run = session("object robot /gt Pose\nnever robot.velocity > 2\n")
    for time, x in ((0.0, 0.0), (1.0, 1.5), (1.5, 3.0)):
        position(run, time, x=x, y=0.0, z=0.0)
    assert names(run) == ["presumably_satisfied", "violated"]
    failure = run.tracks[0].decided_at
    assert failure is not None
    assert failure.values == (("robot.velocity", 3.0),)


def test_after_a_long_silence_a_difference_quotient_is_over_the_time_since_the_last_tick() -> None:
    run = session("_rate_ = 2\nobject robot /gt Pose\nnever robot.velocity > 2\n")
    for time, x in ((0.0, 0.0), (100.0, 0.5), (200.0, 2.0)):
        position(run, time, x=x, y=0.0, z=0.0)
    run.advance(ns(200.0))
    failure = run.tracks[0].decided_at
    assert failure is not None
    assert (failure.time, failure.values) == (ns(200.0), (("robot.velocity", 3.0),))


def test_two_positions_at_the_same_time_have_no_speed() -> None:
    run = session("object robot /gt Pose\nnever robot.velocity > 2\n")
    for time, x in ((0.0, 0.0), (0.0, 1.5)):
        position(run, time, x=x, y=0.0, z=0.0)
    assert (run.tracks[0].steps, run.tracks[0].invalid) == (0, 1)


def test_strings_booleans_and_arrays_are_sampled_as_they_are() -> None:
    run = session(
        "decl mode /m std_msgs/String.data\ndecl flag /f std_msgs/Bool.data\ndecl scan /s LaserScan.ranges\n"
        'never mode == "off"\nalways flag\nalways min(scan) > 0.5\n'
    )
    feed(run, (0, "/m", "off"), (0, "/f", True), (0, "/s", [1, 0.25]))
    assert [track.verdict.value for track in run.tracks] == ["violated", "presumably_satisfied", "violated"]


def test_properties_with_the_same_text_are_judged_each() -> None:
    run = feed(session(XY + "never x > 2\nnever x > 2\n"), (0, "/a", 3.0))
    assert [track.verdict for track in run.tracks] == [Verdict.VIOLATED] * 2


@given(st.floats(width=32, allow_nan=False))
def test_a_binary32_is_written_with_digits_that_read_as_the_same_binary32(value: float) -> None:
    written = float(reports.value_text(value))
    assert np.float32(written) == np.float32(value)
    assert significant(reports.value_text(value)) <= significant(repr(value))


def significant(number: str) -> int:
    """How many digits of a number are more than zeros at its ends."""
    return len(number.partition("e")[0].replace(".", "").strip("-0"))


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (float(np.float32(0.3)), "0.3"),
        (0.3, "0.3"),
        (0.30000001, "0.30000001"),
        (float(np.float32(1e-45)), "1e-45"),
        (16777216.0, "16777216.0"),
        (1e300, "1e+300"),
        (-0.0, "-0.0"),
        ((float(np.float32(0.1)), math.nan, 2), "[0.1, nan, 2]"),
    ],
)
def test_a_number_is_written_as_people_would(value: Any, text: str) -> None:
    assert reports.value_text(value) == text


def test_sides_that_differ_are_never_written_alike() -> None:
    condition = Condition("d > 0.3", True, float(np.float32(0.3)), 0.3, ">")
    run = feed(session(XY + "never x > 2\n"))
    text = reports.condition_text(run.tracks[0].property, condition)
    assert text == "d > 0.3: true, 0.30000001192092896 > 0.3 by 1.19209e-08"


def test_a_long_value_is_cut_in_text() -> None:
    assert reports.value_text((1.0, 2.0)) == "[1.0, 2.0]"
    array = reports.value_text((0.5,) * 1_000_000)
    assert array.startswith("[0.5, 0.5, ")
    assert array.endswith("]... (1000000 in all)")
    assert len(array) < 2000
    assert reports.value_text("é" * 201) == repr("é" * 200) + "... (201 in all)"


def test_a_malformed_message_is_no_step_but_is_news_and_renews_ages() -> None:
    run = feed(session(BOTH), (0, "/a", 1.0), (0, "/b", 1.0))
    (track,) = run.tracks
    assert run.judge(ns(1), "/a", None) == []
    assert (track.steps, track.invalid, run.session.is_incomplete) == (1, 0, True)
    assert "1 message on /a was malformed" in reports.summary(run.session)
    assert documents.document("run", run.session)["properties"][0]["malformed_messages"] == {"/a": 1}
    assert 'failures="0" errors="1"' in junit.junit("run", run.session)
    watched = feed(session("decl a /a std_msgs/Float64.data\nalways age(a) <= 2 s\n"), (0, "/a", 1.0))
    assert watched.judge(ns(2), "/a", None) == []
    assert watched.advance(ns(4)) == []
    assert [change.moment.time for change in watched.advance(ns(5))] == [ns(4) + 1]


def test_nothing_is_well_where_messages_were_lost_that_a_property_reads() -> None:
    run = feed(session(BOTH + SPEED + "other: never speed > 9\n"), (0, "/a", 1.0), (1, "/b", 2.0), (1, "/odom", 1.0))
    run.session.lose("/a")
    run.session.lose("/b", 2)
    run.session.lose("/b", 1)
    run.session.lose("/b")
    both, other = documents.document("run", run.session)["properties"]
    assert both["lost_messages"] == {"/a": None, "/b": None}
    assert both["lost_at_least"] == {"/a": 0, "/b": 3}
    assert "lost_messages" not in other
    assert (
        "may have been lost; 3 messages on /b were lost, and more may have been"
        in reports.summary(run.session).splitlines()[0]
    )
    assert 'failures="0" errors="1"' in junit.junit("run", run.session)
    verdicts = [track.verdict for track in run.tracks]
    assert (reports.exit_code(verdicts), reports.exit_code(verdicts, has_lost=True)) == (0, 3)


def test_ticks_begin_with_the_first_message_that_a_property_reads_whatever_others_read() -> None:
    alone = session("_rate_ = 5\ndecl x /x Float64.data\nx: never x > 2")
    beside = session(
        "_rate_ = 5\ndecl x /x Float64.data\ndecl y /y Float64.data\nx: never x > 2\ny: never y > 2\n"
        "ages: always age(y) <= 1 s\nxs: never @{x, -1} > 2"
    )
    for run in (alone, beside):
        run.begin(0)
        for time, topic, value in ((0.05, "/y", 1.0), (0.1, "/x", 1.0), (0.45, "/x", 3.0), (0.9, "/y", 3.0)):
            if topic in run.session.messages:
                run.message(ns(time), topic, [value])
        run.advance(ns(2))
    moments = {track.property.label: track.decided_at for run in (alone, beside) for track in run.tracks}
    assert {label: found and (found.step, found.time) for label, found in moments.items()} == {
        "x": (2, ns(0.5)),
        "y": (5, ns(1.05)),
        "ages": (9, ns(1.9) + 1),
        "xs": (2, ns(0.7)),
    }
    assert alone.tracks[0].steps == beside.tracks[0].steps
    assert [track.times[0] for track in beside.tracks] == [ns(0.1), ns(0.05), 0, ns(0.3)]
    assert beside.session.unseen == {"/x": 0, "/y": 0}


@pytest.mark.parametrize("value", [math.inf, -math.inf, 2.0])
def test_within_a_margin_an_infinite_value_equals_itself_and_no_other(value: float) -> None:
    run = session(
        "decl a /a Float64.data\ndecl b /b Float64.data\ndecl as /as Float64MultiArray.data\n"
        "before: always a =={0.5} @{a, -1}\nbeside: always a =={0.5} b\nconstant: always a =={0.5} 1e999\n"
        "elements: never any(as =={0.5} b)"
    )
    for time in (0, 1):
        run.samples(time, ("a", "b", "as"), (math.inf, value, [value, -value]))
    holds = value == math.inf
    assert [track.verdict.holds for track in run.tracks] == [True, holds, True, False]


@pytest.mark.parametrize("predicate", ["busy", "not busy", "not not busy", "busy or not busy", "(busy implies done)"])
def test_on_an_empty_segment_nothing_holds_initially_whatever_it_is_and_however_it_is_spelt(predicate: str) -> None:
    declared = "decl busy /t Bool.data\ndecl done /d Bool.data\n"
    run = session(
        f"{declared}is: until done, initially {predicate}\nnot_: until done, not initially {predicate}\n"
        f"named = initially {predicate}\nin_time: until done, within 1 s, named"
    )
    run.samples(0, ("busy", "done"), (False, True))
    assert [track.verdict for track in run.tracks] == [Verdict.VIOLATED, Verdict.SATISFIED, Verdict.VIOLATED]


def test_two_ways_to_write_an_array_whole_are_one_array_in_a_condition_on_its_elements() -> None:
    run = session("decl scan /scan LaserScan.ranges\nnever any(scan[0:] > scan[:])")
    run.samples(0, ("scan",), ((1.0, 2.0),))
    assert run.tracks[0].verdict is Verdict.PRESUMABLY_SATISFIED
