"""`each`: a property is judged for each id, on the slice of the run for it."""

from __future__ import annotations

import json
import math
import random
from pathlib import Path

import pytest
from each_by_definition import (
    HEAD,
    ONE_TOPIC,
    TWO_TOPICS,
    Quantified,
    Row,
    conjunction,
    give,
    ids_of,
    judged,
    plan_of,
    quantified,
    random_rows,
    run,
)
from effort import share_of
from language_support import compiled
from stepping import session

import ltlc
from ltlc.analysis.analyse import analyse
from ltlc.automata import Budget
from ltlc.base.errors import UnusableInput
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.runtime import documents
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.runtime.slice_ids import Ids
from ltlc.runtime.slice_keys import Id
from ltlc.runtime.slice_steps import Slices
from ltlc.runtime.tracking import Track
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.verdicts import Verdict

CASES = [*((text, "id") for text in ONE_TOPIC), *((text, "id, fid") for text in TWO_TOPICS)]


def slices_of(track: Track) -> Slices:
    assert isinstance(track.slices, Slices)
    return track.slices


def ids_in(track: Track) -> Ids:
    return slices_of(track).ids


def compare(of: Quantified, rows: list[Row], until: int) -> None:
    """The slices of a session are judged as by definition, and so is the whole."""
    (track,) = run(of.sliced, rows, until).tracks
    slices = ids_in(track)
    expected: dict[Id, Track] = {id_: judged(of, rows, id_, until) for id_ in ids_of(of, rows)}
    decided = {id_: t for id_, t in expected.items() if t.verdict.is_permanent}
    violated = {id_: t.decided_at for id_, t in decided.items() if t.verdict is Verdict.VIOLATED}
    assert track.verdict is conjunction([t.verdict for t in expected.values()])
    assert {i: v.failure.time for i, v in slices.violated.items()} == {i: f and f.time for i, f in violated.items()}
    assert slices.satisfied == decided.keys() - violated.keys()
    assert slices.forgotten == expected.keys() - slices.slices.keys() - decided.keys()
    assert (track.episodes or 0) == sum(t.episodes or 0 for t in expected.values())
    for id_, one in slices.slices.items():
        other = expected[id_]
        assert one.verdict is other.verdict
        assert one.deadline() == other.deadline()
    for id_ in expected.keys() - slices.slices.keys() - decided.keys():
        assert expected[id_].verdict is Verdict.PRESUMABLY_SATISFIED, "only what is well is forgotten"
    undecided = [t for t in expected.values() if not t.verdict.is_permanent]
    if len(undecided) == len(expected):
        assert track.steps == sum(t.steps for t in undecided)
        assert track.invalid == sum(t.invalid for t in undecided)


@pytest.mark.parametrize(("text", "keys"), CASES)
def test_slices_are_judged_as_runs_by_themselves(text: str, keys: str) -> None:
    chance = random.Random(f"{text} {keys}")
    of = quantified(text, keys)
    for _ in range(share_of(40)):
        rows = random_rows(chance, chance.randint(1, 60), chance.sample(range(9), chance.randint(1, 5)))
        compare(of, rows, rows[-1][0] + chance.choice([0, 10, 100]))


RATED = [text for text in ONE_TOPIC if " v " in f" {text} " and ("kind" in text or "dist" in text)]


@pytest.mark.parametrize("text", [text.replace(" ns", " us") for text in RATED])
def test_with_a_rate_the_ticks_of_the_session_are_steps_of_every_slice(text: str) -> None:
    chance = random.Random(text)
    of = quantified(text, "id", "_rate_ = 100000\n")
    for _ in range(share_of(25)):
        rows = random_rows(chance, chance.randint(1, 40), chance.sample(range(9), chance.randint(1, 4)))
        first: Row = (rows[0][0], "/odom", {"v": 1.5})  # with this the ticks begin, of each slice by itself, too
        slower = [(1000 * time, topic, values) for time, topic, values in (first, *rows)]
        compare(of, slower, 1000 * (rows[-1][0] + chance.choice([0, 10, 1000])))


