"""Is the property decided at its first step, because a rate holds at first?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import all_parts
from ltlc.semantics.durations import duration_text
from ltlc.semantics.ltl import Not, conjunction
from ltlc.semantics.properties import Now, Throughout
from ltlc.semantics.timed_atoms import News, Occurred


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning if, with all rates as they are at the first step, no run satisfies the property, or every run does."""
    rates = {}
    for path, part in all_parts(subject.specification.property):
        atom = part.predicate if isinstance(part, Now | Throughout) else part
        if isinstance(atom, Occurred) and atom.presumed:
            rates[atom] = path
    if not rates or not subject.is_contingent:
        return
    languages, at_first = study.languages, study.languages.of(conjunction(rates))
    if not study.compatible([at_first, study.words[subject.number]]):
        outcome = "no run satisfies"
    elif not study.compatible([at_first, languages.of(Not(subject.formula))]):
        outcome = "every run satisfies"
    else:
        return
    rate, path = next(iter(rates.items()))
    span = duration_text(rate.within or 0)
    assert isinstance(rate.operand, News)
    counted = f"once {rate.operand.name} {rate.times} times within {span}"
    yield Finding(
        "LTL527",
        subject.specification.spans[path],
        f"`{rate.name}` holds for the first {span} in any case, so {outcome} `{subject.label}`",
        help=f"count the messages: `{counted}` does not hold until there were so many",
    )
