"""Does any finite run satisfy the property, or only infinite ones?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.errors import DisagreementError
from ltlc.analysis.examples import example_of_lasso
from ltlc.analysis.findings import Finding
from ltlc.analysis.search import shortest
from ltlc.analysis.subjects import Study, Subject


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning if some run satisfies the property and none that ends does; not asked where time decides."""
    monitor = subject.monitor
    if monitor is None or subject.never_holds:
        return
    if subject.is_timed or shortest([(subject.formula, monitor)], subject.alphabet, lambda verdicts: verdicts[0].holds):
        return
    lasso = study.languages.word([study.words[subject.number]])
    if lasso is None:
        raise DisagreementError("whether it can hold")
    yield Finding(
        "LTL502",
        subject.specification.span,
        f"only infinite runs satisfy `{subject.label}`: every recording ends with it presumably violated",
        help="say by when something has to happen, for example with `until`",
        example=example_of_lasso(study.setting(subject), lasso, "satisfies it, if it goes on forever"),
    )
