"""Can neither an event nor its closing event hold?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.questions.event_pairs import event_pairs, step_example, step_with
from ltlc.analysis.subjects import Study, Subject
from ltlc.diagnostics import Label
from ltlc.semantics import ltl


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A note, with values, for each pair of events on the same signals that leave a gap."""
    for opening, closing in event_pairs(study, subject):
        letter = step_with(subject, ltl.Not(ltl.Or(opening.predicate, closing.predicate)))
        if letter is None:
            continue
        between = f"between `{opening.text}` and `{closing.text}` is a gap"
        yield Finding(
            "LTL511",
            opening.span,
            f"{between}: there no episode of `{subject.label}` opens or closes",
            label="opens an episode",
            secondary=(Label(closing.span, "closes it"),),
            help="an episode that is open goes on through the gap; `<` and `>=`, for example, leave none",
            example=step_example(study, subject, letter, "a step on which neither holds"),
        )
