"""What mkdocs does beyond pages of `docs/`: it takes in pages from elsewhere, and has ltlc make the pictures.

In a page, `<!-- monitor: LABEL -->` stands for the monitor of that property of the last listing before it, and
`<!-- report -->` for the page that `ltlc run --report` makes of it and of the drive of `examples/first_drive.py`. Code
hosts show neither.
"""

from __future__ import annotations

import contextlib
import io
import os
import posixpath
import re
import runpy
import sys
import tempfile
from html import escape
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files, InclusionLevel
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from ltlc.automata import Budget  # noqa: E402
from ltlc.base import codes  # noqa: E402
from ltlc.base.source import Source  # noqa: E402
from ltlc.cli import main  # noqa: E402
from ltlc.compiler import compile_specification  # noqa: E402
from ltlc.frontend.language import load_text  # noqa: E402
from ltlc.interfaces.pages.machines import machine_picture  # noqa: E402
from ltlc.semantics.encodings import EPISODE  # noqa: E402

TAKEN_IN = {
    "README.md": "index.md",
    "CONTRIBUTING.md": "contributing.md",
    "benchmarks/README.md": "benchmarks.md",
    "tests/fixtures/robots/findings.md": "findings.md",
    **{f"ltlc/base/codes/{code}.md": f"codes/{code}.md" for code in codes.CODES},
}
"""Pages that are not in `docs/`, and where they are in the site."""

REPORT = "first_drive.html"
SUBJECTS = (
    "Syntax",
    "Names",
    "Types and messages",
    "Properties",
    "Settings",
    "What analyses find",
    "What analyses find",
    "Monitors and the gate",
    "Recordings",
    "Files",
)
"""What codes are about, by their first digit."""

LINK = re.compile(r"\[([^\[\]]*)\]\(([^()#:\s]+)(#[^()\s]*)?\)")
CODE = re.compile(r"```.*?^```|`[^`]*`|^(?:    |#)[^\n]*|\[[^\]]*\]\([^)]*\)|\b(LTL\d{3})\b", re.DOTALL | re.MULTILINE)
"""A code in running text is the group; listings, headings and links are matched as a whole, without it."""
LISTING = re.compile(r"```ltlc\n(.*?)```", re.DOTALL)
PICTURE = re.compile(r"<!-- (?:monitor: (\w+)|report) -->")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Take in the pages from elsewhere, and a list of the codes."""
    for source, place in TAKEN_IN.items():
        files.append(File.generated(config, place, abs_src_path=str(ROOT / source)))
    files.append(File.generated(config, "codes/index.md", content=_list_of_codes()))
    return files


def _list_of_codes() -> str:
    """All codes by subject, each with a link to its page."""
    lines = ["# Diagnostics", "", "`ltlc explain CODE`, or its name, shows a page of these in the terminal."]
    shown = ""
    for code, known in sorted(codes.CODES.items()):
        subject = SUBJECTS[int(code[3])]
        if subject != shown:
            lines += ["", f"## {subject}", "", "| code | name | weight | |", "|---|---|---|---|"]
            shown = subject
        weight = known.severity.value + (", with `--pedantic`" if known.pedantic else "")
        lines.append(f"| [{code}]({code}.md) | {known.name} | {weight} | {known.title} |")
    return "\n".join(lines) + "\n"


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Turn links between files into links between pages, codes into links to theirs, and comments into pictures."""
    linked = LINK.sub(lambda link: _link(link, page), markdown)
    coded = CODE.sub(lambda found: _code(found, page), linked)
    return PICTURE.sub(lambda found: _picture(found, config, files), coded)


def _link(link: re.Match[str], page: Page) -> str:
    """The link as the site has it; the text alone where the file is not in the site."""
    text, target, anchor = link.groups()
    origin = page.file.abs_src_path
    if origin is None or not Path(origin).parent.joinpath(target).exists():
        return link[0]
    wanted = os.path.relpath(posixpath.join(os.path.dirname(origin), target), ROOT)
    place = TAKEN_IN.get(wanted) or (wanted.removeprefix("docs/") if wanted.startswith("docs/") else None)
    if place is None:
        return text
    return f"[{text}]({_relative(place, page)}{anchor or ''})"


def _code(found: re.Match[str], page: Page) -> str:
    """A code with a link to its page; anything else as it is."""
    place = TAKEN_IN.get(f"ltlc/base/codes/{found[1]}.md")
    return f"[{found[1]}]({_relative(place, page)})" if place else found[0]


def _relative(place: str, page: Page) -> str:
    return posixpath.relpath(place, posixpath.dirname(page.file.src_uri) or ".")


def _picture(found: re.Match[str], config: MkDocsConfig, files: Files) -> str:
    """What stands for the comment that was `found`."""
    listing, label = LISTING.findall(found.string[: found.start()])[-1], found[1]
    return _monitor(listing, label) if label else _report(listing, config, files)


def _monitor(listing: str, label: str) -> str:
    """The monitor of the property `label` of the listing."""
    specification, _ = load_text(Source("listing", listing))
    if specification is None:
        raise ValueError(f"the listing with {label} has errors")
    compiled, _ = compile_specification(specification, EPISODE, Budget(30.0, 1024))
    subject = next(each for each in compiled if each.specification.label == label)
    picture = machine_picture(subject, None, 0, label)
    letters = ", ".join(f"{letter}: <code>{escape(condition)}</code>" for letter, condition in picture.letters)
    return f'<figure class="picture">{picture.svg}<figcaption>The monitor of {label}. {letters}</figcaption></figure>\n'


def _report(listing: str, config: MkDocsConfig, files: Files) -> str:
    """The report on the drive of the tutorial, in a frame."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        Path("watch.txt").write_text(listing, encoding="utf-8")
        runpy.run_path(str(ROOT / "examples" / "first_drive.py"))["record"](Path("drive"))
        with contextlib.redirect_stdout(io.StringIO()):
            main(["run", "watch.txt", "drive", "--report", REPORT])
        content = Path(REPORT).read_text(encoding="utf-8")
    files.append(File.generated(config, REPORT, content=content, inclusion=InclusionLevel.INCLUDED))
    return f'<iframe class="picture" src="{REPORT}" title="The report on the drive" loading="lazy"></iframe>\n'
