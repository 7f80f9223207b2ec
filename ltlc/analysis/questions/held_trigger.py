"""Does a trigger that holds on keep an interval from beginning, or break it at once?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.predicates import is_possible
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.time_bounds import Interval, intervals
from ltlc.analysis.wording import part_text, written
from ltlc.semantics.durations import duration_text
from ltlc.semantics.ltl import And, Formula, Not
from ltlc.semantics.properties import Always, Never, Now, Throughout
from ltlc.semantics.timed_atoms import News, Previously, atoms_within
from ltlc.specification import timed


def ask_at_once(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning for each interval whose trigger is what may not hold in it."""
    for interval in broken_at_once(subject):
        yield _at_once(study, subject, interval)


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A note for each interval after a trigger that may hold for a while: it is counted from its last instant."""
    for interval, kept in _kept(subject):
        is_moment = any(isinstance(atom, News | Previously) for atom in atoms_within(interval.trigger))
        if not is_moment and is_possible(And(interval.trigger, kept), subject.alphabet):
            yield _finding(study, subject, interval)


def broken_at_once(subject: Subject) -> list[Interval]:
    """The intervals whose trigger is what may not hold in them."""
    return [
        interval
        for interval, kept in _kept(subject)
        if is_possible(interval.trigger, subject.alphabet)
        and not is_possible(And(interval.trigger, kept), subject.alphabet)
    ]


def _kept(subject: Subject) -> Iterator[tuple[Interval, Formula]]:
    """The intervals in which something has to hold on, and what."""
    for interval in intervals(subject.specification.property):
        match interval.body:
            case Always(Now(kept)) | Throughout(kept):
                yield interval, kept
            case Never(Now(bad)):
                yield interval, Not(bad)
            case _:
                pass


def _at_once(study: Study, subject: Subject, interval: Interval) -> Finding:
    text = part_text(study.specification.source, subject.specification, interval.path)
    ends = written(And(Not(interval.trigger), timed.previously(interval.trigger)))
    return Finding(
        "LTL508",
        subject.specification.spans[interval.path],
        f"`{text}` violates the {duration_text(interval.duration)} that it starts: `{subject.label}` never allows it",
        label="it must not hold, already at this very instant",
        help=f"to count from the moment it ends, write `{ends}`",
    )


def _finding(study: Study, subject: Subject, interval: Interval) -> Finding:
    text = part_text(study.specification.source, subject.specification, interval.path)
    begins = written(And(interval.trigger, Not(timed.previously(interval.trigger))))
    return Finding(
        "LTL513",
        subject.specification.spans[interval.path],
        f"the {duration_text(interval.duration)} of `{subject.label}` count from the last instant with `{text}`, and "
        "as long as it holds",
        label="may hold for a while",
        help=f"to count from the moment it begins, write `{begins}`",
    )
