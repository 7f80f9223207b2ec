"""The recipes for continuous integration do what docs/ci.md says, and so do the hooks for pre-commit."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "ci.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(yaml|sh)\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
RECIPES = [yaml.safe_load(block) for language, block in BLOCKS if language == "yaml"]
HOOKS = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))

DRIVES = {
    "satisfied": "time,near,far,stopped\n0,1,0,0\n1,1,0,1\n2,0,1,0\n",
    "owed": "time,near,far,stopped\n0,1,0,0\n1,1,0,0\n",
    "violated": "time,near,far,stopped\n0,1,0,0\n1,0,1,0\n",
}
"""How a robot comes to a sign."""

PROPERTIES = """
decl near /near Bool.data
decl far /far Bool.data
decl stopped /stopped Bool.data
after_until near, far and not near, eventually stopped
"""


def scripts(recipe: Any) -> Iterator[str]:
    """The shell commands of a workflow, wherever they stand in it."""
    match recipe:
        case dict():
            for key, value in recipe.items():
                yield from [value] if key == "run" and isinstance(value, str) else scripts(value)
        case list():
            for value in recipe:
                yield from [value] if isinstance(value, str) else scripts(value)
        case _:
            pass


def commands() -> list[str]:
    """Each `ltlc …` that a recipe, the script or the text shows, once."""
    shown = re.findall(r"^    (ltlc .*)$", PAGE, re.MULTILINE)
    shown += [block for language, block in BLOCKS if language == "sh"]
    shown += [script for recipe in RECIPES for script in scripts(recipe)]
    return sorted({line for text in shown for line in text.splitlines() if line.startswith("ltlc ")})


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """Somebody's repository, with a specification, a recorded drive, and a colcon workspace."""
    (tmp_path / "props.txt").write_text(PROPERTIES)
    (tmp_path / "drives").mkdir()
    (tmp_path / "drives" / "drive.csv").write_text(DRIVES["satisfied"])
    (tmp_path / "src").mkdir()
    return tmp_path


def shell(command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """What `command` does in `folder`, where `ltlc` is on the path."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "PYTHONPATH": str(ROOT)}
    return subprocess.run(
        ["sh", "-ec", command], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize("command", commands())
def test_a_command_of_a_recipe_passes_and_writes_what_the_recipe_keeps(command: str, repository: Path) -> None:
    done = shell(command, repository)
    assert done.returncode == 0, done.stderr
    written = re.findall(r"(?:>|--summary|-o) (\S+)", command)
    assert all((repository / name).exists() for name in written)


def test_the_recipes_have_commands_for_each_of_the_three_things() -> None:
    assert {command.split()[1] for command in commands()} == {"check", "run", "build"}


@pytest.mark.parametrize(("drive", "code"), [("owed", 0), ("violated", 1)])
def test_a_job_can_let_pass_what_is_owed_but_not_what_is_violated(drive: str, code: int, repository: Path) -> None:
    (repository / "drives" / "drive.csv").write_text(DRIVES[drive])
    (command,) = (each for each in commands() if "||" in each)
    assert shell(command, repository).returncode == code


def test_the_readme_and_the_command_line_have_the_same_words_for_exit_codes() -> None:
    (words,) = re.findall(r"Exit codes: (.*)\.\n", (ROOT / "README.md").read_text(encoding="utf-8"))
    said = shell("ltlc --help", ROOT).stdout
    assert words in " ".join(said.split())
    assert words.partition("3 ")[2] in PAGE


def test_pre_commit_accepts_the_hooks_and_the_recipe_that_asks_for_them(tmp_path: Path) -> None:
    pytest.importorskip("pre_commit")
    config = tmp_path / ".pre-commit-config.yaml"
    (recipe,) = (each for each in RECIPES if "repos" in each)
    config.write_text(yaml.safe_dump(recipe))
    assert {hook["id"] for repo in recipe["repos"] for hook in repo["hooks"]} <= {hook["id"] for hook in HOOKS}
    for what, file in (("validate-manifest", ROOT / ".pre-commit-hooks.yaml"), ("validate-config", config)):
        done = shell(f"pre-commit {what} {file}", tmp_path)
        assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("hook", HOOKS, ids=lambda hook: hook["id"])
def test_a_hook_passes_files_that_are_well_and_fails_for_one_that_is_not(hook: dict[str, str], tmp_path: Path) -> None:
    names = ["props.txt", "dock.ltlc", "robot/props.txt", "notes.txt", "my_props.txt"]
    taken = [name for name in names if re.search(hook["files"], name)]
    assert taken == names[:3]
    (tmp_path / "robot").mkdir()
    for name in taken:
        (tmp_path / name).write_text("decl speed /speed Float64.data\n\nnever speed > 2\n")
    assert shell(f"{hook['entry']} {' '.join(taken)}", tmp_path).returncode == 0
    (tmp_path / taken[-1]).write_text("never speed >\n")
    assert shell(f"{hook['entry']} {' '.join(taken)}", tmp_path).returncode != 0
