"""What the documentation says of other people's patterns and phrases beside sentences of ours is so."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from language_support import compiled
from published import DECLARED, PLACES, relation
from stepping import session

from ltlc.automata.spot_syntax import parse
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso

PAGE = (Path(__file__).parents[1] / "docs" / "patterns.md").read_text(encoding="utf-8")
PHRASES, _, REST = PAGE.partition("\n## Missions\n")
MISSIONS = REST.partition("\n## ")[0]
MESSAGES = frozenset("pqrs")

PATTERN = r"### (.*?)\n.*?```ltlc\n(.*?)```\n\nPublished: `(.*?)`\.\s+Compared: (.*?)\.\n"
PATTERNS = re.findall(PATTERN, MISSIONS, re.DOTALL)


def rows(head: str) -> list[list[str]]:
    """The rows of the tables of the page of phrases whose head begins so, without the marks of code."""
    tables = re.findall(rf"^\| {head} \|.*?\n\|.*?\n((?:\|.*\n)+)", PHRASES, re.MULTILINE)
    lines = [line for table in tables for line in table.splitlines()]
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]


HPL, FRET = ([row for row in rows(head) if len(row) == 4] for head in ("HPL", "FRETish"))
SENTENCES = [row[-2] for head in ("HPL", "FRETish") for row in rows(head)]


@pytest.mark.parametrize(("name", "sentence", "published", "told"), PATTERNS, ids=[each[0] for each in PATTERNS])
def test_a_mission_relates_to_its_published_formula_as_the_page_says(
    name: str, sentence: str, published: str, told: str
) -> None:
    assert relation(published, sentence) == told


def test_all_missions_of_the_catalogue_are_there() -> None:
    assert len(PATTERNS) == MISSIONS.count("\n### ") == 22


def test_the_page_of_missions_shows_how_to_name_places() -> None:
    (text,) = re.findall(r"```ltlc\n(model .*?)```", MISSIONS, re.DOTALL)
    assert compiled(text).properties


def test_the_published_formula_of_ordered_patrolling_rejects_the_published_example() -> None:
    (published,) = (formula for name, _, formula, _ in PATTERNS if name == "Ordered patrolling")
    stem, loop = ([frozenset(place.split()) for place in run] for run in (["l1", "l1", "l2", "", "", "l3"], PLACES))
    around = tuple(sorted(loop, key=sorted))
    assert not holds_on_lasso(parse(published), Lasso(tuple(stem), around))
    assert holds_on_lasso(parse(published), Lasso(tuple(stem[1:]), around))


@pytest.mark.parametrize(("phrase", "formula", "sentence", "told"), HPL, ids=[row[0] for row in HPL])
def test_a_phrase_of_hpl_relates_to_ours_as_the_page_says(phrase: str, formula: str, sentence: str, told: str) -> None:
    assert relation(formula.strip("`"), sentence.strip("`"), MESSAGES) == told


@pytest.mark.parametrize(("phrase", "formula", "sentence", "told"), FRET, ids=[row[0] for row in FRET])
def test_a_phrase_of_fret_relates_to_ours_as_the_page_says(phrase: str, formula: str, sentence: str, told: str) -> None:
    assert relation(formula.strip("`"), sentence.strip("`")) == told


@pytest.mark.parametrize("sentence", SENTENCES)
def test_a_sentence_beside_a_phrase_compiles(sentence: str) -> None:
    assert compiled(DECLARED + sentence.strip("`")).properties


LATER = [row for head in ("HPL", "FRETish") for row in rows(head) if len(row) == 3]
Word = list[tuple[int, str]]
"""Messages, each a time and a topic in small letters, or in capitals if its value is true."""


def judged(holds: Callable[[int, int], bool], first: str, second: str, at_most: int, word: Word) -> bool:
    """Whether all messages that are of `first` have one of `second` at places that hold, at most so much apart."""
    return all(
        any(holds(i, j) and abs(time - other) <= at_most for j, (other, topic) in enumerate(word) if topic in second)
        for i, (time, named) in enumerate(word)
        if named in first
    )


def none_later(word: Word, at_most: int) -> bool:
    return not any(
        a in "rR" and b in "sS" and i < j and other - time <= at_most
        for i, (time, a) in enumerate(word)
        for j, (other, b) in enumerate(word)
    )


OF_HPL: dict[str, Callable[[Word], bool]] = {
    "`globally: /r causes /s within 100 ms`": lambda word: judged(operator.le, "rR", "sS", 100, word),
    "`globally: /r requires /s within 5 s`": lambda word: judged(operator.ge, "rR", "sS", 5000, word),
    "`globally: /r forbids /s within 5 s`": lambda word: none_later(word, 5000),
    "`globally: no /r {data}`": lambda word: all(topic != "R" for _, topic in word),
    "`globally: /r {data} causes /s {data} within 1 s`": lambda word: judged(operator.le, "R", "S", 1000, word),
}
"""What HPL's documentation says of messages and their times, in ms."""

