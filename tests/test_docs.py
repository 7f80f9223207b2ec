"""What the documentation shows is so."""

from __future__ import annotations

import re
from pathlib import Path

from support import compiled

from ltlc.diagnostics import Severity
from ltlc.language import load_text
from ltlc.semantics.denotation import episodes
from ltlc.semantics.ltl import Atom
from ltlc.semantics.properties import AfterUntil, Eventually, Now
from ltlc.source import Source

ROOT = Path(__file__).parents[1]


def blocks(page: str) -> list[str]:
    """The fenced blocks of a page."""
    return re.findall(r"^```\w*\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)


def test_the_specifications_in_the_readme_compile() -> None:
    texts = [block for block in blocks("README.md") if re.search(r"^(never|after_until)\b", block, re.MULTILINE)]
    texts = [text for text in texts if not text.startswith("$")]
    assert len(texts) == 2
    for text in texts:
        _, diagnostics = load_text(Source("README.md", text))
        assert [d.message for d in diagnostics if d.severity is Severity.ERROR] == []


def table(page: str, first: str) -> dict[str, list[str]]:
    """The rows of the table in a page whose head begins with `first`, by their first cell."""
    lines = (ROOT / page).read_text(encoding="utf-8").splitlines()
    start = next(number for number, line in enumerate(lines) if line.startswith(f"| {first} |"))
    rows = [line.strip("|").split("|") for line in lines[start:] if line.startswith("|")]
    return {row[0].strip(): [cell.strip() for cell in row[1:]] for row in rows[:7]}


def test_the_example_of_episodes_has_the_verdicts_that_it_shows() -> None:
    rows = table("docs/language.md", "step")
    names = ("near", "stopped", "far")
    word = tuple(frozenset(n for n in names if rows[n][step] == "●") for step in range(8))
    near, stopped, far = map(Atom, names)
    shown = {"ps": "presumably_satisfied", "pv": "presumably_violated", "**violated**": "violated"}
    verdicts = compiled(AfterUntil(near, far, Eventually(Now(stopped)))).monitor.run(word)
    assert [v.value for v in verdicts] == [shown[cell] for cell in rows["verdict"]]
    inside = {step: which for which, span in zip(("first", "second"), episodes(word, near, far), strict=True)
              for step in range(*span)}  # fmt: skip
    assert [inside.get(step, "") for step in range(8)] == rows["episode"]


def test_every_page_that_a_page_links_to_is_there() -> None:
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
    for page in pages:
        for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text(encoding="utf-8")):
            assert (page.parent / target).exists(), f"{page.name} links to {target}"
