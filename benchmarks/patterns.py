"""Writes the end of `docs/patterns.md`: which specification patterns differ between their editions, and from `episode`.

Run it as `python -m benchmarks.patterns`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from ltlc.analysis.comparison.answer import answer
from ltlc.analysis.comparison.forms import as_markdown
from ltlc.analysis.comparison.published import FORMULAS, LETTERS, Pattern, Scope, formula
from ltlc.analysis.comparison.reference import shown
from ltlc.analysis.comparison.results import (
    Answer,
    Candidate,
    Comparison,
    Question,
    Related,
    Relation,
    Runs,
    SeparatingRun,
)
from ltlc.analysis.comparison.tables import RELATIONS, Block, Heading, Paragraph, Table
from ltlc.base.limits import Budget, Exceeded
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.semantics import ltl
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.ltl import Atom, Formula

PAGE = Path(__file__).parents[1] / "docs" / "patterns.md"
TITLE = "The specification patterns"
"""The page, and the heading of its last section, which is written here."""

FIRST, SECOND, BOTH = "edition 1", "edition 2", "editions 1 and 2"

BODIES: dict[Pattern, str] = {
    Pattern.ABSENCE: "never p",
    Pattern.EXISTENCE: "eventually p",
    Pattern.UNIVERSALITY: "p",
    Pattern.PRECEDENCE: "(never p) or (until s, never p)",
    Pattern.RESPONSE: "always (p implies eventually s)",
    Pattern.PRECEDENCE_CHAIN_2_1: "(never p) or (until p, eventually (s and eventually t))",
    Pattern.PRECEDENCE_CHAIN_1_2: "(eventually (s and eventually t)) implies (until p, never s)",
    Pattern.RESPONSE_CHAIN_2_1: "always (s and eventually t implies eventually (t and eventually p))",
    Pattern.RESPONSE_CHAIN_1_2: "always (p implies eventually (s and eventually t))",
}
"""Each pattern in the language of ltlc."""

DECLARATIONS = "".join(f"decl {letter} /{letter} Bool.data\n" for letter in LETTERS)


@dataclass(frozen=True)
class Row:
    """One pattern in one scope: what was asked, and the answer."""

    pattern: Pattern
    scope: Scope
    answer: Answer

    @property
    def editions(self) -> tuple[str, ...]:
        """The names of the editions, of both together where they have one formula."""
        names = {candidate.name for candidate in self.answer.question.candidates}
        return tuple(name for name in (FIRST, SECOND, BOTH) if name in names)

    def comparison(self, left: str, right: str) -> Comparison:
        """How two of its formulas relate."""
        return next(c for c in self.answer.comparisons if (c.left, c.right) == (left, right))


def sentences(pattern: Pattern, scope: Scope) -> Iterator[str]:
    """The sentences of ltlc that come closest to `pattern` in `scope`."""
    body = BODIES[pattern]
    match scope:
        case Scope.GLOBALLY:
            yield body
        case Scope.AFTER:
            yield f"after q, {body}"
        case Scope.BEFORE:
            yield f"until r, {body}"
            yield f"(eventually r) implies (until r, {body})"
        case Scope.BETWEEN | Scope.AFTER_UNTIL:
            yield f"after_until q, r, {body}"


def meaning(sentence: str) -> Formula:
    """The sentence, which has no mistake, in core LTL."""
    specification, _ = load_text(Source("a pattern", DECLARATIONS + sentence))
    if specification is None:
        raise ValueError(f"not a sentence: {sentence}")
    return encode(specification.properties[0].property, EPISODE)


def rows() -> list[Row]:
    """Every pattern and scope, compared."""
    asked = list(FORMULAS)
    answers = answer([_question(*key) for key in asked], Budget(seconds=30.0))
    return [Row(*key, found) for key, found in zip(asked, answers, strict=True)]


def _question(pattern: Pattern, scope: Scope) -> Question:
    first, second = (
        formula(pattern, scope, number, **{letter: Atom(letter) for letter in LETTERS}) for number in (1, 2)
    )
    editions = [Candidate(BOTH, first)] if first == second else [Candidate(FIRST, first), Candidate(SECOND, second)]
    ours = (Candidate(text, meaning(text)) for text in sentences(pattern, scope))
    candidates = (*editions, *ours)
    used = set(ltl.atoms(ltl.conjunction(candidate.formula for candidate in candidates)))
    alphabet = Alphabet(tuple(letter for letter in LETTERS if letter in used))
    return Question(f"{pattern.value}, {scope.value}", None, "", alphabet, alphabet, candidates)


def blocks(found: list[Row]) -> Iterator[Block]:
    """The section."""
    yield Heading(2, TITLE)
    yield Paragraph(
        "Dwyer, Avrunin and Corbett published their patterns in linear temporal logic twice: the first edition at "
        "people.cs.ksu.edu/~dwyer/SPAT/ltl.html, the second at matthewbdwyer.github.io/psp/patterns/ltl.html. Of the "
        f"{len(found)} pairs of pattern and scope below, these differ between the editions: "
        f"{', '.join(f'{row.pattern.value} {row.scope.value}' for row in found if _differ(row))}. Of the "
        f"{len(_occurrence(found))} pairs of absence, existence and universality, "
        f"{sum(map(_differ, _occurrence(found)))} differ. Chains are the same in both editions; their next(…) is the "
        "next step. The published chain of two causes after q lacks a parenthesis and accepts every run that begins "
        "without q."
    )
    yield Paragraph(
        "{q} is a step with q and nothing else. Each run is a shortest one that shows the difference, and was judged "
        "by the reference interpreters; each claim was decided by automata and tried on all runs of up to "
        f"{_least_length(found)} steps, for most pairs on longer ones. This section is written by "
        "python -m benchmarks.patterns."
    )
    yield Heading(3, "Edition 1 and edition 2")
    yield Table(
        ("pattern", "scope", FIRST, SECOND, FIRST + " is", "only edition 1 accepts", "only edition 2 accepts"),
        tuple(_edition_row(row) for row in found),
    )
    yield Heading(3, "The editions and episode")
    yield Paragraph(
        "The sentences have their meaning in ltlc. Its until requires the event to occur, which 'before' in the "
        "patterns does not; it has no keyword for 'between', which does not judge a scope that stays open."
    )
    yield Table(
        (
            "pattern",
            "scope",
            "sentence",
            "edition",
            "the edition is",
            "only the edition accepts",
            "only episode accepts",
        ),
        tuple(line for row in found for line in _episode_rows(row)),
    )


def _occurrence(found: list[Row]) -> list[Row]:
    """The rows of the patterns that the authors call occurrence patterns."""
    return [row for row in found if row.pattern in (Pattern.ABSENCE, Pattern.EXISTENCE, Pattern.UNIVERSALITY)]


def _differ(row: Row) -> bool:
    if BOTH in row.editions:
        return False
    parts = row.comparison(FIRST, SECOND).related.values()
    return any(isinstance(part, Related) and part.relation is not Relation.EQUIVALENT for part in parts)


def _least_length(found: list[Row]) -> int:
    parts = (part for row in found for c in row.answer.comparisons for part in c.related.values())
    return min(part.confirmation.length for part in parts if isinstance(part, Related))


def _edition_row(row: Row) -> tuple[str, ...]:
    first, second = FORMULAS[row.pattern, row.scope]
    if BOTH in row.editions:
        return (row.pattern.value, row.scope.value, first, "the same", "", "", "")
    return (row.pattern.value, row.scope.value, first, second, *_relation(row.comparison(FIRST, SECOND)))


def _episode_rows(row: Row) -> Iterator[tuple[str, ...]]:
    for text in sentences(row.pattern, row.scope):
        for edition in row.editions:
            number = edition.partition(" ")[2]
            yield row.pattern.value, row.scope.value, text, number, *_relation(row.comparison(edition, text))


def _relation(comparison: Comparison) -> tuple[str, str, str]:
    """The relation on infinite and, where it is another, on finite runs; and the runs that show it."""
    infinite, finite = (comparison.related[kind] for kind in (Runs.INFINITE, Runs.FINITE))
    if isinstance(infinite, Exceeded) or isinstance(finite, Exceeded):
        raise TimeoutError(f"{comparison.left}, {comparison.right}: not decided")
    relation = _word(infinite.relation)
    if finite.relation is not infinite.relation:
        relation += f", on finite runs {_word(finite.relation)}"
    return relation, _witness(finite.left_only, infinite.left_only), _witness(finite.right_only, infinite.right_only)


def _word(relation: Relation) -> str:
    return RELATIONS[relation].removeprefix("is ").rsplit(" ", 1)[0]


def _witness(finite: SeparatingRun | None, infinite: SeparatingRun | None) -> str:
    """The finite run if there is one, else the infinite one."""
    run = finite or infinite
    return "" if run is None else shown(run.word)


def main() -> None:
    """Write the section."""
    before = PAGE.read_text(encoding="utf-8").partition(f"## {TITLE}\n")[0]
    PAGE.write_text(before + as_markdown(blocks(rows())), encoding="utf-8")


if __name__ == "__main__":
    main()
