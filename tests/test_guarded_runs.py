"""`ltlc run --guard`: what guards let through of a recording, and that no property is violated by what leaves them."""

from __future__ import annotations

import json
import random
from pathlib import Path
from xml.etree import ElementTree

import pytest
from effort import share_of

import ltlc
from benchmarks.guarded import CMD, EXAMPLES, SCAN, SCANS, SPEEDS, Driven, Example
from ltlc.cli import main
from ltlc.monitoring.guarding.followed import Followed
from ltlc.specification.expressions import Field

NEAR = EXAMPLES["near"].text.replace("message stop {linear.x: 0}", "message stop {}")
ASKED = "decl asked /cmd_vel_raw geometry_msgs/Twist.linear.x\n"

Row = dict[str, object]


@pytest.mark.parametrize("name", EXAMPLES)
def test_what_leaves_a_guard_violates_no_property(name: str) -> None:
    driven = Driven(EXAMPLES[name])
    for seed in range(share_of(8)):
        found = driven.run(random.Random(seed), 60)
        assert not found["violated"], seed
        assert not found["lost"], seed


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_guard_knows_when_a_property_is_violated(name: str) -> None:
    driven = Driven(EXAMPLES[name])
    labels = {p.label for some in driven.guarding.solved for p in some.arena.parts}
    for seed in range(share_of(20)):
        followed = None
        driven.judge.reset()
        for time, values in driven.rows(random.Random(seed), 60):
            topic = driven.topic_of(values)
            followed = followed or driven.followed(time)
            for each in followed:
                each.hear(time, topic, values)
            driven.judge.step(values, time_ns=time)
            violated = {at.violated[0] for at in followed if at.violated is not None}
            judged = {x for x in labels if driven.judge.verdicts[x] is ltlc.Verdict.VIOLATED}
            assert violated <= judged, (seed, time)
            assert bool(violated) == bool(judged), (seed, time)
            if judged:
                break


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_guard_that_minds_nothing_lets_violations_through(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Followed, "rests", True)
    monkeypatch.setattr(Followed, "violated", None)
    driven = Driven(EXAMPLES[name])
    assert any(driven.run(random.Random(seed), 60)["violated"] for seed in range(20))


def guarded(folder: Path, text: str, rows: list[Row], *options: str) -> tuple[int, dict[str, object]]:
    """The exit code and the JSON of `ltlc run --guard` for a table of `rows`."""
    (folder / "p.txt").write_text(text, encoding="utf-8")
    (folder / "r.jsonl").write_text("".join(f"{json.dumps(row)}\n" for row in rows), encoding="utf-8")
    output = folder / "found.json"
    with pytest.MonkeyPatch.context() as patch, output.open("w", encoding="utf-8") as stream:
        patch.setattr("sys.stdout", stream)
        code = main(["run", "--guard", "--format", "json", *options, str(folder / "p.txt"), str(folder / "r.jsonl")])
    return code, json.loads(output.read_text(encoding="utf-8") or "{}")


def deeds(document: dict[str, object], guard: int = 0) -> list[tuple[float, str, object, object, str]]:
    """What a guard did: when, what, with which command, what left, and why."""
    (found,) = [document["guard"][guard]]  # type: ignore[index]
    kinds = ("passed", "changed", "held_back", "sent", "lost")
    return sorted(
        (
            each["time"],
            kind,
            each["command"] and each["command"]["speed"],
            each["sent"] and each["sent"]["speed"],
            each["reason"],
        )
        for kind in kinds
        for each in found[kind]
    )


