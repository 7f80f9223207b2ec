"""Many recordings at once: which are found, what is told of them together, and what becomes of one that breaks."""

from __future__ import annotations

import io
import json
import os
import signal
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Sequence
from contextlib import redirect_stderr
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from processes import children_of
from stepping import from_text

from ltlc.backends.python.load import load_plan
from ltlc.cli import main
from ltlc.interfaces.commands import progress
from ltlc.monitoring.campaigns.campaign import TRIES, judge_all, judge_one, on_this_machine
from ltlc.monitoring.campaigns.outcomes import Outcome, of_report
from ltlc.monitoring.campaigns.places import Location, find, is_one
from ltlc.monitoring.campaigns.rows import outcome_of, rows_of
from ltlc.monitoring.campaigns.tally import Result, Tally, kind_of
from ltlc.monitoring.judging.run import Judge, RunReport
from ltlc.runtime.session import Plan

SPECIFICATION = """decl speed /speed std_msgs/Float64.data
decl distance /distance std_msgs/Float64.data
limit: never speed > 2
stop: after_until distance < 1, distance > 1, eventually speed == 0
"""
GOOD = "time,speed,distance\n0,1,5\n1,1.5,6\n"
FAST = "time,speed,distance\n0,1,5\n1,2.5,0.5\n"
OWED = "time,speed,distance\n0,1,0.5\n"
BROKEN = "time,speed,distance\n0,1,5\nx\n"


@pytest.fixture
def drives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A specification, and a folder of recordings that come out in each way, seen from where they are."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "props.txt").write_text(SPECIFICATION)
    folder = tmp_path / "drives"
    (folder / "late").mkdir(parents=True)
    (folder / "a.csv").write_text(GOOD)
    (folder / "b.csv").write_text(FAST)
    (folder / "late" / "c.csv").write_text(OWED)
    (folder / "notes.txt").write_text("sunny")
    return folder


def judge() -> Judge:
    return Judge(*from_text(SPECIFICATION))


def names(*arguments: str) -> list[str]:
    return [place.name for place in find(arguments).places]


