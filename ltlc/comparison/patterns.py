"""Writes `docs/dwyer.md`: which of the specification patterns differ between their editions, and from `episode`.

Run it as `python -m ltlc.comparison.patterns > docs/dwyer.md`.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass

from ltlc.comparison.answer import answer
from ltlc.comparison.forms import as_markdown
from ltlc.comparison.published import FORMULAS, LETTERS, Pattern, Scope, formula
from ltlc.comparison.reference import shown
from ltlc.comparison.results import Answer, Candidate, Comparison, Kind, Question, Related, Relation, SeparatingRun
from ltlc.comparison.tables import RELATIONS, Block, Heading, Paragraph, Table
from ltlc.limits import Budget, Exceeded
from ltlc.semantics import ltl
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.ltl import Atom
from ltlc.semantics.properties import (
    After,
    AfterUntil,
    Eventually,
    Implies,
    Never,
    Now,
    Or,
    Property,
    Throughout,
    Until,
)

P, Q, R, S = (Atom(letter) for letter in LETTERS)
FIRST, SECOND = "edition 1", "edition 2"

BODIES: dict[Pattern, tuple[str, Property]] = {
    Pattern.ABSENCE: ("never p", Never(Now(P))),
    Pattern.EXISTENCE: ("eventually p", Eventually(Now(P))),
    Pattern.UNIVERSALITY: ("p", Throughout(P)),
    Pattern.PRECEDENCE: ("never p or (until s, never p)", Or(Never(Now(P)), Until(S, Never(Now(P))))),
}
"""Each pattern in the language of ltlc."""


@dataclass(frozen=True)
class Row:
    """One pattern in one scope: what was asked, and the answer."""

    pattern: Pattern
    scope: Scope
    answer: Answer

    def comparison(self, left: str, right: str) -> Comparison:
        """How two of its formulas relate."""
        return next(c for c in self.answer.comparisons if (c.left, c.right) == (left, right))


def sentences(scope: Scope, text: str, body: Property) -> Iterator[tuple[str, Property]]:
    """The sentences of ltlc that come closest to `body`, written `text`, in `scope`."""
    match scope:
        case Scope.GLOBALLY:
            yield text, body
        case Scope.AFTER:
            yield f"after q, {text}", After(Q, body)
        case Scope.BEFORE:
            yield f"until r, {text}", Until(R, body)
            yield f"(eventually r) implies (until r, {text})", Implies(Eventually(Now(R)), Until(R, body))
        case Scope.BETWEEN | Scope.AFTER_UNTIL:
            yield f"after_until q, r, {text}", AfterUntil(Q, R, body)


def rows() -> list[Row]:
    """Every pattern and scope, compared."""
    asked = list(FORMULAS)
    answers = answer([_question(*key) for key in asked], Budget(seconds=30.0))
    return [Row(*key, found) for key, found in zip(asked, answers, strict=True)]


def _question(pattern: Pattern, scope: Scope) -> Question:
    editions = (
        Candidate(name, formula(pattern, scope, number, p=P, q=Q, r=R, s=S))
        for number, name in enumerate((FIRST, SECOND), 1)
    )
    ours = (Candidate(text, encode(property_, EPISODE)) for text, property_ in sentences(scope, *BODIES[pattern]))
    candidates = (*editions, *ours)
    used = set(ltl.atoms(ltl.conjunction(candidate.formula for candidate in candidates)))
    alphabet = Alphabet(tuple(letter for letter in LETTERS if letter in used))
    return Question(f"{pattern.value}, {scope.value}", None, "", alphabet, alphabet, candidates)


def blocks(found: list[Row]) -> Iterator[Block]:
    """The page."""
    yield Heading(1, "Two editions of the specification patterns, and episode")
    yield Paragraph(
        "Dwyer, Avrunin and Corbett published their patterns in linear temporal logic twice: the first edition at "
        "people.cs.ksu.edu/~dwyer/SPAT/ltl.html, the second at matthewbdwyer.github.io/psp/patterns/ltl.html. Of the "
        f"{len(found)} pairs of a pattern and a scope below, these differ between the editions: "
        f"{', '.join(f'{row.pattern.value} {row.scope.value}' for row in found if _differ(row))}. Among the "
        f"{len(_occurrence(found))} of absence, existence and universality those are "
        f"{sum(map(_differ, _occurrence(found)))}."
    )
    yield Paragraph(
        "{q} is a step with q and nothing else. Each run is as short as any that shows the difference, and was judged "
        "by the reference interpreters; each claim was decided by automata and tried on all runs of up to "
        f"{_least_length(found)} steps, of most pairs on longer ones. This page was written by: "
        "python -m ltlc.comparison.patterns > docs/dwyer.md"
    )
    yield Heading(2, "Edition 1 and edition 2")
    yield Table(
        ("pattern", "scope", FIRST, SECOND, FIRST + " is", "only edition 1 accepts", "only edition 2 accepts"),
        tuple(_edition_row(row) for row in found),
    )
    yield Heading(2, "The editions and episode")
    yield Paragraph(
        "The sentences are read as ltlc reads them. Its until demands that the event comes, which the patterns' "
        "'before' does not; it has no keyword for 'between', which does not judge a scope that stays open."
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
    return [row for row in found if row.pattern is not Pattern.PRECEDENCE]


def _differ(row: Row) -> bool:
    parts = row.comparison(FIRST, SECOND).related.values()
    return any(isinstance(part, Related) and part.relation is not Relation.EQUIVALENT for part in parts)


def _least_length(found: list[Row]) -> int:
    parts = (part for row in found for c in row.answer.comparisons for part in c.related.values())
    return min(part.confirmation.length for part in parts if isinstance(part, Related))


def _edition_row(row: Row) -> tuple[str, ...]:
    first, second = FORMULAS[row.pattern, row.scope]
    return (row.pattern.value, row.scope.value, first, second, *_relation(row.comparison(FIRST, SECOND)))


def _episode_rows(row: Row) -> Iterator[tuple[str, ...]]:
    for text, _ in sentences(row.scope, *BODIES[row.pattern]):
        for edition in (FIRST, SECOND):
            yield row.pattern.value, row.scope.value, text, edition[-1], *_relation(row.comparison(edition, text))


def _relation(comparison: Comparison) -> tuple[str, str, str]:
    """The relation on infinite and, where it is another, on finite runs; and the runs that show it."""
    infinite, finite = (comparison.related[kind] for kind in (Kind.INFINITE, Kind.FINITE))
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
    """Print the page."""
    sys.stdout.write(as_markdown(blocks(rows())))


if __name__ == "__main__":
    main()
