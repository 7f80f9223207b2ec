"""What TAB offers in bash, zsh and fish, each asked itself."""

from __future__ import annotations

import os
import pty
import re
import select
import shutil
import signal
import subprocess
from pathlib import Path

import pytest

from ltlc.cli import main
from ltlc.interfaces.commands.parser import COMMANDS

LONGEST = 60.0
"""Seconds after which a shell that says nothing has failed."""


@pytest.fixture(scope="module", params=["bash", "zsh", "fish"])
def shell(request: pytest.FixtureRequest) -> str:
    if shutil.which(request.param) is None:
        pytest.skip(f"{request.param} is not installed")
    return str(request.param)


@pytest.fixture
def script(shell: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    assert main(["completion", shell]) == 0
    path = tmp_path / "script"
    path.write_text(capsys.readouterr().out, encoding="utf-8")
    (tmp_path / "specs").mkdir()
    return path


def offered(shell: str, script: Path, line: str) -> list[str]:
    """What the shell offers at the end of `line`."""
    match shell:
        case "bash":
            words = line.split(" ")
            text = (
                f"source {script}; COMP_WORDS=({line} ''); COMP_CWORD={len(words) - 1}; _shtab_ltlc ltlc '{words[-1]}'"
            )
            return output(["bash", "--norc", "-c", f'{text}; printf "%s\\n" "${{COMPREPLY[@]}}"'], script.parent)
        case "fish":
            found = output(["fish", "--no-config", "-c", f"source {script}; complete -C '{line}'"], script.parent)
            return [each.partition("\t")[0] for each in found]
        case _:
            return typed_in_zsh(script, line)


def output(command: list[str], folder: Path) -> list[str]:
    environment = {**os.environ, "HOME": str(folder), "XDG_DATA_HOME": str(folder), "XDG_CONFIG_HOME": str(folder)}
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=True, timeout=LONGEST
    ).stdout.splitlines()


def typed_in_zsh(script: Path, line: str) -> list[str]:
    """What the line of an interactive zsh is after TAB: the one thing that is offered."""
    child, terminal = pty.fork()
    if child == 0:
        os.chdir(script.parent)
        os.execvpe("zsh", ["zsh", "-f", "-i"], {**os.environ, "HOME": str(script.parent), "TERM": "dumb"})
    try:
        load = f'PS1=; unsetopt zle; autoload -Uz compinit; compinit -u -D; eval "$(cat {script})"; setopt zle'
        os.write(terminal, f"{load}; echo re''ady\n".encode())
        said_until(terminal, "(ready)")
        os.write(terminal, f"{line}\t\x01echo 'line': '\x05'\n".encode())
        return [said_until(terminal, "line: ([^\r\n]*)").strip().split(" ")[-1]]
    finally:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        os.close(terminal)


def said_until(terminal: int, line: str) -> str:
    """What comes out of a terminal, up to a whole line that `line` matches: its first group."""
    said = ""
    while (found := re.search(rf"\n{line}\r\n", said)) is None:
        assert select.select([terminal], [], [], LONGEST)[0], said
        said += os.read(terminal, 4096).decode(errors="replace")
    return found[1]


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("ltlc expl", "explain"),
        ("ltlc check --ped", "--pedantic"),
        ("ltlc check --format con", "concise"),
        ("ltlc build --target am", "ament"),
        ("ltlc check spe", "specs"),
        ("ltlc run specs --msg-path spe", "specs"),
    ],
)
def test_tab_completes_what_has_one_end(shell: str, script: Path, line: str, expected: str) -> None:
    assert [each.rstrip("/") for each in offered(shell, script, line)] == [expected]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_its_options_in_every_script(shell: str, script: Path, command: str) -> None:
    if shell == "zsh":
        assert f"_shtab_ltlc_{command}_options" in script.read_text(encoding="utf-8")
        return
    assert "--quiet" in offered(shell, script, f"ltlc {command} --")


def test_a_shell_that_is_not_known_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["completion", "csh"])
    assert ended.value.code == 2
    assert "'bash', 'zsh', 'fish'" in capsys.readouterr().err
