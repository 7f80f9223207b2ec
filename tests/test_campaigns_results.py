"""Results of a campaign in a table: nothing is judged twice, nothing that has changed is kept, a crash costs little."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from stepping import from_text
from test_campaigns import BROKEN, FAST, GOOD, SPECIFICATION, ran

from ltlc.monitoring.campaigns import results
from ltlc.monitoring.campaigns.campaign import judge_one
from ltlc.monitoring.campaigns.outcomes import Outcome
from ltlc.monitoring.campaigns.places import Location, find
from ltlc.monitoring.campaigns.results import Results
from ltlc.monitoring.campaigns.rows import COLUMNS
from ltlc.monitoring.judging.run import Judge

parquet = pytest.importorskip("pyarrow.parquet", reason="needs pyarrow (pip install '.[campaigns]')")


@pytest.fixture
def drives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A specification and a folder of four recordings, seen from where they are."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "props.txt").write_text(SPECIFICATION)
    folder = tmp_path / "drives"
    folder.mkdir()
    for name, content in (("a", GOOD), ("b", FAST), ("c", GOOD), ("d", BROKEN)):
        (folder / f"{name}.csv").write_text(content)
    return folder


def rows(path: str = "r.parquet") -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = parquet.read_table(path).to_pylist()
    return found


def judged(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict[str, Any]]:
    """The exit code and summary of a campaign that keeps its results."""
    code, out, _ = ran(capsys, *arguments, "--results", "r.parquet", "--format", "json")
    return code, json.loads(out)


@pytest.mark.usefixtures("drives")
def test_the_table_has_a_row_for_each_recording_and_property(capsys: pytest.CaptureFixture[str]) -> None:
    assert judged(capsys, "drives")[0] == 2
    assert parquet.read_schema("r.parquet").names == list(COLUMNS)
    found = {(row["recording"], row["property"]): row for row in rows()}
    assert len(found) == 8
    violated = found["drives/b.csv", "limit"]
    told = ("verdict", "time_ns", "step", "by_time", "episodes", "error", "tries")
    assert {name: violated[name] for name in told} == {
        "verdict": "violated",
        "time_ns": 1_000_000_000,
        "step": 1,
        "by_time": False,
        "episodes": None,
        "error": None,
        "tries": 1,
    }
    assert json.loads(violated["failing_state"]) == {"speed": 2.5}
    assert violated["figure"].startswith("Error at line 3 of props.txt (limit):")
    assert found["drives/a.csv", "stop"]["never_triggered"]
    assert found["drives/b.csv", "stop"]["open_since_ns"] == 1_000_000_000
    damaged = found["drives/d.csv", "limit"]
    assert (damaged["is_damaged"], damaged["error_code"]) == (True, "LTL802")
    assert not Path("r.parquet.journal").exists()


@pytest.mark.usefixtures("drives")
def test_a_recording_without_verdicts_has_one_row_that_says_why(capsys: pytest.CaptureFixture[str]) -> None:
    judged(capsys, "none.csv")
    [row] = rows()
    assert (row["recording"], row["property"], row["error_code"]) == ("none.csv", None, "LTL901")


def test_again_only_what_has_changed_or_failed_is_judged_and_the_report_is_the_same(
    drives: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first = judged(capsys, "drives")
    second = judged(capsys, "drives")
    assert (first[1]["summary"]["judged_before"], second[1]["summary"]["judged_before"]) == (0, 3)
    assert second[1]["recordings"] == first[1]["recordings"]
    (drives / "a.csv").write_text(GOOD + "2,9,9\n")
    (drives / "d.csv").write_text(GOOD)
    code, third = judged(capsys, "drives")
    assert (code, third["summary"]["judged_before"]) == (1, 2)
    assert third["recordings"][0]["properties"][0]["verdict"] == "violated"
    assert len(rows()) == 8


def test_text_and_junit_are_the_same_for_what_was_judged_before(
    drives: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (drives / "d.csv").unlink()
    for form in ("text", "junit"):
        alone = ran(capsys, "drives", "--format", form)[1]
        ran(capsys, "drives", "--results", "r.parquet")
        kept = ran(capsys, "drives", "--format", form, "--results", "r.parquet")[1]
        assert kept.replace(", 3 judged before", "") == alone


@pytest.mark.usefixtures("drives")
@pytest.mark.parametrize("change", ["limit", "--until", "--encoding", "version"])
def test_with_another_specification_setting_or_version_all_is_judged_again(
    change: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    judged(capsys, "drives")
    more: Sequence[str] = ()
    if change == "limit":
        Path("props.txt").write_text(SPECIFICATION.replace("> 2", "> 9"))
    elif change == "version":
        monkeypatch.setattr(results, "__version__", "0")
    else:
        more = (change, {"--until": "0.5", "--encoding": "dwyer"}[change])
    assert judged(capsys, "drives", *more)[1]["summary"]["judged_before"] == 0


@pytest.mark.usefixtures("drives")
def test_the_table_has_the_recordings_that_were_given_and_no_others(capsys: pytest.CaptureFixture[str]) -> None:
    judged(capsys, "drives")
    judged(capsys, "drives/b.csv", "drives/c.csv")
    assert {row["recording"] for row in rows()} == {"drives/b.csv", "drives/c.csv"}


@pytest.mark.parametrize("content", [b"not parquet", b"PAR1", b""])
def test_a_file_that_is_no_table_of_results_is_not_touched(
    content: bytes, drives: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("r.parquet").write_bytes(content)
    code, out, err = ran(capsys, str(drives), "--results", "r.parquet")
    assert (code, out, "error[LTL833]" in err) == (2, "", True)
    assert Path("r.parquet").read_bytes() == content


@pytest.mark.usefixtures("drives")
def test_a_table_of_something_else_is_not_touched(capsys: pytest.CaptureFixture[str]) -> None:
    import pyarrow

    parquet.write_table(pyarrow.table({"recording": ["mine"]}), "r.parquet")
    assert "is not a table of results of ltlc" in ran(capsys, "drives", "--results", "r.parquet")[2]
    assert rows() == [{"recording": "mine"}]


@pytest.mark.usefixtures("drives")
@pytest.mark.parametrize("option", ["--results", "--summary"])
def test_what_cannot_be_written_is_told_before_anything_is_judged(
    option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    for path in ("none/x", "drives"):
        code, out, err = ran(capsys, "drives", option, path)
        assert (code, out, f"ltlc: {path} cannot be written" in err) == (2, "", True)


@pytest.mark.usefixtures("drives")
def test_the_table_in_a_folder_of_recordings_is_no_recording_itself(capsys: pytest.CaptureFixture[str]) -> None:
    Path("drives/r.csv").write_text("")
    found = find(["drives"], Path("drives/r.csv"))
    assert (len(found.places), found.doubled) == (4, [])


def names(places: Sequence[Location], judged_with: str = "x") -> set[str]:
    """What a table has at the beginning of a campaign, which then ends without a word."""
    table = Results(Path("r.parquet"), judged_with, places)
    table._journal.close()
    return table.names()


def crashed(found: Sequence[Outcome], places: Sequence[Location]) -> None:
    """A campaign in which `found` has arrived ends without a word."""
    table = Results(Path("r.parquet"), "x", places)
    for outcome in found:
        table.add(outcome)
    table._journal.close()


def outcomes() -> list[Outcome]:
    judge = Judge(*from_text(SPECIFICATION))
    found = [judge_one(judge, place) for place in find(["drives"]).places]
    return [each for each in found if isinstance(each, Outcome)]


@pytest.mark.usefixtures("drives")
def test_what_arrived_before_a_crash_is_kept_though_the_table_was_not_written() -> None:
    found = outcomes()
    places = [each.place for each in found]
    crashed(found[:2], places)
    assert rows() == []
    assert names(places) == {"drives/a.csv", "drives/b.csv"}
    assert len(rows()) == 4


@pytest.mark.usefixtures("drives")
@pytest.mark.parametrize("cut", [1, 20, 700])
def test_a_line_of_the_journal_that_is_cut_off_is_none(cut: int) -> None:
    found = outcomes()
    places = [each.place for each in found]
    crashed(found[:2], places)
    journal = Path("r.parquet.journal")
    journal.write_bytes(journal.read_bytes()[: -1 - cut])
    assert names(places) == {"drives/a.csv"}


@pytest.mark.usefixtures("drives")
def test_the_table_is_written_now_and_then_and_has_nothing_twice() -> None:
    first, second, third, _ = found = outcomes()
    places = [each.place for each in found]
    table = Results(Path("r.parquet"), "x", places)
    table.add(first)
    table._next = 0.0
    table.add(second)
    assert {row["recording"] for row in rows()} == {"drives/a.csv", "drives/b.csv"}
    assert Path("r.parquet.journal").read_bytes() == b""
    table.add(third)
    table._journal.close()
    # as if it had ended between the table and the journal
    Path("r.parquet.journal").write_bytes(f"{json.dumps(rows())}\n".encode() + Path("r.parquet.journal").read_bytes())
    assert names(places) == {"drives/a.csv", "drives/b.csv", "drives/c.csv"}
    assert len(rows()) == 6


@pytest.mark.usefixtures("drives")
def test_names_that_are_no_text_are_kept_with_escapes(capsys: pytest.CaptureFixture[str]) -> None:
    Path("drives/\udcff.csv").write_text(FAST)
    assert judged(capsys, "drives")[0] == 2
    assert "drives/\\udcff.csv" in {row["recording"] for row in rows()}


def test_a_place_of_which_nothing_tells_whether_it_has_changed_is_judged_again(drives: Path) -> None:
    [found, *_] = outcomes()
    unknown = Outcome(Location("s3://x/a.csv"), found.report, found.properties)
    with Results(Path("r.parquet"), "x", [unknown.place]) as table:
        table.add(unknown)
    assert names([unknown.place]) == set()


KILLED = """
import os, signal, sys
from ltlc.monitoring.campaigns import results
from ltlc.cli import main
add = results.Results.add
def last(self, outcome):
    add(self, outcome)
    if outcome.place.name.endswith("b.csv"):
        os.kill(os.getpid(), signal.SIGKILL)
