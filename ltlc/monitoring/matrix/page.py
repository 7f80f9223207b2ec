"""The matrix as one page of HTML that prints: nothing is loaded with it, and names stay text."""

from __future__ import annotations

import jinja2

from ltlc.base.provenance import provenance
from ltlc.monitoring.matrix.forms import gaps, results_text, summary
from ltlc.monitoring.matrix.matrix import Matrix
from ltlc.runtime.reports import printable


def page(matrix: Matrix) -> str:
    """Requirements with their properties, what is not covered, and what each recording has shown of each property."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("ltlc.monitoring.matrix", "."),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters |= {"shown": printable, "results": results_text}
    return environment.get_template("page.html").render(
        summary=summary(matrix),
        made_of=provenance(matrix.sources),
        requirements=matrix.requirements,
        properties=matrix.properties,
        gaps=gaps(matrix),
    )
