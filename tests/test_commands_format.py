"""`ltlc format` as a user calls it: what is written, what is said, and the exit codes."""

from __future__ import annotations

import io
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from ltlc.cli import main

LOOSE = "p :never robot.velocity>2\r\n"
CANONICAL = "p: never robot.velocity > 2\r\n"
BROKEN = "never robot.velocity &&\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "props.txt"
    path.write_bytes(LOOSE.encode())
    return path


def test_a_file_is_laid_out_in_place_and_named(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["format", str(path)]) == 0
    assert path.read_bytes() == CANONICAL.encode()
    assert capsys.readouterr().out == f"{path}\n"


def test_a_file_that_has_the_layout_is_not_touched(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["format", str(path)])
    capsys.readouterr()
    before = path.stat()
    assert main(["format", str(path)]) == 0
    assert (path.stat().st_ino, path.stat().st_mtime_ns) == (before.st_ino, before.st_mtime_ns)
    assert capsys.readouterr() == ("", "")


def test_check_names_what_would_change_and_fails(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = path.with_name("other.txt")
    other.write_text("never robot.velocity > 3\n")
    assert main(["format", "--check", str(path), str(other)]) == 1
    assert capsys.readouterr().out == f"{path}\n"
    assert path.read_bytes() == LOOSE.encode()


@pytest.mark.skipif(shutil.which("patch") is None, reason="there is no `patch`")
@pytest.mark.parametrize("text", [LOOSE, LOOSE.rstrip("\r\n"), "# c\n" * 9 + "a=1\nb=2 never b>a"])
def test_patch_makes_of_a_file_what_diff_shows(path: Path, text: str, capsys: pytest.CaptureFixture[str]) -> None:
    path.write_bytes(text.encode())
    assert main(["format", "--diff", str(path)]) == 1
    shown = capsys.readouterr().out
    patched = path.with_name("patched.txt")
    subprocess.run(["patch", "--binary", "-s", "-o", patched, path], input=shown.encode(), check=True)
    main(["format", str(path)])
    assert patched.read_bytes() == path.read_bytes()


def test_what_cannot_be_parsed_is_kept_and_the_others_are_laid_out(
    path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    broken = path.with_name("broken.txt")
    broken.write_text(BROKEN)
    assert main(["format", str(broken), str(path.with_name("none.txt")), str(path)]) == 2
    assert broken.read_text() == BROKEN
    assert path.read_bytes() == CANONICAL.encode()
    assert "LTL004" in capsys.readouterr().err


def test_a_file_that_is_not_there_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["format", str(tmp_path / "none.txt")]) == 2
    assert "LTL901" in capsys.readouterr().err


def test_standard_input_is_laid_out_to_standard_output(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(LOOSE.encode())))
    assert main(["format", "-"]) == 0
    assert capsys.readouterr().out == CANONICAL


def test_standard_input_can_be_checked(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(LOOSE.encode())))
    assert main(["format", "-", "--check"]) == 1
    assert capsys.readouterr().out == "<stdin>\n"


def test_permissions_a_byte_order_mark_and_a_link_stay(path: Path) -> None:
    path.write_bytes(b"\xef\xbb\xbf" + LOOSE.encode())
    path.chmod(0o640)
    link = path.with_name("link.txt")
    link.symlink_to(path)
    assert main(["format", str(link)]) == 0
    assert link.is_symlink()
    assert path.read_bytes() == b"\xef\xbb\xbf" + CANONICAL.encode()
    assert path.stat().st_mode & 0o777 == 0o640


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everything")
def test_a_file_that_may_not_be_written_is_kept(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path.chmod(0o440)
    assert main(["format", str(path)]) == 2
    assert path.read_bytes() == LOOSE.encode()
    assert "cannot be written" in capsys.readouterr().err