results.Results.add = last
main(["run", "props.txt", "drives", "--jobs", "1", "--results", "r.parquet"])
"""


@pytest.mark.usefixtures("drives")
def test_a_campaign_that_is_killed_goes_on_where_it_was(capsys: pytest.CaptureFixture[str]) -> None:
    killed = subprocess.run([sys.executable, "-c", KILLED], capture_output=True, timeout=60, check=False)
    assert killed.returncode == -signal.SIGKILL
    assert rows() == []
    code, document = judged(capsys, "drives")
    assert (code, document["summary"]["judged_before"]) == (2, 2)
    assert [each["recording"] for each in document["recordings"]] == [f"drives/{name}.csv" for name in "abcd"]


@pytest.mark.usefixtures("drives")
def test_verdicts_of_each_step_are_not_kept_and_that_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = ran(capsys, "drives", "--verdicts", "--results", "r.parquet")
    assert (code, "--verdicts" in err) == (2, True)


@pytest.mark.usefixtures("drives")
def test_a_journal_that_cannot_be_written_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    Path("r.parquet.journal").mkdir()
    code, _, err = ran(capsys, "drives", "--results", "r.parquet")
    assert (code, "`r.parquet` cannot be written: Is a directory" in err) == (2, True)


@pytest.mark.usefixtures("drives")
def test_a_disk_that_gets_full_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    Path("r.parquet.journal").symlink_to("/dev/full")
    code, _, err = ran(capsys, "drives", "--results", "r.parquet")
    assert (code, "`r.parquet` cannot be written: No space left on device" in err) == (2, True)


@pytest.mark.usefixtures("drives")
@pytest.mark.parametrize(
    "line", ["5", "null", "{{{", "[5]", "[null]", '[{"recording": 5}]', '[{"steps": "x"}]', "[" * 9999]
)
def test_a_journal_that_is_damaged_costs_what_was_damaged(capsys: pytest.CaptureFixture[str], line: str) -> None:
    judged(capsys, "drives")
    kept = rows()
    Path("r.parquet").unlink()
    Path("r.parquet.journal").write_text(f"{line}\n{json.dumps(kept)}\n{line}\n")
    code, document = judged(capsys, "drives")
    assert (code, document["summary"]["judged_before"]) == (2, 3)
    assert len(rows()) == len(kept)


DAMAGES = [("report", "5"), ("report", "null"), ("report", "{{{"), ("report", "{}"), ("recording_report", "null")]


@pytest.mark.usefixtures("drives")
@pytest.mark.parametrize(("column", "cell"), [*DAMAGES, ("remarks", "5"), ("remarks", "{{{")])
def test_a_table_whose_cells_are_damaged_is_told(capsys: pytest.CaptureFixture[str], column: str, cell: str) -> None:
    judged(capsys, "drives")
    table = parquet.read_table("r.parquet")
    number = table.schema.get_field_index(column)
    parquet.write_table(table.set_column(number, table.schema.field(number), [[cell] * len(table)]), "r.parquet")
    code, _, err = ran(capsys, "drives", "--results", "r.parquet")
    assert (code, "error[LTL833]" in err) == (2, True)


@pytest.mark.usefixtures("drives")
@pytest.mark.parametrize("content", ["5", "null", "{{{", ""])
def test_a_table_that_is_none_is_told_and_stays(capsys: pytest.CaptureFixture[str], content: str) -> None:
    Path("r.parquet").write_text(content)
    code, _, err = ran(capsys, "drives", "--results", "r.parquet")
    assert (code, "error[LTL833]" in err) == (2, True)
    assert Path("r.parquet").read_text() == content
    assert not Path("r.parquet.journal").exists()


def test_a_second_campaign_into_the_same_table_is_refused_and_loses_nothing(
    drives: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    judge = Judge(*from_text(SPECIFICATION))
    places = find([str(drives)]).places
    with Results(Path("r.parquet"), "the same", places) as first:
        first.add(judge_one(judge, places[0]))  # type: ignore[arg-type]
        code, _, err = ran(capsys, "drives", "--results", "r.parquet")
        assert (code, "another campaign is writing `r.parquet`" in err) == (2, True)
        first.add(judge_one(judge, places[1]))  # type: ignore[arg-type]
    assert len({row["recording"] for row in rows()}) == 2
    assert judged(capsys, "drives")[0] == 2
