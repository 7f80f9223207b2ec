"""Recordings on other storage, and workers elsewhere: the same verdicts, nothing left behind, a line for what fails."""

from __future__ import annotations

import functools
import http.server
import json
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from stepping import from_text
from test_campaigns import BROKEN, FAST, GOOD, OWED, SPECIFICATION, ran

from ltlc.monitoring.campaigns import engine
from ltlc.monitoring.campaigns.campaign import TRIES, judge_all, on_this_machine
from ltlc.monitoring.campaigns.places import Location, find
from ltlc.monitoring.judging.run import Judge

fsspec = pytest.importorskip("fsspec", reason="needs fsspec (pip install '.[campaigns]')")

DRIVES = {"a.csv": GOOD, "b.csv": FAST, "late/c.csv": OWED, "notes.txt": "sunny"}


@pytest.fixture
def memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """A storage with recordings; temporary files are in a folder of their own."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "props.txt").write_text(SPECIFICATION)
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    system = fsspec.filesystem("memory")
    for name, text in DRIVES.items():
        system.pipe(f"/drives/{name}", text.encode())
    yield system
    system.rm("/", recursive=True)


@pytest.mark.usefixtures("memory")
@pytest.mark.parametrize(
    ("address", "wanted", "left_alone"),
    [
        ("memory://drives", ["a.csv", "b.csv", "late/c.csv"], 1),
        ("memory://drives/*", ["a.csv", "b.csv"], 1),
        ("memory://drives/**/*.csv", ["a.csv", "b.csv", "late/c.csv"], 0),
        ("memory://drives/b.csv", ["b.csv"], 0),
    ],
)
def test_folders_and_patterns_are_searched_there_too(address: str, wanted: list[str], left_alone: int) -> None:
    found = find([address])
    assert found.problems == []
    assert [place.name for place in found.places] == [f"memory:///drives/{name}" for name in wanted]
    assert found.left_alone == left_alone


def test_a_folder_of_a_bag_is_one_recording_there_too(memory: Any) -> None:
    memory.pipe("/drives/bag/metadata.yaml", b"")
    memory.pipe("/drives/bag/bag_0.mcap", b"x")
    found = find(["memory://drives"])
    assert "memory:///drives/bag" in [place.name for place in found.places]
    assert len(found.places) == 4
    assert find(["memory://drives/bag"]).places == [each for each in found.places if each.name.endswith("/bag")]


def test_verdicts_are_those_of_the_file_and_no_copy_is_left(
    memory: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    memory.pipe("/drives/broken.csv", BROKEN.encode())
    code, out, err = ran(capsys, "memory://drives", "--format", "json")
    for document in json.loads(out)["recordings"]:
        name = document["recording"].removeprefix("memory:///drives/")
        path = tmp_path / Path(name).name
        path.write_text({**DRIVES, "broken.csv": BROKEN}[name])
        alone = json.loads(ran(capsys, str(path), "--format", "json")[1])
        for told in alone["diagnostics"]:
            told["message"] = told["message"].replace(str(path), document["recording"])
        assert document == {**alone, "recording": document["recording"]}
    assert code == 2
    assert "memory:///drives/broken.csv" in err
    assert list((tmp_path / "temporary").iterdir()) == []


def test_what_has_changed_there_is_another_version(memory: Any) -> None:
    before = find(["memory://drives"]).places
    assert find(["memory://drives"]).places == before
    memory.pipe("/drives/a.csv", FAST.encode())
    assert [new != old for new, old in zip(find(["memory://drives"]).places, before, strict=True)] == [1, 0, 0]


@pytest.mark.usefixtures("memory")
@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("memory://none/x.csv", "`memory://none/x.csv` cannot be read: there is nothing"),
        ("memory://none/*.csv", "`memory://none/*.csv` matches no recording"),
        ("nowhere://x", "`nowhere://x` cannot be read: Protocol not known: nowhere"),
    ],
)
def test_what_is_not_there_is_one_line(address: str, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = ran(capsys, address)
    assert (code, words in " ".join(err.split())) == (2, True)


@pytest.mark.usefixtures("memory")
def test_without_fsspec_it_is_said_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "fsspec", None)
    code, _, err = ran(capsys, "s3://bucket/x.csv")
    assert (code, "pip install 'ltlc[campaigns]'" in err) == (2, True)


def test_a_recording_that_cannot_be_fetched_is_tried_again_and_then_told(memory: Any) -> None:
    place = Location("memory:///drives/gone.csv")
    [outcome] = judge_all(Judge(*from_text(SPECIFICATION)), [place], on_this_machine(1))
    assert outcome.tries == TRIES
    assert outcome.error is not None
    assert (outcome.error["code"], outcome.exit_code) == ("LTL831", 2)


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing."""


