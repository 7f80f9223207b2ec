"""How properties are read: scope position, the current step, events, mixtures; and where their parts stand."""

from __future__ import annotations

import pytest
from language_support import SIGNALS, codes_of, compiled, findings, marked, only_property

from ltlc.semantics import ltl
from ltlc.semantics.properties import (
    After,
    AfterUntil,
    Always,
    And,
    Eventually,
    Implies,
    Never,
    Not,
    Now,
    Or,
    Property,
    Throughout,
    Until,
)
from ltlc.specification.specification import parts

P, Q, R = ltl.Atom("flag"), ltl.Atom("v > 1"), ltl.Atom("w > 1")
BOTH = ltl.And(Q, R)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("flag", Throughout(P)),
        ("not flag", Throughout(ltl.Not(P))),
        ("flag implies v > 1", Throughout(ltl.implies(P, Q))),
        ("always flag", Always(Now(P))),
        ("never flag", Never(Now(P))),
        ("eventually flag", Eventually(Now(P))),
        ("flag and eventually v > 1", And(Throughout(P), Eventually(Now(Q)))),
        ("after flag, v > 1", After(P, Throughout(Q))),
        ("after flag, v > 1 and w > 1", After(P, Throughout(BOTH))),
        ("after flag, v > 1 and eventually w > 1", After(P, And(Throughout(Q), Eventually(Now(R))))),
        ("until flag, v > 1", Until(P, Throughout(Q))),
        ("after_until flag, v > 1, w > 1", AfterUntil(P, Q, Throughout(R))),
        ("after_until flag, v > 1, eventually w > 1", AfterUntil(P, Q, Eventually(Now(R)))),
        ("always after flag, v > 1", Always(After(P, Throughout(Q)))),
        ("always (flag implies eventually v > 1)", Always(Implies(Now(P), Eventually(Now(Q))))),
        ("always (flag or not eventually v > 1)", Always(Or(Now(P), Not(Eventually(Now(Q)))))),
        ("(always flag) or eventually v > 1", Or(Always(Now(P)), Eventually(Now(Q)))),
        ("not always flag", Not(Always(Now(P)))),
        ("flag == (v > 1)", Throughout(ltl.Or(ltl.And(P, Q), ltl.And(ltl.Not(P), ltl.Not(Q))))),
        ("true", Throughout(ltl.TRUE)),
        ("not always 1 > 2", Not(Always(Now(ltl.FALSE)))),
    ],
)
def test_a_state_predicate_is_read_by_its_position(text: str, expected: Property) -> None:
    assert only_property(text).property == expected


@pytest.mark.parametrize("name_it", ["x = flag", "x = flag  y = x"])
def test_an_association_stands_for_its_tree(name_it: str) -> None:
    assert only_property(f"{name_it} after x, x and eventually not x").property == (
        After(P, And(Throughout(P), Eventually(Now(ltl.Not(P)))))
    )


def test_an_association_is_a_tree_not_a_text() -> None:
    assert only_property("either = flag or v > 1 always (either and w > 1)").property == (
        Always(Now(ltl.And(ltl.Or(P, Q), R)))
    )
    assert only_property("sum = v + 1 always sum * 2 > 1").atoms[0].name == "(v + 1) * 2 > 1"


def test_a_property_can_be_an_association() -> None:
    assert only_property("stops = eventually flag always stops").property == Always(Eventually(Now(P)))


MIXTURES = [
    "flag or eventually v > 1",
    "flag implies eventually v > 1",
    "not (flag and eventually v > 1)",
    "(flag and eventually v > 1) or always w > 1",
    "w > 1 and (flag or eventually v > 1)",
]


@pytest.mark.parametrize(
    "form", ["{}", "after w > 1, {}", "until w > 1, {}", "after_until w > 1, flag, {}", "always after flag, {}"]
)
@pytest.mark.parametrize("mixture", MIXTURES)
def test_a_mixture_in_scope_position_is_ambiguous(form: str, mixture: str) -> None:
    (found,) = findings(SIGNALS + form.format(mixture))
    assert (found.code, marked(found)) == ("LTL302", "flag")


