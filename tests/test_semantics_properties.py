"""The language: the meaning of each keyword, and each encoding against it."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import ABC, properties, words

from ltlc.automata.engine import spot
from ltlc.semantics import denotation, finite
from ltlc.semantics.denotation import EPISODE, READINGS, episodes, satisfies
from ltlc.semantics.encodings import ENCODINGS, Encoding, encode
from ltlc.semantics.ltl import TRUE, Atom, Next, to_text
from ltlc.semantics.ltl import And as LtlAnd
from ltlc.semantics.ltl import Not as LtlNot
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
    atoms,
    predicates,
)
from ltlc.semantics.words import Word, all_letters, all_words

X, Y, P, Q = map(Atom, "xypq")
NEAR, FAR, STOPPED = Atom("near"), Atom("far"), Atom("stopped")


def word(text: str) -> Word:
    """`p.pq.-` is three steps: p, both, none; the empty text is the empty word."""
    return tuple(frozenset(step.strip("-")) for step in text.split(".")) if text else ()


MEANINGS: list[tuple[Property, dict[str, bool]]] = [
    (Now(P), {"": False, "p": True, "p.-": True, "-.p": False}),
    (Now(LtlNot(P)), {"": True, "p": False, "-": True}),
    (Throughout(P), {"": True, "p.p": True, "p.-": False}),
    (Not(Eventually(Now(P))), {"": True, "-": True, "-.p": False}),
    (And(Now(P), Now(Q)), {"pq": True, "p": False, "": False}),
    (Or(Now(P), Now(Q)), {"p": True, "q": True, "-": False}),
    (Implies(Now(P), Now(Q)), {"": True, "-": True, "p": False, "pq": True, "q": True}),
    (Always(Now(P)), {"": True, "p": True, "p.p": True, "p.-": False, "-.p": False}),
    (Never(Now(P)), {"": True, "-": True, "-.p": False}),
    (Eventually(Now(P)), {"": False, "-.p": True, "p.-": True, "-": False}),
    (Always(Eventually(Now(P))), {"": True, "-.p": True, "p.-": False}),
    (Eventually(Always(Now(P))), {"": False, "p.-": False, "-.p": True}),
    (Never(And(Now(P), Now(Q))), {"p.q": True, "pq": False}),
    # after: nothing is owed without the event, and the first event counts, its step included.
    (After(X, Throughout(P)), {"": True, "-.-": True, "x": False, "-.xp.p": True, "xp.-": False, "-.xp": True}),
    (After(X, Eventually(Now(P))), {"x": False, "p.x": False, "x.p": True, "xp": True}),
    (After(X, Now(P)), {"xp.x": True, "x.xp": False}),
    # until: the event must come; the segment before it may be empty, and the event's own step is outside.
    (Until(X, Throughout(P)), {"": False, "p": False, "x": True, "p.x": True, "-.x": False, "p.x.-": True}),
    (Until(X, Eventually(Now(P))), {"x": False, "xp": False, "p.x": True, "-.x.p": False}),
    (Until(X, Until(Y, Throughout(P))), {"y.x": True, "x": False, "p.x": False, "p.y.x": True, "p.x.y": False}),
    # after_until: no closing event is needed, the closing step is outside, an episode is judged once.
    (AfterUntil(X, Y, Throughout(P)), {"": True, "-": True, "xp.p": True, "xp.-": False, "xp.y.-": True}),
    (AfterUntil(X, Y, Eventually(Now(P))), {"x": False, "xp": True, "x.y.p": False, "x.p.y": True}),
    (AfterUntil(X, Y, Eventually(Now(P))), {"x.p.y.x": False, "x.p.y.x.p": True, "x.yp": False}),
    # An opening step that also closes opens nothing; a closing step does not open.
    (AfterUntil(X, Y, Throughout(P)), {"xy": True, "xy.x": False, "xp.xy.-": True, "xp.xy.x": False}),
    # The opening event inside an open episode opens nothing: stopped once, then driving on near the sign.
    (AfterUntil(X, Y, Eventually(Now(P))), {"x.xp.x.x": True, "x.xp.x.y": True, "x.xp.x.y.x": False}),
    (Always(AfterUntil(X, Y, Eventually(Now(P)))), {"x.xp.x": False, "x.xp": True}),
    (AfterUntil(X, Y, After(Q, Throughout(P))), {"x.p": True, "x.q": False, "x.qp.p.y.q": True}),
]


@pytest.mark.parametrize(
    ("property_", "text", "expected"),
    [(property_, text, expected) for property_, row in MEANINGS for text, expected in row.items()],
)
def test_keywords_mean_what_the_reference_says(property_: Property, text: str, expected: bool) -> None:
    assert satisfies(word(text), property_) is expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", []),
        ("-.y", []),
        ("x", [(0, 1)]),
        ("-.x.-.y.-", [(1, 3)]),
        ("x.x.y.x.y", [(0, 2), (3, 4)]),
        ("xy.x", [(1, 2)]),
        ("x.xy.x", [(0, 1), (2, 3)]),
    ],
)
def test_episodes_open_with_the_first_event_and_end_before_the_second(
    text: str, expected: list[tuple[int, int]]
) -> None:
    assert episodes(word(text), X, Y) == expected


STOP_SIGN = AfterUntil(NEAR, FAR, Eventually(Now(STOPPED)))
DRIVES_ON_NEAR_THE_SIGN: Word = tuple(map(frozenset, (["near"], ["near", "stopped"], ["near"], ["far"])))


@pytest.mark.parametrize(
    ("name", "accepted"), [("episode", True), ("pointwise", False), ("pointwise-strong", False), ("dwyer", False)]
)
def test_only_episode_accepts_the_robot_that_stops_and_drives_on_within_the_zone(name: str, accepted: bool) -> None:
    formula = encode(STOP_SIGN, ENCODINGS[name])
    assert finite.holds(formula, DRIVES_ON_NEAR_THE_SIGN) is accepted


@pytest.mark.parametrize(
    ("property_", "name", "text"),
    [
        (After(X, Throughout(P)), "episode", "!x W (x & G p)"),
        (After(X, Throughout(P)), "pointwise", "G(x -> G p)"),
        (Until(X, Throughout(P)), "episode", "F x & (p W x)"),
        (Until(X, Throughout(P)), "pointwise", "p U x"),
        (Until(X, And(Throughout(P), Throughout(Q))), "pointwise", "(p & q) U x"),
        (Until(X, Always(Now(P))), "pointwise", "(G p) U x"),
        (AfterUntil(X, Y, Throughout(P)), "pointwise", "G(x -> (p W y))"),
        (AfterUntil(X, Y, Throughout(P)), "pointwise-strong", "G(x -> (p U y))"),
    ],
)
def test_encodings_are_the_published_sentences(property_: Property, name: str, text: str) -> None:
    ours = spot.formula(to_text(encode(property_, ENCODINGS[name])))
    assert spot.are_equivalent(ours, spot.formula(text))


def test_every_encoding_has_a_reading_to_be_checked_against() -> None:
    assert ENCODINGS.keys() == READINGS.keys()
    assert denotation.READINGS["episode"] is EPISODE


@settings(max_examples=100)
@given(properties(depth=3), st.lists(words(max_size=8), max_size=8))
@pytest.mark.parametrize("encoding", ENCODINGS.values(), ids=lambda encoding: encoding.name)
def test_encodings_agree_with_their_readings(encoding: Encoding, property_: Property, samples: list[Word]) -> None:
    formula = encode(property_, encoding)
    for u in samples:
        assert finite.holds(formula, u) == satisfies(u, property_, READINGS[encoding.name])


SHORT_WORDS = [u for length in range(4) for u in all_words(all_letters(ABC), length)]


@settings(max_examples=25)
@given(properties(depth=3))
@pytest.mark.parametrize("encoding", ENCODINGS.values(), ids=lambda encoding: encoding.name)
def test_encodings_agree_with_their_readings_on_all_short_words(encoding: Encoding, property_: Property) -> None:
    formula, reading = encode(property_, encoding), READINGS[encoding.name]
    different = [u for u in SHORT_WORDS if finite.holds(formula, u) != satisfies(u, property_, reading)]
    assert not different


def test_a_temporal_event_is_refused() -> None:
    with pytest.raises(ValueError, match=r"not a state predicate: X\[!\] x"):
        After(Next(X), Throughout(P))


def test_predicates_and_atoms_come_in_the_order_of_the_text() -> None:
    property_ = Implies(AfterUntil(Y, X, Throughout(P)), Until(Q, And(Now(TRUE), Throughout(LtlAnd(Y, P)))))
    assert list(predicates(property_)) == [Y, X, P, Q, TRUE, LtlAnd(Y, P)]
    assert atoms(property_) == ("y", "x", "p", "q")
