"""A violation explains itself: by how much, which element, how old an age was, and what a constant is called."""

from __future__ import annotations

import json
import random
from itertools import accumulate
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from stepping import from_text

from ltlc.backends.python.load import load_plan
from ltlc.inputs.recordings.reading import Offset, ReadOptions, limit
from ltlc.monitoring.judging.run import Judge, RunReport
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.semantics.verdicts import Verdict

HEAD = """
decl a /a sensor_msgs/JointState.effort
decl level /d diagnostic_msgs/DiagnosticStatus.level
decl power /b sensor_msgs/BatteryState.power_supply_status
decl v /v std_msgs/Float64.data
"""


def judged(folder: Path, text: str, *rows: dict[str, Any], **options: Any) -> RunReport:
    path = folder / "run.jsonl"
    path.write_text("".join(f"{json.dumps(row)}\n" for row in rows))
    return Judge(*from_text(HEAD + text), ReadOptions(**options)).judge(path)


def because(report: RunReport) -> list[str]:
    """The lines below `Because:`."""
    lines = report.text().splitlines()
    below = lines[lines.index("Because:") + 1 :]
    return [line.strip() for line in below[: next(n for n, line in enumerate(below) if not line.startswith("  "))]]


@pytest.mark.parametrize(
    ("text", "left", "line"),
    [
        ("never v > 0.5", 0.53, "v > 0.5: true, 0.53 > 0.5 by 0.03"),
        ("always v > 0.5", 0.5, "v > 0.5: false, 0.5 <= 0.5"),
        ("always v <= 0.5", 0.75, "v <= 0.5: false, 0.75 > 0.5 by 0.25"),
        ("always v == 2", 1.5, "v == 2: false, 1.5 differs from 2.0 by 0.5"),
        ("never v == 2", 2, "v == 2: true"),
        ("never v > 0.5", float("inf"), "v > 0.5: true, inf > 0.5"),
    ],
)
def test_a_comparison_says_by_how_much_it_holds_or_fails(tmp_path: Path, text: str, left: float, line: str) -> None:
    assert because(judged(tmp_path, text, {"time": 0, "v": left if left < 9e9 else "inf"})) == [line]


def test_a_deadline_without_a_trigger_counts_from_the_first_moment_without_its_goal(tmp_path: Path) -> None:
    report = judged(tmp_path, "always eventually v > 0 within 2 s", {"time": 0, "v": 0}, {"time": 3, "v": 0})
    assert because(report) == ['more than 2 s since the first moment without "v > 0": true']


BEFORE = {
    "previously v > 1": lambda v: v > 1,
    "previously v < 1": lambda v: v < 1,
    "previously (v > 0 and v < 3)": lambda v: 0 < v < 3,
}


@given(values=st.lists(st.integers(0, 3), min_size=2, max_size=8), seed=st.randoms(use_true_random=False))
def test_what_a_violation_says_of_the_instant_before_is_so_of_the_message_before(
    values: list[int], seed: random.Random
) -> None:
    asked = [seed.choice(["", "not "]) + each for each in seed.sample([*BEFORE], 2)]
    text = seed.choice(["never (v < 2 and {})", "always (v > 1 implies {} or {})", "always (v == 2 implies {} and {})"])
    rows = ByRows(Session(load_plan(*from_text(f"{HEAD}{text.format(*asked)}"))))
    for time, value in enumerate(values):
        rows.samples(10 * time, ("v",), (float(value),))
    track = rows.session.tracks[0]
    if track.decided_at is not None and not track.decided_at.by_time:
        step = track.decided_at.step
        told = {each.text: each.holds for each in track.decided_at.because if each.text in BEFORE}
        assert told == {each: step > 0 and BEFORE[each](values[step - 1]) for each in told}


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("never (previously v > 2 and v < 1)", ["previously v > 2: true", "v < 1: true, 0.0 < 1.0 by 1"]),
        ("always (v < 1 implies previously v < 2)", ["previously v < 2: false", "v < 1: true, 0.0 < 1.0 by 1"]),
        (
            "always ((v < 1 implies not previously v > 2) and (v > 4 implies previously v > 3))",
            ["previously v > 2: true", "v < 1: true, 0.0 < 1.0 by 1"],
        ),
        ("(never v < 1) and always (v > 4 implies previously v > 3)", ["v < 1: true, 0.0 < 1.0 by 1"]),
    ],
)
def test_what_was_so_at_the_instant_before_is_told_where_it_matters(
    tmp_path: Path, text: str, lines: list[str]
) -> None:
    assert because(judged(tmp_path, text, {"time": 0, "v": 2.5}, {"time": 1, "v": 0})) == lines