def ran(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main(["run", "props.txt", *arguments])
    shown = capsys.readouterr()
    return code, shown.out, shown.err


@pytest.mark.usefixtures("drives")
@pytest.mark.parametrize(
    "arguments",
    [
        ("drives/a.csv", "--report", "drives/late/../a.csv"),
        ("drives/a.csv", "--output", "props.txt"),
        ("drives/a.csv", "--output", "one", "--report", "one"),
        ("drives/a.csv", "drives/b.csv", "--summary", "drives/b.csv"),
        ("drives", "--summary", "drives/b.csv"),
        ("drives", "--report", "drives/b.csv"),
    ],
)
def test_what_is_read_is_not_overwritten(arguments: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    before = {path: path.read_bytes() for path in Path().rglob("*.*") if path.is_file()}
    code, out, err = ran(capsys, *arguments)
    assert (code, out) == (2, "")
    assert "is not written: that file is an input, or another output" in err
    assert {path: path.read_bytes() for path in Path().rglob("*") if path.is_file()} == before


@pytest.mark.usefixtures("drives")
def test_a_folder_that_may_not_be_looked_into_is_told_and_keeps_no_other_from_being_judged(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def only_open_ones(path: str, look: Any = os.scandir) -> Any:
        if str(path).endswith("late"):
            raise PermissionError(13, "Permission denied", path)
        return look(path)

    monkeypatch.setattr(os, "scandir", only_open_ones)
    code, out, err = ran(capsys, "drives")
    assert code == 2
    assert "error[LTL902]: `drives/late` cannot be read: Permission denied" in err
    assert "2 recordings: 1 with a violation" in out


@pytest.mark.usefixtures("drives")
def test_a_folder_is_searched_for_recordings_in_their_order() -> None:
    found = find(["drives"])
    assert [place.name for place in found.places] == ["drives/a.csv", "drives/b.csv", "drives/late/c.csv"]
    assert found.left_alone == 1


def test_hidden_files_and_folders_are_passed_over(drives: Path) -> None:
    (drives / ".trash").mkdir()
    (drives / ".trash" / "old.csv").write_text(GOOD)
    (drives / ".b.csv").write_text(GOOD)
    assert len(names("drives")) == 3


def test_a_folder_with_metadata_of_a_bag_is_one_recording(drives: Path) -> None:
    bag = drives / "bag"
    bag.mkdir()
    (bag / "metadata.yaml").write_text("")
    (bag / "bag_0.mcap").write_bytes(b"")
    assert names("drives") == ["drives/a.csv", "drives/b.csv", "drives/bag", "drives/late/c.csv"]
    assert is_one([str(bag)])
    before = find([str(bag)]).places
    (bag / "bag_0.mcap").write_bytes(b"more")
    assert find([str(bag)]).places != before


def test_links_in_a_circle_are_followed_once(drives: Path) -> None:
    (drives / "late" / "again").symlink_to(drives, target_is_directory=True)
    found = find(["drives"])
    assert (len(found.places), found.doubled) == (3, [])


@pytest.mark.usefixtures("drives")
@pytest.mark.parametrize(
    ("pattern", "wanted"),
    [
        ("drives/*.csv", ["drives/a.csv", "drives/b.csv"]),
        ("drives/**/*.csv", ["drives/a.csv", "drives/b.csv", "drives/late/c.csv"]),
        ("drives/**", ["drives/a.csv", "drives/b.csv", "drives/late/c.csv"]),
        ("drives/*", ["drives/a.csv", "drives/b.csv", "drives/late/c.csv"]),
        ("*/[b-z].csv", ["drives/b.csv"]),
    ],
)
def test_a_pattern_stands_for_the_recordings_that_match(pattern: str, wanted: list[str]) -> None:
    found = find([pattern])
    assert ([place.name for place in found.places], found.doubled) == (wanted, [])


def test_a_file_is_itself_even_if_its_name_looks_like_a_pattern(drives: Path) -> None:
    (drives / "[b].csv").write_text(GOOD)
    assert names("drives/[b].csv") == ["drives/[b].csv"]
    assert is_one(["drives/[b].csv"])


@pytest.mark.usefixtures("drives")
def test_the_same_recording_is_taken_once_and_that_is_said() -> None:
    Path("other").symlink_to("drives", target_is_directory=True)
    found = find(["drives/b.csv", "drives", "./drives/a.csv", "other/a.csv"])
    assert [place.name for place in found.places] == ["drives/b.csv", "drives/a.csv", "drives/late/c.csv"]
    assert found.doubled == ["drives/b.csv", "drives/a.csv", "other/a.csv"]


@pytest.mark.usefixtures("drives")
@pytest.mark.parametrize("argument", ["drives/*.mcap", "empty", ""])
def test_a_pattern_or_a_folder_without_recordings_is_an_error(
    argument: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("empty").mkdir()
    code, out, err = ran(capsys, "none*", argument, "drives/a.csv", "--format", "json")
    assert (code, err.count("error[LTL830]")) == (2, 2)
    assert len(json.loads(out)["summary"]["not_found"]) == 2


def test_where_nothing_was_judged_nothing_is_well() -> None:
    assert Tally().exit_code == 2


@pytest.mark.usefixtures("drives")
def test_one_recording_is_told_as_it_always_was(capsys: pytest.CaptureFixture[str]) -> None:
    for form in ("text", "json", "junit"):
        report = judge().judge(Path("drives/b.csv"))
        wanted = {"text": report.text, "json": report.json, "junit": report.junit}[form]()
        assert ran(capsys, "drives/b.csv", "--format", form)[:2] == (1, wanted)


@pytest.mark.usefixtures("drives")
def test_one_blank_line_comes_before_the_table_whatever_the_last_recording_shows(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for last in ("drives/a.csv", "drives/b.csv"):
        _, out, _ = ran(capsys, "drives/late/c.csv", last)
        before, _, _ = out.partition("property  violated")
        assert before.endswith("\n\n")
        assert not before.endswith("\n\n\n")


@pytest.mark.usefixtures("drives")
def test_several_have_a_line_each_then_a_table_and_a_summary(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = ran(capsys, "drives", "drives/a.csv")
    assert code == 1
    assert out.splitlines() == [
        "drives/a.csv: 1 never triggered, 1 presumably satisfied",
        "drives/b.csv: 1 violated, 1 still open",
        "Error at line 3 of props.txt (limit), in drives/b.csv:",
        "  never speed > 2",
        "Failing state:",
        "  speed: 2.5",
        "Because:",
        "  speed > 2: true, 2.5 > 2.0 by 0.5",
        "At +1 s (step 1).",
        "",
        "drives/late/c.csv: 1 still open, 1 presumably satisfied",
        "",
        "property  violated  still open  not started  never triggered  presumably satisfied  satisfied",
        "limit            1                                                               2",
        "stop                         2                             1",
        "",
        "3 recordings: 1 with a violation, 1 with something still open or not started, 1 in which all properties hold; "
        "1 file skipped: not a recording; 1 recording given twice, judged once",
    ]


@pytest.mark.usefixtures("drives")
def test_the_json_document_has_that_of_each_recording(capsys: pytest.CaptureFixture[str]) -> None:
    _, out, _ = ran(capsys, "drives", "--format", "json", "--verdicts")
    document = json.loads(out)
    alone = []
    for name in names("drives"):
        ran_alone = ran(capsys, name, "--format", "json", "--verdicts")[1]
        alone.append(json.loads(ran_alone))
    assert document["recordings"] == alone
    assert document["summary"]["recordings"] == 3
    assert [each["violated"] for each in document["summary"]["properties"]] == [1, 0]


def test_the_junit_report_has_a_suite_for_each_recording(drives: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (drives / "broken.csv").write_text(BROKEN)
    (drives / "empty.csv").write_text("")
    code, out, _ = ran(capsys, "drives", "--format", "junit")
    root = ElementTree.fromstring(out)
    assert (code, root.tag) == (2, "testsuites")
    suites = {suite.get("name"): suite for suite in root}
    for name, suite in suites.items():
        one = ElementTree.fromstring(judge().judge(Path(name or "")).junit())
        assert ElementTree.tostring(suite).strip() == ElementTree.tostring(one).strip()
    for name, cases in (("drives/broken.csv", 3), ("drives/empty.csv", 1)):
        assert (suites[name].get("errors"), len(suites[name].findall("testcase"))) == ("1", cases)
        assert suites[name][-1].get("name") == "recording"


def test_a_pattern_that_matches_nothing_is_an_error_in_the_junit_report(
    drives: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, _ = ran(capsys, "drives", "*.mcap", "--format", "junit")
    suite = ElementTree.fromstring(out)[-1]
    assert (code, suite.get("name"), suite.get("errors"), suite[0][0].get("type")) == (2, "*.mcap", "1", "LTL830")


@pytest.mark.parametrize(
    ("contents", "code"),
    [
        ([GOOD, GOOD], 0),
        ([GOOD, OWED], 3),
        ([OWED, FAST, GOOD], 1),
        ([FAST, BROKEN], 2),
        ([GOOD, ""], 2),
    ],
)
def test_the_exit_code_is_that_of_the_worst_recording(
    contents: list[str], code: int, drives: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    paths = [drives / f"x{number}.csv" for number in range(len(contents))]
    for path, content in zip(paths, contents, strict=True):
        path.write_text(content)
    assert ran(capsys, *map(str, paths))[0] == code


def test_a_violation_before_a_damage_is_counted_in_the_summary(
    drives: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    damaged = {"x.csv": FAST + "x\n", "y.csv": GOOD + "x\n"}
    for name, content in damaged.items():
        (drives / name).write_text(content)
    paths = [str(drives / name) for name in damaged]
    _, out, _ = ran(capsys, *paths)
    assert out.endswith("2 recordings: 2 not judged to the end, 1 of these with a violation before that\n")
    assert json.loads(ran(capsys, *paths, "--format", "json")[1])["summary"]["violated_not_judged_whole"] == 1


@pytest.mark.usefixtures("drives")
def test_a_recording_that_is_not_there_does_not_keep_others_from_being_judged(
    capsys: pytest.CaptureFixture[str],
) -> None:
    code, out, err = ran(capsys, "drives/none.csv", "drives/b.csv")
    assert (code, "error[LTL901]" in err) == (2, True)
    assert out.startswith("drives/none.csv: not judged: there is no file `drives/none.csv`\ndrives/b.csv: 1 violated")


def test_what_is_said_of_many_recordings_is_said_once(drives: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for number in range(3):
        (drives / f"x{number}.csv").write_text("time,speed,distance,colour\n0,1,5,red\n")
    _, _, err = ran(capsys, "drives")
    assert err.count("LTL805") == 1
    assert "no property reads the column `colour` (in 3 of 6 recordings)" in err


def test_names_are_shown_without_what_a_terminal_acts_on(drives: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (drives / "\x1b[2J\udcff.csv").write_text(FAST)
    _, out, err = ran(capsys, "drives")
    assert all(c == "\n" or c.isprintable() for c in out + err)


def test_progress_is_shown_where_lines_do_not_say_it(
    drives: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    monkeypatch.delenv("CI", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(progress, "AFTER_SECONDS", 0.0)
    monkeypatch.setattr(progress, "EVERY_SECONDS", 0.0)
    terminal = Terminal()
    with redirect_stderr(terminal):
        main(["run", "props.txt", str(drives), "--format", "json"])
    assert "ltlc: judging, 3 of 3 (" in terminal.getvalue()
    json.loads(capsys.readouterr().out)


class Deadly(Judge):
    """Ends its own process on the recordings `b.csv`, as often as there are files in the folder `deaths`."""

    def judge(self, path: Path, *more: Any) -> RunReport:
        if path.name == "b.csv":
            for wish in sorted(Path("deaths").iterdir()):
                wish.unlink()
                os.kill(os.getpid(), signal.SIGKILL)
        return super().judge(path, *more)


@pytest.mark.parametrize("deaths", [1, TRIES - 1, TRIES])
def test_a_worker_that_dies_costs_its_recording_a_retry_and_no_other(deaths: int, drives: Path) -> None:
    Path("deaths").mkdir()
    for number in range(deaths):
        (Path("deaths") / str(number)).touch()
    deadly = Deadly(*from_text(SPECIFICATION))
    outcomes = {each.place.name: each for each in judge_all(deadly, find(["drives"]).places, on_this_machine(2))}
    assert {name: each.tries for name, each in outcomes.items()} == {
        "drives/a.csv": 1,
        "drives/b.csv": min(deaths + 1, TRIES),
        "drives/late/c.csv": 1,
    }
    error = outcomes["drives/b.csv"].error
    if deaths < TRIES:
        assert error is None
        assert outcomes["drives/b.csv"].exit_code == 1
    else:
        assert error is not None
        assert error["code"] == "LTL832"
        assert "its process ended with signal 9, 3 times" in error["message"]


def test_workers_that_say_nothing_of_a_recording_do_not_make_it_vanish() -> None:
    [outcome] = judge_all(judge(), [Location("a.csv")], lambda judge, places: iter(()))
    assert (outcome.exit_code, outcome.tries) == (2, TRIES)


def test_an_error_of_ours_on_one_recording_is_told_and_others_are_judged(drives: Path) -> None:
    class Faulty(Judge):
        def judge(self, path: Path, *more: Any) -> RunReport:
            if path.name == "a.csv":
                raise ZeroDivisionError("oh")
            return super().judge(path, *more)

    faulty = Faulty(*from_text(SPECIFICATION))
    outcomes = {each.place.name: each for each in judge_all(faulty, find([str(drives)]).places, on_this_machine(1))}
    error = outcomes[str(drives / "a.csv")].error
    assert error is not None
    assert "ZeroDivisionError: oh, 3 times" in error["message"]
    assert outcomes[str(drives / "b.csv")].is_judged


def test_workers_that_are_not_asked_for_more_are_ended(drives: Path) -> None:
    for number in range(20):
        (drives / f"x{number}.csv").write_text(GOOD)
    before = children_of(os.getpid())
    outcomes = judge_all(judge(), find([str(drives)]).places, on_this_machine(2))
    next(outcomes)
    assert children_of(os.getpid()) - before
    outcomes.close()  # type: ignore[attr-defined]
    assert children_of(os.getpid()) == before


def outcomes() -> Iterator[Outcome]:
    for place in find(["drives"]).places:
        found = judge_one(judge(), place)
        assert isinstance(found, Outcome)
        yield found


def test_rows_of_a_table_lose_nothing_of_an_outcome(drives: Path) -> None:
    (drives / "broken.csv").write_text(BROKEN)
    (drives / "empty.csv").write_text("")
    for outcome in outcomes():
        kept = outcome_of(json.loads(json.dumps(rows_of(outcome))))
        assert kept == replace(outcome, diagnostics=())
        assert (kept.document(), kept.exit_code) == (outcome.document(), outcome.exit_code)


def test_each_property_comes_out_in_one_way(drives: Path) -> None:
    (drives / "d.csv").write_text("time,distance\n0,5\n")
    tally = Tally()
    for outcome in outcomes():
        tally.add(outcome)
        assert [each.verdict.holds for each in outcome.properties] == [
            kind_of(each) in (Result.NEVER_TRIGGERED, Result.PRESUMABLY_SATISFIED, Result.SATISFIED)
            for each in outcome.properties
        ]
    assert all(sum(each.counts.values()) == 4 for each in tally.properties.values())
    assert tally.properties["limit"].counts[Result.NOT_STARTED] == 1


def test_a_judge_makes_its_plan_once_for_recordings_of_one_kind(drives: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from ltlc.monitoring.judging import run

    made = []

    def counted(*given: Any) -> Plan:
        made.append(given)
        return load_plan(*given)

    monkeypatch.setattr(run, "load_plan", counted)
    again = judge()
    found = [again.judge(drives / name).text() for name in ("a.csv", "b.csv", "a.csv")]
    assert len(made) == 1
    assert found == [judge().judge(drives / name).text() for name in ("a.csv", "b.csv", "a.csv")]


def test_an_outcome_speaks_of_the_recording_and_not_of_the_copy_that_was_read(drives: Path) -> None:
    found = of_report(Location("s3://x/b.csv"), judge().judge(drives / "none.csv"), 0.0)
    assert found.report["recording"] == "s3://x/b.csv"
    assert found.diagnostics[0].message == "there is no file `s3://x/b.csv`"
    assert found.diagnostics[0].source.name == "s3://x/b.csv"


@pytest.mark.usefixtures("drives")
def test_a_page_has_a_section_for_each_of_several_recordings(capsys: pytest.CaptureFixture[str]) -> None:
    plain = ran(capsys, "drives")
    assert ran(capsys, "drives", "--report", "page.html") == plain
    page = Path("page.html").read_text(encoding="utf-8")
    assert all(f'id="recording-{number}"' in page for number in range(3))
    assert all(f"drives/{name}.csv</h2>" in page for name in ("a", "b", "late/c"))


@pytest.mark.usefixtures("drives")
@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--output", "out.mcap"), "--output takes a single recording"),
        (("--timing",), "--timing takes a single recording"),
        (("--report", "page.html", "--results", "r.parquet"), "omit these, or use --summary"),
        (("--report", "page.html", "--engine", "local"), "omit these, or use --summary"),
    ],
)
def test_what_is_about_one_recording_is_refused_of_several(
    capsys: pytest.CaptureFixture[str], options: Sequence[str], said: str
) -> None:
    code, out, err = ran(capsys, "drives", *options)
    assert (code, out, said in err) == (2, "", True)
    assert not Path("page.html").exists()
