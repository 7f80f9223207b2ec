"""What the page begins with: a text, and examples of specifications with runs to choose from."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.resources import files
from typing import Any

from ltlc import __version__
from ltlc.dataclass import dataclass
from ltlc.frontend.syntax.lexer import CONTEXTUAL, FUNCTIONS, KEYWORDS, QUANTIFIERS
from ltlc.semantics.durations import UNITS
from ltlc.semantics.encodings import ENCODINGS


@dataclass(frozen=True, slots=True)
class Start:
    """The `text` of the file called `name`, both empty without one; `message_paths` as of `ltlc check`."""

    name: str = ""
    text: str = ""
    message_paths: tuple[str, ...] = ()

    def document(self) -> dict[str, Any]:
        """All of it, for the page."""
        return {
            "name": self.name,
            "text": self.text,
            "examples": list(_examples()),
            "encodings": list(ENCODINGS),
            "words": {
                "keywords": sorted(KEYWORDS),
                "contextual": sorted(CONTEXTUAL),
                "functions": [*FUNCTIONS, *QUANTIFIERS],
                "units": [*UNITS, "Hz"],
            },
            "version": __version__,
        }


def _examples() -> Iterator[dict[str, str]]:
    """Specifications, each with a run as CSV; the first line of each says what it is about."""
    folder = files("ltlc.interfaces.serve") / "examples"
    for path in sorted(each.name for each in folder.iterdir() if each.name.endswith(".txt")):
        text = (folder / path).read_text(encoding="utf-8")
        run = (folder / path.replace(".txt", ".csv")).read_text(encoding="utf-8")
        yield {"title": text.partition("\n")[0].lstrip("# ").rstrip("."), "text": text, "run": run}
