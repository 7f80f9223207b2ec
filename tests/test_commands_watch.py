"""`--watch`: a command runs again whenever what it reads changes, and ends at Ctrl-C with the code of its last run."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from ltlc.cli import main
from ltlc.interfaces.commands.watching import _wait, files_at

WAITING = "ltlc: waiting for a change, Ctrl-C ends"
PROPERTY = "decl v /v Float64.data\nslow: never v > {}\n"

Start = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    """Starts a command in `tmp_path`, and ends it after the test."""
    started: list[subprocess.Popen[str]] = []

    def begin(*arguments: str) -> subprocess.Popen[str]:
        command = [sys.executable, "-m", "ltlc", *arguments]
        environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1]), "PYTHONUNBUFFERED": "1"}
        process = subprocess.Popen(
            command, cwd=tmp_path, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )
        started.append(process)
        return process

    yield begin
    for process in started:
        process.kill()
        process.communicate()


def put(path: Path, text: str) -> None:
    """Write a file that is there as a whole or not at all."""
    part = path.with_name(".part")
    part.write_text(text)
    part.replace(path)


def report(process: subprocess.Popen[str]) -> str:
    """What is printed until the command waits."""
    assert process.stdout is not None
    lines: list[str] = []
    while (line := process.stdout.readline()).strip() != WAITING:
        assert line, "".join(lines)
        lines.append(line)
    return "".join(lines)


def interrupted(process: subprocess.Popen[str]) -> int:
    process.send_signal(signal.SIGINT)
    return process.wait()


@pytest.mark.live
def test_check_runs_again_when_the_specification_changes(start: Start, tmp_path: Path) -> None:
    path = tmp_path / "props.txt"
    path.write_text("slow: never w > 2\n")
    process = start("check", "props.txt", "--watch")
    assert "LTL101" in report(process)
    put(path, PROPERTY.format(2))
    assert report(process) == "slow: can hold, can fail\n"
    assert interrupted(process) == 0


@pytest.mark.live
def test_run_runs_again_when_a_recording_comes_and_ends_with_its_last_code(start: Start, tmp_path: Path) -> None:
    """What it writes among the recordings is no change."""
    (tmp_path / "props.txt").write_text(PROPERTY.format(2))
    (tmp_path / "drives").mkdir()
    (tmp_path / "drives" / "a.csv").write_text("time,v\n0,1\n")
    process = start("run", "props.txt", "drives", "--watch", "--summary", "drives/all.html")
    assert "1 recording" in report(process)
    put(tmp_path / "drives" / "b.csv", "time,v\n0,3\n")
    assert "2 recordings: 1 with a violation" in report(process)
    assert interrupted(process) == 1


@pytest.mark.parametrize(
    "arguments",
    [
        ("check", "-", "--watch"),
        ("check", "props.txt", "--watch", "--format", "json"),
        ("check", "props.txt", "--watch", "--format", "sarif"),
        ("run", "-", "a.csv", "--watch"),
        ("run", "props.txt", "s3://bucket/drives", "--watch"),
        ("run", "props.txt", "a.csv", "--watch", "--format", "junit"),
    ],
)
def test_what_cannot_be_watched_is_refused_by_name(
    arguments: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "--watch" in captured.err
    assert (
        next(each for each in arguments if each in ("-", "json", "sarif", "junit", "s3://bucket/drives"))
        in captured.err
    )


def test_a_change_counts_when_nothing_has_changed_for_a_while() -> None:
    """Editors write a file in several steps."""
    states = iter([{"a": (1, 1, 1)}, {"a": (1, 1, 1)}, {}, {"a": (2, 0, 2)}, {"a": (2, 9, 3)}, {"a": (2, 9, 3)}])
    _wait(lambda: next(states), {"a": (1, 1, 1)})
    assert next(states, None) is None


def test_files_are_found_by_name_in_folders_and_by_patterns_but_hidden_ones(tmp_path: Path) -> None:
    for name in ("a.csv", "b.csv", ".a.csv.swp", "out.html"):
        (tmp_path / name).write_text("")
    found = files_at([str(tmp_path), f"{tmp_path}/*.csv", "no such file"], {str(tmp_path / "out.html")})
    assert sorted(Path(name).name for name in found) == ["a.csv", "b.csv"]
