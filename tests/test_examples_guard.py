"""The worked examples of guards: each crashes without its guard, and the page shows what happens with it."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

pytest.importorskip("mujoco", reason="needs MuJoCo: install ltlc[simulation]")

ROOT = Path(__file__).parent.parent
EXAMPLES = ROOT / "examples" / "guard"
NAMES = sorted(path.stem for path in EXAMPLES.glob("*.txt"))
PAGE = (ROOT / "docs" / "guard.md").read_text(encoding="utf-8")


@cache
def shown() -> dict[str, str]:
    """The rows of the page's table, by the names of the examples."""
    return {found[1]: found[0] for found in re.finditer(r"^\| `(\w+)` \|.*\|$", PAGE, re.MULTILINE)}


def crash(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run the command that makes the table."""
    command = [sys.executable, str(folder / "crash.py"), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("name", NAMES)
def test_the_page_shows_what_happens_without_and_with_the_guard(name: str) -> None:
    run = crash(EXAMPLES, name)
    assert (run.returncode, run.stdout.splitlines()[-1], run.stderr) == (0, shown()[name], "")


def test_there_is_an_example_for_each_row() -> None:
    assert sorted(shown()) == NAMES
    assert len(NAMES) == 9


@pytest.mark.parametrize("name", NAMES)
def test_the_page_quotes_the_properties_of_the_example(name: str) -> None:
    quoted = re.split(r"\n\n\*\*|\n## ", PAGE.split(f"(`{name}.txt`)")[1])[0]
    text = (EXAMPLES / f"{name}.txt").read_text(encoding="utf-8")
    listing = re.findall(r"(?:^    .*\n)+", quoted, re.MULTILINE)
    assert listing
    assert all(re.sub(r"^    ", "", each, flags=re.MULTILINE) in text for each in listing)


def test_a_guard_that_keeps_nothing_of_a_scene_is_reported(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLES, tmp_path / "guard")
    properties = tmp_path / "guard" / "fence.txt"
    text = properties.read_text(encoding="utf-8").split("zone")[0]
    properties.write_text(f"{text}kept: always (new speed implies x < 100)\n", encoding="utf-8")
    assert crash(tmp_path / "guard", "fence").returncode == 1


def test_a_recording_of_the_drive_without_a_guard_can_be_tried_with_it(tmp_path: Path) -> None:
    assert crash(EXAMPLES, "joystick", "--record", str(tmp_path)).returncode == 0
    command = [sys.executable, "-m", "ltlc", "run", "--guard", str(EXAMPLES / "joystick.txt"), "joystick.jsonl"]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    passed, changed, held, sent = shown()["joystick"].split(" | ")[-4:]
    did = f"{passed} passed, {changed} changed, {held} held back, {sent.strip(' |')} sent by itself"
    assert f"guard of /cmd_vel: {did}" in run.stdout


def test_a_scene_that_is_not_there_is_refused_with_those_that_are() -> None:
    run = crash(EXAMPLES, "peple")
    assert run.returncode == 2
    assert "there is no scene peple: the scenes are people, estop" in run.stderr
