"""What stands above each property: what its monitor can do, which is also the way to its picture."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from ltlc.base.source import Span
from ltlc.interfaces.editor.document import Document
from ltlc.specification.specification import PropertySpecification


class Lens(NamedTuple):
    """A line above the property at `span`, which leads to the automaton of the one with this label."""

    span: Span
    title: str
    label: str


def lenses(document: Document, summaries: Mapping[str, str]) -> Iterator[Lens]:
    """One for each property, as far as `summaries` has them by text; for those of one `forall`, one for the first."""
    copies: dict[Span, list[PropertySpecification]] = {}
    for property_ in document.properties:
        copies.setdefault(property_.span, []).append(property_)
    for span, (first, *others) in copies.items():
        title = summaries.get(first.text, "show the automaton")
        of_forall = f" ({first.label}, and {len(others)} more of `forall`)" if others else ""
        yield Lens(span, title + of_forall, first.label)
