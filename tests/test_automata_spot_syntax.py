"""Spot's syntax into core LTL: against what ltlc writes in that syntax, and against Spot's own semantics."""

import pytest
from hypothesis import given, settings
from strategies import formulas, words

from ltlc.automata.spot_syntax import SpotSyntaxError, parse
from ltlc.semantics.finite import holds
from ltlc.semantics.ltl import Formula, to_text
from ltlc.semantics.words import Word


@settings(max_examples=200)
@given(formulas(), words())
def test_a_formula_that_is_written_out_and_read_again_means_the_same(formula: Formula, word: Word) -> None:
    if word:  # Spot simplifies `X[!] 1`-like constants as it reads, which keeps all but the empty word
        assert holds(parse(to_text(formula)), word) == holds(formula, word)


@pytest.mark.parametrize(
    ("text", "word", "expected"),
    [
        ("a xor b", "ab", False),
        ("a xor b", "a", True),
        ("a <-> b", "", True),
        ("X a", "a", True),
        ("X[!] a", "a", False),
        ("[]<>a", "a", True),
        ("a W b", "", False),
    ],
)
def test_an_operator_means_what_it_means_in_spot(text: str, word: str, expected: bool) -> None:
    assert holds(parse(text), (frozenset(word),)) is expected


@pytest.mark.parametrize(
    ("text", "offset"), [("a U (b", 4), ("a b", 2), ("", 0), ('"größe" U (', 11), ("{a;b}[]->c", 0), ("X" * 60_000, 0)]
)
def test_what_is_no_formula_is_refused_at_its_place(text: str, offset: int) -> None:
    with pytest.raises(SpotSyntaxError) as caught:
        parse(text)
    assert abs(caught.value.offset - offset) <= 2


def test_a_formula_nested_as_deeply_as_may_be_can_be_written_and_judged() -> None:
    formula = parse("X(" * 140 + "a" + ")" * 140)
    assert to_text(formula).count("X") == 140
    assert holds(formula, (frozenset(),) * 3)


def test_a_formula_that_is_nested_too_deeply_is_refused() -> None:
    with pytest.raises(SpotSyntaxError, match="deeply"):
        parse("X(" * 200 + "a" + ")" * 200)


@pytest.mark.parametrize("bracket", ["(", "{", "[", "X(", "{a;", "X["])
def test_brackets_that_never_close_are_refused_before_spot_looks_for_their_ends(bracket: str) -> None:
    with pytest.raises(SpotSyntaxError, match="deeply") as caught:
        parse(bracket * 15_000)
    assert caught.value.offset == 150 * len(bracket) + min(k for k, c in enumerate(bracket) if c in "([{")
