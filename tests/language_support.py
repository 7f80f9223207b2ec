"""What the tests of the language share: compiling a text, and looking at what came out."""

from __future__ import annotations

from ltlc.base.diagnostics import Diagnostic
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import Comparison
from ltlc.specification.specification import PropertySpecification, Specification

SIGNALS = "decl v /v Float64.data decl w /w Float64.data decl flag /flag Bool.data decl mode /mode String.data\n"
"""Two numbers, a boolean and a string."""


def compiled(text: str) -> Specification:
    """The specification that `text` states; it must have no errors."""
    specification, diagnostics = load_text(Source("props.txt", text))
    assert specification is not None, [(d.code, d.message) for d in diagnostics]
    return specification


def only_property(text: str) -> PropertySpecification:
    """The one property that `text` states, with the signals of `SIGNALS` declared."""
    (found,) = compiled(SIGNALS + text).properties
    return found


def only_atom(text: str) -> Atom:
    """The one atom of the one property."""
    (found,) = only_property(text).atoms
    return found


def only_comparison(text: str) -> Comparison:
    """The one comparison of numbers."""
    condition = only_atom(text).condition
    assert isinstance(condition, Comparison)
    return condition


def findings(text: str) -> list[Diagnostic]:
    """All that is said about `text`, without what is said about unused names."""
    _, diagnostics = load_text(Source("props.txt", text))
    return [d for d in diagnostics if d.code != "LTL104"]


def codes_of(text: str) -> list[str]:
    """The codes of `findings`."""
    return [d.code for d in findings(text)]


def marked(diagnostic: Diagnostic) -> str:
    """The text that a diagnostic points at."""
    assert diagnostic.primary is not None
    span = diagnostic.primary.span
    return diagnostic.source.text[span.start : span.end]