ELEMENTS = st.lists(st.sampled_from([-2.0, -1.0, 0.0, 1.0, 2.0, 3.0, float("nan")]), min_size=1, max_size=9)


def decides(text: str, array: list[float]) -> int | None:
    """The first element without which, and what comes after it, the condition would be otherwise."""

    def holds(part: list[float]) -> bool:
        return {
            "any(a > 1)": any(x > 1 for x in part),
            "all(a < 2)": not any(x >= 2 for x in part),
            "count(a > 0) < 2": sum(x > 0 for x in part) < 2,
            "count(a[1:] < 1) >= 2": sum(x < 1 for x in part[1:]) >= 2,
        }[text]

    final = holds(array)
    found = [n for n in range(len(array)) if holds(array[: n + 1]) == final != holds(array[:n])]
    return found[0] if found else None


@pytest.mark.parametrize("text", ["any(a > 1)", "all(a < 2)", "count(a > 0) < 2", "count(a[1:] < 1) >= 2"])
@given(array=ELEMENTS)
def test_the_element_is_named_that_decides_a_condition_on_an_array(text: str, array: list[float]) -> None:
    for keyword in ("always", "never"):
        rows = ByRows(Session(Judge(*from_text(f"{HEAD}{keyword} {text}")).plan(())))
        rows.message(0, "/a", [tuple(array)])
        failure = rows.tracks[0].decided_at
        if failure is not None:
            [condition] = failure.because
            index = decides(text, array)
            assert condition.element == (None if index is None else (index, (("a", array[index]),)))


@given(array=ELEMENTS)
def test_of_the_least_and_the_greatest_element_the_first_such_is_named(array: list[float]) -> None:
    for text, extreme in (("min(a) < 99", min), ("max(a) < 99", max)):
        rows = ByRows(Session(Judge(*from_text(f"{HEAD}never {text}")).plan(())))
        rows.message(0, "/a", [tuple(array)])
        failure, numbers = rows.tracks[0].decided_at, [x for x in array if x == x]
        assert (failure is None) == (not numbers)
        if failure is not None:
            index = array.index(extreme(numbers))
            assert failure.because[0].element == (index, (("a", array[index]),))


def test_an_age_is_given_where_it_has_not_just_passed_its_bound(tmp_path: Path) -> None:
    rows = ({"time": 0, "v": 1, "level": 0}, {"time": 3.4, "level": 2})
    report = judged(tmp_path, "never age(v) > 500 ms and level == 2", *rows)
    assert because(report)[-1] == "age(v) <= 500 ms: false, the age is 3.4 s"
    report = judged(tmp_path, "always age(v) <= 500 ms", *rows)
    assert because(report) == ["age(v) <= 500 ms: false"]


def test_values_go_by_the_names_of_the_constants_of_their_message(tmp_path: Path) -> None:
    report = judged(tmp_path, "always level == DiagnosticStatus.OK", {"time": 0, "level": 2})
    assert "  level: ERROR (2)\n" in report.text()
    assert because(report) == ["level == OK (0): false, it is ERROR (2)"]
    assert report.document()["properties"][0]["decided_at"]["constants"] == {"level": "ERROR"}


def test_of_several_constants_with_one_value_those_are_meant_that_are_called_alike(tmp_path: Path) -> None:
    text = "always power == BatteryState.POWER_SUPPLY_STATUS_FULL"
    report = judged(tmp_path, text, {"time": 0, "power": 1})
    assert "  power: POWER_SUPPLY_STATUS_CHARGING (1)\n" in report.text()


def test_numbers_that_were_compared_with_numbers_have_no_names(tmp_path: Path) -> None:
    assert "  level: 2.0\n" in judged(tmp_path, "never level == 2", {"time": 0, "level": 2}).text()


EPOCH = [{"time": 1_700_000_000 + n, "v": n} for n in range(6)]


def test_from_and_until_with_a_plus_count_from_the_beginning(tmp_path: Path) -> None:
    report = judged(tmp_path, "never v > 2", *EPOCH, since=limit("+1"), until=limit("+4"))
    assert report.session is not None
    assert (report.session.steps, report.diagnostics) == (4, ())
    assert "line 6: violated at +3 s (step 2); " in report.text()


def test_a_from_before_the_recording_is_reported(tmp_path: Path) -> None:
    report = judged(tmp_path, "never v > 2", *EPOCH, since=limit("5"))
    assert [each.code for each in report.diagnostics] == ["LTL816"]
    assert "`--from +5`" in (report.diagnostics[0].help or "")
    assert judged(tmp_path, "never v > 2", *EPOCH, since=limit("1700000000")).diagnostics == ()


