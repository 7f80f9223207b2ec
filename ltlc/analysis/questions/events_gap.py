"""Do the numbers of an event and those of its closing event leave a gap between them?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.predicates import is_possible
from ltlc.analysis.questions.event_pairs import event_pairs
from ltlc.analysis.subjects import Study, Subject
from ltlc.base.diagnostics import Label
from ltlc.semantics import ltl
from ltlc.semantics.ltl import Formula
from ltlc.specification.expressions import Comparison, Relation


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A note, with values, for each pair of events on the same signals that leave a gap; states and words have none."""
    for opening, closing in event_pairs(study, subject):
        either = ltl.Or(opening.predicate, closing.predicate)
        neither = ltl.Not(either)
        if not _is_on_a_line(either, subject) or not is_possible(neither, subject.alphabet):
            continue
        text = f"there is a gap between `{opening.text}` and `{closing.text}`"
        yield Finding(
            "LTL511",
            opening.span,
            f"{text}: then no episode of `{subject.label}` opens or closes",
            label="opens an episode",
            secondary=(Label(closing.span, "closes it"),),
            help="an open episode continues through the gap; `<` and `>=`, for example, leave none",
            example=study.example_step(neither, "a step on which neither holds", subject),
        )


def _is_on_a_line(events: Formula, subject: Subject) -> bool:
    """Whether `events` only compare values by less or more."""
    names = set(ltl.atoms(events))
    conditions = [atom.condition for atom in subject.specification.atoms if atom.name in names]
    return all(isinstance(each, Comparison) and each.relation is not Relation.EQUAL for each in conditions)
