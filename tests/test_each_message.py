"""`each new s: P`: P is judged from each message of s on, as `always (new s implies P)` says where that is accepted."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from pathlib import Path

import pytest
from each_by_definition import HEAD, Row, give, plan_of, random_rows
from effort import share_of
from language_support import compiled

import ltlc
from ltlc.analysis.english import English
from ltlc.base.errors import UnusableInput
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.runtime.properties import Failure
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Plan, Session
from ltlc.runtime.slice_ids import Messages
from ltlc.runtime.slice_steps import Slices
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict

ACCEPTED = (
    "eventually kind == 2",
    "eventually (new prog and prog > 2) within 20 ns",
    "eventually stop within 15 ns",
    "never stop within 15 ns",
    "always v < 3 for 20 ns",
    "always v < 3",
    "never kind == 1",
    "until stop, always v < 2",
    "after kind == 1, eventually stop",
    "initially v < 2",
    "v < 3",
    "age(prog) <= 40 ns",
    "once stop within 20 ns",
    "once new prog or (historically v < 3 for 10 ns)",
    "new stop",
    "eventually new prog",
    "after kind == 1, never dist > 3",
    "(eventually kind == 2) or always stop",
    "eventually (previously v > 2 and v < 1)",
    "eventually once v > 2 2 times within 30 ns",
    "never once new prog 3 times within 40 ns",
)
"""Properties P of which `always (new s implies P)` is accepted, too."""


HOW_MANY = share_of(20)
"""Runs for each property."""


def verdicts(plan: Plan, rows: Sequence[Row], until: int) -> list[tuple[Verdict, int]]:
    """The changes of the verdict of one property, each with its time; satisfied for good counts as satisfied so far."""
    judge = ByRows(Session(plan))
    found = judge.begin(rows[0][0])
    for row in rows:
        found += give(judge, row)
    found += judge.advance(until)
    return _settled([(change.current, change.moment.time) for change in found])


def _settled(found: list[tuple[Verdict, int]]) -> list[tuple[Verdict, int]]:
    """What the verdict was at last at each time, where that is another than before."""
    well = Verdict.PRESUMABLY_SATISFIED
    at = {time: well if verdict is Verdict.SATISFIED else verdict for verdict, time in found}
    pairs = [(verdict, time) for time, verdict in at.items()]
    return [pair for n, pair in enumerate(pairs) if not n or pairs[n - 1][0] is not pair[0]]


@pytest.mark.parametrize(("number", "text"), list(enumerate(ACCEPTED)))
def test_each_new_says_what_always_says_where_that_is_accepted(number: int, text: str) -> None:
    chance = random.Random(text)
    opener = ("prog", "kind", "stop")[number % 3]
    is_state = not text.startswith(("eventually", "never", "always", "until", "after", "initially", "("))
    each = plan_of(f"{HEAD}p: each new {opener}: {'initially ' if is_state else ''}{text}")
    whole = plan_of(f"{HEAD}p: always (new {opener} implies {f'({text})' if is_state else text})")
    for _ in range(HOW_MANY):
        rows = random_rows(chance, chance.randint(1, 40), [1])
        until = rows[-1][0] + chance.choice([0, 10, 100])
        assert verdicts(each, rows, until) == verdicts(whole, rows, until)


MANY = (
    "eventually (prog > @{kind, opening} + 1 and v > 1) within 20 ns",
    "(eventually kind == 2 within 40 ns) and (after kind == 1, eventually stop within 30 ns)",
    "after_until kind == 1, kind == 2, eventually v < 1 within 30 ns",
    "within 50 ns, after kind == 2, always v < 3 for 10 ns",
)
"""Properties that need a clock or a value for each message."""


def instances(plan: Plan, rows: Sequence[Row], until: int) -> Track:
    """The one property of `plan` after these rows."""
    judge = ByRows(Session(plan))
    for row in rows:
        give(judge, row)
    judge.advance(until)
    return judge.session.tracks[0]


def messages_of(track: Track) -> Messages:
    assert isinstance(track.slices, Slices)
    assert isinstance(track.slices.ids, Messages)
    return track.slices.ids


def judged_from(plan: Plan, rows: Sequence[Row], first: int, until: int) -> Track:
    """By definition: what is known comes with the message, and the property is judged on the rest of the run."""
    judge = ByRows(Session(plan))
    fields, known = judge.session.fields, dict[str, object]()
    for _, topic, values in rows[: first + 1]:
        known |= {name: values[name] for name in fields.get(topic, ())}
    time, topic, _ = rows[first]
    judge.samples(time, tuple(known), list(known.values()), [topic] if topic in fields else [])
    for row in rows[first + 1 :]:
        give(judge, row)
    judge.advance(until)
    return judge.session.tracks[0]


@pytest.mark.parametrize("text", MANY)
def test_each_message_begins_the_property_on_the_rest_of_the_run(text: str) -> None:
    chance = random.Random(text)
    each, plain = plan_of(f"{HEAD}p: each new stop: {text}"), plan_of(f"{HEAD}p: {text}")
    for _ in range(HOW_MANY):
        known = [(0, "/track", {"id": 1, "kind": 0, "dist": 1.0}), (0, "/fb", {"fid": 1, "prog": 0.0})]
        known += [(0, "/odom", {"v": 1.0}), (0, "/estop", {"stop": False})]
        rows: list[Row] = [*known, *_without_nan(random_rows(chance, chance.randint(1, 40), [1]))]
        until = rows[-1][0] + chance.choice([0, 10, 100])
        openers = [n for n, row in enumerate(rows) if row[1] == "/estop"]
        expected = [judged_from(plain, rows, n, until) for n in openers]
        found = messages_of(instances(each, rows, until))
        decided = sorted(t.decided_at.time for t in expected if t.decided_at and t.verdict is Verdict.VIOLATED)
        assert sorted(time for v in found.violated.values() for time in [v.failure.time] * (1 + v.more)) == decided
        assert found.well == sum(t.verdict is Verdict.SATISFIED for t in expected)
        undecided = sum(not t.verdict.is_permanent for t in expected)
        assert sum(1 + found.more[id_] for id_ in found.slices) == undecided


CROWDED = (
    "eventually kind == 2 within 60 ns",
    "eventually (kind == 2 and v < 3) within 90 ns",
    "always (kind == 1 implies eventually kind == 2 within 30 ns)",
    "always (kind == 1 implies always v < 3 for 30 ns)",
    "always (kind == 2 implies eventually (v < 3 and kind == 0) within 20 ns)",
)
"""Properties of which many instances wait in one state."""


def crowded(chance: random.Random) -> tuple[list[Row], int]:
    """Rows of which many open an instance, the first ones are known before, and the last ones may have NaN."""
    known = {"id": 1, "kind": 0, "dist": 1.0}
    rows: list[Row] = [(0, "/track", known), (0, "/odom", {"v": 1.0})]
    openers = chance.randint(5, 25)
    for number in range(2 * openers + 20):
        time = rows[-1][0] + chance.choice((0, 1, 3, 9))
        if number < 2 * openers and number % 2:
            rows.append((time, "/estop", {"stop": False}))
        elif chance.random() < 0.7:
            rows.append((time, "/track", {**known, "kind": chance.choices((0, 1, 2), (8, 2, 1))[0]}))
        else:
            rows.append(
                (time, "/odom", {"v": chance.choice((0.5, 2.0, 5.0, math.nan if number > 2 * openers else 2.0))})
            )
    return rows, rows[-1][0] + chance.choice((0, 10, 200))


@pytest.mark.parametrize("text", CROWDED)
def test_each_of_many_open_messages_is_judged_as_the_only_one(text: str) -> None:
    chance = random.Random(text)
    each, plain = plan_of(f"{HEAD}p: each new stop: {text}"), plan_of(f"{HEAD}p: {text}")
    for _ in range(HOW_MANY):
        rows, until = crowded(chance)
        openers = [n for n, row in enumerate(rows) if row[1] == "/estop"]
        expected = [judged_from(plain, rows, n, until) for n in openers]
        track = instances(each, rows, until)
        found = messages_of(track)
        decided = sorted(_told(t.decided_at) for t in expected if t.decided_at and t.verdict is Verdict.VIOLATED)
        assert sorted(told for v in found.violated.values() for told in [_told(v.failure)] * (1 + v.more)) == decided
        assert found.well == sum(t.verdict is Verdict.SATISFIED for t in expected)
        owed = sorted(t.open_since.time for t in expected if t.open_since)
        assert (
            sorted(
                o.open_since.time for o in found.slices.values() if o.open_since for _ in range(1 + found.more[o.id])
            )
            == owed
        )
        assert all(0 < one.steps <= track.steps for one in found.slices.values())


def _told(failure: Failure) -> tuple[int, str]:
    """When it was, and the values, but whether a message opened this instance."""
    return failure.time, str([pair for pair in failure.values if not pair[0].startswith("new ")])


def _without_nan(rows: Sequence[Row]) -> list[Row]:
    return [(time, topic, values) for time, topic, values in rows if all(value == value for value in values.values())]


GOALS = """decl goal     /goal     std_msgs/Float64.data
decl accepted /accepted std_msgs/Float64.data
"""
ANSWERED = f"{GOALS}answered: each new goal: eventually (new accepted and accepted == @{{goal, opening}}) within 1 s\n"


def ran(folder: Path, text: str, rows: str) -> ltlc.Run:
    path = folder / "goals.csv"
    path.write_text(f"time,goal,accepted\n{rows}")
    return ltlc.run(text, path)


def test_a_report_names_the_messages_that_violated_a_property_and_those_that_are_owed(tmp_path: Path) -> None:
    text = ran(tmp_path, ANSWERED, "0,,0\n1,1,\n1.5,2,\n1.6,3,\n1.7,,2\n1.8,,1\n3,4,\n").text()
    assert text.startswith("Error at line 3 of specification (answered[goal at +1.6 s]):\n")
    assert 'more than 1 s since this "new goal": true' in text
    assert "(this one)" not in text
    assert text.endswith(
        "answered: violated by 1 of 4 messages of goal: that at +1.6 s (decided at +2.6 s); "
        "still open: that at +3 s (1 s left); 2 satisfied; 4 episodes\n"
    )


def test_a_document_has_the_messages(tmp_path: Path) -> None:
    (of,) = ran(tmp_path, ANSWERED, "0,,0\n1,1,\n1.5,2,\n1.7,,2\n3,4,\n").document()["properties"]
    each = of["each"]
    assert (each["new"], each["messages"], each["judged"], each["satisfied"]) == ("goal", 3, 3, 1)
    assert [(v["message"], v["opened_at"]["time"], v["decided_at"]["time"]) for v in each["violated"]] == [
        (1, 1.0, 2.000000001)
    ]
    assert [(o["opened_at"]["time"], o["left"]) for o in each["owed"]] == [(3.0, 1.0)]


def test_two_messages_at_one_time_open_two_instances(tmp_path: Path) -> None:
    found = ran(tmp_path, ANSWERED, "0,,0\n1,1,\n1,2,\n1.5,,2\n3,,0\n").document()["properties"][0]["each"]
    assert (found["judged"], found["satisfied"], len(found["violated"])) == (2, 1, 1)


def test_a_message_before_all_has_a_value_opens_nothing(tmp_path: Path) -> None:
    found = ran(tmp_path, f"{GOALS}p: each new goal: eventually accepted == 1", "0,1,\n1,,0\n2,2,\n3,nan,\n")
    each = found.document()["properties"][0]["each"]
    assert (each["messages"], each["judged"], each["no_step"]) == (3, 2, 1)


def test_a_message_opens_an_instance_where_the_run_before_it_decides(tmp_path: Path) -> None:
    found = ran(tmp_path, f"{GOALS}p: each new goal: initially once new accepted\n", "0,,0\n1,1,\n2,2,\n")
    each = found.document()["properties"][0]["each"]
    assert (each["messages"], each["satisfied"], each["no_step"]) == (2, 2, 0)


def test_messages_beyond_the_limit_of_open_ones_are_left_out(tmp_path: Path) -> None:
    text = f"{GOALS}p: each new goal limit 1: eventually accepted == @{{goal, opening}}\n"
    run = ran(tmp_path, text, "0,,0\n1,1,\n2,2,\n3,,1\n4,3,\n5,,3\n")
    each = run.document()["properties"][0]["each"]
    assert (each["left_out"], each["satisfied"], run.exit_code) == (1, 2, 3)


def test_what_goes_on_alike_is_kept_once() -> None:
    plan = plan_of(f"{GOALS}p: each new goal: never accepted > 2")
    track = instances(plan, [(0, "/accepted", {"accepted": 0.0}), *((t, "/goal", {"goal": t}) for t in range(1, 9))], 9)
    assert (list(messages_of(track).slices), messages_of(track).more) == ([1], {1: 7})
    rows: list[Row] = [(0, "/accepted", {"accepted": 0.0}), (1, "/goal", {"goal": 1}), (2, "/goal", {"goal": 1})]
    track = instances(plan, [*rows, (3, "/accepted", {"accepted": 3.0})], 9)
    assert messages_of(track).failed == 2


def test_with_a_rate_a_tick_that_has_news_opens_one() -> None:
    plan = plan_of(f"_rate_ = 1\n{GOALS}p: each new goal: eventually accepted > 2 within 2 s")
    second = 10**9
    rows: list[Row] = [(0, "/accepted", {"accepted": 0.0}), (0, "/goal", {"goal": 1})]
    rows += [(second // 4, "/goal", {"goal": 2}), (second // 2, "/goal", {"goal": 3})]
    found = messages_of(instances(plan, rows, 4 * second))
    assert [(v.failure.opened[0].time, v.failure.time) for v in found.violated.values()] == [
        (0, 2 * second + 1),
        (second, 3 * second + 1),
    ]


def test_a_sentence_says_that_it_is_judged_from_each_message_on() -> None:
    (of,) = compiled(ANSWERED).properties
    assert English(of).sentence().startswith("For each message of goal: at some moment in the next 1 s")


def test_python_refuses_by_name_what_is_judged_from_each_message_on() -> None:
    with pytest.raises(UnusableInput) as refused:
        ltlc.build(ANSWERED, "python")
    assert [(d.code, "each message of `goal`" in d.message) for d in refused.value.diagnostics] == [("LTL708", True)]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("each new goal limit 0: never goal > 2", "`limit` is the most that are kept"),
        ("each new nothing: never goal > 2", "nothing called `nothing` is defined"),
        ("each new goal: each new goal: goal > 2", "cannot stand here"),
    ],
)
def test_what_does_not_fit_is_an_error(text: str, told: str) -> None:
    _, found = load_text(Source("props.txt", f"{GOALS}p: {text}"))
    assert any(told in each.message for each in found), [each.message for each in found]


@pytest.mark.parametrize(
    ("text", "code", "instead"),
    [
        (
            "always (new goal implies (eventually accepted == 1 within 1 s) or (eventually accepted == 2 within 2 s))",
            "LTL310",
            "each new goal: (eventually accepted == 1 within 1 s) or (eventually accepted == 2 within 2 s)",
        ),
        (
            "always (new goal implies after accepted == 1, eventually accepted == 2 within 3 s)",
            "LTL310",
            "each new goal: after accepted == 1, eventually accepted == 2 within 3 s",
        ),
        (
            "always (new goal implies eventually accepted == @{goal, opening} within 1 s)",
            "LTL312",
            "each new goal: eventually accepted == @{goal, opening} within 1 s",
        ),
        (
            "always (new goal implies accepted > @{goal, opening})",
            "LTL312",
            "each new goal: initially accepted > @{goal, opening}",
        ),
    ],
)
def test_what_needs_a_clock_or_a_value_for_each_message_is_offered_as_such(text: str, code: str, instead: str) -> None:
    _, found = load_text(Source("props.txt", f"{GOALS}p: {text}"))
    (error,) = (each for each in found if each.code == code)
    assert f"write `{instead}`" in error.help
    compiled(f"{GOALS}p: {instead}")


def test_what_is_judged_for_each_id_is_not_offered_for_each_message() -> None:
    _, found = load_text(
        Source(
            "props.txt", f"{GOALS}p: each g of goal: always (new goal implies within 1 s, eventually always goal > 1)"
        )
    )
    assert [each.code for each in found if "each new" in each.help] == []


def test_a_topic_that_only_brings_news_is_not_why_nothing_started() -> None:
    text = "decl v /v Float64.data\ndecl bump /bump std_msgs/Empty\ndecl other /other Float64.data\n"
    text += "b: each new v: eventually new bump within 1 s\nc: each new v: eventually other < 1\n"
    news, value = ltlc.monitor(text).finish().text().splitlines()
    assert news == "b: not started; 0 messages of v; 0 episodes"
    assert value == "c: not started; no message on /other; 0 messages of v; 0 episodes"