def test_an_until_before_the_recording_is_reported(tmp_path: Path) -> None:
    assert [each.code for each in judged(tmp_path, "never v > 2", *EPOCH, until=limit("5")).diagnostics] == ["LTL804"]


def test_a_time_with_a_plus_is_an_offset() -> None:
    assert (limit("+0.5"), limit("0.5"), limit("-3")) == (Offset(500_000_000), 500_000_000, -3_000_000_000)


STEPS = st.lists(st.tuples(st.integers(1, 3), st.booleans(), st.booleans()), min_size=2, max_size=9)


@given(STEPS)
def test_what_has_not_held_long_enough_is_reported_with_how_long_it_has(
    tmp_path_factory: pytest.TempPathFactory, steps: list[tuple[int, bool, bool]]
) -> None:
    text = "decl near /near Bool.data\nalways (near implies historically v < 1 for 4 s)"
    times = [*accumulate(gap for gap, _, _ in steps)]
    rows = [{"time": time, "v": 2 - 2 * held, "near": near} for time, (_, held, near) in zip(times, steps, strict=True)]
    report, since = judged(tmp_path_factory.mktemp("run"), text, *rows), None
    for time, (_, held, near) in zip(times, steps, strict=True):
        before, since = since, (time if since is None else since) if held else None
        if near and (since is None or time - since < 4):
            told = [each["lasted"] for each in told_by(report) if "lasted" in each]
            assert told == ([time - before] if held and before is not None else [])
            assert not told or f"historically v < 1 for 4 s: false, {told[0]:g} s so far" in because(report)
            return
    assert report.session is not None
    assert report.session.tracks[0].verdict is not Verdict.VIOLATED


def test_the_failing_state_calls_the_news_of_a_vector_as_the_author_does(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text("time,pos.x,pos.y,pos.z\n0,1,2,3\n")
    text = "decl pos /p geometry_msgs/Vector3Stamped.vector\nnever (new pos and pos.y > 1)"
    assert "  new pos: true\n" in Judge(*from_text(text)).judge(tmp_path / "run.csv").text()


@given(STEPS)
def test_what_has_not_held_of_late_is_reported_with_how_long_ago_it_did(
    tmp_path_factory: pytest.TempPathFactory, steps: list[tuple[int, bool, bool]]
) -> None:
    text = "decl near /near Bool.data\nalways (near implies once v < 1 within 2 s)"
    times = [*accumulate(gap for gap, _, _ in steps)]
    rows = [{"time": time, "v": 2 - 2 * held, "near": near} for time, (_, held, near) in zip(times, steps, strict=True)]
    report, last, was = judged(tmp_path_factory.mktemp("run"), text, *rows), None, False
    for time, (_, held, near) in zip(times, steps, strict=True):
        last, was = time if was or held else last, held
        if near and (last is None or time - last > 2):
            told = [each["ago"] for each in told_by(report) if "ago" in each]
            assert told == ([] if last is None else [time - last])
            assert not told or f"once v < 1 within 2 s: false, last {told[0]:g} s ago" in because(report)
            return
        if near and not held and last is not None and last + 2 < next((t for t in times if t > time), time):
            return  # time alone violates it, just past the bound
    assert report.session is not None
    assert report.session.tracks[0].verdict is not Verdict.VIOLATED


def test_what_has_held_of_late_and_must_not_is_reported_with_how_long_ago(tmp_path: Path) -> None:
    rows = ({"time": time, "v": v} for time, v in ((0, 0), (1, 3), (2.5, 9)))
    found = because(judged(tmp_path, "always (v > 8 implies not once v < 1 within 2 s)", *rows))
    assert "once v < 1 within 2 s: true, last 1.5 s ago" in found


def told_by(report: RunReport) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = report.document()["properties"][0]["decided_at"]["because"]
    return found


@pytest.mark.parametrize(("ended", "lasted"), [(1.5, "1.5 s"), (3.75, "3.75 s")])
def test_a_bound_that_a_violation_came_before_is_reported_with_what_had_passed_of_it(
    tmp_path: Path, ended: float, lasted: str
) -> None:
    rows = ({"time": time, "v": v} for time, v in ((0, 8), (1, 3), (1 + ended, 7)))
    found = because(judged(tmp_path, "after v < 5, always v < 7 for 4 s", *rows))
    assert f'more than 4 s since the first "v < 5": false, {lasted} so far' in found