def whole(text: str, rows: list[Row], until: int | None = None) -> Track:
    """The one property of `text` after these rows."""
    (track,) = run(plan_of(HEAD + text), rows, rows[-1][0] if until is None else until).tracks
    return track


def track_row(time: int, id_: object, kind: int = 0, dist: float = 0.0) -> Row:
    return time, "/track", {"id": id_, "kind": kind, "dist": dist}


def test_a_message_without_an_id_is_in_no_slice_and_is_counted() -> None:
    rows = [track_row(0, 1), track_row(1, math.nan, 2), track_row(2, None, 2)]
    slices = slices_of(whole("p: each g of id: never kind == 2", rows))
    assert (slices.ids.messages, slices.ids.without_id, slices.ids.violated) == (1, 2, {})


def test_zero_and_minus_zero_are_one_id() -> None:
    rows = [track_row(0, 0.0, 1), track_row(1, -0.0, 2)]
    slices = slices_of(
        whole("p: each g of dist: never kind == 2", [(t, p, {**v, "dist": v["id"]}) for t, p, v in rows])
    )
    assert list(slices.ids.violated) == [0]


def test_an_infinite_id_is_a_string_in_json() -> None:
    rows = [(time, "/track", {"id": 1, "kind": kind, "dist": math.inf}) for time, kind in ((0, 1), (1, 2))]
    text = "p: each g of dist: never kind == 2\nq: each g of dist: eventually kind == 3"
    violated, owed = (slices_of(t).document() for t in run(plan_of(HEAD + text), rows, 1).tracks)
    assert [each["id"] for each in (*violated["violated"], *owed["owed"])] == ["inf", "inf"]


def test_each_violation_is_told_once_and_the_ids_are_listed() -> None:
    judge = ByRows(
        Session(plan_of(f"{HEAD}p: each g of id: always (kind == 1 implies eventually kind == 2 within 9 ns)"))
    )
    slices = slices_of(judge.session.tracks[0])
    told = []
    for row in (track_row(0, 7, 1), track_row(5, 8, 1), track_row(12, 9), track_row(13, 9, 1)):
        give(judge, row)
        told.append([json.loads(line)["id"] for _, line in slices.untold()])
    assert told == [[], [], [7], []]
    assert slices.listed() == {"violated ids": "7", "open ids": "8, 9"}
    judge.advance(100)
    texts = [text for text, _ in slices.untold()]
    assert [text.splitlines()[0] for text in texts] == [
        f"Error at line {slices.track.property.line} of props.txt (p[g = {id_}]):" for id_ in (8, 9)
    ]


def test_messages_that_were_lost_are_reported_of_topics_that_are_sliced() -> None:
    session = run(plan_of(f"{HEAD}p: each g of id, fid: never g == 3 and v > 2"), [track_row(0, 1)], 1)
    for topic in ("/track", "/fb", "/odom", "/estop"):
        session.lose(topic, 2)
    (document,) = documents.document("drive", session)["properties"]
    assert document["lost_messages"] == {"/track": 2, "/fb": 2, "/odom": 2}


def test_ids_beyond_the_limit_are_left_out_and_those_that_come_later_are_marked() -> None:
    text = "p: each g of id limit 1: after kind == 1, never kind == 2"
    rows = [track_row(0, 1, 1), track_row(1, 2, 2), track_row(2, 1, 2)]
    slices = slices_of(whole(text, rows))
    assert (slices.left_out, list(slices.ids.violated)) == (1, [1])
    assert "1 message of ids beyond the limit of 1 left out" in slices.remarks()
    freed = "p: each g of id limit 1: always (kind == 1 implies eventually kind == 2)"
    rows = [track_row(0, 1, 1), track_row(1, 2), track_row(2, 1, 2), track_row(3, 2, 1)]
    slices = slices_of(whole(freed, rows))
    assert (slices.left_out, slices.ids.lacking) == (1, {2})
    assert slices.remarks()[0] == "still open: 2 since +0 s (its beginning may be missing)"


