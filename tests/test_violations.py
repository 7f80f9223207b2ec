"""All violations of a property: what remains of a run is judged anew after each, from the next instant on."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from stepping import from_text

from ltlc.backends.python.load import load_plan
from ltlc.monitoring.judging.run import Judge, RunReport
from ltlc.monitoring.later import MOST, all_violations
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.semantics.verdicts import Verdict

HEAD = "decl a /a std_msgs/Bool.data\ndecl b /b std_msgs/Bool.data\n"

Row = tuple[int, bool, bool]
"""A time in ns, and what a and b are from then on."""

Found = list[tuple[int, int | None]]
"""When each violation was, and the first instant after it."""

PROPERTIES = [
    "never a",
    "always (a or b)",
    "always (a implies b)",
    "never (a and not b)",
    "always (a implies eventually b)",
    "always (a implies eventually b within 3 ns)",
    "always (a implies always b for 2 ns)",
    "always (a implies never b within 4 ns)",
    "always eventually b within 5 ns",
    "after_until a, b, never b",
    "after_until a, not a, eventually b",
    "after_until a, not a, eventually b within 3 ns",
    "after_until a, b, always a for 2 ns",
    "after a, always b",
    "until a, not b",
    "eventually b within 4 ns",
    "initially a",
    "(always a) or (always b)",
    "(never a) and after_until a, not a, eventually b",
]


def judged(folder: Path, text: str, rows: Sequence[Row]) -> RunReport:
    """What `ltlc run` finds."""
    lines = [f"{time / 1e9:.9f},{str(a).lower()},{str(b).lower()}" for time, a, b in rows]
    path = folder / "run.csv"
    path.write_text("\n".join(["time,a,b", *lines, ""]))
    return Judge(*from_text(HEAD + text)).judge(path)


def found_in(report: RunReport) -> Found:
    assert report.session is not None
    [track] = report.session.tracks
    found = all_violations(track)
    assert found is not None
    return [(each.moment.time, each.until) for each in found]


def instants(rows: Sequence[Row]) -> list[Row]:
    """Every nanosecond of a run, with what is held then."""
    found: list[Row] = []
    for row, (following, *_) in zip(rows, [*rows[1:], (rows[-1][0], 0, 0)], strict=True):
        found.append(row)
        found += [(time, *row[1:]) for time in range(row[0] + 1, following + 1)]
    return found


def by_definition(text: str, rows: Sequence[Row]) -> Found:
    """A run of its own on each part of it that is judged anew, an instant at a time."""
    plan = load_plan(*from_text(HEAD + text))
    found: Found = []
    judge, is_violated = None, False
    for time, a, b in instants(rows):
        if judge is None:
            judge = ByRows(Session(plan))
        names = [name for name in "ab" if name in judge.session.sampler.samples]
        judge.samples(time, tuple(names), [{"a": a, "b": b}[name] for name in names])
        verdict = judge.tracks[0].verdict
        if verdict is Verdict.VIOLATED:
            found += [] if is_violated else [(time, None)]
            judge, is_violated = None, True
        elif is_violated and verdict is not Verdict.PRESUMABLY_VIOLATED:
            found[-1] = (found[-1][0], time)
            is_violated = False
    return found


gaps = st.lists(st.tuples(st.integers(1, 5), st.booleans(), st.booleans()), min_size=1, max_size=9)


@pytest.mark.parametrize("text", PROPERTIES)
@given(drawn=gaps)
def test_violations_are_those_of_the_rest_of_the_run_judged_anew(
    tmp_path_factory: pytest.TempPathFactory, text: str, drawn: list[tuple[int, bool, bool]]
) -> None:
    rows, time = [], 0
    for gap, a, b in drawn:
        rows.append((time, a, b))
        time += gap
    assert found_in(judged(tmp_path_factory.mktemp("run"), text, rows)) == by_definition(text, rows)


def found_in_seconds(folder: Path, text: str, *rows: str) -> list[str]:
    """What `ltlc run --all` lists of a property that reads a and b."""
    path = folder / "run.csv"
    path.write_text("\n".join(["time,a,b", *rows, ""]))
    report = Judge(*from_text(HEAD + text)).judge(path).text(with_all=True)
    lines = report.splitlines()
    start = next(number for number, line in enumerate(lines) if line.endswith(("violation:", "violations:")))
    return [line.strip() for line in lines[start + 1 : lines.index("", start)]]


def test_a_violation_at_a_message_does_not_last(tmp_path: Path) -> None:
    rows = ("0,true,", "1,true,", "2,false,", "3,true,")
    assert found_in_seconds(tmp_path, "never new a and a", *rows) == ["+0 s (step 0)", "+1 s (step 1)", "+3 s (step 3)"]


def test_a_silent_topic_violates_its_watchdog_up_to_its_next_message(tmp_path: Path) -> None:
    rows = ("0,true,true", "1,,true", "3.5,true,", "4,,true", "6,,true")
    assert found_in_seconds(tmp_path, "always age(a) <= 1 s", *rows) == [
        "+1 s (after step 0) for 2.5 s",
        "+4.5 s (after step 1) for 1.5 s, up to the end",
    ]


def test_an_answer_that_is_late_ends_the_violation(tmp_path: Path) -> None:
    rows = ("0,true,false", "0.5,false,", "4,,true", "5,true,false", "5.5,,true")
    text = "always (a implies eventually b within 1 s)"
    assert found_in_seconds(tmp_path, text, *rows) == ["+1 s (after step 1)"]
    assert found_in_seconds(tmp_path, text, rows[0], *rows[2:]) == ["+1 s (after step 0) for 3 s"]


@pytest.mark.parametrize(
    "text", ["never (a and previously b)", "always (a implies once b within 1 s)", "never once a 2 times within 1 s"]
)
def test_of_a_property_that_reads_the_past_the_first_violation_is_looked_for_only(tmp_path: Path, text: str) -> None:
    report = judged(tmp_path, text, [(0, False, True), (10, True, False), (20, False, False), (30, True, False)])
    assert report.session is not None
    assert all_violations(report.session.tracks[0]) is None
    assert report.document()["properties"][0]["violations"] is None


@pytest.mark.parametrize(
    ("text", "reads"),
    [
        ("never (a and previously b)", "the past"),
        ("after_until a, not a, a == @{b, opening}", "values at openings"),
    ],
)
def test_text_says_why_later_violations_are_not_looked_for(tmp_path: Path, text: str, reads: str) -> None:
    report = judged(tmp_path, text, [(0, False, True), (10, True, False), (20, False, False)])
    assert f"looked for: the property reads {reads}." in report.text(with_all=True)


def test_json_has_when_each_violation_was_and_how_long_it_lasted(tmp_path: Path) -> None:
    report = judged(tmp_path, "never a", [(0, True, False), (10, False, False), (20, True, False), (25, True, False)])
    [found] = report.document()["properties"]
    told = [(each["time_ns"], each["until_ns"], each["lasted_ns"]) for each in found["violations"]]
    assert told == [(0, 10, 10), (20, None, 5)]
    assert found["decided_at"]["time_ns"] == 0
    assert "2 violations" in report.text()


def test_what_holds_has_no_violations(tmp_path: Path) -> None:
    [found] = judged(tmp_path, "never a", [(0, False, False)]).document()["properties"]
    assert found["violations"] == []


def test_no_more_violations_than_the_most_are_looked_for(tmp_path: Path) -> None:
    report = judged(tmp_path, "never a", [(10 * n, n % 2 == 0, False) for n in range(2 * MOST + 10)])
    assert len(found_in(report)) == MOST
    assert f"{MOST} violations or more:" in report.text(with_all=True)
