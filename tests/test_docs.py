"""What the documentation shows is so."""

from __future__ import annotations

import doctest
import os
import re
import runpy
import shlex
import subprocess
import sys
from collections.abc import Iterator
from io import StringIO
from pathlib import Path

import pytest
from support import compiled

from ltlc.base.diagnostics import Severity
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.frontend.layout import layout
from ltlc.semantics.denotation import episodes
from ltlc.semantics.ltl import Atom
from ltlc.semantics.properties import AfterUntil, Eventually, Now

ROOT = Path(__file__).parents[1]


def blocks(page: str) -> list[str]:
    """The fenced blocks of a page."""
    return re.findall(r"^```\w*\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)


def test_the_specifications_in_the_readme_compile() -> None:
    texts = [block for block in blocks("README.md") if re.search(r"\b(never|after_until) ", block)]
    texts = [text for text in texts if not text.startswith("$")]
    assert len(texts) == 2
    for text in texts:
        _, diagnostics = load_text(Source("README.md", text))
        assert [d.message for d in diagnostics if d.severity is Severity.ERROR] == []


def test_the_picture_in_the_readme_is_the_monitor_of_its_property() -> None:
    script = runpy.run_path(str(ROOT / "scripts" / "readme_picture.py"))
    assert script["PICTURE"].read_text(encoding="utf-8") == script["picture"](), "run scripts/readme_picture.py"


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


def listings(page: str) -> Iterator[tuple[str, str]]:
    """The language and the text of each fenced block of a page, in order."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return ((found[1], found[2]) for found in re.finditer(r"^```(\w*)\n(.*?)^```", text, re.DOTALL | re.MULTILINE))


@pytest.mark.parametrize("page", ["tutorial", "sentences", "patterns", "matrix", "guard"])
def test_specifications_are_shown_in_the_layout_that_all_have(page: str) -> None:
    shown = [listing for language, listing in listings(f"docs/{page}.md") if language == "ltlc"]
    assert shown
    assert [layout(Source(page, listing)) for listing in shown] == shown


def printed(listing: str, folder: Path) -> str:
    """What a shell prints in `folder` when the commands of `listing` are typed, with the commands."""
    typed = [line.removeprefix("$ ") for line in listing.splitlines() if line.startswith("$ ")]
    script = "".join(f"status=$?; echo {shlex.quote(f'$ {each}')}; (exit $status)\n{each}\n" for each in typed)
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "NO_COLOR": "1"}
    command = ["bash", "-c", f"exec 2>&1\n{script}"]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False).stdout


def pattern(line: str) -> str:
    """What a line of a listing stands for: `…` is the rest of a line, or, alone, any lines."""
    return "(?s:.*)" if line == "…" else re.escape(line).replace("…", ".*") + "\n"


@pytest.mark.parametrize("page", ["tutorial", "matrix", "evidence", "guard", "import", "robustness", "falsify", "mine"])
def test_a_page_prints_what_it_shows(page: str, tmp_path: Path) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    for language, listing in listings(f"docs/{page}.md"):
        if language == "ltlc":
            name = listing.splitlines()[0].removeprefix("# ")
            (tmp_path / name).write_text(listing, encoding="utf-8")
            continue
        found = printed(listing, tmp_path).rstrip() + "\n"
        assert re.fullmatch("".join(map(pattern, listing.splitlines())), found), found


def test_the_examples_of_the_python_interface_are_so() -> None:
    names: dict[str, object] = {}
    examples = [block for block in blocks("docs/python.md") if block.startswith(">>>")]
    assert len(examples) >= 5
    for number, block in enumerate(examples):
        test = doctest.DocTestParser().get_doctest(block, names, f"block {number}", "docs/python.md", 0)
        told = StringIO()
        assert doctest.DocTestRunner().run(test, out=told.write, clear_globs=False).failed == 0, told.getvalue()
        names |= test.globs
