"""What CONTRIBUTING.md lists under 'To add …': each thing that is easily forgotten is asked for here."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest

from ltlc import backends
from ltlc.frontend.syntax.lexer import PAST
from ltlc.inputs.recordings import is_recording
from ltlc.interfaces.building.targets import target_of
from ltlc.interfaces.editor.keywords import MEANINGS
from ltlc.program.functions import ROWS
from ltlc.specification.functions import WRITTEN, Function

ROOT = Path(__file__).parent.parent


@pytest.mark.parametrize("function", Function)
def test_a_function_of_the_language_is_computed_by_a_row_of_numbers_or_of_an_array(function: Function) -> None:
    rows = [primitive for primitive, row in ROWS.items() if row.of is function]
    assert len(rows) == function.takes.array + function.takes.among + (function.takes.least > 0)


@pytest.mark.parametrize("name", WRITTEN)
def test_a_function_has_its_place_in_the_reference_and_the_editor(name: str) -> None:
    assert re.search(f"`{name}[(`]", (ROOT / "docs/language.md").read_text())
    assert name in MEANINGS


@pytest.mark.parametrize("target", backends.FILE_NAMES)
def test_a_target_is_made_by_its_name_and_told_of_in_the_readme(target: str) -> None:
    assert target_of(target, None, "props").name == target
    assert target == "tests" or importlib.import_module(f"ltlc.backends.{target}").emit
    assert re.search(f"`{target}`|--target {target}`", (ROOT / "README.md").read_text()) or target == "ros2"


def test_a_page_is_in_the_navigation_of_the_site() -> None:
    shown = (ROOT / "mkdocs.yml").read_text()
    assert [page.name for page in (ROOT / "docs").glob("*.md") if page.name not in shown] == []


@pytest.mark.parametrize("keyword", sorted(PAST))
def test_an_operator_of_the_past_has_its_place_in_the_reference_and_the_editor(keyword: str) -> None:
    assert keyword in MEANINGS
    assert re.search(rf"`[^`]*\b{keyword}\b", (ROOT / "docs/language.md").read_text())
    assert keyword in (ROOT / "editors/textmate/ltlc.tmLanguage.json").read_text()


@pytest.mark.parametrize("ending", ["mcap", "db3", "bag", "csv", "csv.gz", "csv.zst", "jsonl", "parquet"])
def test_a_form_of_recordings_is_known_by_its_ending_and_told_of(ending: str) -> None:
    assert is_recording(Path(f"drive.{ending}"))
    assert f".{ending}" in (ROOT / "docs/recordings.md").read_text()
