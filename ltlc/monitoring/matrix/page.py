"""The matrix as one page of HTML."""

from __future__ import annotations

from ltlc.base.provenance import provenance
from ltlc.monitoring.documents import document
from ltlc.monitoring.matrix.forms import gaps, results_text, summary
from ltlc.monitoring.matrix.matrix import Matrix


def page(matrix: Matrix) -> str:
    """Requirements with their properties, what is not covered, and what each recording has shown of each property."""
    return document(
        __package__,
        "page.html.jinja",
        results=results_text,
        summary=summary(matrix),
        made_of=provenance(matrix.sources),
        requirements=matrix.requirements,
        properties=matrix.properties,
        gaps=gaps(matrix),
    )
