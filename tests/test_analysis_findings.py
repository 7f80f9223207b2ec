"""Files that have a finding, and twins that nearly have it: `NAME.txt` with what is found in `NAME.expected`."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import pytest

from ltlc.analysis.analyse import analyse
from ltlc.automata import Budget
from ltlc.base.codes import CODES, page
from ltlc.base.diagnostics import Diagnostic
from ltlc.frontend.language import load
from ltlc.frontend.language.suppression import suppress
from ltlc.semantics.encodings import EPISODE

FIXTURES = Path(__file__).parent / "fixtures" / "analysis"
FILES = sorted(FIXTURES.glob("*.txt"))
TWINS = [path for path in FILES if path.stem.endswith("_twin")]

FINDINGS = {known.name for code, known in CODES.items() if code.startswith(("LTL5", "LTL6", "LTL104"))}
"""The names of all findings; `not-decided` is no finding but the lack of one."""


@cache
def found_in(path: Path, pedantic: bool = True) -> list[Diagnostic]:
    """With time enough on the slowest machine: without it, what is found depends on how fast it is."""
    specification, diagnostics = load(path)
    assert specification is not None, [d.message for d in diagnostics]
    controls = re.findall(r"^# controls: (.*)$", specification.source.text, re.MULTILINE)
    report = analyse(specification, EPISODE, Budget(600.0, 1024), pedantic=pedantic, controls=controls)
    return sorted(suppress(specification, [*diagnostics, *report.diagnostics], pedantic=pedantic), key=line)


def line(diagnostic: Diagnostic) -> str:
    assert diagnostic.primary is not None
    start = diagnostic.source.position(diagnostic.primary.span.start)
    return f"{start.line}:{start.column} {diagnostic.severity.value} {diagnostic.name}"


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_each_file_has_the_findings_that_are_expected(path: Path) -> None:
    found = "".join(f"{line(diagnostic)}\n" for diagnostic in found_in(path))
    assert found == path.with_suffix(".expected").read_text(encoding="utf-8")


@pytest.mark.parametrize("twin", TWINS, ids=lambda path: path.stem)
def test_a_twin_lacks_what_its_file_has(twin: Path) -> None:
    own = twin.with_name(twin.name.replace("_twin", "")).with_suffix(".expected").read_text(encoding="utf-8")
    lacks = set(own.split()) & FINDINGS - set(twin.with_suffix(".expected").read_text(encoding="utf-8").split())
    assert lacks or "suppressed" in twin.stem


PAGES = [code for code in CODES if code.startswith(("LTL5", "LTL6")) and code != "LTL690"]


@pytest.mark.parametrize("code", PAGES)
def test_the_example_of_a_page_has_its_finding_and_the_mended_one_has_not(code: str, tmp_path: Path) -> None:
    examples = re.findall(r"```ltlc\n(.*?)```", page(code), re.DOTALL)
    found = []
    for number, text in enumerate(examples):
        path = tmp_path / f"{number}.txt"
        path.write_text(text, encoding="utf-8")
        found.append([diagnostic.code for diagnostic in found_in(path)])
    faulty, mended = found
    assert code in faulty
    assert code not in mended


def test_every_finding_has_a_file() -> None:
    named = {word for path in FILES for word in path.with_suffix(".expected").read_text(encoding="utf-8").split()}
    assert named >= FINDINGS - {"not-decided"}


def test_a_clean_file_has_notes_only() -> None:
    found = found_in(FIXTURES / "hysteresis_and_a_limit.txt")
    assert {diagnostic.severity.value for diagnostic in found} <= {"note"}
