"""Does any run satisfy the property?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis import reasons
from ltlc.analysis.errors import DisagreementError
from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study, Subject

CONFIRMED_LENGTHS = (1, 2, 3)
"""The lengths of the runs that are searched for one that should not be there."""


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """An error if no run does. The monitor says so, and a search for a run must find none."""
    if not subject.never_holds:
        return
    from ltlc.analysis.lassos import find_lasso

    if find_lasso([subject.formula], subject.alphabet, CONFIRMED_LENGTHS) is not None:
        raise DisagreementError("whether it can hold")
    yield Finding(
        "LTL501",
        subject.specification.span,
        f"no run satisfies `{subject.label}`: its monitor would report a violation at the first step",
        secondary=reasons.labels(study.specification.source, subject) or reasons.conflict(study, subject),
        help="look for contradictory conditions, or for `never` where you mean `always`",
    )
