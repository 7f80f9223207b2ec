"""What is not installed: the core does without every extra, and what cannot names the command that brings it."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pyarrow
import pytest
import zstandard
from bag_support import FORMS, odometry
from pyarrow import parquet

from ltlc.base.libraries import EXTRAS

PROJECT = Path(__file__).parents[1]
ALL = sorted(module for modules in EXTRAS.values() for module in modules)
BLOCK = f"""import sys
sys.modules.update(dict.fromkeys({ALL}))
from ltlc.cli import main
sys.exit(main(sys.argv[1:]))
"""
SPECIFICATION = """
decl v /odom nav_msgs/Odometry.twist.twist.linear.x
stop: always (v > 1 implies eventually v < 0.5 within 2 s)
"""
ROWS = [(k, 2.0 if k % 10 == 0 else 0.25) for k in range(9_000)]


@pytest.fixture
def core(tmp_path: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Runs a command on `props.txt` where no extra is installed."""
    (tmp_path / "props.txt").write_text(SPECIFICATION)

    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-c", BLOCK, *arguments]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)

    return run


Core = Callable[..., subprocess.CompletedProcess[str]]


def test_the_core_checks(core: Core) -> None:
    done = core("check", "props.txt")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("target", "output"), [("python", "m.py"), ("c", "m.c"), ("rust", "m.rs"), ("ros2", "node.py"), ("ament", "m")]
)
def test_the_core_builds_and_certifies(core: Core, target: str, output: str) -> None:
    for command in (
        ("build", "props.txt", "--target", target, "-o", output, "--certificate", "proof.json"),
        ("certify", "props.txt", "proof.json", "--code", output),
    ):
        done = core(*command)
        assert done.returncode == 0, done.stderr


def test_the_core_knows_the_messages_of_a_package(core: Core, tmp_path: Path) -> None:
    folder = tmp_path / "own_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Level.msg").write_text("float32 level\nuint8 FULL=2\n")
    (tmp_path / "own.txt").write_text("decl level /level own_msgs/Level.level\nlow: never level > Level.FULL\n")
    done = core("check", "own.txt", "--msg-path", "own_msgs")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", ["drive.csv", "drive.jsonl"])
def test_the_core_judges_large_text_as_a_library_would(core: Core, tmp_path: Path, name: str) -> None:
    lines = {
        "drive.csv": ["time,v", *(f"{time},{v}" for time, v in ROWS)],
        "drive.jsonl": [json.dumps({"time": time, "v": v}) for time, v in ROWS],
    }
    (tmp_path / name).write_text("\n".join(lines[name]))
    assert (tmp_path / name).stat().st_size > 1 << 16
    command = ["run", "props.txt", name, "--format", "json"]
    everything = subprocess.run(
        [sys.executable, "-m", "ltlc", *command], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    done = core(*command)
    assert (done.returncode, done.stdout) == (0, everything.stdout), done.stderr


def recorded(folder: Path, form: str) -> str:
    """The name of a small recording in this form."""
    if form == "parquet":
        parquet.write_table(pyarrow.table({"time": [0.0, 1.0], "v": [1.0, 0.0]}), folder / "drive.parquet")
        return "drive.parquet"
    if form == "csv.zst":
        (folder / "drive.csv.zst").write_bytes(zstandard.compress(b"time,v\n0,1\n1,0\n"))
        return "drive.csv.zst"
    return FORMS[form](folder, [odometry(10**9, twist__twist__linear__x=0.1)]).name


@pytest.mark.parametrize(
    "form",
    ["mcap", "mcap folder by message", "mcap folder by file", "sqlite3 by message", "ros1", "parquet", "csv.zst"],
)
def test_a_recording_that_needs_a_library_names_the_command(core: Core, tmp_path: Path, form: str) -> None:
    done = core("run", "props.txt", recorded(tmp_path, form))
    assert done.returncode == 2
    assert re.search(r"error\[LTL808\]: this needs `\w+`.* `pip install 'ltlc\[recordings\]'`", done.stderr)


@pytest.mark.parametrize(
    "arguments",
    [
        ("check", "props.txt", "--recording", "drive.parquet"),
        ("new", "drive.parquet"),
        ("mine", "mined.txt", "drive.parquet"),
        ("run", "props.txt", "drive.csv", "--output", "verdicts.mcap"),
        ("run", "props.txt", "drive.csv", "--results", "all.parquet"),
        ("run", "props.txt", "drive.csv", "drive.parquet"),
    ],
)
def test_every_command_names_what_it_lacks(core: Core, tmp_path: Path, arguments: tuple[str, ...]) -> None:
    (tmp_path / "drive.csv").write_text("time,v\n0,1\n1,0\n")
    (tmp_path / "mined.txt").write_text(f"{SPECIFICATION}fast: never v > ?\n")
    recorded(tmp_path, "parquet")
    done = core(*arguments)
    assert (done.returncode, "pip install 'ltlc[recordings]'" in done.stderr) == (2, True), done.stderr
    assert "Traceback" not in done.stderr
    assert "bug" not in done.stderr


def test_a_search_names_what_it_lacks(core: Core) -> None:
    command = ("falsify", "props.txt", "--simulate", "true {v} {recording}", "--parameter", "v=0..1")
    done = core(*command)
    assert (done.returncode, "pip install 'ltlc[falsify]'" in done.stderr) == (2, True), done.stderr


def test_the_extras_of_the_package_bring_the_modules_that_are_named() -> None:
    extras = tomllib.loads((PROJECT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    for name, modules in EXTRAS.items():
        assert {re.split(r"[<>=\[]", each)[0] for each in extras[name]} <= set(modules)
