"""What `docs/verified.md` and `docs/known-issues.md` name is there: theorems, tests, diagnostics, commits."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from ltlc.base.codes import CODES

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "verified.md").read_text(encoding="utf-8")
CARRIED = [row.split("|")[2] for row in PAGE.splitlines() if row.startswith("|") and not row.startswith("|-")]
"""The second cell of each row, heads of tables included."""


def named(kind: str) -> set[str]:
    """What is named between backquotes in a cell that says what carries a promise, and looks like this."""
    return {name for cell in CARRIED for name in re.findall(r"`([^`]*)`", cell) if re.fullmatch(kind, name)}


TESTS, FILES, CODE = r"test_\w+", r"\w+\.v", r"LTL\d+"
OTHERS = r"(ltlc|python) .*"
THEOREMS = r"(?!test_)\w+"


def test_every_theorem_that_is_named_is_proved_and_audited() -> None:
    proofs = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "proofs").glob("*.v"))
    stated = set(re.findall(r"^ *(?:Theorem|Lemma|Corollary|Example) (\w+)", proofs, re.MULTILINE))
    audited = set(re.findall(r"@(\w+)", (ROOT / "proofs" / "Audit.v").read_text(encoding="utf-8")))
    assert len(named(THEOREMS)) > 20
    assert named(THEOREMS) <= stated & audited


def test_every_test_that_is_named_is_there() -> None:
    tests = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").glob("test_*.py"))
    assert len(named(TESTS)) > 30
    assert named(TESTS) <= set(re.findall(r"^def (test_\w+)", tests, re.MULTILINE))


def test_nothing_is_named_that_these_do_not_look_for() -> None:
    for cell in CARRIED:
        for name in re.findall(r"`([^`]*)`", cell):
            assert any(re.fullmatch(kind, name) for kind in (TESTS, FILES, OTHERS, THEOREMS)), name
    assert all((ROOT / "proofs" / name).exists() for name in named(FILES))
    assert set(re.findall(CODE, PAGE)) <= set(CODES)


def test_every_row_says_what_carries_its_promise() -> None:
    assert all(cell.strip() for cell in CARRIED)


def test_every_commit_that_is_named_as_a_fix_is_one() -> None:
    if not (ROOT / ".git").exists():
        pytest.skip("this is no checkout")
    page = (ROOT / "docs" / "known-issues.md").read_text(encoding="utf-8")
    commits = re.findall(r"`([0-9a-f]{7})`", page)
    assert len(commits) > 20
    command = ["git", "rev-parse", "--is-shallow-repository"]
    if subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip() == "true":
        pytest.skip("this checkout has no history")
    for commit in commits:
        asked = ["git", "merge-base", "--is-ancestor", commit, "HEAD"]
        assert subprocess.run(asked, cwd=ROOT, capture_output=True, check=False).returncode == 0, commit
