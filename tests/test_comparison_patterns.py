"""The specification patterns: as published, and the page about them."""

import csv
from pathlib import Path

import pytest

from benchmarks.patterns import FIRST, PAGE, SECOND, TITLE, blocks, rows
from ltlc.analysis.comparison import forms
from ltlc.analysis.comparison.published import FORMULAS, LETTERS, Pattern, Scope, formula
from ltlc.analysis.comparison.results import Related, Relation, Runs
from ltlc.automata.queries import implies
from ltlc.automata.spot_syntax import parse
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.ltl import Atom

PUBLISHED = Path(__file__).parents[2] / "shared" / "data" / "dwyer_two_editions.tsv"

FREE = Alphabet(LETTERS)
MEANING = {letter: Atom(letter) for letter in LETTERS}


def test_the_section_is_what_the_command_writes() -> None:
    found = rows()
    _, heading, section = PAGE.read_text(encoding="utf-8").partition(f"## {TITLE}\n")
    assert heading + section == forms.as_markdown(blocks(found))
    both = [row for row in found if FIRST in row.editions]
    relations = {(row.pattern, row.scope): row.comparison(FIRST, SECOND).related[Runs.INFINITE] for row in both}
    differing = {
        key: part.relation
        for key, part in relations.items()
        if isinstance(part, Related) and part.relation is not Relation.EQUIVALENT
    }
    assert differing == {
        (Pattern.EXISTENCE, Scope.BEFORE): Relation.WEAKER,
        (Pattern.EXISTENCE, Scope.BETWEEN): Relation.INCOMPARABLE,
        (Pattern.EXISTENCE, Scope.AFTER_UNTIL): Relation.INCOMPARABLE,
        (Pattern.PRECEDENCE, Scope.GLOBALLY): Relation.STRONGER,
        (Pattern.RESPONSE, Scope.BEFORE): Relation.WEAKER,
        (Pattern.RESPONSE, Scope.BETWEEN): Relation.WEAKER,
        (Pattern.RESPONSE, Scope.AFTER_UNTIL): Relation.WEAKER,
    }


@pytest.mark.parametrize(("pattern", "scope"), list(FORMULAS))
def test_a_pattern_is_read_as_spot_reads_it(pattern: Pattern, scope: Scope) -> None:
    for edition, text in enumerate(FORMULAS[pattern, scope], 1):
        ours = formula(pattern, scope, edition, **MEANING)
        theirs = parse(text.replace("next(", "X("))
        assert implies(ours, theirs, FREE)
        assert implies(theirs, ours, FREE)


@pytest.mark.skipif(not PUBLISHED.exists(), reason="the table of the published formulas is not here")
def test_the_formulas_are_those_of_the_published_table() -> None:
    with PUBLISHED.open(encoding="utf-8") as file:
        table = {row[0]: row[1:] for row in csv.reader(file, delimiter="\t")}
    compared = 0
    for (pattern, scope), formulas in FORMULAS.items():
        if published := table.get(f"{pattern.value}/{scope.value}"):
            assert [parse(text) for text in published] == [parse(text) for text in formulas]
            compared += 1
    assert compared == 15
