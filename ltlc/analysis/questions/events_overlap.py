"""Can an event and its closing event hold together?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.predicates import is_possible
from ltlc.analysis.questions.event_pairs import event_pairs
from ltlc.analysis.subjects import Study, Subject
from ltlc.base.diagnostics import Label
from ltlc.semantics import ltl


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning, with values, for each pair of events on the same signals that can.

    None where one closes within what the other opens, as in an approach from `d < 5` until `d < 1`: that is a way in.
    """
    for opening, closing in event_pairs(study, subject):
        both = ltl.And(opening.predicate, closing.predicate)
        outside = ltl.And(closing.predicate, ltl.Not(opening.predicate))
        if not is_possible(both, subject.alphabet) or not is_possible(outside, subject.alphabet):
            continue
        text = f"`{opening.text}` and `{closing.text}` can hold together"
        yield Finding(
            "LTL510",
            opening.span,
            f"{text}: such a step opens no episode of `{subject.label}`",
            label="opens an episode, unless the closing event holds",
            secondary=(Label(closing.span, "closes it"),),
            help="move the numbers apart; if this is intended, add `and not` with the closing event to the opening one",
            example=study.example_step(both, "a step on which both hold", subject),
        )
