"""What is said about specifications: a fixture is `fixtures/check/NAME.txt` and, a line for each, `NAME.expected`."""

from __future__ import annotations

from pathlib import Path

import pytest

from ltlc.base.diagnostics import Severity
from ltlc.base.render import concise, full, json, sarif
from ltlc.frontend.language import load

FIXTURES = sorted((Path(__file__).parent / "fixtures" / "check").glob("*.txt"))


@pytest.mark.parametrize("path", FIXTURES, ids=lambda path: path.stem)
def test_what_is_said_about_a_file_is_as_expected(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(path.parent)
    _, diagnostics = load(path.name)
    assert concise.render(diagnostics) == path.with_suffix(".expected").read_text(encoding="utf-8")


@pytest.mark.parametrize("path", FIXTURES, ids=lambda path: path.stem)
def test_a_specification_comes_back_exactly_if_there_is_no_error(path: Path) -> None:
    specification, diagnostics = load(path)
    assert (specification is None) == any(d.severity is Severity.ERROR for d in diagnostics)


@pytest.mark.parametrize("path", FIXTURES, ids=lambda path: path.stem)
def test_every_form_of_output_can_show_it(path: Path) -> None:
    _, diagnostics = load(path)
    assert full.render(diagnostics).count("\n\n") >= len(diagnostics)
    assert len(json.documents(diagnostics)) == len(diagnostics)
    assert len(sarif.document(diagnostics)["runs"][0]["results"]) == len(diagnostics)
