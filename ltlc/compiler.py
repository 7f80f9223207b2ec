"""The compiler on one page: the passes in order, and nothing else.

    text ─load→ specification ─encode→ core LTL ─translate→ monitor ─gate→ assured monitor ─emit→ file
"""

from __future__ import annotations

from dataclasses import dataclass

from ltlc.language.specification import PropertySpecification
from ltlc.semantics.encodings import Encoding
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor


@dataclass(frozen=True, slots=True)
class Compiled:
    """A property, its formula of core LTL under `encoding`, and the monitor made of that formula."""

    specification: PropertySpecification
    encoding: Encoding
    formula: Formula
    monitor: Monitor
