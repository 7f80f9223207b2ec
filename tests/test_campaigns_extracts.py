"""`ltlc run --cut` on many recordings: each has its own folder of extracts, and a campaign goes on where it stopped."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest
from bag_support import mcap, rosbag2
from test_campaigns_page import Reader
from test_recordings_extracts import SLOW, drive

from ltlc.cli import main
from ltlc.interfaces.commands.campaign import _with_extracts_here
from ltlc.monitoring.campaigns.outcomes import Outcome, PropertyOutcome
from ltlc.monitoring.campaigns.places import Location
from ltlc.monitoring.judging.cutting import folders_of

EXTRACTS = ["drives_a_mcap/slow+10s.mcap", "drives_b/slow+20s.mcap", "drives_b/slow+5s.mcap"]


@pytest.fixture
def drives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A specification, and a folder of three bags, two of which violate it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.ltlc").write_text(SLOW)
    folder = tmp_path / "drives"
    folder.mkdir()
    mcap(folder / "a.mcap", drive(range(30), fast=[10]))
    rosbag2(folder / "b", drive(range(30), fast=[5, 20]))
    mcap(folder / "c.mcap", drive(range(30)))
    return folder


def campaign(*more: str) -> int:
    return main(["run", "p.ltlc", "drives", "--cut", "cut", *more])


def files(folder: str = "cut") -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in Path(folder).rglob("*.mcap"))


@pytest.mark.usefixtures("drives")
def test_the_extracts_of_each_recording_are_in_a_folder_with_its_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert campaign("--jobs", "2") == 1
    assert files() == EXTRACTS
    told = capsys.readouterr().err.splitlines()
    assert "ltlc: wrote cut/drives_a_mcap/slow+10s.mcap: slow at +10 s, 15 messages" in told
    assert len(told) == 3


@pytest.mark.usefixtures("drives")
def test_they_are_those_of_the_recordings_by_themselves(capsys: pytest.CaptureFixture[str]) -> None:
    campaign("--quiet")
    for name, folder in (("drives/a.mcap", "drives_a_mcap"), ("drives/b", "drives_b")):
        main(["run", "p.ltlc", name, "--cut", f"alone/{folder}", "--quiet"])
    assert capsys.readouterr().err == ""
    assert files("alone") == EXTRACTS
    assert [(Path("alone") / f).read_bytes() for f in EXTRACTS] == [(Path("cut") / f).read_bytes() for f in EXTRACTS]


def told(capsys: pytest.CaptureFixture[str], *more: str) -> dict[str, Any]:
    """The JSON document of a campaign."""
    capsys.readouterr()
    campaign("--format", "json", "--quiet", *more)
    document: dict[str, Any] = json.loads(capsys.readouterr().out)
    return document


@pytest.mark.usefixtures("drives")
def test_the_json_document_has_the_extracts_of_each_property(capsys: pytest.CaptureFixture[str]) -> None:
    first, _, last = told(capsys, "--before", "1s")["recordings"]
    began = 1_700_000_000 * 10**9
    assert first["cut"] == {"folder": "cut", "before_ns": 10**9, "after_ns": 2 * 10**9, "error": None}
    assert first["properties"][0]["extracts"] == [
        {
            "file": "cut/drives_a_mcap/slow+10s.mcap",
            "about": "slow at +10 s",
            "since": 1_700_000_009.0,
            "since_ns": began + 9 * 10**9,
            "until": 1_700_000_012.0,
            "until_ns": began + 12 * 10**9,
            "messages": 7,
            "replaced": False,
        }
    ]
    assert last["properties"][0]["extracts"] == []


@pytest.mark.usefixtures("drives")
def test_a_campaign_goes_on_with_what_is_missing(capsys: pytest.CaptureFixture[str]) -> None:
    keep = ("--results", "r.parquet")
    assert told(capsys, *keep)["summary"]["judged_before"] == 0
    again = told(capsys, *keep)
    assert again["summary"]["judged_before"] == 3
    assert [len(each["properties"][0]["extracts"]) for each in again["recordings"]] == [1, 2, 0]
    Path("cut/drives_b/slow+5s.mcap").unlink()
    assert told(capsys, *keep)["summary"]["judged_before"] == 2
    assert files() == EXTRACTS
    assert told(capsys, *keep, "--after", "3s")["summary"]["judged_before"] == 0


@pytest.mark.usefixtures("drives")
def test_results_without_extracts_are_judged_again_to_be_cut(capsys: pytest.CaptureFixture[str]) -> None:
    main(["run", "p.ltlc", "drives", "--results", "r.parquet"])
    assert told(capsys, "--results", "r.parquet")["summary"]["judged_before"] == 0
    assert files() == EXTRACTS


@pytest.mark.usefixtures("drives")
def test_the_page_links_to_the_extracts() -> None:
    Path("pages").mkdir()
    campaign("--summary", "pages/s.html")
    page = Reader(Path("pages/s.html").read_text(encoding="utf-8"))
    links = [unquote(value) for name, value in page.attributes if name == "href"]
    assert [link for link in links if link.startswith("../cut")] == [
        "../cut/drives_a_mcap/slow+10s.mcap",
        "../cut/drives_b/slow+5s.mcap",
        "../cut/drives_b/slow+20s.mcap",
    ]
    assert all((Path("pages") / link).exists() for link in links)


@pytest.mark.usefixtures("drives")
def test_an_extract_that_cannot_be_written_is_the_fault_of_its_recording_alone(
    capsys: pytest.CaptureFixture[str],
) -> None:
    Path("cut").mkdir()
    Path("cut/drives_a_mcap").write_text("in the way")
    assert campaign("--results", "r.parquet") == 2
    printed = capsys.readouterr().out
    assert "a.mcap: 1 violated, an extract is missing: cut/drives_a_mcap cannot be written: File exists" in printed
    assert files() == EXTRACTS[1:]
    Path("cut/drives_a_mcap").unlink()
    assert told(capsys, "--results", "r.parquet")["summary"]["judged_before"] == 2
    assert files() == EXTRACTS


@pytest.mark.usefixtures("drives")
def test_without_a_violation_that_is_said_once(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "p.ltlc", "drives/c.mcap", "drives/c*", "--cut", "cut", "--summary", "s.html"]) == 0
    told = capsys.readouterr().err
    assert told == "ltlc: nothing is written to cut: no property is violated\n"
    assert not Path("cut").exists()


def test_a_table_among_bags_is_refused_before_any_is_judged(drives: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (drives / "d.csv").write_text("time,speed\n0,3\n")
    assert campaign() == 2
    assert capsys.readouterr().err == "ltlc: --cut copies messages from bags; drives/d.csv is a table\n"
    assert not Path("cut").exists()


@pytest.mark.usefixtures("drives")
def test_extracts_are_not_written_among_the_recordings_that_are_judged(capsys: pytest.CaptureFixture[str]) -> None:
    campaign("--quiet")
    capsys.readouterr()
    assert main(["run", "p.ltlc", "drives", "cut", "--cut", "cut"]) == 2
    told = "cut/drives_a_mcap/slow+10s.mcap is a recording, and lies where extracts are written"
    assert told in capsys.readouterr().err


def test_recordings_whose_names_differ_in_other_characters_have_different_folders() -> None:
    names = ["a b/c", "a_b/c", "/a/b.c", "s3://a/b-c", "../x", "x", "é"]
    assert list(folders_of(names).values()) == ["a_b_c", "a_b_c_2", "a_b_c_3", "s3_a_b-c", "x", "x_2", "é"]


def test_an_extract_that_a_worker_has_written_elsewhere_is_an_error(tmp_path: Path) -> None:
    found = PropertyOutcome({"label": "p", "verdict": "violated", "extracts": [{"file": str(tmp_path / "x")}]}, "")
    report = {"properties": [], "is_damaged": False, "cut": {"error": None}}
    outcome = Outcome(Location("a.mcap"), report, (found,))
    assert _with_extracts_here(outcome).exit_code == 2
    (tmp_path / "x").touch()
    assert _with_extracts_here(outcome).exit_code == 1
