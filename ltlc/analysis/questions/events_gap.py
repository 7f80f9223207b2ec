"""Can neither an event nor its closing event hold?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.predicates import is_possible
from ltlc.analysis.questions.event_pairs import event_pairs
from ltlc.analysis.subjects import Study, Subject
from ltlc.diagnostics import Label
from ltlc.semantics import ltl


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A note, with values, for each pair of events on the same signals that leave a gap."""
    for opening, closing in event_pairs(study, subject):
        neither = ltl.Not(ltl.Or(opening.predicate, closing.predicate))
        if not is_possible(neither, subject.alphabet):
            continue
        text = f"between `{opening.text}` and `{closing.text}` is a gap"
        yield Finding(
            "LTL511",
            opening.span,
            f"{text}: there no episode of `{subject.label}` opens or closes",
            label="opens an episode",
            secondary=(Label(closing.span, "closes it"),),
            help="an episode that is open goes on through the gap; `<` and `>=`, for example, leave none",
            example=study.example_step(neither, "a step on which neither holds", subject),
        )
