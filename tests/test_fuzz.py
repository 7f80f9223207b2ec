"""Inputs that broke something once, each run again: an answer or a diagnostic, within bounds, and no traceback."""

from __future__ import annotations

from pathlib import Path

import pytest
from effort import share_of
from fuzzing import BROKEN, TARGETS, Case, broken_by, drawn, saved


@pytest.mark.parametrize("folder", sorted(BROKEN.iterdir()), ids=lambda folder: folder.name)
def test_what_broke_something_once_does_no_more(folder: Path) -> None:
    assert broken_by(saved(folder)) is None


@pytest.mark.parametrize("target", TARGETS)
def test_no_input_breaks_anything(target: str) -> None:
    """A few at a time; `benchmarks/fuzz.py` goes on as long as it is let."""
    for case in drawn(TARGETS[target], share_of(5)):
        assert broken_by(case) is None, case


def test_a_case_is_the_same_after_it_was_saved(tmp_path: Path) -> None:
    case = Case(("run", "props.txt", "ö \udcff", ""), (("props.txt", b"\xff\0"), ("run.csv", b"")))
    case.save(tmp_path)
    assert saved(tmp_path) == case


@pytest.mark.parametrize("arguments", [("check", "props.txt", "--budget=1,64"), ("check",)])
def test_usage_and_diagnostics_are_not_what_fuzzing_looks_for(arguments: tuple[str, ...]) -> None:
    assert broken_by(Case(arguments, (("props.txt", b"never"),))) is None


def test_a_traceback_is_what_fuzzing_looks_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ltlc.interfaces.commands.check.run", lambda options: 1 // 0)
    problem = broken_by(Case(("check", "props.txt")))
    assert problem is not None
    assert problem.endswith("ZeroDivisionError: integer division or modulo by zero\n")
