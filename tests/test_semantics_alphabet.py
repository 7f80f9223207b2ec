"""Which letters exist; and monitors and verdicts as data."""

from __future__ import annotations

from itertools import islice

import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import ABC, alphabets

from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.finite import holds
from ltlc.semantics.monitor import Decision, Monitor
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter, all_letters

LESS, EQUAL, MORE, FREE = "d < 1", "d == 1", "d > 1", "b"
ONE_OF_THREE = Group((LESS, EQUAL, MORE), (frozenset({LESS}), frozenset({EQUAL}), frozenset({MORE})))


def test_without_groups_every_letter_exists() -> None:
    assert set(Alphabet(ABC).letters()) == set(all_letters(ABC))


def test_letters_are_the_products_of_valuations_and_free_atoms() -> None:
    alphabet = Alphabet((LESS, FREE, EQUAL, MORE), (ONE_OF_THREE,))
    expected = {frozenset({atom}) | more for atom in ONE_OF_THREE.atoms for more in (frozenset(), frozenset({FREE}))}
    assert set(alphabet.letters()) == expected
    assert len(list(alphabet.letters())) == 6


@given(alphabets())
def test_the_three_ways_to_say_which_letters_exist_agree(alphabet: Alphabet) -> None:
    listed = list(alphabet.letters())
    assert len(set(listed)) == len(listed)
    for letter in all_letters(ABC):
        assert (letter in listed) == alphabet.allows(letter) == holds(alphabet.as_formula(), (letter,))


@given(alphabets(), st.lists(st.sampled_from(ABC), unique=True))
def test_restricting_keeps_what_remains_of_each_letter(alphabet: Alphabet, kept: list[str]) -> None:
    restricted = alphabet.restricted_to(kept)
    assert restricted.atoms == tuple(kept)
    assert set(restricted.letters()) == {letter & frozenset(kept) for letter in alphabet.letters()}


STOPPED_ONCE = Monitor(
    ("near", "stopped"),
    (Verdict.PRESUMABLY_SATISFIED, Verdict.PRESUMABLY_VIOLATED, Verdict.SATISFIED),
    (~0, ~1, 2),
    (Decision(0, 0, ~1), Decision(1, 1, 2)),
)
"""`after near, eventually stopped`, by hand."""


@pytest.mark.parametrize(
    ("letters", "verdicts"),
    [
        ([], []),
        ([{"stopped"}, {"near"}], [Verdict.PRESUMABLY_SATISFIED, Verdict.PRESUMABLY_VIOLATED]),
        ([{"near"}, set(), {"stopped"}, set()], [Verdict.PRESUMABLY_VIOLATED] * 2 + [Verdict.SATISFIED] * 2),
        ([{"near", "stopped", "something else"}], [Verdict.SATISFIED]),
    ],
)
def test_a_monitor_follows_its_decisions(letters: list[Letter], verdicts: list[Verdict]) -> None:
    assert STOPPED_ONCE.run(map(frozenset, letters)) == verdicts


@pytest.mark.parametrize(
    ("verdict", "name", "permanent", "holding"),
    [
        (Verdict.VIOLATED, "violated", True, False),
        (Verdict.PRESUMABLY_VIOLATED, "presumably_violated", False, False),
        (Verdict.PRESUMABLY_SATISFIED, "presumably_satisfied", False, True),
        (Verdict.SATISFIED, "satisfied", True, True),
        (Verdict.NOT_STARTED, "not_started", False, False),
    ],
)
def test_verdicts_have_names_and_say_what_is_permanent(
    verdict: Verdict, name: str, permanent: bool, holding: bool
) -> None:
    assert (verdict.value, verdict.is_permanent, verdict.holds) == (name, permanent, holding)


def test_letters_come_one_after_the_other_however_many_there_are() -> None:
    names = tuple(f"p{n}" for n in range(200))
    alphabet = Alphabet(names, (Group(names[:1], (frozenset(), frozenset(names[:1]))),))
    assert list(islice(alphabet.letters(), 3)) == [frozenset(), {"p0"}, {"p1"}]
    assert alphabet.count() == 2**200