def test_commands_pass_are_changed_held_back_and_sent_each_with_its_reason(tmp_path: Path) -> None:
    rows: list[Row] = [
        {"time": 0, "asked": 1},
        {"time": 1, "scan": [2, 3]},
        {"time": 2, "asked": 1},
        {"time": 3, "scan": [0.3, 3]},
        {"time": 3.05, "asked": 1},
        {"time": 4, "scan": [2, 3]},
        {"time": 5, "asked": 1},
        {"time": 6, "scan": [0.4, 3]},
        {"time": 7, "scan": [0.4, 3]},
    ]
    code, document = guarded(tmp_path, ASKED + NEAR, rows)
    assert code == 0
    assert deeds(document) == [
        (0, "held_back", 1, None, "a topic has not spoken yet"),
        (2, "passed", 1, 1, ""),
        (3.05, "changed", 1, 0, "it would violate `q`"),
        (5, "passed", 1, 1, ""),
        (6.09, "sent", None, 0, "ahead of a deadline of `p`"),
    ]
    assert {each["verdict"] for each in document["properties"]} == {"presumably_satisfied"}  # type: ignore[attr-defined]


def test_the_controller_has_its_time_to_do_it_by_itself(tmp_path: Path) -> None:
    rows: list[Row] = [
        {"time": 1, "scan": [2]},
        {"time": 2, "asked": 1},
        {"time": 3, "scan": [0.3]},
        {"time": 3.08, "asked": 0.1},
    ]
    _, document = guarded(tmp_path, ASKED + NEAR, [*rows, {"time": 4, "scan": [0.3]}])
    assert [(kind, sent) for _, kind, _, sent, _ in deeds(document)] == [("passed", 1), ("passed", 0.1)]


