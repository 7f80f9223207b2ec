"""Runs in time: what clocks and the past make of them is what the denotation on instants says."""

from __future__ import annotations

import pytest
from effort import share_of
from timed import Draw, holds, letters_of, monitor_of, ordinary_atoms, word_of

import ltlc
from ltlc.automata import translate, translate_by_progression
from ltlc.semantics import finite
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.denotation import satisfies
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.ltl import Formula
from ltlc.semantics.reset_machine import ResetMachine
from ltlc.semantics.words import Word


def test_the_encoding_on_clock_steps_means_what_the_property_means_on_instants() -> None:
    for seed in range(share_of(1500)):
        draw = Draw(seed)
        property_, run = draw.property(most_clocks=9), draw.run()
        formula = encode(property_, EPISODE)
        assert finite.holds(formula, tuple(letters_of(formula, run))) == holds(property_, run), (property_, run)


def test_the_last_verdict_of_a_monitor_is_what_the_run_means_unless_it_is_permanent() -> None:
    for seed in range(share_of(250)):
        draw = Draw(seed)
        property_ = draw.property()
        formula, monitor = encode(property_, EPISODE), monitor_of(property_)
        for run in (draw.run() for _ in range(5)):
            last = monitor.run(letters_of(formula, run))[-1]
            assert last.is_permanent or last.holds == holds(property_, run), (property_, run)


def test_a_letter_that_is_repeated_changes_nothing() -> None:
    """The denotation may look at each instant any number of times: properties are next-free."""
    for seed in range(share_of(500)):
        draw = Draw(seed)
        property_, run = draw.property(most_clocks=9), draw.run()
        word = word_of(property_, run)
        twice = tuple(each for each in word for _ in range(2))
        assert satisfies(twice, property_) == satisfies(word, property_), (property_, run)


def test_a_run_is_a_word_of_the_reset_machine_which_moves_by_each_letter_in_one_way() -> None:
    def among(letters: Word, predicate: Formula) -> Word | None:
        return letters if finite.holds(predicate, letters) else None

    for seed in range(share_of(500)):
        draw = Draw(seed)
        formula = encode(draw.property(most_clocks=9), EPISODE)
        machine = ResetMachine(formula)
        for word in (tuple(letters_of(formula, draw.run())) for _ in range(5)):
            clocks = machine.initial
            for k in range(len(word)):
                (move,) = machine.moves(clocks, word[k : k + 1], among)
                clocks = move.target


def test_both_constructions_give_the_same_monitor() -> None:
    for seed in range(share_of(150)):
        property_ = Draw(seed).property()
        formula = encode(property_, EPISODE)
        alphabet = Alphabet(ordinary_atoms(formula))
        assert translate(formula, alphabet) == translate_by_progression(formula, alphabet), property_


IN_UNTIL = "after_until a, d, until b, always (c implies eventually q within 1 s)"
IN_EPISODES = "after_until a, d, always (c implies eventually q within 1 s)"


@pytest.mark.parametrize(
    ("property_", "rows", "violated"),
    [
        (IN_UNTIL, [(0, "a"), (1, "c"), (1.5, ""), (5, "")], 2_000_000_001),
        (IN_UNTIL, [(0, "a"), (1, "b"), (2, "c"), (5, "")], None),
        (IN_UNTIL, [(0, "a"), (1, "b"), (2, "d"), (3, "a"), (4, "c"), (9, "")], 5_000_000_001),
        (IN_EPISODES, [(0, "a"), (1, "c"), (1.5, ""), (5, "")], 2_000_000_001),
        (IN_EPISODES, [(0, "a"), (1, "cq"), (2, "d"), (3, "a"), (3.5, "c"), (5, "")], 4_500_000_001),
    ],
)
def test_a_scope_in_a_scope_opens_anew_with_it_and_its_clocks_run_on_in_it(
    property_: str, rows: list[tuple[float, str]], violated: int | None
) -> None:
    declared = "".join(f"decl {name} /{name} Bool.data\n" for name in "abcdq")
    given = [{"time": time, **{name: name in held for name in "abcdq"}} for time, held in rows]
    found = ltlc.run(f"{declared}p: {property_}", given)["p"]
    assert (found.decided and found.decided.time) == violated
