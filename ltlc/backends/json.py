"""Monitors as JSON, for tools: the whole machine of each property. The schema is `ltlc-monitors-1`.

schema        "ltlc-monitors-1"; it changes when a reader of this schema could be misled
source        the name of the specification
rate, timeout of the specification, in Hz and s, or null
properties    in the order of the specification, each with
  label, line, text
  requirement the requirement that it states, if there is one: its `id`, `text` and `attributes`
  encoding    the name of the encoding of scopes
  formula     core LTL in Spot's syntax; `X[!]` is the strong next
  atoms       conditions, in the order in which decisions ask them
  alphabet    the groups of atoms that exclude one another: `atoms` and the `valuations` that exist
  states      the verdict of each state; state 0 is the initial one, its verdict that of the empty run
  edges       for each state, where a step from it leads: a state, or, if negative, decision `-1 - n`
  decisions   [atom, low, high]: which atom is asked, and where it leads if it does not hold and if it does
provenance    version and commit of ltlc, and the SHA-256 of the specification
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from ltlc.base.provenance import provenance
from ltlc.compiler import Compiled
from ltlc.runtime.times import seconds
from ltlc.semantics.alphabet import Group
from ltlc.semantics.ltl import to_text
from ltlc.specification.specification import Specification

SCHEMA = "ltlc-monitors-1"


def emit(compiled: Sequence[Compiled], specification: Specification) -> str:
    """One JSON document; equal input gives equal bytes."""
    document = {
        "schema": SCHEMA,
        "source": specification.source.name,
        "rate": specification.rate,
        "timeout": None if specification.timeout is None else seconds(specification.timeout),
        "properties": [_property(c) for c in compiled],
        "provenance": provenance([specification.source]),
    }
    return json.dumps(document, indent=2, allow_nan=False) + "\n"


def _property(compiled: Compiled) -> dict[str, Any]:
    property_, monitor = compiled.specification, compiled.monitor
    return {
        "label": property_.label,
        "line": property_.line,
        "text": property_.text,
        **({"requirement": property_.requirement.document()} if property_.requirement else {}),
        "encoding": compiled.encoding.name,
        "formula": to_text(compiled.formula),
        "atoms": list(monitor.atoms),
        "alphabet": [_group(group) for group in property_.alphabet.groups],
        "states": [verdict.value for verdict in monitor.verdicts],
        "edges": list(monitor.edges),
        "decisions": [list(decision) for decision in monitor.decisions],
    }


def _group(group: Group) -> dict[str, Any]:
    """The valuations as lists of atoms, in the order of the group."""
    return {
        "atoms": list(group.atoms),
        "valuations": [[atom for atom in group.atoms if atom in valuation] for valuation in group.valuations],
    }
