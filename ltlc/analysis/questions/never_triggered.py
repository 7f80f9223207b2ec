"""Is there an event that cannot occur in any run that satisfies the property, or that other properties exclude?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis import reasons
from ltlc.analysis.findings import Finding
from ltlc.analysis.predicates import is_possible
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import part_at, part_text
from ltlc.automata.languages import Language
from ltlc.base.diagnostics import Label
from ltlc.dataclass import dataclass
from ltlc.semantics import ltl
from ltlc.semantics.ltl import Formula, eventually
from ltlc.semantics.properties import After, AfterUntil, Eventually, Now, Property, Until
from ltlc.specification.specification import Path, parts

NEVER_TESTED = "the body of this scope is never tested; check the event"


@dataclass(frozen=True, slots=True)
class Event:
    """An event of a property: the place of its text, when it counts, and whether the scope's property needs it."""

    path: Path
    predicate: Formula
    role: str
    opens: bool


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning for each event that cannot occur; about the property by itself first, then with one other at a time."""
    if not subject.is_contingent:
        return
    excluded = impossible(study, subject)
    for event in events(subject.specification.property):
        if event in excluded:
            yield _excluded_by_itself(study, subject, event)
            continue
        excluding = _excluding(study, subject, _occurrence(study, event))
        if excluding is not None:
            yield _excluded_by(study, subject, event, excluding)


def impossible(study: Study, subject: Subject) -> list[Event]:
    """The events that no run has that satisfies the property."""
    own = study.words[subject.number]
    return [
        event
        for event in events(subject.specification.property)
        if not study.compatible([own, _occurrence(study, event)])
    ]


def _occurrence(study: Study, event: Event) -> Language:
    """The runs in which the event occurs."""
    return study.languages.of(eventually(event.predicate))


def events(node: Property | Formula, path: Path = ()) -> Iterator[Event]:
    """The events of `node`, outer ones first."""
    match node:
        case After(event, _):
            yield Event((*path, 0), event, "opens the scope", opens=True)
        case Until(event, _):
            yield Event((*path, 0), event, "ends the scope", opens=False)
        case AfterUntil(opening, closing, _):
            yield Event((*path, 0), ltl.And(opening, ltl.Not(closing)), "opens an episode", opens=True)
            yield Event((*path, 1), closing, "closes an episode", opens=False)
        case _:
            pass
    if isinstance(node, Property):
        for index, part in enumerate(parts(node)):
            yield from events(part, (*path, index))


def _excluding(study: Study, subject: Subject, occurs: Language) -> Subject | None:
    """The first other property with which the event cannot occur, though the two properties can hold together.

    None that excludes events of its own: that is reported there, and is no reason here.
    """
    own = study.words[subject.number]
    for number in sorted(study.neighbours[subject.number]):
        other, word = study.subjects[number], study.words[number]
        excludes = not study.compatible([own, occurs, word]) and study.compatible([own, word])
        if excludes and not has_dead_scope(study, other):
            return other
    return None


def has_dead_scope(study: Study, subject: Subject) -> bool:
    """Whether the property forbids an event that opens a scope of its own."""
    return any(event.opens for event in impossible(study, subject))


def is_untested(study: Study, subject: Subject, other: Subject) -> bool:
    """Whether an event that opens a scope of the property cannot occur in runs that satisfy `other`."""
    word = study.words[other.number]
    opening = [event for event in events(subject.specification.property) if event.opens]
    return any(not study.compatible([word, _occurrence(study, event)]) for event in opening)


def _excluded_by_itself(study: Study, subject: Subject, event: Event) -> Finding:
    text = part_text(study.specification.source, subject.specification, event.path)
    if is_possible(event.predicate, subject.alphabet):
        message = f"`{text}` never happens in a run that satisfies `{subject.label}`"
        label = f"what {event.role} makes the property fail"
    else:
        message = f"`{text}`, which {event.role} of `{subject.label}`, can never happen"
        label = "no values of the signals make this true"
    return Finding(
        "LTL505",
        subject.specification.spans[event.path],
        message,
        label=label,
        secondary=reasons.labels(study.specification.source, subject),
        help=_after_the_end(study, subject, event) or NEVER_TESTED,
        example=study.example_step(event.predicate, "a step with the event", subject),
    )


def _after_the_end(study: Study, subject: Subject, event: Event) -> str:
    """The message if an episode must reach something that holds only when it is over; otherwise empty."""
    scope = part_at(subject.specification.property, event.path[:-1])
    match scope:
        case AfterUntil(_, closing, Eventually(Now(wanted))) if event.opens:
            in_time = ltl.And(wanted, ltl.Not(closing))
            if is_possible(in_time, subject.alphabet) or not is_possible(wanted, subject.alphabet):
                return ""
            body = (*event.path[:-1], 2, 0)
            text = part_text(study.specification.source, subject.specification, body)
            return f"an episode ends at the step that closes it, and `{text}` holds at no step before that"
    return ""


def _excluded_by(study: Study, subject: Subject, event: Event, other: Subject) -> Finding:
    text = part_text(study.specification.source, subject.specification, event.path)
    both = (subject, other)
    return Finding(
        "LTL505",
        subject.specification.spans[event.path],
        f"`{text}`, which {event.role} of `{subject.label}`, never happens while `{other.label}` holds",
        secondary=(Label(other.specification.span, "this property excludes it"),),
        help="the body of this scope is tested only if the other property is violated",
        example=study.example_step(event.predicate, "a step with the event", *both),
    )