@pytest.mark.live
def test_recordings_are_read_over_http(tmp_path: Path) -> None:
    pytest.importorskip("aiohttp", reason="fsspec reads http through aiohttp, which is yours to install")
    (tmp_path / "b.csv").write_text(FAST)
    handler = functools.partial(Quiet, directory=str(tmp_path))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            places = find([f"http://127.0.0.1:{server.server_port}/b.csv"]).places
            [outcome] = judge_all(Judge(*from_text(SPECIFICATION)), places, on_this_machine(1))
        finally:
            server.shutdown()
            thread.join()
    assert outcome.exit_code == 1


def test_without_dask_it_is_said_what_to_install(
    memory: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    code, out, err = ran(capsys, "memory://drives", "--engine", "local")
    assert (code, out, "pip install 'ltlc[campaigns]'" in err) == (2, "", True)


def test_an_engine_that_does_not_answer_is_told(
    memory: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("distributed", reason="needs Dask (pip install '.[campaigns]')")
    monkeypatch.setattr(engine, "SECONDS", 0.2)
    for address in ("tcp://127.0.0.1:9", "what"):
        code, out, err = ran(capsys, "memory://drives", "--engine", address)
        assert (code, out, f"error[LTL834]: no workers at `{address}`" in err) == (2, "", True)


CAMPAIGN = """
import sys
from pathlib import Path
import psutil
from ltlc.monitoring.campaigns import engine
from ltlc.monitoring.campaigns.campaign import judge_all, on_this_machine
from ltlc.monitoring.campaigns.engine import on_engine
from ltlc.monitoring.campaigns.places import find
from ltlc.monitoring.judging.run import Judge
from stepping import from_text

if __name__ == "__main__":
    engine.SECONDS = 300.0
    places = find(["drives"]).places
    judge = Judge(*from_text(Path("props.txt").read_text()))
    wanted = {each.place: each.document() for each in judge_all(judge, places, on_this_machine(1))}
    found = {}
    with on_engine("local", 2) as workers:
        for number, outcome in enumerate(judge_all(judge, places, workers)):
            found[outcome.place] = outcome.document()
            if number == 5:
                below = psutil.Process().children(recursive=True)
                max(below, key=lambda each: each.cpu_times().user).kill()
    assert len(found) == 40
    assert found == wanted
"""


@pytest.mark.live
def test_workers_of_an_engine_give_the_same_and_one_that_dies_costs_retries(tmp_path: Path) -> None:
    pytest.importorskip("distributed", reason="needs Dask (pip install '.[campaigns]')")
    (tmp_path / "props.txt").write_text(SPECIFICATION)
    (tmp_path / "campaign.py").write_text(CAMPAIGN)
    (tmp_path / "drives").mkdir()
    for number in range(40):
        (tmp_path / "drives" / f"{number:02}.csv").write_text([GOOD, FAST, OWED, BROKEN][number % 4] * (number < 39))
    paths = os.pathsep.join([str(Path(__file__).parents[1]), str(Path(__file__).parent)])
    # a process of its own, since Dask's helpers outlive its cluster
    done = subprocess.run(
        [sys.executable, "campaign.py"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