GAPS = st.sampled_from([0, 1, 99, 100, 101, 900, 1000, 1001, 4899, 4999, 5000, 5001])


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(GAPS, st.sampled_from("rRsS")), min_size=1, max_size=6))
def test_phrases_of_hpl_with_time_and_values_hold_of_the_same_messages(drawn: list[tuple[int, str]]) -> None:
    word = [(sum(gap for gap, _ in drawn[: n + 1]), topic) for n, (_, topic) in enumerate(drawn)]
    for phrase, holds in OF_HPL.items():
        (sentence,) = (row[1].strip("`") for row in LATER if row[0] == phrase)
        live = session(f"{DECLARED}{sentence}\nnever new r and new s")
        for time, topic in word:
            live.samples(time * 10**6, (topic.lower(),), (topic.isupper(),))
        live.advance((word[-1][0] + 6000) * 10**6)
        assert (live.tracks[0].verdict is Verdict.VIOLATED) == (not holds(word)), phrase


def begins(p: str, at: int) -> bool:
    return p[at] == "1" and p[at - 1 : at] != "1"


OF_FRET: dict[str, Callable[[str, str], bool]] = {
    "whenever p the robot shall within 5 seconds satisfy r": lambda p, r: all(
        "1" in r[at : at + 6] for at in range(len(p) - 5) if p[at] == "1"
    ),
    "upon p the robot shall within 5 seconds satisfy r": lambda p, r: all(
        "1" in r[at : at + 6] for at in range(len(p) - 5) if begins(p, at)
    ),
    "upon p the robot shall for 5 seconds satisfy r": lambda p, r: all(
        "0" not in r[at : at + 6] for at in range(len(p)) if begins(p, at)
    ),
    "upon p the robot shall after 5 seconds satisfy r": lambda p, r: all(
        "1" not in r[at : at + 6] and r[at + 6 : at + 7] != "0" for at in [p.find("1")] if at >= 0
    ),
}
"""FRET's formulas, `p -> F[0, 5] r` and the like, on time points a second apart; the end forgives what is open."""


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.sampled_from("0001"), st.sampled_from("01")), min_size=1, max_size=14))
def test_phrases_of_fret_with_durations_hold_of_the_same_time_points(points: list[tuple[str, str]]) -> None:
    p, r = map("".join, zip(*points, strict=True))
    for phrase, holds in OF_FRET.items():
        (sentence,) = (row[1].strip("`").replace("5.1 s", "6 s") for row in LATER if row[0] == phrase)
        live = session(f"_rate_ = 1\n{DECLARED}{sentence}")
        for at, values in enumerate(points):
            live.samples(at * 10**9, ("p", "r"), tuple(value == "1" for value in values))
        live.advance((len(points) - 1) * 10**9 + 1)
        assert (live.tracks[0].verdict is Verdict.VIOLATED) == (not holds(p, r)), phrase


def test_each_row_beside_a_phrase_is_compared_with_what_is_published() -> None:
    assert {row[0] for row in LATER} == OF_HPL.keys() | OF_FRET.keys()
    assert {len(row) for head in ("HPL", "FRETish") for row in rows(head)} == {3, 4}


def test_a_trigger_that_holds_on_is_told_from_one_that_begins() -> None:
    told = relation("G(p -> r)", "always (p and not previously p implies r)")
    assert told == "only ours accepts `{p, r}; ({p}) for ever`"
