"""Intervals `[A, B]` in the place of a duration: where they can stand, what they mean, and what is said elsewhere."""

from __future__ import annotations

import pytest
from language_support import compiled, findings, marked

from ltlc.analysis.english import English
from ltlc.analysis.wording import written
from ltlc.base.source import Source
from ltlc.frontend.layout import layout
from ltlc.semantics import properties as p
from ltlc.semantics.ltl import Atom, Not
from ltlc.specification.specification import PropertySpecification

SIGNALS = "decl near /near Bool.data decl far /far Bool.data decl tilt /tilt Float64.data\n"
NEAR, FAR = Atom("near"), Atom("far")
SECOND = 10**9


def only(text: str) -> PropertySpecification:
    (found,) = compiled(SIGNALS + text).properties
    return found


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("eventually near within [2 s, 10 s]", p.Within(10 * SECOND, p.Eventually(p.Now(NEAR)), 2 * SECOND)),
        ("never near within [1 ns, 2 ns]", p.Within(2, p.Never(p.Now(NEAR)), 1)),
        ("always near for [1 us, 2 us]", p.Within(2000, p.Always(p.Now(NEAR)), 1000)),
        ("within [1 us, 2 us], until near, far", p.Within(2000, p.Until(NEAR, p.Throughout(FAR)), 1000)),
        ("after near, never far within [1 us, 2 us]", p.After(NEAR, p.Within(2000, p.Never(p.Now(FAR)), 1000))),
        ("eventually near within [0 s, 2 us]", p.Within(2000, p.Eventually(p.Now(NEAR)))),
        ("limit = 1 us eventually near within\n[limit, 2 us]", p.Within(2000, p.Eventually(p.Now(NEAR)), 1000)),
        ("within [1 us, 2 us], initially not near", p.Within(2000, p.And(p.SOME_STEP, p.Now(Not(NEAR))), 1000)),
    ],
)
def test_an_interval_is_a_bound_with_a_beginning(text: str, meaning: p.Property) -> None:
    assert only(text).property == meaning


def test_a_line_of_attributes_behind_an_interval_is_one() -> None:
    first, second = compiled(SIGNALS + 'never near within [1 s, 2 s]\n[id "R"]\nnever far').properties
    assert first.text == "never near within [1 s, 2 s]"
    assert second.requirement is not None


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("eventually near within [2 s, 1 s]", ("LTL217", "[2 s, 1 s]", "write `[1 s, 2 s]`")),
        ("eventually near within [1, 2 s]", ("LTL216", "1", "write `1 s`, `1 ms` or another")),
        (
            "never (once near within [1 s, 2 s])",
            ("LTL308", "within [1 s, 2 s]", "write `within 2 s`, which looks back from now on"),
        ),
        (
            "always (near implies eventually far within [1 s, 2 s])",
            ("LTL310", "eventually far within [1 s, 2 s]", "to"),
        ),
        ("eventually always near for [1 s, 2 s]", ("LTL310", "always near for [1 s, 2 s]", "judge it once per")),
    ],
)
def test_what_an_interval_cannot_be_is_refused_by_name(text: str, said: tuple[str, str, str]) -> None:
    (found,) = findings(SIGNALS + text)
    assert (found.code, marked(found), found.help[: len(said[2])]) == said


def test_the_past_takes_no_interval_and_says_why() -> None:
    (found,) = findings(SIGNALS + "always (near implies (far since near within [1 s, 2 s]))")
    assert "would have to store everything that happened in the last 2 s" in found.message


@pytest.mark.parametrize(
    "text",
    [
        "eventually near within [2 s, 10 s]",
        "always near for [2 s, 10 s]",
        "within [2 s, 10 s], until near, always far",
    ],
)
def test_an_interval_is_laid_out_and_written_as_the_author_does(text: str) -> None:
    assert layout(Source("p", text.replace(", ", " ,  ") + "\n")) == text + "\n"
    assert written(only(text).property) == text


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("eventually near within [2 s, 5 s]", "At some moment from 2 s to 5 s after the start, near is true."),
        (
            "after far, never near within [2 s, 5 s]",
            "Once far is true for the first time: there is no moment from 2 s to 5 s later at which near is true.",
        ),
        (
            "within [2 s, 5 s], until near, always far",
            "Considering only the time from 2 s to 5 s after the start: there is a moment at which near is true; "
            "before that, at every moment, far is true.",
        ),
    ],
)
def test_an_interval_is_explained(text: str, sentence: str) -> None:
    assert English(only(text)).sentence() == sentence


def test_a_scope_in_an_interval_opens_after_its_beginning() -> None:
    found = only("within [2 s, 5 s], after near, never tilt > @{tilt, opening}")
    assert [str(clock) for clock in found.openings().values()] == ['after near, after "2 s since the beginning"']
