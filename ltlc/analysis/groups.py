"""Which atoms constrain one another: those that are computed from a common value."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence

from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import (
    Condition,
    Current,
    Input,
    Opening,
    Past,
    Read,
    Recent,
    Signal,
    operands,
    reads,
)


def reads_of(condition: Condition) -> tuple[Read, ...]:
    """The values of signals that `condition` is computed from, each once."""
    return tuple(dict.fromkeys(i for expression in operands(condition) for i in reads(expression)))


def key(value: Read) -> Hashable:
    """What a value is, whatever the author calls it: two names of one field of a topic are the same value."""
    match value:
        case Past(signal, samples):
            return Past, samples, source(signal)
        case Recent(signal, samples):
            return Recent, samples, source(signal)
        case Opening(signal, scope, label):
            return Opening, (scope, label), source(signal)
        case _:
            return type(value), source(value.signal)


def source(signal: Signal) -> Hashable:
    """Where the samples of `signal` come from."""
    return (signal.definition, signal.when, signal.otherwise) if signal.is_taken else signal.definition


def grouped(atoms: Sequence[Atom], through_definitions: bool) -> list[tuple[Atom, ...]]:
    """`atoms` in groups that have no value in common, in the order of their first atoms.

    With `through_definitions`, a speed also goes with its components if atoms read both.
    """
    direct = {key(value) for atom in atoms for value in reads_of(atom.condition)}
    groups: list[tuple[set[Hashable], list[int]]] = []
    for number, atom in enumerate(atoms):
        keys = set(_keys(atom, through_definitions)) & direct
        members = [number]
        for group in [g for g in groups if not g[0].isdisjoint(keys)]:
            groups.remove(group)
            keys |= group[0]
            members = group[1] + members
        groups.append((keys, sorted(members)))
    return [tuple(atoms[n] for n in members) for _, members in sorted(groups, key=lambda g: g[1])]


def _keys(atom: Atom, through_definitions: bool) -> Iterator[Hashable]:
    for value in reads_of(atom.condition):
        yield key(value)
        if through_definitions and isinstance(value, Current):
            yield from (key(part) for part in definition_inputs(value.signal))


def definition_inputs(signal: Signal) -> Iterator[Input]:
    """The values that `signal` is computed from, and those that they are computed from, and so on."""
    for part in signal.inputs:
        yield part
        if isinstance(part, Current):
            yield from definition_inputs(part.signal)
