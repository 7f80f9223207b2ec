"""Writes `docs/stop_sign.svg`: the monitor of the property `stop` in the README, as ltlc draws it.

.venv/bin/python scripts/readme_picture.py
"""

from __future__ import annotations

import re
import sys
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from ltlc.automata import Budget  # noqa: E402
from ltlc.base.source import Source  # noqa: E402
from ltlc.compiler import compile_specification  # noqa: E402
from ltlc.frontend.language import load_text  # noqa: E402
from ltlc.interfaces.pages.machines import machine_picture  # noqa: E402
from ltlc.semantics.encodings import EPISODE  # noqa: E402

PICTURE = ROOT / "docs" / "stop_sign.svg"
LEGEND, LINE = 40, 16
"""The height of the picture above its legend that is cut away below, and that of a line of the legend."""


def picture() -> str:
    """The monitor of `stop`, with a legend, on white: code hosts show it in their dark themes, too."""
    listing = re.findall(r"```\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)[0]
    specification, _ = load_text(Source("README.md", listing))
    if specification is None:
        raise ValueError("the first listing of the README has errors")
    compiled, _ = compile_specification(specification, EPISODE, Budget(30.0, 1024))
    drawn = machine_picture(next(each for each in compiled if each.specification.label == "stop"), None, 0, "stop")
    size = re.search(r'width="(\d+)" height="(\d+)" viewBox="0 0 \d+ \d+"', drawn.svg)
    assert size is not None
    width, height = int(size[1]), int(size[2]) + LINE * len(drawn.letters)
    head = f'width="{width}" height="{height}" viewBox="0 0 {width} {height}"'
    legend = "".join(
        f'<text x="330" y="{int(size[2]) + LINE * number - LEGEND}">{letter}: {escape(condition)}</text>'
        for number, (letter, condition) in enumerate(drawn.letters)
    )
    svg = drawn.svg.replace(size[0], head, 1).replace("</svg>", f"{legend}</svg>")
    return re.sub(r"(<svg[^>]*>)", r'\1<rect width="100%" height="100%" fill="white"/>', svg, count=1) + "\n"


if __name__ == "__main__":
    PICTURE.write_text(picture(), encoding="utf-8")
