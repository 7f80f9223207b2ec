"""What is drawn of a property: its limits with their margins, and what it compares with what."""

from __future__ import annotations

import pytest
from stepping import from_text

from ltlc.interfaces.pages.panels import Bound, Drawing, Limit, Panel, panels
from ltlc.specification.text import text

DECLARATIONS = """decl v /v Float64.data
decl w /w Float64.data
decl near /near Bool.data
decl mode /mode String.data
"""


def drawn(property_: str) -> list[Panel]:
    compiled, specification = from_text(f"{DECLARATIONS}{property_}\n")
    return panels(compiled[0].specification, specification.source)


@pytest.mark.parametrize("property_", ["never v > 2", "never 2 < v"])
def test_a_limit_is_the_constant_that_a_signal_is_compared_with(property_: str) -> None:
    (panel,) = drawn(property_)
    assert (panel.title, panel.kind) == ("v", Drawing.NUMBER)
    assert [(limit.value, limit.reach) for limit in panel.limits] == [(2.0, 0.0)]


@pytest.mark.parametrize(("property_", "value"), [("never v >{0.25} 2", 2.25), ("always v <{0.25} 2", 2.25)])
def test_the_margin_of_an_ordering_moves_its_limit(property_: str, value: float) -> None:
    (panel,) = drawn(property_)
    assert [limit.value for limit in panel.limits] == [value]


def test_the_margin_of_an_ordering_moves_the_limit_the_same_way_when_its_sides_are_exchanged() -> None:
    (panel,), (turned,) = drawn("never v >{0.25} 2"), drawn("never 2 <{0.25} v")
    assert [limit.value for limit in turned.limits] == [limit.value for limit in panel.limits]


def test_an_equality_with_a_margin_has_a_band() -> None:
    (panel,) = drawn("eventually v =={0.1} 0")
    assert panel.limits == [Limit("v =={0.1} 0", 0.0, 0.1)]


def test_a_margin_is_told_as_its_author_wrote_it() -> None:
    (panel,) = drawn("never v >{0.25} 2")
    assert panel.limits[0].text == "v > 2.25, of v >{0.25} 2"


def test_limits_of_one_expression_are_in_one_panel() -> None:
    (panel,) = drawn("after_until v > 2, v < 1, eventually v > 3")
    assert [limit.value for limit in panel.limits] == [2.0, 1.0, 3.0]


def test_two_signals_that_are_compared_are_drawn_together() -> None:
    (panel,) = drawn("never v >{0.5} w + 1")
    ((bound),) = panel.bounds
    assert isinstance(bound, Bound)
    assert (text(bound.expression), bound.shift) == ("w + 1", 0.5)


def test_what_is_computed_is_drawn_as_it_is_compared() -> None:
    assert [panel.title for panel in drawn("never v - w > 2")] == ["v - w"]


@pytest.mark.parametrize(
    ("property_", "title", "kind"),
    [
        ("always near", "near", Drawing.BOOLEAN),
        ("always near == false", "near", Drawing.BOOLEAN),
        ('eventually mode == "docked"', "mode", Drawing.STRING),
        ("always eventually new v within 2 s", "new v", Drawing.NEWS),
    ],
)
def test_what_is_no_number_is_drawn_as_what_it_is(property_: str, title: str, kind: Drawing) -> None:
    (panel,) = drawn(property_)
    assert (panel.title, panel.kind) == (title, kind)


def test_strings_that_are_waited_for_are_told() -> None:
    (panel,) = drawn('eventually (mode == "docked" or mode == "off")')
    assert panel.wanted == ["docked", "off"]


def test_of_a_value_at_an_opening_it_is_said_that_it_is_not_drawn() -> None:
    found = drawn("after near, always v < @{v, opening} + 1")
    assert [panel.title for panel in found] == ["near", "v"]
    assert "its value at the opening is not drawn" in found[1].remarks[0]


def test_an_age_is_drawn_with_its_limit_instead_of_the_messages_that_it_counts_from() -> None:
    news, aged = drawn("after new v, always age(v) < 1.5 s")
    assert (news.title, news.kind) == ("new v", Drawing.NEWS)
    assert (aged.title, aged.kind) == ("age(v)", Drawing.AGE)
    assert [(limit.text, limit.value) for limit in aged.limits] == [("age(v) < 1.5 s", 1.499999999)]
