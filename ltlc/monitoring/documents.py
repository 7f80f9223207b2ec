"""Pages of HTML that are read and printed: nothing is loaded with them, and names stay text."""

from __future__ import annotations

from importlib.resources import files
from typing import Any

from ltlc.backends.templates import template
from ltlc.runtime.reports import printable


def document(package: str, name: str, **content: Any) -> str:
    """The page that the template `name` of `package` makes of `content`, in the style that all have."""
    style = files(__package__).joinpath("document.css").read_text(encoding="utf-8")
    return template(package, name, escape=True).render(style=style, shown=printable, **content)
