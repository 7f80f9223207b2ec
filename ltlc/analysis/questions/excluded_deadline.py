"""Is there a trigger whose deadline comes before what another property demands first is over?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.questions.never_triggered import has_dead_scope
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import all_parts, part_text
from ltlc.diagnostics import Label
from ltlc.semantics.durations import duration_text
from ltlc.semantics.ltl import Formula, eventually
from ltlc.semantics.properties import Always, Implies, Now, Within
from ltlc.specification.specification import Path


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning for each trigger after which this property and another cannot both hold; told at the later of two.

    None about a trigger that one of them excludes by itself, nor about properties that can never hold together.
    """
    if not subject.is_contingent or not subject.is_timed:
        return
    for path, trigger, duration in _triggers(subject):
        for number in sorted(study.neighbours[subject.number]):
            other = study.subjects[number]
            is_told_there = number > subject.number and any(each == trigger for _, each, _ in _triggers(other))
            if not is_told_there and _excludes(study, subject, other, trigger):
                yield _finding(study, subject, path, duration, other)


def _excludes(study: Study, subject: Subject, other: Subject, trigger: Formula) -> bool:
    """Whether the trigger can occur while either of the two holds, but not while both do, and they can hold."""
    if not other.is_timed:
        return False
    own, word = study.words[subject.number], study.words[other.number]
    occurs, compatible = study.languages.of(eventually(trigger)), study.languages.compatible
    return (
        compatible([own, occurs])
        and not compatible([own, word, occurs])
        and compatible([word, occurs])
        and not has_dead_scope(study, other)
        and all(study.can_hold([subject, other, study.subjects[n]]) for n in study.neighbours[subject.number])
    )


def _triggers(subject: Subject) -> Iterator[tuple[Path, Formula, int]]:
    """What an interval begins with, and how long that is."""
    for path, part in all_parts(subject.specification.property):
        match part:
            case Always(Implies(Now(trigger), Within(duration, _))):
                yield (*path, 0, 0), trigger, duration


def _finding(study: Study, subject: Subject, path: Path, duration: int, other: Subject) -> Finding:
    text = part_text(study.specification.source, subject.specification, path)
    spans = other.specification.spans
    theirs = next((f" of {duration_text(d)}" for _, _, d in _triggers(other)), "")
    return Finding(
        "LTL606",
        subject.specification.spans[path],
        f"once `{text}` holds, `{subject.label}` and `{other.label}` cannot both hold",
        label=f"begins {duration_text(duration)} of `{subject.label}`",
        secondary=(Label(spans[()], f"the time{theirs} here does not fit"),),
        help="change one of the bounds: whatever the robot does after that, one of the two is violated",
    )
