"""ltlc where ROS's wheels were installed by pip: an old lark-parser has overwritten lark, and nothing may need it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

OLD_LARK = 'raise ImportError("lark-parser 0.12 has overwritten lark")\n'
PROPERTIES = "decl x /x std_msgs/Float64.data\nlow: never x > 5\n"


@pytest.mark.parametrize(
    "command",
    [
        ("check", "props.txt"),
        ("build", "props.txt"),
        ("run", "props.txt", "run.csv"),
        ("explain", "props.txt"),
        ("compare", "props.txt"),
    ],
    ids=lambda command: command[0],
)
def test_no_command_imports_lark(tmp_path: Path, command: tuple[str, ...]) -> None:
    (tmp_path / "site" / "lark").mkdir(parents=True)
    (tmp_path / "site" / "lark" / "__init__.py").write_text(OLD_LARK)
    (tmp_path / "props.txt").write_text(PROPERTIES)
    (tmp_path / "run.csv").write_text("time,x\n0,1\n")
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "site")}
    assert _run(["-c", "import lark"], tmp_path, environment).returncode == 1
    done = _run(["-m", "ltlc", *command], tmp_path, environment)
    assert (done.returncode, "Traceback" in done.stderr) == (0, False), done.stderr


def _run(arguments: list[str], folder: Path, environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
