"""Specifications of robots, as their developers write them: nearly all that is found in them is of use."""

from __future__ import annotations

from pathlib import Path

import pytest
from effort import share_of
from test_analysis_findings import found_in

from ltlc.base.codes import CODES
from ltlc.base.diagnostics import Diagnostic

FIXTURES = Path(__file__).parent / "fixtures" / "robots"
FILES = sorted(FIXTURES.glob("*.txt"))
ROWS = [
    [cell.strip() for cell in line.strip("|\n").split("|")]
    for line in (FIXTURES / "findings.md").read_text(encoding="utf-8").splitlines()
    if line.startswith("|")
][2:]

USEFUL = 45 / 55


def place(found: Diagnostic) -> str:
    assert found.primary is not None
    start = found.source.position(found.primary.span.start)
    return f"{start.line}:{start.column} {found.code}"


WITHOUT = [path for path in FILES if path.stem not in {row[0] for row in ROWS}]
"""In which nothing is found: a share of them is enough, since most of what is said of them is the same."""


@pytest.mark.parametrize(
    "path", [path for path in FILES if path not in WITHOUT[share_of(len(WITHOUT)) :]], ids=lambda path: path.stem
)
def test_what_is_found_in_a_file_has_been_judged(path: Path) -> None:
    judged = [f"{where} {code}" for file, where, code, *_ in ROWS if file == path.stem]
    assert sorted(map(place, found_in(path, pedantic=False))) == sorted(judged)


def test_the_table_is_about_files_that_there_are() -> None:
    assert {row[0] for row in ROWS} <= {path.stem for path in FILES}


def test_nearly_all_that_is_found_is_of_use() -> None:
    judgements = [row[3] for row in ROWS]
    assert set(judgements) == {"yes", "no"}
    assert judgements.count("yes") / len(judgements) >= USEFUL


@pytest.mark.parametrize("path", FILES[::12], ids=lambda path: path.stem)
def test_what_is_told_on_demand_is_all_that_is_added(path: Path) -> None:
    usual, pedantic = found_in(path, pedantic=False), found_in(path, pedantic=True)
    assert [each for each in pedantic if not CODES[each.code].pedantic] == usual
