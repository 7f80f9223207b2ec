"""The examples that ship compile, and nothing is to be said about them."""

from __future__ import annotations

from pathlib import Path

import pytest

from ltlc.frontend.language import load

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.txt"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_compiles_without_a_word(path: Path) -> None:
    specification, diagnostics = load(path)
    assert diagnostics == []
    assert specification is not None
    assert all(not p.label.startswith("line ") for p in specification.properties)
