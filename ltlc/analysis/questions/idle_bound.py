"""Is there a bound on time that makes no difference?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.left_out import without_bound
from ltlc.analysis.questions.vacuous_part import vacuous
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.time_bounds import TimeBound, time_bounds
from ltlc.analysis.wording import part_at, part_text
from ltlc.base.diagnostics import Help, Label
from ltlc.semantics.durations import duration_text
from ltlc.semantics.properties import Within
from ltlc.specification.specification import Path


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning for each bound without which the property means the same; none inside a part that is idle itself."""
    if not subject.is_contingent or not subject.is_timed:
        return
    bounds = [bound for bound in time_bounds(subject.specification.property) if _is_idle(study, subject, bound)]
    idle = [path for path, _ in vacuous(study, subject)] if bounds else []
    for bound in bounds:
        if not any(bound.path[: len(path)] == path or path[: len(bound.path)] == bound.path for path in idle):
            yield _finding(study, subject, bound)


def _is_idle(study: Study, subject: Subject, bound: TimeBound) -> bool:
    without = None if bound.unbounded is None else study.language(bound.unbounded)
    return without is not None and study.languages.equal(study.words[subject.number], without)


def _finding(study: Study, subject: Subject, bound: TimeBound) -> Finding:
    duration = duration_text(bound.duration)
    outer = _outer(subject, bound)
    source, spans = study.specification.source, subject.specification.spans
    inner = without_bound(source, spans[bound.path])
    if outer is None:
        text = part_text(source, subject.specification, bound.path)
        return Finding(
            "LTL507",
            spans[bound.path],
            f"the bound of {duration} makes no difference to `{subject.label}`: `{text}` means the same without it",
            label="here",
            help=Help("omit the bound, or check that the property says what you mean", inner),
        )
    path, around = outer
    return Finding(
        "LTL507",
        spans[bound.path],
        f"the bound of {duration} makes no difference to `{subject.label}`: after {duration_text(around)} the part "
        "around it is over",
        label=f"may take {duration}",
        secondary=(Label(spans[path], f"is over after {duration_text(around)}"),),
        help=Help("omit one of the two, or swap them", inner),
    )


def _outer(subject: Subject, bound: TimeBound) -> tuple[Path, int] | None:
    """The place of a bound around this one that is not larger, and so is over before; the past is not inside one."""
    property_ = subject.specification.property
    if not isinstance(part_at(property_, bound.path), Within):
        return None
    for depth in range(len(bound.path) - 1, -1, -1):
        match part_at(property_, bound.path[:depth]):
            case Within(duration, _) if duration <= bound.duration:
                return bound.path[:depth], duration
    return None
