"""Does a property follow from others, or is it equivalent to one?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, islice

from ltlc.analysis.findings import Finding
from ltlc.analysis.left_out import without_property
from ltlc.analysis.questions.never_triggered import has_dead_scope, is_untested
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import listed
from ltlc.base.diagnostics import Label
from ltlc.semantics.verdicts import Verdict

MOST_SETS = 3_000
"""How many sets of others are tried for one property."""

SMALL_SET = 4
"""Of so many others, a product of automata is made; of more, a run is searched for."""

LARGEST_SET = 3
"""Properties that only follow from more others than this are not found."""


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning if it does, with a smallest set that it follows from; about equivalent properties, at the later one.

    None where `never-triggered` reports why it follows.
    """
    if not subject.is_contingent:
        return
    others = [study.subjects[n] for n in sorted(study.neighbours[subject.number])]
    implying = [other for other in others if _implies(study, [other], subject)]
    equivalent = [other for other in implying if _implies(study, [subject], other)]
    stronger = [other for other in implying if other not in equivalent]
    if equivalent and equivalent[0].number < subject.number:
        yield _equivalent(study, subject, equivalent[0])
    elif not _is_goal(subject) or study.pedantic:
        given = _reason(study, subject, others, stronger, equivalent)
        if given:
            yield _redundant(study, subject, given)


def _is_goal(subject: Subject) -> bool:
    """Whether the property can be satisfied during a run, and never violated: then it adds information."""
    verdicts = subject.monitor.verdicts if subject.monitor else ()
    return Verdict.SATISFIED in verdicts and Verdict.VIOLATED not in verdicts


def _reason(
    study: Study,
    subject: Subject,
    others: Sequence[Subject],
    stronger: Sequence[Subject],
    equivalent: Sequence[Subject],
) -> Sequence[Subject] | None:
    """A smallest set that the property follows from, and that is stronger."""
    if stronger:
        return list(islice((other for other in stronger if _is_the_reason(study, subject, other)), 1))
    if equivalent or _has_own_run(study, subject, others):
        return None
    return _implying_set(study, subject, others)


def _is_the_reason(study: Study, subject: Subject, other: Subject) -> bool:
    """Whether to report here that the property follows from `other`, as no other finding reports it."""
    return not (has_dead_scope(study, other) or is_untested(study, subject, other) or _is_sum(study, other))


def _is_sum(study: Study, subject: Subject) -> bool:
    """Whether a few properties that follow from it are equivalent to it together: then it is the one to omit."""
    others = [study.subjects[n] for n in sorted(study.neighbours[subject.number])]
    weaker = [o for o in others if _implies(study, [subject], o) and not _implies(study, [o], subject)]
    return 1 < len(weaker) <= LARGEST_SET and _implies(study, weaker, subject)


def _implies(study: Study, given: Sequence[Subject], then: Subject) -> bool:
    return study.implies([study.words[subject.number] for subject in given], study.words[then.number])


def _has_own_run(study: Study, subject: Subject, others: Sequence[Subject]) -> bool:
    """Whether a run is found that satisfies all `others` and not `subject`: then no set of them implies it."""
    if len(others) <= SMALL_SET:
        return not others or not _implies(study, others, subject)
    wanted = {other.number: True for other in others}
    return study.common_runs.find({**wanted, subject.number: False}) is not None


def _implying_set(study: Study, subject: Subject, others: Sequence[Subject]) -> Sequence[Subject] | None:
    """A smallest consistent set of `others` that implies `subject`."""
    tried = 0
    for size in range(2, LARGEST_SET + 1):
        for given in combinations(others, size):
            tried += 1
            if tried > MOST_SETS:
                return None
            if _implies(study, given, subject) and study.can_hold(given):
                return given
    return None


def _equivalent(study: Study, subject: Subject, other: Subject) -> Finding:
    return Finding(
        "LTL603",
        subject.specification.span,
        f"`{subject.label}` is equivalent to `{other.label}`",
        secondary=(Label(other.specification.span, "the same runs satisfy this"),),
        help=without_property("omit one of them", study.specification.source, subject.specification.span),
    )


def _redundant(study: Study, subject: Subject, given: Sequence[Subject]) -> Finding:
    names = listed([f"`{other.label}`" for other in given])
    violated = "one of them" if len(given) > 1 else "that"
    advice = "omit it, unless its own verdict is useful"
    code, so = "LTL602", f"a run that violates it violates {violated}"
    if _is_goal(subject):
        code, so = "LTL605", "its monitor can only report satisfied, perhaps earlier"
    return Finding(
        code,
        subject.specification.span,
        f"`{subject.label}` follows from {names}: {so}",
        secondary=tuple(Label(other.specification.span, "it follows from this") for other in given),
        help=without_property(advice, study.specification.source, subject.specification.span),
    )
