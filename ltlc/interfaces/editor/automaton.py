"""The automaton of one property as a page for a browser, which needs nothing from elsewhere."""

from __future__ import annotations

from dataclasses import replace

from ltlc import __version__
from ltlc.analysis.english import English
from ltlc.automata import Budget
from ltlc.backends.templates import template
from ltlc.compiler import compile_specification
from ltlc.interfaces.pages.machines import machine_picture
from ltlc.runtime.reports import printable
from ltlc.runtime.times import Scale
from ltlc.semantics.encodings import Encoding
from ltlc.specification.specification import PropertySpecification, Specification


def automaton_page(
    specification: Specification, property_: PropertySpecification, encoding: Encoding, budget: Budget
) -> str:
    """The page about `property_` of `specification`, in HTML; why there is no monitor, if there is none.

    Raises SpotMissing.
    """
    alone = replace(specification, properties=(property_,))
    compiled, problems = compile_specification(alone, encoding, budget)
    picture = machine_picture(compiled[0], None, Scale(), "monitor") if compiled else None
    return template(__package__, "automaton.html.jinja", escape=True).render(
        version=__version__,
        label=printable(property_.label),
        text=printable(property_.text),
        english=printable(English(property_).sentence()),
        picture=picture,
        problem=problems[0].message if problems else "",
    )
