"""Several specifications on a command line, folders, the standard input; and fixes that `ltlc check` carries out."""

from __future__ import annotations

import io
import json
import os
import shlex
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from sarif_schema import problems

from ltlc import cli
from ltlc.cli import main

CLEAN = "limit: never robot.velocity > 2\n"
WARNED = "still: eventually robot.velocity == 0\n"
WRONG = "band: always (robot.velocity < 1 and robot.velocity > 2)\n"
SLIPS = "limit: never robot.velocity = 2 && true\n"
MENDED = "limit: never robot.velocity == 2 and true\n"

Capture = pytest.CaptureFixture[str]


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Gives a text to the standard input."""

    def give(text: str) -> None:
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text.encode())))

    return give


def write(**texts: str) -> None:
    for name, text in texts.items():
        Path(f"{name}.ltlc").write_bytes(text.encode())


def test_each_of_several_files_is_a_specification_of_its_own(capsys: Capture) -> None:
    write(a=CLEAN, b=WARNED + CLEAN)
    assert main(["check", "a.ltlc", "b.ltlc"]) == 0
    assert capsys.readouterr().out == (
        "a.ltlc: limit: can hold, can fail\nb.ltlc: still: can hold, can fail\nb.ltlc: limit: can hold, can fail\n"
    )


def test_the_exit_code_is_the_worst_of_all_files() -> None:
    write(a=CLEAN, b=WRONG)
    assert main(["check", "b.ltlc", "a.ltlc"]) == 1
    assert main(["check", "none.ltlc", "b.ltlc", "a.ltlc"]) == 2


@pytest.mark.parametrize(
    ("texts", "line"),
    [
        ({"a": WARNED}, "1 warning in 1 file"),
        ({"a": WRONG, "b": WRONG, "c": WARNED}, "2 errors, 1 warning in 3 files"),
        ({"a": CLEAN, "b": CLEAN}, "nothing found in 2 files"),
        ({"a": SLIPS}, "1 error in 1 file; 1 fixable with --fix"),
    ],
)
def test_the_last_line_counts_what_was_found(texts: dict[str, str], line: str, capsys: Capture) -> None:
    write(**texts)
    main(["check", *(f"{name}.ltlc" for name in texts)])
    assert capsys.readouterr().err.splitlines()[-1] == line


def test_of_one_file_without_a_finding_nothing_is_counted(capsys: Capture) -> None:
    write(a=CLEAN)
    main(["check", "a.ltlc"])
    assert capsys.readouterr().err == ""


def test_of_a_folder_all_specifications_are_checked_and_nothing_else(here: Path, capsys: Capture) -> None:
    (here / "specs" / "deep").mkdir(parents=True)
    (here / "specs" / ".git").mkdir()
    for path in ("b.ltlc", "deep/a.ltlc", ".git/c.ltlc", ".d.ltlc", "readme.txt", "e.ltlc~"):
        (here / "specs" / path).write_text(f"{CLEAN if path in ('b.ltlc', 'deep/a.ltlc') else 'prose, no'}\n")
    assert main(["check", "specs", "specs/b.ltlc"]) == 0
    assert [line.partition(":")[0] for line in capsys.readouterr().out.splitlines()] == [
        "specs/b.ltlc",
        "specs/deep/a.ltlc",
    ]


def test_format_takes_folders_as_check_does(here: Path, capsys: Capture) -> None:
    (here / "specs").mkdir()
    (here / "specs" / "a.ltlc").write_text("never   robot.velocity>2\n")
    assert main(["format", "--quiet", "specs"]) == 0
    assert (here / "specs" / "a.ltlc").read_text() == "never robot.velocity > 2\n"
    assert capsys.readouterr().out == ""


def test_a_folder_without_specifications_is_unusable(here: Path, capsys: Capture) -> None:
    (here / "docs").mkdir()
    (here / "docs" / "props.txt").write_text(CLEAN)
    write(a=CLEAN)
    assert main(["check", "docs", "a.ltlc"]) == 2
    output = capsys.readouterr()
    assert "there is no file *.ltlc in docs" in output.err
    assert output.out == "limit: can hold, can fail\n"


def test_json_of_several_files_is_one_document_in_which_each_property_names_its_file(capsys: Capture) -> None:
    write(a=WARNED, b=WRONG)
    main(["check", "a.ltlc", "b.ltlc", "--format", "json"])
    output = capsys.readouterr()
    document = json.loads(output.out)
    assert [(each["file"], each["label"]) for each in document["properties"]] == [
        ("a.ltlc", "still"),
        ("b.ltlc", "band"),
    ]
    assert [each["span"]["file"] for each in document["diagnostics"]] == ["a.ltlc", "b.ltlc"]
    assert output.err == ""


def test_sarif_of_several_files_has_their_mends_as_the_standard_has_them(capsys: Capture) -> None:
    write(a=SLIPS, b=WARNED)
    main(["check", "a.ltlc", "b.ltlc", "nowhere", "--format", "sarif"])
    log = json.loads(capsys.readouterr().out)
    assert problems(log) == []
    [change] = log["runs"][0]["results"][0]["fixes"][0]["artifactChanges"]
    assert change["artifactLocation"] == {"uri": "a.ltlc"}
    [replacement] = change["replacements"]
    assert replacement["insertedContent"] == {"text": "=="}
    assert (replacement["deletedRegion"]["startColumn"], replacement["deletedRegion"]["endColumn"]) == (29, 30)


@pytest.mark.parametrize("command", ["check", "explain", "compare"])
def test_the_standard_input_is_a_specification(command: str, said: Callable[[str], None], capsys: Capture) -> None:
    said("limit: until robot.velocity > 2, robot.position.x < 1\n")
    assert main([command, "-"]) == 0
    assert "limit" in capsys.readouterr().out


def test_a_finding_in_the_standard_input_is_in_stdin(said: Callable[[str], None], capsys: Capture) -> None:
    said("never spede > 2")
    assert main(["check", "-", "--format", "concise"]) == 1
    assert capsys.readouterr().err.startswith("<stdin>:1:7: error[LTL101]")


def test_run_and_mine_and_build_take_the_standard_input(here: Path, said: Callable[[str], None]) -> None:
    (here / "drive.csv").write_text("time,robot.velocity\n0,1\n1,3\n")
    said(CLEAN)
    assert main(["run", "-", "drive.csv"]) == 1
    said(CLEAN.replace("2", "?"))
    assert main(["mine", "-", "drive.csv"]) == 0
    said(CLEAN)
    assert main(["build", "-", "--target", "json", "-o", "out.json"]) == 0
    assert (here / "out.json").exists()


def test_build_of_the_standard_input_asks_what_to_call_the_output(
    here: Path, said: Callable[[str], None], capsys: Capture
) -> None:
    said(CLEAN)
    assert main(["build", "-"]) == 2
    assert "--output" in capsys.readouterr().err
    assert list(here.iterdir()) == []


def test_fix_mends_what_has_one_certain_mend_and_says_so(here: Path, capsys: Capture) -> None:
    write(a=SLIPS)
    assert main(["check", "--fix", "a.ltlc"]) == 0
    assert (here / "a.ltlc").read_text() == MENDED
    said = capsys.readouterr().err.splitlines()
    assert said[:2] == ["ltlc: fixed a.ltlc:1:29: write `==`", "ltlc: fixed a.ltlc:1:34: write `and`"]
    assert said[-1] == "1 warning in 1 file; 2 fixed"


def test_fix_keeps_line_endings_the_byte_order_mark_permissions_and_links(here: Path) -> None:
    (here / "a.ltlc").write_bytes(b"\xef\xbb\xbf# speed\r\n" + SLIPS.replace("\n", "\r\n").encode())
    os.chmod(here / "a.ltlc", 0o640)
    (here / "link.ltlc").symlink_to("a.ltlc")
    main(["check", "--fix", "link.ltlc"])
    assert (here / "a.ltlc").read_bytes() == b"\xef\xbb\xbf# speed\r\n" + MENDED.replace("\n", "\r\n").encode()
    assert stat.S_IMODE((here / "a.ltlc").stat().st_mode) == 0o640
    assert (here / "link.ltlc").is_symlink()


def test_fix_leaves_a_file_alone_that_has_nothing_to_mend(here: Path) -> None:
    write(a=WARNED)
    before = (here / "a.ltlc").stat()
    main(["check", "--fix", "a.ltlc"])
    assert (here / "a.ltlc").stat() == before


def test_fix_does_not_carry_out_what_may_be_meant_otherwise(here: Path, capsys: Capture) -> None:
    write(a="near = robot.velocity > 1\nnever naer\n")
    assert main(["check", "--fix", "a.ltlc"]) == 1
    assert "naer" in (here / "a.ltlc").read_text()
    assert "did you mean" in capsys.readouterr().err


def test_fix_of_the_standard_input_prints_the_text_and_nothing_else(
    said: Callable[[str], None], capsys: Capture
) -> None:
    for text, better in ((SLIPS, MENDED), (CLEAN, CLEAN), ("never", "never")):
        said(text)
        main(["check", "--fix", "-"])
        assert capsys.readouterr().out == better
    assert main(["check", "--fix", "-", "--format", "json"]) == 2
    assert capsys.readouterr().out == ""


def test_diff_shows_what_fix_would_change_and_changes_nothing(here: Path, capsys: Capture) -> None:
    write(a=SLIPS.strip(), b=CLEAN)
    assert main(["check", "--diff", "a.ltlc", "b.ltlc"]) == 1
    unended = "\\ No newline at end of file\n"
    assert capsys.readouterr().out == f"--- a.ltlc\n+++ a.ltlc\n@@ -1 +1 @@\n-{SLIPS}{unended}+{MENDED}{unended}"
    assert (here / "a.ltlc").read_text() == SLIPS.strip()
    assert main(["check", "--diff", "b.ltlc"]) == 0
    assert main(["check", "--diff", "none.ltlc", "b.ltlc"]) == 2


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_cannot_be_written_is_said_and_nothing_is_left_behind(here: Path, capsys: Capture) -> None:
    write(a=SLIPS)
    here.chmod(0o500)
    assert main(["check", "--fix", "a.ltlc"]) == 2
    assert "a.ltlc cannot be written" in capsys.readouterr().err
    here.chmod(0o700)
    assert [path.name for path in here.iterdir()] == ["a.ltlc"]


def test_what_is_no_file_is_checked_and_not_mended_and_the_others_are(here: Path, capsys: Capture) -> None:
    write(b=SLIPS)
    reading, writing = os.pipe()
    os.write(writing, SLIPS.encode())
    os.close(writing)
    assert main(["check", "--fix", f"/dev/fd/{reading}", "b.ltlc"]) == 2
    os.close(reading)
    assert "cannot be written: it is not a file" in capsys.readouterr().err
    assert (here / "b.ltlc").read_text() == MENDED


@pytest.mark.parametrize("command", ["check", "format"])
def test_an_empty_name_is_not_this_folder(command: str, here: Path, capsys: Capture) -> None:
    write(a="never   robot.velocity > 2")
    with pytest.raises(SystemExit, match="2"):
        main([command, ""])
    assert "a name is empty" in capsys.readouterr().err
    assert (here / "a.ltlc").read_text() == "never   robot.velocity > 2"


def shell(command: str) -> subprocess.CompletedProcess[str]:
    """What `ltlc` does as a process of its own, in a line of a shell."""
    line = command.replace("ltlc", f"{shlex.quote(sys.executable)} -m ltlc")
    return subprocess.run(["bash", "-c", line], check=False, capture_output=True, text=True)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full")
def test_output_that_cannot_be_written_is_said_in_a_line(here: Path) -> None:
    (here / "a.props").write_text(CLEAN)
    done = shell("ltlc format - < a.props > /dev/full")
    assert (done.returncode, done.stderr) == (2, "ltlc: No space left on device\n")


def test_a_standard_input_that_is_closed_is_empty() -> None:
    done = shell("ltlc format - <&-")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_an_interrupt_while_a_command_is_read_is_said_in_a_line(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    def interrupted(command: str) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("ltlc.interfaces.commands.parser.module_of", interrupted)
    assert main(["check", "a.ltlc"]) == 130
    assert capsys.readouterr().err == "ltlc: interrupted\n"


def test_quiet_check_says_only_what_is_wrong(capsys: Capture) -> None:
    write(a=CLEAN, b=WARNED)
    assert main(["check", "-q", "a.ltlc", "a.ltlc", "b.ltlc"]) == 0
    output = capsys.readouterr()
    assert output.out == ""
    assert output.err.count("warning[LTL520]") == 1
    assert " in 2 files" not in output.err


def test_quiet_build_and_run_write_their_files_without_a_word(here: Path, capsys: Capture) -> None:
    write(a=CLEAN)
    (here / "drive.csv").write_text("time,robot.velocity\n0,1\n1,3\n")
    assert main(["build", "-q", "a.ltlc", "--target", "c", "--certificate", "a.cert"]) == 0
    assert {path.name for path in here.iterdir()} >= {"a.cert", "a.c", "a.h"}
    assert capsys.readouterr() == ("", "")
    assert main(["run", "-q", "a.ltlc", "drive.csv", "--output", "out.mcap"]) == 1
    output = capsys.readouterr()
    assert (here / "out.mcap").exists()
    assert "violated at +1 s" in output.out
    assert output.err == ""


def test_a_bug_is_reported_as_one_and_where_it_is_only_if_that_is_asked_for(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.setattr("ltlc.interfaces.commands.parser.module_of", lambda command: 1 // 0)
    for asked in (False, True):
        if asked:
            monkeypatch.setenv("LTLC_TRACEBACK", "1")
        assert main(["check", "a.ltlc"]) == 2
        err = capsys.readouterr().err
        assert err.startswith("ltlc: this is a bug in ltlc ")
        assert ("Traceback" in err) == asked


@pytest.mark.parametrize("raised", [MemoryError, RecursionError, BrokenPipeError, OSError, KeyboardInterrupt])
def test_no_way_to_end_looks_like_a_violation(monkeypatch: pytest.MonkeyPatch, raised: type[BaseException]) -> None:
    def end(command: str) -> None:
        raise raised

    monkeypatch.setattr("ltlc.interfaces.commands.parser.module_of", end)
    monkeypatch.setattr(cli, "_give_up_stdout", lambda: None)
    assert main(["run", "a.ltlc", "a.csv"]) == (130 if raised is KeyboardInterrupt else 2)


def test_a_pipe_that_is_closed_is_not_a_violation(here: Path) -> None:
    (here / "a.props").write_text(CLEAN)
    done = shell("ltlc explain LTL101 | true; exit ${PIPESTATUS[0]}")
    assert (done.returncode in (0, 2), done.stderr) == (True, "")


@pytest.mark.parametrize("command", [["check"], ["explain"], ["build"], ["run", "drive.csv"], ["mine", "drive.csv"]])
def test_without_spot_a_command_says_how_to_get_it(tmp_path: Path, command: list[str]) -> None:
    value = "?" if command[0] == "mine" else "2"
    (tmp_path / "props.txt").write_text(f"decl v /v Float64.data\nnever v > {value}\n")
    (tmp_path / "drive.csv").write_text("time,v\n0,1\n")
    (tmp_path / "spot.py").write_text("raise ImportError('not here')\n")
    arguments = [command[0], "props.txt", *command[1:]]
    program = f"from ltlc.cli import main; raise SystemExit(main({arguments}))"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, check=False, capture_output=True, text=True, env=environment
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert "pip install spottl" in done.stderr
    assert "Traceback" not in done.stderr