def test_nothing_is_kept_of_ids_that_are_forgotten_or_decided() -> None:
    text = "p: each g of id limit 1: (always (kind == 1 implies eventually kind == 2)) and never kind == 3"
    rows = [track_row(0, 1, 1), track_row(1, 2), track_row(2, 1, 2)]
    rows += [track_row(2 * n, n, 1) for n in range(2, 9)] + [track_row(2 * n + 1, n, 2) for n in range(2, 9)]
    slices = slices_of(whole(text, [*sorted(rows), track_row(20, 9, 3)]))
    assert (slices.left_out, list(slices.ids.violated), slices.ids.slices, slices.ids.lacking) == (1, [9], {}, set())


def test_what_is_as_new_is_dropped_and_what_is_decided_stays_so() -> None:
    text = "p: each g of id: always (kind == 1 implies eventually kind == 2 within 5 ns)"
    slices = slices_of(whole(text, [track_row(0, 1, 1), track_row(2, 1, 2), track_row(2, 2, 1)], 20))
    assert (slices.ids.slices, list(slices.ids.violated), slices.ids.forgotten) == ({}, [2], {1})
    slices = slices_of(whole(text, [track_row(0, 1, 1), track_row(20, 1, 1)], 100))
    assert (slices.ids.births, list(slices.ids.violated)) == (1, [1])


def test_the_verdict_of_the_whole_is_told_as_it_changes_and_is_never_satisfied() -> None:
    text = "p: each g of id: eventually kind == 2 within 10 ns"
    judge = ByRows(Session(plan_of(HEAD + text)))
    told = []
    for row in (track_row(0, 1), track_row(1, 2), track_row(2, 1, 2), track_row(3, 2, 2), track_row(5, 3)):
        told += [(change.current, change.moment.time) for change in give(judge, row)]
    told += [(change.current, change.moment.time) for change in judge.advance(100)]
    owed, well = Verdict.PRESUMABLY_VIOLATED, Verdict.PRESUMABLY_SATISFIED
    assert told == [(owed, 0), (well, 3), (owed, 5), (Verdict.VIOLATED, 16)]
    assert judge.due() is None


def test_the_verdict_after_each_step_is_that_of_the_whole() -> None:
    rows = [track_row(0, 1, 1), track_row(1, 2), track_row(2, 1, 2)]
    plan = plan_of(f"{HEAD}p: each g of id: always (kind == 1 implies eventually kind == 2)")
    (track,) = run(plan, rows, 2, keep_verdicts=True).tracks
    assert [verdict.value for verdict in track.verdicts or ()] == [
        "presumably_violated",
        "presumably_violated",
        "presumably_satisfied",
    ]
    assert track.times == [0, 1, 2]


def test_a_timeout_counts_from_the_first_step_of_any_slice_and_ends_all() -> None:
    text = "_timeout_ = 0.000000010\np: each g of id: eventually kind == 2 within 8 ns"
    slices = slices_of(whole(text, [track_row(0, 1), track_row(5, 2), track_row(11, 3)], 100))
    assert (list(slices.ids.violated), list(slices.ids.slices)) == ([1], [2])


def test_the_end_of_a_run_that_a_slice_begins_is_noticed_by_the_next_message() -> None:
    declared = "decl id /track std_msgs/Int32.data\ndecl v /v std_msgs/Float64.data\n_timeout_ = 10 ns\n"
    run = session(f"{declared}each g of id: never g == 3\nnever v > @{{v, -9}}\n")
    run.message(0, "/v", (1.0,))
    run.message(5, "/track", (1,))
    run.message(16, "/track", (3,))
    assert run.session.is_over
    assert not slices_of(run.tracks[0]).ids.violated


