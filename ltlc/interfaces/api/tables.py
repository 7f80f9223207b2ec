"""What results have in common: each shows itself as text, Markdown and HTML, and gives a document and rows."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator
from importlib import import_module
from typing import Any

from ltlc.analysis.comparison import forms
from ltlc.analysis.comparison.tables import Block


class Display:
    """A result. In a notebook it shows itself."""

    def blocks(self) -> Iterator[Block]:
        """The result laid out."""
        raise NotImplementedError

    def document(self) -> dict[str, Any]:
        """The result as the document that `--format json` writes."""
        raise NotImplementedError

    def rows(self) -> list[dict[str, Any]]:
        """The result as rows with the same keys."""
        raise NotImplementedError

    def __str__(self) -> str:
        return forms.as_text(self.blocks())

    def _repr_html_(self) -> str:
        return forms.as_fragment(self.blocks())

    def to_frame(self) -> Any:
        """`rows` as a data frame. Raises ImportError without pandas."""
        return import_module("pandas").DataFrame(self.rows())

    def formatted(self, form: str) -> str:
        """The result as `text`, `json`, `csv`, `md` or `html`."""
        match form:
            case "json":
                return json.dumps(self.document(), indent=2, ensure_ascii=False) + "\n"
            case "csv":
                return _as_csv(self.rows())
            case "md":
                return forms.as_markdown(self.blocks())
            case "html":
                return forms.as_html(self.blocks())
            case _:
                return str(self)


def _as_csv(rows: list[dict[str, Any]]) -> str:
    text = io.StringIO()
    if rows:
        writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    return text.getvalue()
