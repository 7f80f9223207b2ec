"""What findings tell an author to write instead can be written: it parses, has its types, and has its clocks."""

from __future__ import annotations

import re

import pytest

from ltlc.analysis.examine import examine
from ltlc.automata import Budget
from ltlc.base.diagnostics import Severity
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.semantics.encodings import EPISODE

SIGNALS = "".join(f"decl {name} /{name} {of}\n" for name, of in {"x": "Float64.data", "goal": "Float64.data"}.items())
SIGNALS += "".join(f"decl {name} /{name} Bool.data\n" for name in "abcq")

FAULTY = [
    ("always (c implies within 2 s, eventually always q)", "LTL310"),
    ("always (c implies eventually (a and (eventually q within 1 s)))", "LTL310"),
    ("always (x >{0.5} 1 implies within 2 s, eventually always q)", "LTL310"),
    ("always (x > @{x, -1} implies within 2 s, eventually always q)", "LTL310"),
    ("always (new goal or c implies always eventually q within 2 s)", "LTL310"),
    ("eventually (always (a or b) for 3 s)", "LTL310"),
    ("never (never (a and b) within 3 s)", "LTL310"),
    ("after_until a, b, always x <= @{x, opening}", "LTL512"),
    ("after a, eventually x <= @{x, opening}", "LTL512"),
    ("after a, b and eventually q", "LTL512"),
    ("after_until a, b, after c, eventually q", "LTL512"),
    ("always (a implies always b for 3 s)", "LTL513"),
    ("always (x > 1 or a implies never b within 3 s)", "LTL513"),
    ("always (once a within 1 s implies never b within 3 s)", "LTL513"),
    ("always (a implies never a within 3 s)", "LTL508"),
    ("always (a implies x < @{x, opening})", "LTL312"),
    ("eventually a or b for 2 s", "LTL308"),
]


def errors(text: str) -> list[str]:
    return [each.message for each in load_text(Source("p", text))[1] if each.severity is Severity.ERROR]


@pytest.mark.parametrize(("property_", "code"), FAULTY)
def test_what_a_finding_says_to_write_can_be_written(property_: str, code: str) -> None:
    examined = examine(Source("p", SIGNALS + property_), [], EPISODE, Budget(30.0, 1024), pedantic=True)
    found = [each for each in examined.diagnostics if each.code == code]
    assert found
    for offered in [text for each in found for text in re.findall(r"write `([^`]*)`", each.help)]:
        if not re.search("…|END|BEGIN", offered):
            assert not errors(f"{SIGNALS}{offered}\n"), offered
