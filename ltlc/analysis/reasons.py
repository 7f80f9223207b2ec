"""Why a property has no run, or cannot fail: its events and state predicates that never, or always, hold."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from ltlc.analysis.predicates import is_possible
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import part_text
from ltlc.base.diagnostics import Label
from ltlc.base.source import Source
from ltlc.semantics import ltl
from ltlc.semantics.encodings import encode
from ltlc.semantics.ltl import Formula, Not
from ltlc.semantics.properties import And, Now, Property, Throughout
from ltlc.specification.expressions import Current, Past, operands
from ltlc.specification.numbers import numbers_of
from ltlc.specification.specification import Path, parts
from ltlc.specification.text import text
from ltlc.specification.wire import Kind

MOST_CONJUNCTS = 12
"""A conjunction of more parts than this is not searched for those that conflict."""

MOST_ATOMS = 3
"""How many atoms that exclude one another are looked for."""


def labels(source: Source, subject: Subject) -> tuple[Label, ...]:
    """The state predicates of the property whose truth does not depend on the step, with what they are."""
    found: list[Label] = []
    for path, predicate in state_predicates(subject.specification.property):
        verdict = constant(predicate, subject)
        if verdict is not None:
            part = part_text(source, subject.specification, path)
            why = exclusion(predicate, subject) if verdict == "never" else ""
            why = why or _range(predicate, subject)
            found.append(Label(subject.specification.spans[path], f"`{part}` {verdict} holds{why}"))
    return tuple(found)


def _range(predicate: Formula, subject: Subject) -> str:
    """What follows from the type of a field, in words, if `predicate` is about one whole number only."""
    asked = ltl.atoms(predicate)
    compared = {e for atom in subject.specification.atoms if atom.name in asked for e in operands(atom.condition)}
    fields = [e for e in compared if isinstance(e, Current | Past)]
    if len(fields) != 1 or numbers_of(fields[0]).kind is not Kind.INTEGER:
        return ""
    numbers = numbers_of(fields[0])
    return f": `{text(fields[0])}` is a whole number from {numbers.least} to {numbers.most}"


def conflict(study: Study, subject: Subject) -> tuple[Label, ...]:
    """Two or three parts, joined by `and`, that cannot hold together; nothing if that is not the reason."""
    joined = list(_conjuncts(subject.specification.property))
    words = [study.languages.of(encode(part, study.encoding)) for _, part in joined]
    for count in (2, 3):
        for chosen in combinations(range(len(joined)) if len(joined) <= MOST_CONJUNCTS else (), count):
            if not study.languages.compatible([words[number] for number in chosen]):
                spans = [subject.specification.spans[joined[number][0]] for number in chosen]
                return tuple(Label(span, "cannot hold together with the other") for span in spans)
    return ()


def _conjuncts(node: Property, path: Path = ()) -> Iterator[tuple[Path, Property]]:
    """The properties that a property joins by `and`, with their places."""
    if not isinstance(node, And):
        yield path, node
        return
    for index, part in enumerate((node.left, node.right)):
        yield from _conjuncts(part, (*path, index))


def state_predicates(node: Property | Formula, path: Path = ()) -> Iterator[tuple[Path, Formula]]:
    """The events and state predicates of a property that are not part of a larger one, with their places."""
    if isinstance(node, Now | Throughout):
        yield path, node.predicate
    elif isinstance(node, Formula):
        yield path, node
    else:
        for index, part in enumerate(parts(node)):
            yield from state_predicates(part, (*path, index))


def constant(predicate: Formula, subject: Subject) -> str | None:
    """`always` or `never` if `predicate`, which is not written as a constant, has one value at all steps."""
    if not ltl.atoms(predicate):
        return None
    if not is_possible(predicate, subject.alphabet):
        return "never"
    return None if is_possible(Not(predicate), subject.alphabet) else "always"


def exclusion(predicate: Formula, subject: Subject) -> str:
    """Atoms of `predicate` that cannot hold together, in words; empty if there are none or too many."""
    names = () if isinstance(predicate, ltl.Atom) else ltl.atoms(predicate)
    for count in range(1, min(MOST_ATOMS, len(names)) + 1):
        for chosen in combinations(names, count):
            if not is_possible(ltl.conjunction(ltl.Atom(name) for name in chosen), subject.alphabet):
                together = " together" if count > 1 else ""
                return ": there is no value for " + " and ".join(f"`{name}`" for name in chosen) + together
    return ""
