"""`ltlc import`: files of other tools on the command line, and what goes wrong with them."""

from __future__ import annotations

import io
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from ltlc.cli import main

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Writes a file, imports it, and gives the exit code, the output and the errors."""
    monkeypatch.chdir(tmp_path)

    def call(name: str, text: str, *options: str) -> tuple[int, str, str]:
        Path(name).write_text(text, encoding="utf-8")
        code = main(["import", name, *options])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return call


def test_everything_equal_is_well(run: Run) -> None:
    code, out, err = run("a.smv", "LTLSPEC G (p -> F q)")
    assert (code, err) == (0, "")
    assert out.startswith("# Imported by `ltlc import` from a.smv (NuSMV): 1 of 1 requirements; 1 shown equal")


def test_what_is_written_can_be_checked(run: Run) -> None:
    code, out, _ = run("a.smv", "LTLSPEC G (go -> F[0,3] lamp)", "-o", "a.ltlc", "--step", "100ms")
    assert (code, out) == (0, "wrote a.ltlc\n")
    text = Path("a.ltlc").read_text(encoding="utf-8")
    assert "_rate_ = 10\n" in text
    assert "within 300 ms" in text
    assert main(["check", "-q", "a.ltlc"]) == 0


def test_a_file_is_not_overwritten(run: Run) -> None:
    code, _, err = run("a.smv", "LTLSPEC G p", "-o", "a.smv")
    assert code == 2
    assert "a.smv already exists" in err


def test_what_cannot_be_imported_is_a_finding_at_its_place(run: Run) -> None:
    code, out, err = run("a.smv", "LTLSPEC G p\nLTLSPEC G (\n")
    assert code == 1
    assert "error[LTL331]" in err
    assert "a.smv:2:9" in err
    assert "always signal_p" in out


def test_what_is_not_compared_is_undecided(run: Run) -> None:
    code, out, err = run("a.smv", "LTLSPEC G (a -> F[2,500] (b & G[0,90] c))")
    assert code == 3
    assert "warning[LTL333]" in err
    assert "# Not shown equal: the bounds are too long to be unrolled." in out


def test_where_the_readings_of_a_formula_part_is_printed_and_is_no_finding(run: Run) -> None:
    code, out, err = run("a.smv", "LTLSPEC G (go -> Y ready)")
    assert code == 0
    assert "note[LTL334]: the readings of `1` differ: over signals (`--reading signals`) it would not accept" in err
    assert "# Over signals (`--reading signals`) it would not accept `({ready}; {go}) for ever`.\n" in out
    code, out, err = run("a.smv", "LTLSPEC G (go -> Y ready)", "--reading", "signals")
    assert code == 0
    assert "at points 1 s apart (`--reading points`) it would also accept `({ready}; {go}) for ever`" in err


def test_a_property_that_differs_is_a_finding_with_a_run(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    from ltlc.importing import conversion
    from ltlc.importing.writing import Writer

    class Wrong(Writer):
        def property(self, formula: object) -> str:
            return "always b"

    monkeypatch.setattr(conversion, "Writer", Wrong)
    code, out, err = run("a.smv", "LTLSPEC G (a -> b)")
    assert code == 1
    assert "warning[LTL332]: `1` is imported, but not equal: only the original accepts `({}) for ever`" in err
    assert "# Not equal: only the formula of NuSMV accepts `({}) for ever`." in out


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("a.json", '[{"reqid": ', "error[LTL330]: a.json cannot be imported as FRET: not JSON"),
        ("a.json", "", "error[LTL330]"),
        ("a.csv", "", "error[LTL330]"),
        ("a.hpl", "", "there is nothing in it to import"),
        ("a.json", '{"requirements": 3}', "FRET exports a list of requirements"),
    ],
)
def test_a_file_of_another_form_is_unusable(run: Run, name: str, text: str, expected: str) -> None:
    code, out, err = run(name, text)
    assert (code, out) == (2, "")
    assert expected in err


def test_a_name_that_says_nothing_needs_the_form(run: Run) -> None:
    code, _, err = run("a.txt", "LTLSPEC G p")
    assert code == 2
    assert "give `--from fret|hpl|csv|c2po|smv|stl`" in err
    assert run("a.txt", "LTLSPEC G p", "--from", "smv")[0] == 0


def test_a_table_is_no_recording_here(run: Run) -> None:
    code, out, _ = run("a.csv", "id,formula\nR1,G ready\n")
    assert code == 0
    assert '[id "R1"]\nR1: always ready\n' in out


def test_standard_input_is_read(run: Run, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"LTLSPEC G ready")))
    assert main(["import", "-", "--from", "smv"]) == 0
    assert "always ready" in capsys.readouterr().out


def test_a_file_that_is_not_there_is_unusable(run: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["import", "missing.smv"]) == 2
    assert "there is no file missing.smv" in capsys.readouterr().err


def test_a_step_without_a_decimal_rate_is_refused(run: Run) -> None:
    code, _, err = run("a.smv", "LTLSPEC G p", "--step", "3ms")
    assert code == 2
    assert "`--step` must be" in err


def test_over_signals_there_is_no_next(run: Run) -> None:
    code, _, err = run("a.smv", "LTLSPEC G (p -> X q)", "--reading", "signals")
    assert code == 1
    assert "`--reading points`" in err
