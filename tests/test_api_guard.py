"""`ltlc.guard`: guards stepped row by row do what they do with the same rows in a recording."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from pathlib import Path

import pytest
from effort import share_of

import ltlc
from benchmarks.guarded import CMD, EXAMPLES, MS, SCAN, Driven
from ltlc.cli import main
from ltlc.runtime.guarding import Action, Deed

NEAR = f"""{CMD}{SCAN}decl asked /cmd_vel_raw geometry_msgs/Twist.linear.x
near: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)
"""

Row = dict[str, object]


def drawn(driven: Driven, seed: int) -> Iterator[tuple[int, Row]]:
    """Times in ns, and rows with the commands in columns by topic and field."""
    chance, time = random.Random(seed), 0
    _, commands = driven.guarding.wanted(driven.signals)
    columns = {let: column for column, let in commands.items()}
    topics = [*driven.example.values, *driven.raws]
    for number in range(40):
        time += chance.choice([0, 1, 10 * MS, 30 * MS, 90 * MS, 100 * MS, 500 * MS])
        for topic in driven.example.values if number == 0 else [chance.choice(topics)]:
            values = driven.example.values[topic]
            yield time, {columns.get(name, name): chance.choice(of) for name, of in values.items()}


@pytest.mark.parametrize("name", EXAMPLES)
def test_steps_do_what_is_done_with_the_same_rows_in_a_recording(name: str, tmp_path: Path) -> None:
    driven, run = Driven(EXAMPLES[name]), ltlc.guard(EXAMPLES[name].text)
    (tmp_path / "p.txt").write_text(EXAMPLES[name].text, encoding="utf-8")
    for seed in range(share_of(3)):
        run.reset()
        rows = [*drawn(driven, seed)]
        deeds = [deed for time, row in rows for deed in stepped(run, time, row)]
        lines = (json.dumps({"time": 0, **row}).replace("0", f"{time / 1e9:.9f}", 1) for time, row in rows)
        (tmp_path / "r.jsonl").write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
        assert sorted(map(shown, deeds)) == sorted(recorded(tmp_path))


def stepped(run: ltlc.LiveGuard, time: int, row: Row) -> Iterator[Deed]:
    """What a guard does that is stepped whenever it is due, and at a row."""
    while (due := run.due) is not None and due <= time:
        yield from run.step({}, time_ns=due)
    yield from run.step(row, time_ns=time)


def shown(deed: Deed) -> str:
    values = (None if some is None else {n: _plain(v) for n, v in some.items()} for some in (deed.command, deed.values))
    return json.dumps([deed.time, deed.action.value, deed.message, deed.reason, *values])


def _plain(value: object) -> object:
    return list(value) if isinstance(value, tuple) else value


def recorded(folder: Path) -> Iterator[str]:
    """What `ltlc run --guard` lists."""
    output = folder / "found.json"
    with pytest.MonkeyPatch.context() as patch, output.open("w", encoding="utf-8") as stream:
        patch.setattr("sys.stdout", stream)
        main(["run", "--guard", "--format", "json", str(folder / "p.txt"), str(folder / "r.jsonl")])
    for guard in json.loads(output.read_text(encoding="utf-8"))["guard"]:
        for action in Action:
            for each in guard[action.value]:
                values = (each["command"], each["sent"])
                yield json.dumps([each["time_ns"], action.value, each["message"], each["reason"], *values])


def test_a_guard_that_is_stepped_when_it_is_due_sends_its_fallback() -> None:
    assert ltlc.guard(NEAR).due is None
    run = ltlc.guard(NEAR)
    run.step({"scan": [2.0]}, time=0)
    run.step({"asked": 1.0}, time=0.5)
    run.step({"scan": [0.3]}, time=1)
    assert run.due == 1_090 * MS
    assert run.step({}, time_ns=run.due - 1) == []
    (deed,) = run.step({}, time_ns=run.due)
    assert (deed.time, deed.action, deed.message, deed.values) == (1_090 * MS, Action.SENT, "stop", {"speed": 0.0})


def test_a_guard_that_is_stepped_too_late_has_lost() -> None:
    run = ltlc.guard(NEAR)
    run.step({"scan": [2.0]}, time=0)
    run.step({"asked": 1.0}, time=0.5)
    run.step({"scan": [0.3]}, time=1)
    deeds = run.step({"asked": 0.0}, time=1.2)
    assert [each.action for each in deeds] == [Action.LOST, Action.CHANGED]
    assert deeds[0].reason.startswith("it was late")


def test_after_a_reset_nothing_has_spoken_yet() -> None:
    run = ltlc.guard(NEAR)
    run.step({"scan": [2.0]}, time=0)
    assert [each.action for each in run.step({"asked": 1.0}, time=1)] == [Action.PASSED]
    run.reset()
    assert [each.action for each in run.step({"asked": 1.0}, time=0)] == [Action.HELD]


def test_fields_of_fallbacks_are_given_by_their_paths() -> None:
    assert ltlc.guard(NEAR).fallbacks == {"stop": {"linear/x": 0.0}}
    assert ltlc.guard(EXAMPLES["battery low"].text).fallbacks == {"dock": {"data": "dock"}}


@pytest.mark.parametrize(
    ("row", "reason"),
    [
        ({"scam": [1.0]}, "no guard reads `scam`; did you mean `scan`?"),
        ({"/cmd_vel_row/linear/x": 1.0}, "no guard reads `/cmd_vel_row/linear/x`"),
        ({"asked": "fast"}, '`asked`: `"fast"` is not a number'),
    ],
)
def test_a_row_that_cannot_be_used_is_refused_and_has_no_effect(row: Row, reason: str) -> None:
    run = ltlc.guard(NEAR)
    run.step({"scan": [2.0]}, time=0)
    with pytest.raises(ltlc.UnusableInput) as error:
        run.step(row, time=1)
    assert reason in str(error.value)
    assert [each.action for each in run.step({"asked": 1.0}, time=0)] == [Action.PASSED]


def test_time_does_not_go_back_and_a_row_is_a_mapping() -> None:
    run = ltlc.guard(NEAR)
    run.step({"scan": [2.0], "time": 1})
    with pytest.raises(ltlc.UnusableInput, match="row 2"):
        run.step({"asked": 1.0}, time=0.5)
    with pytest.raises(ltlc.UnusableInput, match="row 2 is 3; a row must be a mapping"):
        run.step(3, time=2)  # type: ignore[arg-type]
    with pytest.raises(ltlc.UnusableInput, match="row 2: there is no `time`"):
        run.step({"asked": 1.0})


def test_fields_that_no_property_reads_may_be_in_a_row() -> None:
    run = ltlc.guard(NEAR)
    run.step({"/scan/ranges": [2.0], "/scan/range_max": 10.0}, time=0)
    (deed,) = run.step({"/cmd_vel_raw/linear/x": 1.0, "/cmd_vel_raw/angular/z": 0.5}, time=1)
    assert (deed.action, deed.values) == (Action.PASSED, {"speed": 1.0})


def test_a_file_without_a_guard_is_refused() -> None:
    with pytest.raises(ltlc.UnusableInput, match="specification has no guard"):
        ltlc.guard("slow: never robot.velocity > 2")


def test_a_guard_does_not_answer_what_none_of_its_properties_reads() -> None:
    run = ltlc.guard(
        "guard /limit_raw to /limit else low\nmessage low {data: 0.3}\ndecl limit /limit std_msgs/Float64.data\n"
        "guard /x_raw to /x\ndecl x /x std_msgs/Float64.data\ndecl armed /armed std_msgs/Bool.data\n"
        "p: always (new limit implies limit <= 0.5)\nq: always (new x implies armed)"
    )
    assert run.step({"armed": True}, time=0) == []
    assert [each.action for each in run.step({"/limit_raw/data": 0.4}, time=1)] == [Action.PASSED]
    assert [each.message for each in run.step({"/limit_raw/data": 0.6}, time=2)] == ["low"]
