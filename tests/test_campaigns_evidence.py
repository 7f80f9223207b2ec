"""The evidence of a campaign: a document for each recording, in order, the same file however often it was stopped."""

from __future__ import annotations

import shutil
from pathlib import Path
from random import Random

import pytest
from evidencing import random_rows, specification, write_bag

from ltlc.assurance.evidence import recorded
from ltlc.assurance.evidence.document import END, HEADER, Document, digest
from ltlc.assurance.evidence.parsing import parsed_all
from ltlc.cli import main

TEXT = specification(["never x > 2", "always age(y) <= 1 s"])
NAMES = ["a", "b", "c"]


@pytest.fixture
def drives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with three bags, beside a specification."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "props.txt").write_text(TEXT)
    for number, name in enumerate(NAMES):
        write_bag(tmp_path / "drives" / name, random_rows(Random(number)))
    return tmp_path / "drives"


def campaign(*more: str) -> int:
    return main(["run", "props.txt", "drives", "--evidence", "all.evidence", "--quiet", *more])


def bundle() -> tuple[Document, ...]:
    found = parsed_all(Path("all.evidence").read_text(encoding="utf-8"))
    assert isinstance(found, tuple)
    return found


def names() -> list[str]:
    return [document.head.recordings[0].name.partition("/")[0] for document in bundle()]


def test_there_is_a_document_for_each_recording_in_their_order(drives: Path) -> None:
    campaign("--jobs", "2")
    assert names() == NAMES
    assert recorded.main(["all.evidence", *(str(drives / name) for name in NAMES)]) == 0


def test_a_campaign_that_was_stopped_goes_on_to_the_same_bytes(
    drives: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    campaign("--results", "all.parquet")
    whole = Path("all.evidence").read_bytes()
    Path("all.evidence").write_bytes(whole[: whole.rindex(HEADER.encode()) + 200])  # the last one is cut off
    capsys.readouterr()
    campaign("--results", "all.parquet")
    assert Path("all.evidence").read_bytes() == whole
    assert "2 judged before" in capsys.readouterr().out


def test_evidence_that_was_changed_in_between_is_made_anew_though_its_digest_is_right(drives: Path) -> None:
    campaign("--results", "all.parquet")
    whole = Path("all.evidence").read_text()
    first, second = whole.split(END, 1)
    forged = first.replace("verdict presumably_satisfied", "verdict satisfied").replace(
        "verdict violated", "verdict satisfied"
    )
    assert forged != first
    Path("all.evidence").write_text(f"{forged}{END}{digest(forged)}{second[64:]}")
    assert len(bundle()) == 3
    campaign("--results", "all.parquet")
    assert Path("all.evidence").read_text() == whole


def test_nothing_is_written_where_nothing_has_changed(drives: Path) -> None:
    campaign("--results", "all.parquet")
    before = Path("all.evidence").stat().st_mtime_ns
    campaign("--results", "all.parquet")
    assert Path("all.evidence").stat().st_mtime_ns == before


def test_a_recording_that_has_changed_is_judged_again_and_what_is_gone_is_left_out(drives: Path) -> None:
    campaign("--results", "all.parquet")
    first = bundle()
    write_bag(drives / "b", random_rows(Random(9)))
    shutil.rmtree(drives / "c")
    campaign("--results", "all.parquet")
    assert names() == ["a", "b"]
    assert bundle()[0] == first[0]
    assert bundle()[1] != first[1]


def test_another_specification_begins_anew(drives: Path) -> None:
    campaign("--results", "all.parquet")
    Path("props.txt").write_text(TEXT.replace("x > 2", "x > 1"))
    campaign("--results", "all.parquet")
    assert len({document.head.specification for document in bundle()}) == 1
    assert "never x > 1" in Path("all.evidence").read_text()


def test_what_cannot_be_judged_to_its_end_has_no_evidence(drives: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bag = drives / "b" / "b.mcap"
    bag.write_bytes(bag.read_bytes()[:-2000])
    assert campaign() == 2
    assert names() == ["a", "c"]
    assert f"no evidence of what could not be judged to its end: {Path('drives') / 'b'}" in capsys.readouterr().err


def test_a_file_that_cannot_be_written_is_unusable(drives: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "props.txt", "drives", "--evidence", "drives/a/x"]) == 2
    assert main(["run", "props.txt", "drives", "--evidence", "nowhere/all.evidence"]) == 2
    assert "cannot be written" in capsys.readouterr().err


@pytest.mark.usefixtures("drives")
def test_another_file_is_not_replaced(capsys: pytest.CaptureFixture[str]) -> None:
    Path("all.evidence").write_text("notes")
    assert campaign() == 2
    assert "another file is there that is not evidence" in capsys.readouterr().err
    assert Path("all.evidence").read_text() == "notes"


def test_of_one_recording_it_is_written_as_a_whole_or_not_at_all(
    drives: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["run", "props.txt", str(drives / "a"), "--evidence", "one.evidence"]
    main(command)
    assert "ltlc: wrote one.evidence" in capsys.readouterr().err
    bag = drives / "a" / "a.mcap"
    bag.write_bytes(bag.read_bytes()[:-2000])
    Path("one.evidence").unlink()
    assert main(command) == 2
    assert not Path("one.evidence").exists()
    assert "one.evidence is not written: not all of the recording could be judged" in capsys.readouterr().err


def test_the_folder_of_a_campaign_is_certified_as_its_recordings_are(
    drives: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    campaign()
    assert main(["certify", "props.txt", "--evidence", "all.evidence", "drives", "-q"]) == 0
    shutil.rmtree(drives / "c")
    assert main(["certify", "props.txt", "--evidence", "all.evidence", "drives", "-q"]) == 3
    assert main(["certify", "props.txt", "--evidence", "all.evidence", "nowhere/*", "-q"]) == 2
    assert "`nowhere/*` matches no recording" in capsys.readouterr().err