def test_the_end_of_a_run_that_begins_before_any_instance_is_noticed_by_the_next_message() -> None:
    declared = "decl goal /goal std_msgs/Int32.data\ndecl v /v std_msgs/Float64.data\n_timeout_ = 10 ns\n"
    run = session(f"{declared}each new goal: never new goal and goal == 3\nnever v > @{{v, -9}}\n")
    run.message(0, "/v", (1.0,))
    run.message(11, "/goal", (3,))
    assert run.session.is_over
    assert run.tracks[0].verdict is Verdict.PRESUMABLY_SATISFIED


def test_a_row_of_a_table_with_two_ids_is_a_step_of_both_slices() -> None:
    text = "p: each g of id, fid: never (new kind and stop)\nq: each g of id, fid: never (new prog and v > 1)"
    session = Session(plan_of(HEAD + text))
    values = {"id": 1, "kind": 0, "fid": 2, "prog": 0.0, "stop": True, "v": 2.0}
    ByRows(session).samples(0, tuple(values), list(values.values()))
    assert [list(ids_in(track).violated) for track in session.tracks] == [[1], [2]]


def test_names_of_the_form_are_names_elsewhere() -> None:
    head = "decl each /a Float64.data decl of /b Float64.data\n"
    text = head + "decl limit /c Float64.data\neach: never each > of\nof > limit"
    assert [p.label for p in compiled(text).properties] == ["each", "line 4"]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("each v of id: never kind == 2", "`v` has another meaning in this file"),
        ("each g of id, kind: never dist > 2", "`/track` has two keys, but a message has one id"),
        ("each g of id limit 0: never dist > 2", "`limit` is the most that are kept"),
        ("each g of id + 1: never dist > 2", "cannot stand here"),
        ("each g of id: never v > 2", "the property uses neither `g` nor a value or news from `/track`"),
        ("each g of id, stop: never dist > 2", "`stop` is a boolean, and `id` is a number"),
        ("each g of id: never new g", "`g` is an id: it never changes"),
        ("each g of id: never @{g, -1} > 2", "`g` is an id: it never changes"),
        ("each g of nothing: never dist > 2", "nothing called `nothing` is defined"),
    ],
)
def test_what_does_not_fit_is_an_error_at_its_place(text: str, told: str) -> None:
    _, found = load_text(Source("props.txt", f"{HEAD}p: {text}"))
    assert any(told in each.message for each in found), [each.message for each in found]


def test_an_id_is_no_name_outside_its_property() -> None:
    _, found = load_text(Source("props.txt", f"{HEAD}p: each g of id: never g == 2\nq: never g == 2"))
    assert [each.code for each in found if each.code == "LTL101"] == ["LTL101"]


def test_properties_of_slices_and_of_the_whole_run_are_not_held_against_each_other() -> None:
    text = f"{HEAD}p: each g of id: never kind == 2\nq: eventually kind == 2\nr: each h of id: eventually kind == 2"
    report = analyse(compiled(text), EPISODE, Budget())
    (conflict,) = [found for found in report.diagnostics if found.code == "LTL601"]
    assert [name in conflict.message for name in ("`p`", "`q`", "`r`")] == [True, False, True]


def test_a_comparison_refuses_by_name_what_is_judged_for_each_id() -> None:
    with pytest.raises(UnusableInput) as refused:
        ltlc.compare(f"{HEAD}p: each g of id: never kind == 2")
    [told] = refused.value.diagnostics
    assert (told.code, told.help) == ("LTL711", "`ltlc run` and `ltlc.monitor` judge it; for known names, use `forall`")
    with pytest.raises(UnusableInput) as refused:
        ltlc.compare(f"{HEAD}p: each new id: never kind == 2")
    assert refused.value.diagnostics[0].help == "`ltlc run` and `ltlc.monitor` judge it"


GOALS = """time,goal,status
0,7,2
4,7,2
4,8,2
9,7,4
19,8,2
70,9,1
75,,
"""
GOALS_TEXT = """decl goal   /goal_status sensor_msgs/JoyFeedback.id
decl status /goal_status sensor_msgs/JoyFeedback.type
ends: each g of goal: eventually status in {4, 5, 6} within 60 s
"""


