"""What the documentation says of other people's patterns and phrases beside sentences of ours is so."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from language_support import compiled
from published import DECLARED, PLACES, relation

from ltlc.automata.spot_syntax import parse
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.words import Lasso

DOCS = Path(__file__).parents[1] / "docs"
MISSIONS = (DOCS / "missions.md").read_text(encoding="utf-8")
PHRASES = (DOCS / "phrases.md").read_text(encoding="utf-8")
MESSAGES = frozenset("pqrs")

PATTERN = r"### (.*?)\n.*?```ltlc\n(.*?)```\n\nPublished: `(.*?)`\.\s+Ours beside it: (.*?)\.\n"
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


def test_a_trigger_that_holds_on_is_told_from_one_that_begins() -> None:
    told = relation("G(p -> r)", "always (p and not previously p implies r)")
    assert told == "only ours accepts `{p, r}; ({p}) for ever`"
