"""How far a command is, on a terminal and nowhere else."""

from __future__ import annotations

import io
import os
import pty
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, suppress
from pathlib import Path

import pytest

from ltlc.cli import main
from ltlc.interfaces.commands import progress


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    monkeypatch.delenv("CI", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    return Terminal()


@pytest.fixture
def slow(monkeypatch: pytest.MonkeyPatch) -> None:
    """Everything takes longer than a moment."""
    monkeypatch.setattr(progress, "AFTER_SECONDS", 0.0)
    monkeypatch.setattr(progress, "EVERY_SECONDS", 0.0)


def file(folder: Path) -> str:
    path = folder / "props.txt"
    path.write_text("limit: never robot.velocity > 2\n", encoding="utf-8")
    return str(path)


@pytest.mark.usefixtures("slow")
def test_check_says_on_a_terminal_how_far_it_is_and_clears_the_line(terminal: Terminal, tmp_path: Path) -> None:
    with redirect_stderr(terminal):
        main(["check", file(tmp_path)])
    assert "ltlc: checking, 1 of 1 (" in terminal.getvalue()
    assert terminal.getvalue().endswith("\r\x1b[K")


@pytest.mark.usefixtures("slow")
def test_build_says_how_far_each_of_its_passes_is(terminal: Terminal, tmp_path: Path) -> None:
    with redirect_stderr(terminal):
        main(["build", file(tmp_path), "--target", "json", "-o", str(tmp_path / "out.json")])
    for what in ("checking", "judging monitors"):
        assert f"\r\x1b[Kltlc: {what}, 1 of 1 (" in terminal.getvalue()


@pytest.mark.usefixtures("slow")
@pytest.mark.parametrize(("variable", "value"), [("CI", "true"), ("TERM", "dumb")])
def test_nothing_is_shown_where_nobody_can_read_it(
    terminal: Terminal, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, variable: str, value: str
) -> None:
    monkeypatch.setenv(variable, value)
    with redirect_stderr(terminal):
        main(["check", file(tmp_path)])
    assert terminal.getvalue() == ""


@pytest.mark.usefixtures("slow")
def test_nothing_is_shown_in_a_pipe(tmp_path: Path) -> None:
    with redirect_stderr(io.StringIO()) as pipe:
        main(["check", file(tmp_path)])
    assert pipe.getvalue() == ""


def test_what_is_done_in_a_moment_shows_nothing(terminal: Terminal) -> None:
    with redirect_stderr(terminal), progress.progress("checking", quiet=False) as watch:
        assert watch is not None
        watch(1, 2)
    assert terminal.getvalue() == ""


@pytest.mark.usefixtures("slow")
def test_run_says_how_far_into_the_recording_it_is(terminal: Terminal, tmp_path: Path) -> None:
    recording = tmp_path / "drive\x1b.csv"
    recording.write_text("time,robot.velocity\n0,1\n0.5,1\n", encoding="utf-8")
    with redirect_stderr(terminal):
        main(["run", file(tmp_path), str(recording)])
    assert "\r\x1b[Kltlc: judging drive\\x1b.csv, 2 rows, up to +0.5 s (" in terminal.getvalue()
    assert terminal.getvalue().endswith("\r\x1b[K")


@pytest.mark.usefixtures("slow")
def test_compare_says_how_far_it_is_with_many_formulas(terminal: Terminal, tmp_path: Path) -> None:
    formulas = tmp_path / "formulas.txt"
    formulas.write_text("F a\na\nG a\n", encoding="utf-8")
    with redirect_stderr(terminal):
        main(["compare", "--ltl-file", str(formulas)])
    assert "ltlc: comparing, 12 of 12 (" in terminal.getvalue()
    assert "ltlc: comparing, 6 of 6 (" in terminal.getvalue()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A specification, one of which a value is sought, a drive, and certificates."""
    folder = tmp_path_factory.mktemp("work")
    (folder / "sought.txt").write_text("never robot.velocity > ?\n", encoding="utf-8")
    (folder / "drive.csv").write_text("time,robot.velocity\n0,1\n0.5,1\n", encoding="utf-8")
    output = ["--target", "hoa", "-o", str(folder / "monitors.hoa"), "--certificate", str(folder / "props.cert")]
    assert main(["build", file(folder), "--quiet", *output]) == 0
    return folder


@contextmanager
def at_once(_: float, call: Callable[[], None]) -> Iterator[None]:
    """The timer, as if the first moment was over at once."""
    call()
    yield


@pytest.mark.usefixtures("slow")
@pytest.mark.parametrize(
    ("arguments", "states"),
    [
        ("explain props.txt", ["explaining (", "explaining, 1 of 1"]),
        ("certify props.txt props.cert", ["checking certificates"]),
        ("mine sought.txt drive.csv", ["looking for recordings", "reading recordings, 0 of 1"]),
        ("compare --corpus random --count 1", ["measuring"]),
        ("build props.txt -o node.py", ["checking, 1 of 1", "judging monitors, 1 of 1", "making the files"]),
        ("run props.txt drive.csv --report page.html", ["explaining the properties", "drawing the page"]),
    ],
)
def test_a_command_says_what_it_is_doing_and_nothing_if_quiet(
    folder: Path, terminal: Terminal, monkeypatch: pytest.MonkeyPatch, arguments: str, states: list[str]
) -> None:
    monkeypatch.setattr(progress, "_every", at_once)
    monkeypatch.chdir(folder)
    with redirect_stderr(terminal):
        main(arguments.split())
    assert [state for state in states if f"\r\x1b[Kltlc: {state}" not in terminal.getvalue()] == []
    with redirect_stderr(Terminal()) as silent:
        main([*arguments.split(), "--quiet"])
    assert silent.getvalue() == ""


def test_the_line_is_on_a_real_terminal_and_gone_before_the_results(folder: Path) -> None:
    child, terminal = pty.fork()
    if child == 0:
        os.chdir(folder)
        environment = {name: value for name, value in os.environ.items() if name != "CI"} | {"TERM": "xterm"}
        hurry = "from ltlc.interfaces.commands import progress; progress.AFTER_SECONDS = progress.EVERY_SECONDS = 0.001"
        program = f"import sys; {hurry}; from ltlc.cli import main; sys.exit(main())"
        os.execve(sys.executable, [sys.executable, "-c", program, "check", "props.txt"], environment)
    shown = b""
    with suppress(OSError):  # what a terminal says at its end
        while part := os.read(terminal, 65536):
            shown += part
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    os.close(terminal)
    lines = shown.decode().split("\r\x1b[K")
    assert lines[1].startswith("ltlc: checking")
    assert lines[-1] == "limit: can hold, can fail\r\n"


@pytest.mark.usefixtures("slow")
def test_time_goes_on_where_nothing_is_told(terminal: Terminal, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "EVERY_SECONDS", 0.001)
    with redirect_stderr(terminal), progress.saying("thinking", quiet=False):
        while "ltlc: thinking (0 s)" not in terminal.getvalue():
            signal.pause()
    assert terminal.getvalue().endswith("\r\x1b[K")
