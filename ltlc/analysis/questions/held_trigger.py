"""Does a trigger that holds on keep an interval from beginning?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import all_parts, part_text, written
from ltlc.semantics.durations import duration_text
from ltlc.semantics.ltl import And, Formula, Not
from ltlc.semantics.properties import Always, Implies, Never, Now, Throughout, Within
from ltlc.semantics.timed_atoms import News, Previously, atoms_within
from ltlc.specification import timed
from ltlc.specification.specification import Path


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A note for each interval after a trigger that may hold for a while: it is counted from its last instant."""
    for path, part in all_parts(subject.specification.property):
        match part:
            case Always(Implies(Now(trigger), Within(duration, Never(Now()) | Always(Now()) | Throughout()))):
                if not any(isinstance(atom, News | Previously) for atom in atoms_within(trigger)):
                    yield _finding(study, subject, (*path, 0, 0), trigger, duration)


def _finding(study: Study, subject: Subject, path: Path, trigger: Formula, duration: int) -> Finding:
    text = part_text(study.specification.source, subject.specification, path)
    begins = written(And(trigger, Not(timed.previously(trigger))))
    return Finding(
        "LTL513",
        subject.specification.spans[path],
        f"the {duration_text(duration)} of `{subject.label}` count from the last instant with `{text}`, and as long as "
        "it holds",
        label="may hold for a while",
        help=f"to count from the moment at which it begins, write `{begins}`",
    )
