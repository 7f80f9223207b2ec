"""What a property goes through in a run: against the verdict after each step, and a search for episodes of its own."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st
from stepping import from_text, ns

from ltlc.inputs.recordings.trails import Deadline, Span, Trail
from ltlc.monitoring.judging.run import Judge, RunReport
from ltlc.semantics.verdicts import Verdict

AB = "decl a /a Float64.data\ndecl b /b Float64.data\n"


def judged(folder: Path, text: str, rows: list[str], keep_verdicts: bool = False) -> RunReport:
    path = folder / "run.csv"
    path.write_text("".join(f"{row}\n" for row in ["time,a,b", *rows]), encoding="utf-8")
    return Judge(*from_text(AB + text), keep_verdicts=keep_verdicts, keep_trails=True).judge(path)


def trail(folder: Path, text: str, *rows: str) -> Trail:
    return judged(folder, text, list(rows)).trails[0]


def times(spans: list[Span]) -> list[tuple[int, int | None]]:
    return [(span.opening.time, None if span.closed is None else span.closed.time) for span in spans]


def test_a_run_leaves_no_trail_unless_it_is_asked_for(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text("time,a,b\n0,1,1\n")
    assert Judge(*from_text(AB + "never a > 2\n")).judge(tmp_path / "run.csv").trails == ()


@given(st.lists(st.tuples(st.integers(0, 2), st.integers(0, 2)), min_size=1, max_size=12))
def test_changes_are_where_the_verdicts_after_the_steps_differ(values: list[tuple[int, int]]) -> None:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        rows = [f"{time},{a},{b}" for time, (a, b) in enumerate(values)]
        report = judged(Path(folder), "after_until a > 1, b > 1, eventually a == 0\n", rows, keep_verdicts=True)
    assert report.session is not None
    track = report.session.tracks[0]
    assert track.verdicts is not None
    before = [Verdict.NOT_STARTED, *track.verdicts]
    wanted = [(step, new) for step, (old, new) in enumerate(pairwise(before)) if old is not new]
    assert [(change.moment.step, change.current) for change in report.trails[0].changes] == wanted


@given(st.lists(st.tuples(st.integers(0, 2), st.integers(0, 2)), min_size=1, max_size=12))
def test_episodes_last_from_what_opens_them_to_what_closes_them(values: list[tuple[int, int]]) -> None:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        rows = [f"{time},{a},{b}" for time, (a, b) in enumerate(values)]
        found = times(judged(Path(folder), "after_until a > 1, b > 1, a >= 0\n", rows).trails[0].spans)
    wanted: list[tuple[int, int | None]] = []
    for time, (a, b) in enumerate(values):
        is_open = bool(wanted) and wanted[-1][1] is None
        if b > 1 and is_open:
            wanted[-1] = (wanted[-1][0], ns(time))
        elif a > 1 and b <= 1 and not is_open:
            wanted.append((ns(time), None))
    assert found == wanted


def test_an_episode_inside_another_ends_with_it(tmp_path: Path) -> None:
    text = "after_until a > 0, a < 0, (after_until b > 0, b < 0, a < 9)\n"
    found = trail(tmp_path, text, "0,1,0", "1,1,1", "2,-1,1", "3,1,1")
    assert [span.depth for span in found.spans] == [0, 1, 0, 1]
    assert times(found.spans) == [(0, ns(2)), (ns(1), ns(2)), (ns(3), None), (ns(3), None)]


def test_a_deadline_is_there_from_when_something_is_owed_until_it_is_done(tmp_path: Path) -> None:
    text = "always (a > 1 implies eventually b > 1 within 2 s)\n"
    found = trail(tmp_path, text, "0,0,0", "1,2,0", "1.5,2,0", "2,0,2", "3,2,0", "9,0,0")
    assert found.deadlines == [Deadline(ns(1), ns(3) + 1, ns(2)), Deadline(ns(3), ns(5) + 1, ns(5) + 1)]
    assert [change.moment.time for change in found.changes][-1] == ns(5) + 1


def test_the_earlier_of_two_deadlines_is_told_and_then_the_later_one(tmp_path: Path) -> None:
    text = "(eventually a > 1 within 5 s) and (eventually b > 1 within 9 s)\n"
    found = trail(tmp_path, text, "0,0,0", "3,2,0", "4,0,2")
    assert found.deadlines == [Deadline(0, ns(5) + 1, ns(3)), Deadline(ns(3), ns(9) + 1, ns(4))]


def test_a_deadline_that_stays_is_told_once(tmp_path: Path) -> None:
    text = "(eventually a > 1 within 5 s) and (eventually b > 1 within 9 s)\n"
    found = trail(tmp_path, text, "0,0,0", "1,0,2", "3,2,0")
    assert found.deadlines == [Deadline(0, ns(5) + 1, ns(3))]


def test_edges_are_told_with_the_first_time_that_each_was_taken(tmp_path: Path) -> None:
    found = trail(tmp_path, "never a > 1\n", "0,0,0", "1,0,0", "2,2,0", "3,2,0")
    moments = sorted((moment.step, before == after) for (before, after), moment in found.edges.items())
    assert moments == [(0, True), (2, False)]


def test_a_sample_that_is_not_a_number_takes_no_edge(tmp_path: Path) -> None:
    assert trail(tmp_path, "never a > 1\n", "0,nan,0").edges == {}