def test_what_was_recorded_without_a_guard_is_taken_for_its_commands(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows: list[Row] = [{"time": 1, "scan": [0.3]}, {"time": 2, "speed": 1}]
    code, document = guarded(tmp_path, NEAR, rows)
    assert (code, document["guard"][0]["commands_from"]) == (0, "/cmd_vel")  # type: ignore[index]
    assert [(kind, sent) for _, kind, _, sent, _ in deeds(document)] == [("changed", 0)]
    assert main(["run", "--guard", str(tmp_path / "p.txt"), str(tmp_path / "r.jsonl")]) == 0
    shown = capsys.readouterr().out
    assert "guard of /cmd_vel: 0 passed, 1 changed, 0 held back, 0 sent by itself" in shown
    assert "/cmd_vel_raw was not recorded: what was recorded on /cmd_vel is taken for its commands" in shown
    assert "  +1 s  changed speed = 1.0 to `stop`: it would violate `q`" in shown


def test_a_command_without_a_value_does_not_pass_nor_does_any_while_a_sensor_has_none(tmp_path: Path) -> None:
    text = ASKED + CMD + "decl gap /gap std_msgs/Float64.data\np: never (new speed and speed > gap)"
    rows: list[Row] = [
        {"time": 1, "gap": 2},
        {"time": 2, "asked": "NaN"},
        {"time": 3, "asked": 1},
        {"time": 4, "gap": "NaN"},
        {"time": 5, "asked": 1},
        {"time": 6, "gap": 2},
        {"time": 7, "asked": 1},
    ]
    _, document = guarded(tmp_path, text, rows)
    assert [(time, kind, why) for time, kind, _, _, why in deeds(document)] == [
        (2, "changed", "it has no value"),
        (3, "passed", ""),
        (5, "changed", "a value is missing"),
        (7, "passed", ""),
    ]


def test_a_guard_whose_first_scan_is_not_a_number_holds_back_until_there_is_one(tmp_path: Path) -> None:
    rows: list[Row] = [
        {"time": 1, "scan": ["NaN", "NaN"]},
        {"time": 2, "asked": 0.1},
        {"time": 3, "scan": ["NaN"]},
        {"time": 4, "scan": [2.0, "NaN"]},
        {"time": 5, "asked": 1},
    ]
    _, document = guarded(tmp_path, ASKED + NEAR, rows)
    assert [(time, kind, why) for time, kind, _, _, why in deeds(document)] == [
        (2, "held_back", "a value is missing"),
        (5, "passed", ""),
    ]


def test_a_broken_assumption_loses_and_from_then_on_the_first_fallback_is_sent(tmp_path: Path) -> None:
    text = ASKED + NEAR + "\nassume a: always min(scan) > 0.1"
    rows: list[Row] = [
        {"time": 1, "scan": [2]},
        {"time": 2, "asked": 1},
        {"time": 3, "scan": [0.05]},
        {"time": 4, "asked": 0.1},
    ]
    code, document = guarded(tmp_path, text, rows)
    assert code == 1
    lost = "the assumption `a` is violated"
    assert deeds(document)[1:] == [(3, "lost", None, None, lost), (4, "changed", 0.1, 0, f"the guard has lost: {lost}")]


def test_a_guard_that_loses_is_a_failure_of_its_own_in_junit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = ASKED + NEAR + "\nassume a: always min(scan) > 0.1"
    rows: list[Row] = [{"time": 1, "scan": [2.0]}, {"time": 2, "asked": 1}, {"time": 3, "scan": [0.05]}]
    guarded(tmp_path, text, rows[:2])
    (tmp_path / "r.jsonl").rename(tmp_path / "kept.jsonl")
    assert guarded(tmp_path, text, rows)[0] == 1
    for recordings in (["kept.jsonl"], ["r.jsonl"], ["kept.jsonl", "r.jsonl"]):
        main(["run", "--guard", "--format", "junit", str(tmp_path / "p.txt"), *(str(tmp_path / r) for r in recordings)])
        cases = [
            (case.attrib["name"], [(each.tag, each.get("message")) for each in case])
            for case in ElementTree.fromstring(capsys.readouterr().out).iter("testcase")
            if case.attrib["name"].startswith("guard")
        ]
        lost = ("failure", "lost at +2.0 s: the assumption `a` is violated")
        found = {"kept.jsonl": ("system-out", None), "r.jsonl": lost}
        assert cases == [("guard of /cmd_vel", [found[name]]) for name in recordings]


def test_the_page_says_what_the_guard_did(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    guarded(tmp_path, ASKED + NEAR, [{"time": 1, "scan": [0.3]}, {"time": 2, "asked": 1}], "--report", str(page))
    shown = page.read_text(encoding="utf-8")
    assert "guard of /cmd_vel: 0 passed, 1 changed, 0 held back, 0 sent by itself" in shown
    assert "+1 s  changed speed = 1.0 to <code>stop</code>: it would violate <code>q</code>" in shown


def test_a_command_that_violates_nothing_yet_is_changed_for_a_play_that_is_shown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "page.html"
    text = ASKED + AVOIDED["at odds"].text
    rows: list[Row] = [{"time": 1, "scan": [2]}, {"time": 2, "frozen": False}, {"time": 3, "asked": 1}]
    _, document = guarded(tmp_path, text, rows, "--report", str(page))
    (changed,) = document["guard"][0]["changed"]  # type: ignore[index]
    near = {"event": "a message on /scan", "values": {"scan": [0.0]}, "violated": [], "in_vain": []}
    frozen = {"event": "a message on /frozen", "values": {"frozen": True}, "violated": [], "in_vain": ["stop"]}
    late = {"event": "more than 100 ms later", "values": {}, "violated": ["p"], "in_vain": ["stop"]}
    assert changed["play"] == [frozen, {**near, "in_vain": ["stop"]}, late]
    assert changed["reason"] == (
        "a violation of `p` could no longer be avoided after it: a message on /frozen with frozen = true, "
        "then a message on /scan with scan = [0.0], then more than 100 ms later"
    )
    assert main(["run", "--guard", str(tmp_path / "p.txt"), str(tmp_path / "r.jsonl")]) == 0
    assert changed["reason"] in capsys.readouterr().out
    whole = "more than 100 ms later; <code>stop</code> before that would not help"
    assert whole in page.read_text(encoding="utf-8")


def test_two_guards_hear_what_the_other_one_sends(tmp_path: Path) -> None:
    text = ASKED + "decl wanted /grip_raw std_msgs/Float64.data\n" + EXAMPLES["two guards"].text
    rows: list[Row] = [{"time": 1, "asked": 0}, {"time": 2, "wanted": -1}, {"time": 3, "asked": 1}]
    _, document = guarded(tmp_path, text, rows)
    begins, keeps = "not all properties have begun", "it would violate `p`"
    assert [(kind, why) for _, kind, _, _, why in deeds(document)] == [("changed", begins), ("changed", keeps)]
    assert [each["sent"] for each in document["guard"][1]["passed"]] == [{"grip": -1}]  # type: ignore[index]


@pytest.mark.parametrize(
    ("text", "options", "said"),
    [
        ("decl speed /cmd_vel geometry_msgs/Twist.linear.x\nnever speed > 1", (), "has no guard"),
        (NEAR, ("--evidence", "e.txt"), "cannot be combined with --evidence: it shows what follows from the recording"),
        (NEAR, ("--cut", "extracts"), "cannot be combined with --cut: an extract has what was recorded"),
        (NEAR, ("--engine", "local"), "cannot be combined with --engine: the game"),
    ],
)
def test_what_cannot_be_tried_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, options: tuple[str, ...], said: str
) -> None:
    code, _ = guarded(tmp_path, text, [{"time": 0, "speed": 1}], *options)
    assert code == 2
    assert said in capsys.readouterr().err


def test_what_a_fallback_has_in_arrays_is_as_a_recording_of_it_would_be_read(tmp_path: Path) -> None:
    text = """guard /raw to /out else stop
message stop {twist.linear.x: 0.5}
decl speed /out geometry_msgs/TwistWithCovariance.twist.linear.x
decl covariance /out geometry_msgs/TwistWithCovariance.covariance
decl second /out geometry_msgs/TwistWithCovariance.covariance[1]
decl free /free std_msgs/Bool.data
p: always (free or speed < 1 and len(covariance) == 36 and max(covariance) == 0 and second == 0)
"""
    rows: list[Row] = [
        {"time": 1, "free": True},
        {"time": 2, "/raw/twist/linear/x": 2, "/raw/covariance": [1.0] * 36, "/raw/covariance[1]": 1},
    ]
    _, document = guarded(tmp_path, text, rows)
    (changed,) = document["guard"][0]["changed"]  # type: ignore[index]
    assert changed["sent"] == {"speed": 0.5, "covariance": [0.0] * 36, "second": 0.0}


def test_several_recordings_are_guarded_each_by_itself(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    guarded(tmp_path, ASKED + NEAR, [{"time": 1, "scan": [0.3]}, {"time": 2, "asked": 1}])
    rows = [{"time": 1, "scan": [0.05]}, {"time": 2, "asked": 0.1}]
    (tmp_path / "s.jsonl").write_text("".join(f"{json.dumps(row)}\n" for row in rows), encoding="utf-8")
    (tmp_path / "p.txt").write_text(f"{ASKED}{NEAR}\nassume a: always min(scan) > 0.1", encoding="utf-8")
    arguments = ["run", "--guard", "-q", str(tmp_path / "p.txt"), str(tmp_path / "r.jsonl"), str(tmp_path / "s.jsonl")]
    assert main(arguments) == 1
    shown = capsys.readouterr().out
    assert (
        "r.jsonl: 3 presumably satisfied\n  guard of /cmd_vel: 0 passed, 1 changed, 0 held back, 0 sent by itself"
        in shown
    )
    assert "1 with a violation or a guard that lost" in shown
    assert shown.endswith("guard of /cmd_vel: 0 passed, 2 changed, 0 held back, 0 sent by itself; it lost 1 time\n")
    assert main([*arguments, "--format", "json"]) == 1
    summary = json.loads(capsys.readouterr().out)["summary"]
    assert summary["guard"] == [{"out": "/cmd_vel", "passed": 0, "changed": 2, "held_back": 0, "sent": 0, "lost": 1}]
    table = str(tmp_path / "t.parquet")
    assert main([*arguments, "--results", table]) == 1
    assert main([*arguments, "--results", table]) == 1
    assert "2 judged before" in capsys.readouterr().out
    main([*arguments[:1], *arguments[2:], "--results", table])
    assert "guard" not in capsys.readouterr().out


def test_a_run_without_guards_on_commands_alone_says_how_they_are_judged(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    guarded(tmp_path, ASKED + NEAR, [{"time": 1, "scan": [0.3]}, {"time": 2, "asked": 1}])
    hint = "`--guard` judges what the guards of the file would have let through of recorded commands"
    assert main(["run", str(tmp_path / "p.txt"), str(tmp_path / "r.jsonl")]) == 3
    assert capsys.readouterr().err.count(hint) == 3  # for the column, and for each property
    assert main(["run", "--guard", str(tmp_path / "p.txt"), str(tmp_path / "r.jsonl")]) == 0
    assert hint not in capsys.readouterr().err


def test_only_what_a_guard_did_between_two_times_is_reported(tmp_path: Path) -> None:
    rows: list[Row] = [{"time": 1, "scan": [2]}]
    rows += [{"time": n, "asked": 1} for n in range(2, 8)]
    _, document = guarded(tmp_path, ASKED + NEAR, rows, "--from", "3", "--until", "5")
    assert [time for time, *_ in deeds(document)] == [3, 4, 5]


def test_the_examples_read_what_they_declare() -> None:
    """An example whose signals no property reads would be judged on nothing."""
    for name, example in EXAMPLES.items():
        driven = Driven(example)
        read = {signal.name for signal in driven.signals.values() if isinstance(signal.definition, Field)}
        assert {n for of in example.values.values() for n in of} == read, name
    assert Driven(Example(CMD + SCAN + "never speed > min(scan)", SPEEDS | SCANS)).labels == ["line 5"]


AVOIDED = {
    "strict": Example(CMD + SCAN + "p: always (min(scan) < 0.5 implies speed <= 0.2)", SPEEDS | SCANS),
    "at odds": Example(
        CMD + SCAN + "decl frozen /frozen std_msgs/Bool.data\n"
        "p: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)\nq: never (new speed and frozen)",
        SPEEDS | SCANS | {"/frozen": {"frozen": [True, False]}},
    ),
    "mixed": Example(
        CMD + SCAN + "p: always (speed > min(scan) implies eventually speed <= min(scan) within 200 ms)", SPEEDS | SCANS
    ),
    "rate and near, as one": EXAMPLES["rate and near, as one"],
}


@pytest.mark.parametrize("name", AVOIDED)
def test_the_play_for_which_a_command_is_held_back_violates_the_properties_that_it_names(name: str) -> None:
    driven, seen = Driven(AVOIDED[name]), 0
    for seed in range(6):
        for heard, done in driven.held_back(random.Random(seed), 60):
            assert done.play is not None
            assert done.deed.command is not None
            seen += 1
            driven.judge.reset()
            for event in heard:
                driven.judge.step(dict(event.values), time_ns=event.time)
            now = done.deed.time
            driven.judge.step(dict(done.deed.command), time_ns=now)
            assert ltlc.Verdict.VIOLATED not in driven.judge.verdicts.values()
            for move in done.play.moves:
                now += 1 if move.event.startswith("a message") else 1_000_000_000
                driven.judge.step(dict(move.values), time_ns=now)
            verdicts = driven.judge.verdicts
            assert {verdicts[label] for label in done.play.moves[-1].violated} == {ltlc.Verdict.VIOLATED}, done
    assert seen


def test_a_command_that_is_held_back_does_not_begin_the_session(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "props.txt").write_text(
        "guard /cmd_vel_raw to /cmd_vel else stop\nmessage stop {}\ndecl speed /cmd_vel geometry_msgs/Twist.linear.x\n"
        f"{ASKED}decl go /go std_msgs/Bool.data\n"
        "beats: always age(speed) <= 100 ms\nslow: always (new speed and not go implies speed == 0)\n"
    )
    (tmp_path / "drive.csv").write_text("time,asked,go\n0,1,\n1,1,\n2,,true\n2.05,1,\n2.2,,\n")
    arguments = ["run", "--guard", str(tmp_path / "props.txt"), str(tmp_path / "drive.csv"), "--format", "json"]
    assert main(arguments) == 0
    [guard] = json.loads(capsys.readouterr().out)["guard"]
    assert [len(guard[each]) for each in ("held_back", "passed", "sent", "lost")] == [2, 1, 1, 0]
    assert guard["sent"][0]["time"] == 2.14