def judged_goals(folder: Path, text: str = GOALS_TEXT) -> ltlc.Run:
    path = folder / "goals.csv"
    path.write_text(GOALS)
    return ltlc.run(text, path)


def test_a_report_names_the_ids_that_violated_a_property_and_those_that_are_owed(tmp_path: Path) -> None:
    text = judged_goals(tmp_path).text()
    assert text.startswith("Error at line 3 of specification (ends[g = 8]):\n")
    assert text.endswith(
        "ends: violated by 1 of 3 ids: 8 at +64 s; still open: 9 since +70 s (55 s left); 1 satisfied; 6 messages\n"
    )


def test_a_document_has_the_ids(tmp_path: Path) -> None:
    (of,) = judged_goals(tmp_path).document()["properties"]
    each = of["each"]
    assert (each["keys"], each["ids"], each["started"], each["satisfied"]) == (["goal"], 3, 3, 1)
    assert [(v["id"], v["decided_at"]["time_ns"]) for v in each["violated"]] == [(8, 64_000_000_001)]
    assert [(o["id"], o["open_since"]["time"], o["left"]) for o in each["owed"]] == [(9, 70.0, 55.0)]
    assert (each["left_out"], each["without_id"], of["decided_at"]["time_ns"]) == (0, 0, 64_000_000_001)


def test_where_ids_were_left_out_not_all_is_well(tmp_path: Path) -> None:
    text = GOALS_TEXT.replace("of goal:", "of goal limit 1:").replace(
        "eventually status in {4, 5, 6} within 60 s", "never status == 9"
    )
    assert judged_goals(tmp_path, GOALS_TEXT.replace("of goal:", "of goal limit 1:")).exit_code == 3
    assert judged_goals(tmp_path, text).exit_code == 0, "what is as new takes no place"


def test_ids_that_would_not_stand_alone_are_in_quotes(tmp_path: Path) -> None:
    rows = "".join(f'{{"time": 0, "name": {json.dumps(name)}}}\n' for name in ("", "arm", "motor: left, 2"))
    (tmp_path / "run.jsonl").write_text(rows)
    report = ltlc.run('decl name /n String.data\np: each n of name: always n == "x"\n', tmp_path / "run.jsonl")
    told = 'p: violated by 3 of 3 ids: "" at +0 s, arm at +0 s, "motor: left, 2" at +0 s; 3 messages'
    assert report.text().splitlines()[-1] == told


def test_messages_that_were_left_out_are_reported_beside_the_verdict(tmp_path: Path) -> None:
    run = judged_goals(tmp_path, GOALS_TEXT.replace("of goal:", "of goal limit 1:"))
    (found,) = (each for each in run.diagnostics if each.code == "LTL850")
    assert found.message == "3 messages were ignored by `ends`, which has a limit of 1"
    assert not any(each.code == "LTL850" for each in judged_goals(tmp_path).diagnostics)


def test_a_run_that_goes_on_is_judged_as_a_recorded_one() -> None:
    live = ltlc.monitor(GOALS_TEXT)
    told = []
    for time, goal, status in ((0, 7, 2), (4, 8, 2), (9, 7, 4), (70, 9, 1)):
        told += [each.current.value for each in live.step({"goal": goal, "status": status}, time=float(time))]
    assert told == ["presumably_violated", "violated"]
    assert live.finish().exit_code == 1


@pytest.mark.parametrize(
    "text", ["always age(status) <= 3 s", "never status - @{status, -1} > 1", "eventually status == 4"]
)
def test_a_run_without_ids_says_what_is_silent(text: str) -> None:
    run = ltlc.monitor(
        f"{GOALS_TEXT.partition('ends')[0]}decl v /v Float64.data\np: each g of goal: {text}\nq: never v > 1"
    )
    run.step({"v": 0.5}, time=0.0)
    assert "p: not started; no message on /goal_status; 0 ids; 0 messages" in run.finish().text()