@pytest.mark.parametrize("mixture", MIXTURES)
def test_both_offered_readings_of_a_mixture_are_unambiguous(mixture: str) -> None:
    (found,) = findings(SIGNALS + mixture)
    first, second = found.help.split("`")[1::2]
    assert "always flag" in first
    assert second.startswith("always (")
    for reading in (first, second):
        assert only_property(reading).property


@pytest.mark.parametrize("mixture", MIXTURES)
@pytest.mark.parametrize("keyword", ["always", "never", "eventually"])
def test_under_a_temporal_keyword_a_mixture_speaks_of_the_current_step(keyword: str, mixture: str) -> None:
    assert codes_of(f"{SIGNALS}{keyword} ({mixture})") == []


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("after eventually flag, v > 1", "eventually flag"),
        ("after flag and always v > 1, v > 1", "flag and always v > 1"),
        ("until never flag, v > 1", "never flag"),
        ("after_until flag, after flag, flag, v > 1", "after flag, flag"),
        ("stops = eventually flag after stops, v > 1", "stops"),
    ],
)
def test_an_event_is_a_state_predicate(text: str, place: str) -> None:
    (found,) = findings(SIGNALS + text)
    assert (found.code, marked(found)) == ("LTL301", place)


def check_spans(found: object, node: object, spans: object, path: tuple[int, ...] = ()) -> int:
    """Every part of a property has a place; the number of parts."""
    assert isinstance(spans, dict)
    assert path in spans
    inside = parts(node)  # type: ignore[arg-type]
    return 1 + sum(check_spans(found, part, spans, (*path, index)) for index, part in enumerate(inside))


@pytest.mark.parametrize(
    "text",
    [
        "after_until flag implies v > 1, v != 1, flag and eventually (v > 1 or not w > 1 implies flag)",
        "x = flag and v > 1 until x, (always x) and never (x == flag)",
        "flag != (v > 1) and 1 < 2 or false",
    ],
)
def test_every_part_of_a_property_has_its_place(text: str) -> None:
    found = only_property(text)
    assert check_spans(found, found.property, found.spans) == len(found.spans)


def test_a_part_is_placed_where_it_is_written_and_in_an_association_where_that_is_used() -> None:
    specification = compiled("x = a.velocity > 1 and b.velocity > 1\nafter a.velocity > 2, x")
    (found,) = specification.properties
    text = specification.source.text
    shown = {path: text[span.start : span.end] for path, span in found.spans.items()}
    assert shown == {
        (): "after a.velocity > 2, x",
        (0,): "a.velocity > 2",
        (1,): "x",
        (1, 0): "x",
        (1, 1): "x",
    }
    assert [text[a.span.start : a.span.end] for a in found.atoms] == ["a.velocity > 2", "x", "x"]


def test_atoms_come_in_the_order_of_first_use() -> None:
    found = only_property("after_until w > 1, flag, v > 1 and (flag or w > 1)")
    assert [atom.name for atom in found.atoms] == ["w > 1", "flag", "v > 1"]
    assert found.alphabet.atoms == ("w > 1", "flag", "v > 1")


def test_settings_are_taken_from_anywhere_in_the_file() -> None:
    specification = compiled("never a.velocity > 1 _timeout_ = 2.5 never b.velocity > 1 _rate_ = 30")
    assert (specification.rate, specification.timeout) == (30, 2_500_000_000)
    assert (compiled("never a.velocity > 1").rate, compiled("never a.velocity > 1").timeout) == (None, None)


@pytest.mark.parametrize("written", ["90 s", "1.5 min", "90", "9e1", "1.5 * 60"])
def test_a_timeout_is_a_duration_or_a_number_of_seconds(written: str) -> None:
    assert compiled(f"_timeout_ = {written}\nnever a.velocity > 1").timeout == 90 * 10**9
