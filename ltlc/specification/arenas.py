"""The arenas of a specification: guards, put together as far as they share properties, and what they have to keep."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple, assert_never

from ltlc.semantics.arenas import Arena, Part, Sending
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.timed_atoms import counts_of
from ltlc.specification.alphabet import alphabet
from ltlc.specification.arrivals import waited_for
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import (
    Comparison,
    Condition,
    IsTrue,
    New,
    Past,
    Read,
    Recent,
    Same,
    openings,
    operands,
    reads,
)
from ltlc.specification.fallbacks import condition_after
from ltlc.specification.guards import Fallback, Guard
from ltlc.specification.specification import PropertySpecification, topics, topics_of
from ltlc.specification.text import ordering_text, text


class Property(NamedTuple):
    """A property with what was made of it."""

    specification: PropertySpecification
    formula: Formula
    monitor: Monitor


def is_in_game(property_: PropertySpecification, guards: Iterable[Guard]) -> bool:
    """Whether `guards` keep a property, or rely on it; one of `each` is watched only."""
    sent = {guard.out for guard in guards}
    return property_.slicing is None and (property_.is_assumed or not sent.isdisjoint(topics(property_)))


def together(guards: Sequence[Guard], properties: Iterable[PropertySpecification]) -> list[tuple[Guard, ...]]:
    """The guards in sets that share no property that is kept."""
    sets = [{n} for n in range(len(guards))]
    for each in properties:
        shared = [s for s in sets if not each.is_assumed and is_in_game(each, (guards[n] for n in s))]
        if len(shared) > 1:
            sets = [*(some for some in sets if some not in shared), set[int]().union(*shared)]
    return [tuple(guards[n] for n in sorted(some)) for some in sorted(sets, key=min)]


def conditions_held(guards: Sequence[Guard], properties: Iterable[PropertySpecification]) -> dict[str, Atom]:
    """The conditions on values that are followed in the game of `guards` about `properties`, by their names.

    Some are there only because a fallback leads to them.
    """
    return _with_effects(guards, properties)[0]


def arena_of(guards: Sequence[Guard], properties: Iterable[Property]) -> Arena:
    """What the game of `guards` about `properties` is played on."""
    parts = [each for each in properties if is_in_game(each.specification, guards)]
    outs = tuple(guard.out for guard in guards)
    sendings = _sendings(guards)
    atoms, effects = _with_effects(guards, (each.specification for each in parts))
    read = {name: frozenset(topics_read(atom)) for name, atom in atoms.items()}
    counts = {count.name: frozenset[str]() for p in parts for count in counts_of(p.formula)}
    loose = frozenset({*counts, *(name for name, atom in atoms.items() if _has_openings(atom))})
    unknown = dict.fromkeys(loose)
    return Arena(
        outs,
        tuple(dict.fromkeys(t for p in parts for t in topics(p.specification) if t not in outs)),
        alphabet(atoms.values()),
        read | counts,
        loose,
        tuple(Sending(f.name, g.out, e | unknown) for (g, f), e in zip(sendings, effects, strict=True)),
        tuple(_part(each, outs) for each in parts),
    )


def _sendings(guards: Iterable[Guard]) -> list[tuple[Guard, Fallback]]:
    return [(guard, fallback) for guard in guards for fallback in guard.fallbacks]


def _with_effects(
    guards: Sequence[Guard], properties: Iterable[PropertySpecification]
) -> tuple[dict[str, Atom], list[dict[str, bool | str | None]]]:
    """The conditions, and what each is after each fallback.

    That may be a condition on what was held that no property has: it is followed as the others are.
    """
    own = (each for each in properties if is_in_game(each, guards))
    atoms = {atom.name: atom for each in own for atom in each.atoms if not _is_news(atom)}
    sendings = _sendings(guards)
    effects: list[dict[str, bool | str | None]] = [{} for _ in sendings]
    names = list(atoms)
    for name in names:
        for (guard, fallback), effect in zip(sendings, effects, strict=True):
            is_loose = _has_openings(atoms[name])
            condition = None if is_loose else condition_after(atoms[name].condition, guard.out, fallback)
            if condition is None or isinstance(condition, bool):
                effect[name] = condition
                continue
            same = next((other for other, atom in atoms.items() if atom.condition == condition), None)
            if same is None:
                same = _condition_text(condition)
                atoms[same] = Atom(same, condition, atoms[name].span)
                names.append(same)
            effect[name] = same
    return atoms, effects


def _condition_text(condition: Condition) -> str:
    match condition:
        case Comparison():
            return ordering_text(condition)
        case Same(left, right):
            return f"{text(left)} == {text(right)}"
        case IsTrue(operand):
            return text(operand)
        case _:
            assert_never(condition)


def _part(of: Property, outs: Sequence[str]) -> Part:
    specification = of.specification
    back = (
        read.samples
        for atom in specification.atoms
        for read in _reads(atom)
        if isinstance(read, Past | Recent) and not set(topics_of(read.signal)).isdisjoint(outs)
    )
    news = {atom.name: operand for atom in specification.atoms for operand in _reads(atom) if isinstance(operand, New)}
    return Part(
        specification.label,
        of.formula,
        of.monitor,
        frozenset(topics(specification)),
        frozenset(t for wanted in waited_for(specification) for t in topics_of(wanted.signal)),
        {name: topics_of(new.signal)[0] for name, new in news.items()},
        max(back, default=0),
        specification.is_assumed,
    )


def _reads(atom: Atom) -> Iterator[Read]:
    return (read for operand in operands(atom.condition) for read in reads(operand))


def _is_news(atom: Atom) -> bool:
    return any(isinstance(read, New) for read in _reads(atom))


def _has_openings(atom: Atom) -> bool:
    return any(True for operand in operands(atom.condition) for _ in openings(operand))


def topics_read(atom: Atom) -> Iterator[str]:
    """The topics of what a condition reads."""
    return (topic for read in _reads(atom) for topic in topics_of(read.signal))
