"""Does a part of the property wait for a signal that it does not read?"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import listed, part_text
from ltlc.semantics.properties import SOME_STEP, And, Property, predicates
from ltlc.semantics.timed_atoms import atoms_within
from ltlc.specification.arrivals import waited_for
from ltlc.specification.expressions import Input
from ltlc.specification.specification import Path, PropertySpecification


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A note for the first of several parts joined by `and` that could begin before the whole does."""
    specification = subject.specification
    waited = waited_for(specification)
    for path, part in _conjuncts(specification.property):
        own = _waited_alone(specification, part)
        others = [wanted for wanted in waited if own is not None and wanted not in own]
        if path and others:
            yield _finding(study, specification, path, others)
            return


def _conjuncts(node: Property, path: Path = ()) -> Iterator[tuple[Path, Property]]:
    match node:
        case And(left, right) if left != SOME_STEP:
            yield from _conjuncts(left, (*path, 0))
            yield from _conjuncts(right, (*path, 1))
        case _:
            yield path, node


def _waited_alone(specification: PropertySpecification, part: Property) -> tuple[Input, ...] | None:
    """What `part` would wait for as a property of its own; None if it reads nothing."""
    names = {atom.name for predicate in predicates(part) for atom in atoms_within(predicate)}
    read = tuple(atom for atom in specification.atoms if atom.name in names)
    return waited_for(replace(specification, property=part, atoms=read)) if read else None


def _finding(study: Study, specification: PropertySpecification, path: Path, others: list[Input]) -> Finding:
    text = part_text(study.specification.source, specification, path)
    names = listed([f"`{name}`" for name in dict.fromkeys(wanted.signal.name for wanted in others)])
    return Finding(
        "LTL524",
        specification.spans[path],
        f"`{text}` waits for {names}, which it does not read: `{specification.label}` begins as a whole",
        label="what comes before that is not judged",
        help="make it a separate property, which begins on its own",
    )
