"""Durations, bounds, the past, ages and news: what the forms mean, and what is said of those that mean nothing."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from language_support import compiled, findings, marked

from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.encodings import ENCODINGS, EPISODE, encode
from ltlc.semantics.ltl import Atom, Formula
from ltlc.semantics.timed_atoms import Age, Historically, News, Once, Previously, Since, TimedAtom, timed_atoms
from ltlc.specification import timed
from ltlc.specification.expressions import IsTrue, New
from ltlc.specification.specification import PropertySpecification, topics
from ltlc.specification.text import predicate_text

SIGNALS = "".join(f"decl {name} /{name} Bool.data\n" for name in ("near", "far", "stopped", "moving"))
SIGNALS += "decl tilt /tilt Float64.data decl scan /scan LaserScan.ranges decl goal /goal PoseStamped.pose.position\n"
SECOND = 10**9
NEAR, FAR, STOPPED, MOVING = (Atom(name) for name in ("near", "far", "stopped", "moving"))


def only(text: str) -> PropertySpecification:
    (found,) = compiled(SIGNALS + text).properties
    return found


def property_of(text: str) -> p.Property:
    return only(text).property


def said_of(text: str) -> tuple[str, str, str]:
    """The code of the only finding, the text that it points at, and its help."""
    (found,) = findings(SIGNALS + text)
    return found.code, marked(found), found.help


def response(trigger: Formula, answer: p.Property) -> p.Property:
    return p.Always(p.Implies(p.Now(trigger), answer))


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("eventually near within 10 s", p.Within(10 * SECOND, p.Eventually(p.Now(NEAR)))),
        ("never near within 5 min", p.Within(300 * SECOND, p.Never(p.Now(NEAR)))),
        ("always near for 2 h", p.Within(7200 * SECOND, p.Always(p.Now(NEAR)))),
        ("within 20 ms, eventually always near", p.Within(20_000_000, p.Eventually(p.Always(p.Now(NEAR))))),
        ("limit = 2 us eventually near within limit", p.Within(2000, p.Eventually(p.Now(NEAR)))),
        ("initially near", p.Now(NEAR)),
        ("after near, initially far", p.After(NEAR, p.Now(FAR))),
        ("until near, initially far", p.Until(NEAR, p.Now(FAR))),
        ("until near, initially not far", p.Until(NEAR, p.And(p.SOME_STEP, p.Now(ltl.Not(FAR))))),
        ("until near, after far, initially not far", p.Until(NEAR, p.After(FAR, p.Now(ltl.Not(FAR))))),
        ("until near, always initially not far", p.Until(NEAR, p.Always(p.Now(ltl.Not(FAR))))),
        (
            "always (near implies eventually stopped within 100 ms)",
            response(NEAR, p.Within(SECOND // 10, p.Eventually(p.Now(STOPPED)))),
        ),
        (
            "after near, (never far within 1 s) and (eventually far within 1.5 s)",
            p.After(
                NEAR,
                p.And(p.Within(SECOND, p.Never(p.Now(FAR))), p.Within(3 * SECOND // 2, p.Eventually(p.Now(FAR)))),
            ),
        ),
        ("always previously near", p.Always(p.Now(Previously("previously near", NEAR)))),
        ("always once near within 2 s", p.Always(p.Now(Once("once near within 2 s", NEAR, 2 * SECOND)))),
        ("never historically near", p.Never(p.Now(Historically("historically near", NEAR)))),
        ("always (near since far)", p.Always(p.Now(Since("near since far", NEAR, FAR)))),
        (
            "after historically near for 3 s, far",
            p.After(Historically("historically near for 3 s", NEAR, 3 * SECOND), p.Throughout(FAR)),
        ),
        ("always new scan", p.Always(p.Now(News("new scan")))),
        (
            "always age(scan) <= 0.2 s",
            p.Always(p.Now(Age("age(scan) <= 200 ms", News("message on scan"), 200_000_000))),
        ),
    ],
)
def test_a_form_means_what_the_language_says(text: str, meaning: p.Property) -> None:
    assert property_of(text) == meaning


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("eventually historically near for 3 s", "eventually (historically near for 3 s)"),
        ("eventually once near within 3 s", "eventually (once near within 3 s)"),
        ("eventually once near within 3 s within 5 s", "eventually (once near within 3 s) within 5 s"),
        ("eventually near within 5 s and far", "(eventually near within 5 s) and far"),
        ("always near for 5 s or eventually far", "(always near for 5 s) or (eventually far)"),
        ("eventually near and far within 5 s", "eventually (near and far) within 5 s"),
        ("not eventually near within 5 s", "not (eventually near within 5 s)"),
        ("always (not near since far and moving)", "always (((not near) since far) and moving)"),
        ("always (once near since not far)", "always ((once near) since (not far))"),
        ("always (near since far or moving)", "always ((near since far) or moving)"),
        ("always once near and far", "always ((once near) and far)"),
        ("always not once near within 1 s", "always not (once near within 1 s)"),
        ("eventually (once near and far) within 5 s", "eventually ((once near) and far) within 5 s"),
        ("eventually (once near) and far within 5 s", "eventually ((once near) and far) within 5 s"),
        ("eventually historically near and far within 5 s", "eventually ((historically near) and far) within 5 s"),
        (
            "eventually far and once near within 1 s within 5 s",
            "eventually (far and (once near within 1 s)) within 5 s",
        ),
        ("initially near implies far", "initially (near implies far)"),
        ("eventually near within 500ms", "eventually near within 0.5 s"),
        ("always 200 ms >= age(scan)", "always age(scan) <= 200 ms"),
        ("always age(scan) > 2 s", "always not age(scan) <= 2 s"),
        ("always age(scan) >= 2 s", "always not age(scan) < 2 s"),
        (
            "once_near = once near within 2 s always (far implies once_near)",
            "always (far implies once near within 2 s)",
        ),
    ],
)
def test_bounds_and_the_past_bind_as_the_language_says(text: str, same: str) -> None:
    assert property_of(text) == property_of(same)


def test_strictly_younger_is_a_nanosecond_less() -> None:
    (age,) = p.predicates(property_of("always age(scan) < 200 ms"))
    assert age == Age("age(scan) < 200 ms", News("message on scan"), 200_000_000 - 1)


def test_what_decides_a_property_is_what_it_reads() -> None:
    found = only("always (tilt > 0.3 implies once (near since new scan) within 2 s) and age(goal) <= 1 s")
    assert [atom.name for atom in found.atoms] == ["tilt > 0.3", "near", "new scan", "message on goal"]
    assert found.alphabet.atoms == ("tilt > 0.3", "near")
    assert topics(found) == ("/tilt", "/near", "/scan", "/goal")


def test_a_message_is_news_of_all_that_is_read_from_its_topic() -> None:
    found = only("always ((new goal.y or age(goal.x) <= 1 s) implies new scan) and age(goal.y) <= 1 s")
    assert [atom.name for atom in found.atoms] == ["new goal", "message on goal", "new scan"]
    assert len({clock for clock in timed_atoms(encode(found.property, EPISODE)) if isinstance(clock, Age)}) == 1


@pytest.mark.parametrize("text", ["new sign", "new sign.position", "new goal.y", "new scan[3]", "new robot.pose"])
def test_news_is_of_anything_that_comes_from_one_topic(text: str) -> None:
    defined = "object sign /sign Pose model robot: pose /pose PoseStamped.pose.position ;\n"
    (atom,) = only(defined + f"always {text}").atoms
    assert isinstance(atom.condition, IsTrue)
    assert isinstance(atom.condition.operand, New)


def test_a_margin_is_in_favour_of_the_property_in_the_past_too() -> None:
    assert [atom.name for atom in only("always once tilt >{0.1} 2").atoms] == ["tilt > 1.9"]
    assert [atom.name for atom in only("never historically tilt >{0.1} 2 for 1 s").atoms] == ["tilt > 2.1"]


@pytest.mark.parametrize(
    "text",
    [
        "new = tilt > 3\nalways new and near",
        "decl new new Bool.data\nalways new",
        "decl initially odom Bool.data\nalways initially\nlabel: always near",
        "initially = tilt > 3\nalways (initially implies near)",
        "initially: always near",
        "ms = tilt > 3\nx = 3\nms: always (ms and tilt > x)",
        "x = 3\ns = near\nalways s and tilt > x",
        "x = 3\nmin: always (near and tilt > x)",
        "h = 2 h\neventually near within h",
        "age = 5\nalways tilt > age",
    ],
)
def test_words_of_time_stay_names_where_nothing_else_is_meant(text: str) -> None:
    compiled(SIGNALS + text)


def test_a_number_before_a_line_that_begins_with_a_function_is_no_duration() -> None:
    first, second = compiled(SIGNALS + "always tilt > 3\nmin(scan) > 0.3").properties
    assert [first.text, second.text] == ["always tilt > 3", "min(scan) > 0.3"]


@pytest.mark.parametrize(
    "first", ["always @{near, -1}", "always max(tilt, 1) > 2", "after once near, far", "x: (near)"]
)
def test_within_and_a_comma_begin_a_property_after_a_whole_one(first: str) -> None:
    found = compiled(f"{SIGNALS}{first}\nwithin 5 s, eventually far").properties
    assert [each.line for each in found] == [6, 7]


def test_a_bound_on_a_line_of_its_own_belongs_to_the_property_before_unless_it_begins_one() -> None:
    (one,) = compiled(SIGNALS + "eventually near\nwithin 5 s").properties
    assert one.property == property_of("eventually near within 5 s")
    two = compiled(SIGNALS + "eventually near\nwithin 5 s, eventually far\nafter once near within 5 s, far").properties
    assert [each.line for each in two] == [6, 7, 8]


FORMULAS = st.recursive(
    st.sampled_from(
        [NEAR, Atom("tilt > 0.3"), News("new scan"), Age("age(scan) <= 1 s", News("message on scan"), SECOND)]
    ),
    lambda inner: st.one_of(
        st.builds(ltl.Not, inner),
        st.builds(ltl.And, inner, inner),
        st.builds(ltl.Or, inner, inner),
        st.builds(timed.previously, inner),
        st.builds(timed.once, inner, st.sampled_from([None, SECOND, 1_500_000])),
        st.builds(timed.historically, inner, st.sampled_from([None, 2 * SECOND])),
        st.builds(timed.since, inner, inner, st.sampled_from([None, 3, 90 * SECOND])),
    ),
    max_leaves=8,
)


@given(FORMULAS)
def test_the_text_of_a_state_predicate_means_it(predicate: Formula) -> None:
    assert _leaning(property_of(f"always ({predicate_text(predicate)})")) == _leaning(p.Always(p.Now(predicate)))


def _leaning(node: Any) -> Any:
    """`node` as data, chains of a connective as lists, since `p and (q and r)` is written as `p and q and r`."""
    if isinstance(node, ltl.And | ltl.Or):
        return type(node), [each for part in (node.left, node.right) for each in _joined(part, type(node))]
    if isinstance(node, Formula | p.Property):
        skipped = ("name",) if isinstance(node, TimedAtom) else ()
        return type(node), [_leaning(getattr(node, f.name)) for f in fields(node) if f.name not in skipped]
    return node


def _joined(node: Formula, connective: type) -> list[Any]:
    if not isinstance(node, connective):
        return [_leaning(node)]
    return [each for part in ltl.children(node) for each in _joined(part, connective)]


@given(FORMULAS, FORMULAS)
def test_equal_names_are_equal_definitions(one: Formula, other: Formula) -> None:
    names: dict[str, Formula] = {}
    for atom in (part for formula in (one, other) for part in ltl.subformulas(timed.once(formula, None))):
        if isinstance(atom, TimedAtom):
            assert _leaning(names.setdefault(atom.name, atom)) == _leaning(atom)


@pytest.mark.parametrize(
    ("text", "code", "place", "help"),
    [
        ("near for 3 s", "LTL016", "for 3 s", "write `always near for 3 s` or `historically near for 3 s`"),
        (
            "after near within 3 s, far",
            "LTL016",
            "within 3 s",
            "write `eventually near within 3 s` or `once near within 3 s`",
        ),
        (
            "always (near implies far within 3 s)",
            "LTL016",
            "within 3 s",
            "write `near implies eventually far within 3 s` or `near implies once far within 3 s`",
        ),
        ("eventually[0,5] near", "LTL021", "eventually[0,5] near", "write `eventually near within 5 s`"),
        ("eventually[<=5] near", "LTL021", "eventually[<=5] near", "write `eventually near within 5 s`"),
        ("eventually<=5 near", "LTL021", "eventually<=5 near", "write `eventually near within 5 s`"),
        ("F<=5 near", "LTL021", "F<=5 near", "write `eventually near within 5 s`"),
        ("F[0,5] near", "LTL021", "F[0,5] near", "write `eventually near within 5 s`"),
        ("within 5, eventually near", "LTL216", "5", "write `5 s`, `5 ms` or another"),
        ("eventually near within 5", "LTL216", "5", "write `5 s`, `5 ms` or another"),
        ("eventually near within tilt", "LTL216", "tilt", "a duration is a number with one of the units"),
        ("eventually near within 5 seconds", "LTL004", "5 seconds", "write `5 s`"),
        ("eventually near within 0 ms", "LTL217", "0 ms", "omit the bound"),
        ("eventually near within 0.5 ns", "LTL217", "0.5 ns", "whole nanoseconds"),
        ("eventually near within 1e-99999 s", "LTL217", "1e-99999 s", ""),
        ("eventually near within 1e99999 s", "LTL217", "1e99999 s", ""),
        ("eventually near within 900000 h", "LTL217", "900000 h", ""),
        ("eventually near for 3 s", "LTL308", "for 3 s", "or `eventually historically near for 3 s`"),
        ("always near within 3 s", "LTL308", "within 3 s", "or `always eventually near within 3 s`"),
        ("never near for 3 s", "LTL308", "for 3 s", "or `never historically near for 3 s`"),
        ("always (once near for 3 s)", "LTL308", "for 3 s", "or `historically near for 3 s`"),
        ("always historically near within 3 s", "LTL308", "within 3 s", "or `once near within 3 s`"),
        ("always (near since far for 3 s)", "LTL308", "for 3 s", "write `near since far within 3 s`"),
        ("after near, far within 3 s", "LTL308", "within 3 s", "write `eventually far within 3 s`"),
        (
            "always near implies far within 3 s",
            "LTL308",
            "within 3 s",
            "write `always (near implies eventually far within 3 s)`",
        ),
        ("after 5 s, always near", "LTL206", "5 s", "`historically true for 5 s` holds from then on"),
        ("within 3 s, near", "LTL309", "near", "write `within 3 s, eventually near` or `within 3 s, always near`"),
        (
            "eventually once near and far within 5 s",
            "LTL309",
            "within 5 s",
            "or replace `once near` by `(once near within 5 s)`",
        ),
        ("never (near or far) and near since far or near within 5 s", "LTL309", "within 5 s", ""),
        ("eventually not once near and far within 5 s", "LTL309", "within 5 s", ""),
        ("always age(scan) <= 5", "LTL218", "age(scan) <= 5", "write the unit: `5 s`"),
        ("always age(scan) == 5 s", "LTL218", "age(scan) == 5 s", "write `age(scan) <= 5 s`"),
        ("always age(scan) < 0 s", "LTL217", "age(scan) < 0 s", "write `new scan`"),
        ("always new (tilt + 1)", "LTL219", "(tilt + 1)", "name a declared signal"),
        ("always new @{tilt, -1}", "LTL219", "@{tilt, -1}", "name a declared signal"),
        ("always age(a.distance.b) < 1 s", "LTL219", "a.distance.b", "name a declared signal"),
        ("object a at (1, 2, 3) always new a", "LTL219", "a", "name a declared signal"),
        ("always once eventually near", "LTL301", "eventually near", "look ahead"),
        ("initially eventually near", "LTL301", "eventually near", ""),
        ("always (near since far since moving)", "LTL013", "since", "put one of them in parentheses"),
        ("always (within 5 s eventually near)", "LTL002", "eventually", "the form is `within DURATION, PROPERTY`"),
    ],
)
def test_a_misreading_is_answered_with_what_may_be_meant(text: str, code: str, place: str, help: str) -> None:
    found_code, found_place, found_help = said_of(text)
    assert (found_code, found_place) == (code, place)
    assert help in found_help


@pytest.mark.parametrize(
    ("text", "place", "instead"),
    [
        ("eventually always near for 3 s", "always near for 3 s", "eventually historically near for 3 s"),
        ("never always near for 3 s", "always near for 3 s", "never historically near for 3 s"),
        (
            "eventually (never (near or far) within 3 s)",
            "(never (near or far) within 3 s)",
            "eventually historically (not (near or far)) for 3 s",
        ),
        (
            "always (near implies within 2 s, eventually always far)",
            "within 2 s, eventually always far",
            "after_until near, not near, within 2 s, eventually always far",
        ),
        (
            "always (near and tilt > 1 implies after far, eventually stopped within 1 s)",
            "eventually stopped within 1 s",
            "after_until near and tilt > 1, not (near and tilt > 1), after far, eventually stopped within 1 s",
        ),
    ],
)
def test_many_clocks_are_refused_with_another_way_to_write_it(text: str, place: str, instead: str) -> None:
    code, found, help = said_of(text)
    assert (code, found) == ("LTL310", place)
    assert f"`{instead}`" in help
    compiled(SIGNALS + instead)


@pytest.mark.parametrize(
    ("trigger", "lasts"),
    [
        ("near and new near", False),
        ("near and not previously near", False),
        ("not near and previously near and tilt > 1", False),
        ("new near or far", True),
        ("not new near", True),
        ("once new near within 1 s", True),
        ("near and not previously far", True),
    ],
)
def test_no_scope_is_offered_that_ends_after_an_instant(trigger: str, lasts: bool) -> None:
    code, _, help = said_of(f"always ({trigger} implies within 2 s, eventually always far)")
    assert code == "LTL310"
    assert (f"`after_until {trigger}, END, within 2 s, eventually always far`" in help) != lasts
    assert (f"to judge each stretch of `{trigger}` once" in help) == lasts
    if lasts:
        compiled(SIGNALS + help.split("`")[-2])


@pytest.mark.parametrize(
    ("encoding", "text", "accepted"),
    [
        ("pointwise", "after near, eventually far within 5 s", False),
        ("pointwise-strong", "until near, eventually far within 5 s", False),
        ("dwyer", "after_until near, far, eventually stopped within 5 s", False),
        ("dwyer", "after near, eventually far within 5 s", True),
        ("pointwise", "always (near implies eventually far within 5 s)", True),
        ("pointwise", "after once near within 5 s, far", True),
    ],
)
def test_a_bound_needs_a_clock_under_the_encoding_that_is_asked_for(encoding: str, text: str, accepted: bool) -> None:
    specification, found = load_text(Source("props.txt", SIGNALS + text), (), ENCODINGS[encoding])
    assert (specification is not None) == accepted
    assert [d.code for d in found if d.code != "LTL104"] == ([] if accepted else ["LTL326"])
