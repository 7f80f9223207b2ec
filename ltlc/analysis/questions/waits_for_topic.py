"""Does a deadline from the beginning wait for a message of the very topic that may stay silent?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.groups import reads_of
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import listed
from ltlc.semantics.durations import duration_text
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import And, Eventually, Now, Property, Within
from ltlc.semantics.timed_atoms import atoms_within
from ltlc.specification.arrivals import waited_for
from ltlc.specification.specification import Path, Slicing, topics, topics_of


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A note for a deadline of the beginning of the run: a silent topic leaves the property not started.

    A slice begins with a message on a sliced topic, so that of one that reads nothing else there is nothing to say.
    """
    slicing = subject.specification.slicing
    if (
        isinstance(slicing, Slicing)
        and len(slicing.keys) == 1
        and slicing.topics.issuperset(topics(subject.specification))
    ):
        return
    for path, deadline, goal in _deadlines(subject.specification.property):
        signals = _signals(subject, goal)
        if signals:
            yield _finding(subject, path, deadline, signals)


def _deadlines(node: Property, path: Path = ()) -> Iterator[tuple[Path, int, Formula]]:
    """The deadlines that begin with the run, and what has to happen by then."""
    match node:
        case And(left, right):
            yield from _deadlines(left, (*path, 0))
            yield from _deadlines(right, (*path, 1))
        case Within(duration, Eventually(Now(goal))):
            yield path, duration, goal
        case _:
            pass


def _signals(subject: Subject, goal: Formula) -> list[str]:
    """The signals of `goal` that it needs a value of; not those that it reads with their news."""
    names = {atom.name for atom in atoms_within(goal)}
    conditions = [atom.condition for atom in subject.specification.atoms if atom.name in names]
    found = [value for condition in conditions for value in reads_of(condition)]
    waited = waited_for(subject.specification)
    return list(dict.fromkeys(value.signal.name for value in found if value in waited))


def _finding(subject: Subject, path: Path, deadline: int, signals: list[str]) -> Finding:
    duration, first = duration_text(deadline), signals[0]
    topics = dict.fromkeys(t for i in waited_for(subject.specification) for t in topics_of(i.signal))
    silent = listed([f"`{topic}`" for topic in topics], "or")
    return Finding(
        "LTL523",
        subject.specification.spans[path],
        f"the {duration} begin when all that `{subject.label}` waits for has a value: while {silent} is silent, it is "
        "not started, not violated",
        label=f"needs a message on the topic of `{first}`",
        help=f"to require that message too, add `eventually new {first} within {duration}`",
    )
