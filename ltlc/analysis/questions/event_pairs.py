"""What an event and its closing event leave between them, and what they have in common."""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.groups import key, reads_of
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import part_text
from ltlc.base.source import Span
from ltlc.dataclass import dataclass
from ltlc.semantics import ltl
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import AfterUntil, Property
from ltlc.specification.specification import Path, parts


@dataclass(frozen=True, slots=True)
class Event:
    """One of the two events: its text and its place."""

    predicate: Formula
    text: str
    span: Span


def event_pairs(study: Study, subject: Subject) -> Iterator[tuple[Event, Event]]:
    """The opening and the closing event of each `after_until` whose events read the same signals.

    Events that read different signals can always hold together, and need not: they are no finding.
    """
    for path, scope in _scopes(subject.specification.property):
        if _signals(subject, scope.opening) == _signals(subject, scope.closing):
            opening, closing = ((*path, 0), scope.opening), ((*path, 1), scope.closing)
            yield _event(study, subject, *opening), _event(study, subject, *closing)


def _event(study: Study, subject: Subject, path: Path, predicate: Formula) -> Event:
    text = part_text(study.specification.source, subject.specification, path)
    return Event(predicate, text, subject.specification.spans[path])


def _scopes(node: Property | Formula, path: Path = ()) -> Iterator[tuple[Path, AfterUntil]]:
    if isinstance(node, AfterUntil):
        yield path, node
    if isinstance(node, Property):
        for index, part in enumerate(parts(node)):
            yield from _scopes(part, (*path, index))


def _signals(subject: Subject, event: Formula) -> set[object]:
    names = set(ltl.atoms(event))
    atoms = [atom for atom in subject.specification.atoms if atom.name in names]
    return {key(value) for atom in atoms for value in reads_of(atom.condition)}
