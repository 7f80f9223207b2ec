"""Several files of one command: all are written or none, and what is there is of one build."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from ltlc.base.files import write_all

CSV = "time,robot.velocity\n" + "".join(f"{k},{k % 2}\n" for k in range(4000))


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the test, with a specification and a recording."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.props").write_text("never robot.velocity > 2\n")
    (tmp_path / "drive.csv").write_text(CSV)
    return tmp_path


def contents(folder: Path) -> dict[str, bytes]:
    """All files in a folder, hidden ones too."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def with_little_room(arguments: str, blocks: int) -> subprocess.CompletedProcess[str]:
    """`ltlc` where no file can be larger than so many kB."""
    line = f"export PYTHONDONTWRITEBYTECODE=1; ulimit -f {blocks}; {shlex.quote(sys.executable)} -m ltlc {arguments}"
    return subprocess.run(["bash", "-c", line], check=False, capture_output=True, text=True)


@pytest.mark.parametrize(
    ("arguments", "blocks", "name"),
    [
        ("build a.props --target ros2 -o m.py --certificate m.cert", 4, "m.py"),
        ("build a.props --target ament -o package --certificate m.cert", 4, "package/"),
        ("run a.props drive.csv --output v.mcap --report r.html", 8, "r.html"),
        ("run a.props drive.csv drive.csv --summary s.html", 1, "s.html"),
        ("run a.props drive.csv drive.csv --summary s.html --report r.html", 40, "r.html"),
    ],
)
def test_where_one_of_several_files_has_no_room_none_is_written(
    here: Path, arguments: str, blocks: int, name: str
) -> None:
    for old in ("m.c", "m.h", "m.hpp", "m.py", "m.cert", "v.mcap", "r.html", "s.html"):
        (here / old).write_text("old")
    before = contents(here)
    done = with_little_room(arguments, blocks)
    assert done.returncode == 2, done
    assert "cannot be written: File too large" in done.stderr
    assert done.stderr.startswith(f"ltlc: {name}") or f"\nltlc: {name}" in done.stderr
    assert contents(here) == before
    assert not (here / "package").exists()


def test_files_are_written_in_folders_that_are_made(here: Path) -> None:
    write_all({here / "a/b/c.txt": "ö", here / "a/d.bin": b"\xff"})
    assert ((here / "a/b/c.txt").read_bytes(), (here / "a/d.bin").read_bytes()) == ("ö".encode(), b"\xff")


@pytest.mark.parametrize("failing", [1, 2, 3])
def test_a_fault_between_files_leaves_what_was_there(here: Path, monkeypatch: pytest.MonkeyPatch, failing: int) -> None:
    before = contents(here)
    count = 0
    real = os.fdopen

    def fdopen(*arguments: object) -> object:
        nonlocal count
        count += 1
        if count == failing:
            raise KeyboardInterrupt
        return real(*arguments)  # type: ignore[call-overload]

    monkeypatch.setattr(os, "fdopen", fdopen)
    with pytest.raises(KeyboardInterrupt):
        write_all({here / "a.props": "new", here / "new/x": "1", here / "new/deep/y": "2"})
    assert contents(here) == before
    assert not (here / "new").exists()


def test_an_output_that_is_the_specification_or_another_output_is_refused() -> None:
    for arguments in ("build a.props --target c -o m.c --certificate m.c", "build a.props -o a.props"):
        done = with_little_room(arguments, 10_000)
        assert (done.returncode, "is not written" in done.stderr) == (2, True)
