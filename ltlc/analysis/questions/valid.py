"""Can the property fail?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis import reasons
from ltlc.analysis.errors import DisagreementError
from ltlc.analysis.findings import Finding
from ltlc.analysis.reasons import constant, state_predicates
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import part_text, written
from ltlc.semantics import ltl
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import After, AfterUntil, Property

CONFIRMED_LENGTHS = (1, 2, 3)
"""The lengths of the runs that are searched for one that should not be there."""


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning, with the reason, if it cannot. The monitor says so; a search for a run that fails must find none."""
    if not subject.always_holds:
        return
    from ltlc.analysis.lassos import find_lasso

    if find_lasso([ltl.Not(subject.formula)], subject.alphabet, CONFIRMED_LENGTHS) is not None:
        raise DisagreementError("whether it can fail")
    yield Finding(
        "LTL503",
        subject.specification.span,
        f"`{subject.label}` cannot fail: {_reason(study, subject)}",
        secondary=reasons.labels(study.specification.source, subject),
        help="a property that every run satisfies monitors nothing; check its conditions and numbers",
    )


def _reason(study: Study, subject: Subject) -> str:
    """Why, as far as one event or one predicate is the reason."""
    event = _impossible_event(subject.specification.property, subject)
    if event is not None:
        return f"its event `{event}` can never happen"
    for path, predicate in state_predicates(subject.specification.property):
        verdict = constant(predicate, subject)
        if verdict is not None:
            text = part_text(study.specification.source, subject.specification, path)
            return f"`{text}` {verdict} holds"
    return "every run satisfies it, whatever happens"


def _impossible_event(property_: Property, subject: Subject) -> str | None:
    """The event of the outermost scope, if it can never happen."""
    match property_:
        case After(event, _):
            opening: Formula = event
        case AfterUntil(event, closing, _):
            opening = ltl.And(event, ltl.Not(closing))
        case _:
            return None
    return written(opening) if constant(opening, subject) == "never" else None
