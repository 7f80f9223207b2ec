"""Is there a trigger whose deadline comes before what another property demands first is over?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.questions.never_triggered import events, has_dead_scope
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.time_bounds import Interval, intervals
from ltlc.analysis.wording import part_text
from ltlc.base.diagnostics import Label
from ltlc.semantics.durations import duration_text
from ltlc.semantics.ltl import Formula, eventually


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning for each trigger after which this property and another cannot both hold, at the later of two.

    None about a trigger that one of them excludes by itself, nor about properties that can never hold together.
    """
    if not subject.is_contingent or not subject.is_timed:
        return
    for interval in intervals(subject.specification.property):
        for number in sorted(study.neighbours[subject.number]):
            other = study.subjects[number]
            is_later = number > subject.number and interval.trigger in _triggers(other)
            if not is_later and not _opens(other, interval) and _excludes(study, subject, other, interval.trigger):
                yield _finding(study, subject, interval, other)


def _triggers(subject: Subject) -> list[Formula]:
    return [interval.trigger for interval in intervals(subject.specification.property)]


def _opens(other: Subject, interval: Interval) -> bool:
    """Whether the trigger opens a scope of `other`: that it cannot happen is reported there."""
    return any(event.predicate == interval.trigger for event in events(other.specification.property))


def _excludes(study: Study, subject: Subject, other: Subject, trigger: Formula) -> bool:
    """Whether the trigger can occur while either of the two holds, but not while both do, and they can hold."""
    if not other.is_timed:
        return False
    own, word = study.words[subject.number], study.words[other.number]
    occurs, compatible = study.languages.of(eventually(trigger)), study.compatible
    return (
        compatible([own, occurs])
        and not compatible([own, word, occurs])
        and compatible([word, occurs])
        and not has_dead_scope(study, other)
        and all(study.can_hold([subject, other, study.subjects[n]]) for n in study.neighbours[subject.number])
    )


def _finding(study: Study, subject: Subject, interval: Interval, other: Subject) -> Finding:
    text = part_text(study.specification.source, subject.specification, interval.path)
    spans = other.specification.spans
    theirs = next((f" of {duration_text(each.duration)}" for each in intervals(other.specification.property)), "")
    return Finding(
        "LTL606",
        subject.specification.spans[interval.path],
        f"once `{text}` holds, `{subject.label}` and `{other.label}` cannot both hold",
        label=f"starts the {duration_text(interval.duration)} of `{subject.label}`",
        secondary=(Label(spans[()], f"the time{theirs} here is incompatible"),),
        help="change one of the bounds: otherwise one of the two is violated, whatever the robot does",
    )
