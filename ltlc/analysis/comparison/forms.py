"""Shows a comparison: as text for a terminal, as Markdown, or as HTML."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from html import escape
from unicodedata import combining, east_asian_width

from ltlc.analysis.comparison.tables import Block, Heading, Paragraph, Table

WIDEST = 60
"""In text, cells wider than this are not padded to a common width."""


def as_text(blocks: Iterable[Block]) -> str:
    """`blocks` for a terminal, without colours."""
    return "\n".join("\n".join(_text_lines(block)) for block in blocks).strip() + "\n"


def _text_lines(block: Block) -> Iterator[str]:
    match block:
        case Heading(level, text):
            yield from ("", text, "=-"[level > 1] * _width(text), "")
        case Paragraph(text):
            yield text
            if not text.endswith(":"):
                yield ""
        case Table(head, rows):
            widths = [max(_width(row[k]) for row in (head, *rows)) for k in range(len(head))]
            for row in (head, *rows):
                cells = (_padded(cell, min(width, WIDEST)) for cell, width in zip(row, widths, strict=True))
                yield "  " + "  ".join(cells).rstrip()
            yield ""


def _padded(text: str, width: int) -> str:
    return text + " " * max(0, width - _width(text))


def _width(text: str) -> int:
    """The columns that `text` takes on a terminal."""
    return sum(0 if combining(c) else 2 if east_asian_width(c) in "WF" else 1 for c in text)


def as_markdown(blocks: Iterable[Block], level: int = 1) -> str:
    """`blocks` in GitHub's Markdown; the outermost headings are of `level`."""
    return "\n".join("\n".join(_markdown_lines(block, level - 1)) for block in blocks).strip() + "\n"


def _markdown_lines(block: Block, deeper: int) -> Iterator[str]:
    match block:
        case Heading(level, text):
            yield from ("#" * (level + deeper) + " " + _escaped(text), "")
        case Paragraph(text):
            yield from (_escaped(text), "")
        case Table(head, rows):
            yield _markdown_row(head)
            yield "|" + "---|" * len(head)
            yield from map(_markdown_row, rows)
            yield ""


def _markdown_row(cells: Iterable[str]) -> str:
    return "| " + " | ".join(map(_escaped, cells)) + " |"


def _escaped(text: str) -> str:
    """`text` as Markdown that shows it as it is."""
    return "".join("\\" + c if c in "\\`*_[]<|~" else c for c in text)


def as_html(blocks: Iterable[Block]) -> str:
    """`blocks` as a page of HTML that needs nothing else."""
    return f'<!DOCTYPE html>\n<html lang="en">\n<head>\n{_HEAD}</head>\n<body>\n{as_fragment(blocks)}</body>\n</html>\n'


_HEAD = """<meta charset="utf-8">
<title>ltlc compare</title>
<style>
body { font-family: sans-serif; margin: 2em; }
table { border-collapse: collapse; margin: 0.5em 0 1em; }
th, td { border: 1px solid #bbb; padding: 0.2em 0.6em; text-align: left; vertical-align: top; }
</style>
"""


def as_fragment(blocks: Iterable[Block]) -> str:
    """`blocks` as HTML to be put into a page."""
    return "".join(map(_html, blocks))


def _html(block: Block) -> str:
    match block:
        case Heading(level, text):
            return f"<h{level + 1}>{escape(text)}</h{level + 1}>\n"
        case Paragraph(text):
            return f"<p>{escape(text)}</p>\n"
        case Table(head, rows):
            lines = [_html_row("th", head), *(_html_row("td", row) for row in rows)]
            return "<table>\n" + "".join(lines) + "</table>\n"


def _html_row(tag: str, cells: Iterable[str]) -> str:
    return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>\n"
