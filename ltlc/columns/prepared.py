"""What judging by columns needs of properties, made once for all recordings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ltlc.backends.python.plan import ScopePart, scopes
from ltlc.backends.steps import clock_names
from ltlc.columns.atoms import Compared, LoweredAtom, comparisons, lowered_atoms, sides
from ltlc.columns.machine import Slot, machine
from ltlc.columns.tables import Tables
from ltlc.compiler import Compiled
from ltlc.program.expressions import Expression, Read
from ltlc.program.lowering import lowered, read
from ltlc.semantics.denotation import opens_by_itself
from ltlc.semantics.timed_atoms import news_of
from ltlc.semantics.verdicts import Verdict
from ltlc.source import Source
from ltlc.specification.expressions import Field, Signal, inputs
from ltlc.specification.shapes import renamed


@dataclass(frozen=True)
class Prepared:
    """A property: its `atoms`, what these `compare` with constants, and the `sides` of comparisons that may be NaN.

    `tables` are those of its shape, None if there are none. `clocks` are the attributes of its monitor that say when
    its clocks are due. `definitions` are by the names of the signals that it reads and that are computed from others.
    Of each value at an opening, `openings` has the states in which it is the latest; where there are some, nothing is
    compared before, and `sides` has all that is read, too.
    """

    atoms: tuple[LoweredAtom, ...]
    compare: tuple[Compared, ...]
    sides: tuple[Expression, ...]
    slots: tuple[Slot, ...]
    tables: Tables | None
    clocks: tuple[str, ...]
    verdicts: tuple[Verdict, ...]
    definitions: dict[str, Expression]
    inputs: tuple[Read, ...]
    openings: dict[Read, frozenset[int]]


def prepare_all(compiled: Sequence[Compiled], source: Source) -> list[Prepared]:
    """What is needed of properties that `source` has the text of; those of one shape have one table."""
    known: dict[object, Tables | None] = {}
    return [_prepared(of, source, known) for of in compiled]


def _prepared(of: Compiled, source: Source, known: dict[object, Tables | None]) -> Prepared:
    atoms, asked = lowered_atoms(of.specification.atoms), sides(of.specification.atoms)
    slots = tuple(_slots(scopes(of.specification, source), None, 0))
    inputs, openings = of.specification.inputs(), _openings(of)
    reads = tuple(map(read, inputs))
    return Prepared(
        atoms,
        () if openings else comparisons(atoms),
        (*(each for each in reads if each.type.is_number), *asked) if openings else asked,
        slots,
        None if openings else _tables(of, slots, known),
        tuple(clock_names(of.machine)),
        of.program.verdicts,
        dict(pair for each in inputs for pair in _definitions(each.signal)),
        reads,
        openings,
    )


def _openings(of: Compiled) -> dict[Read, frozenset[int]]:
    """The values at an opening, and in which states each is the latest one: in all, where none tells."""
    clocks, closed = of.specification.openings(), of.program.closed
    scopes = list(dict.fromkeys(clocks.values()))
    found = {
        read(opening): frozenset(state for state, numbers in enumerate(closed) if scopes.index(clock) in numbers)
        for opening, clock in clocks.items()
    }
    return {kept: states or frozenset(range(len(closed))) for kept, states in found.items()}


def _tables(of: Compiled, slots: tuple[Slot, ...], known: dict[object, Tables | None]) -> Tables | None:
    if any(opens_by_itself(slot.opening, slot.closing) for slot in slots):
        return None
    atoms, news = (tuple(each.name for each in some) for some in (of.specification.atoms, news_of(of.formula)))
    names = {atom: str(number) for number, atom in enumerate(atoms)}
    key = renamed((of.program, atoms, news, of.specification.alphabet, slots), names)
    if key not in known:
        made = machine(*key)
        known[key] = Tables(made) if made is not None and made.stutters else None
    return known[key]


def _slots(parts: Sequence[ScopePart], parent: int | None, first: int) -> Iterator[Slot]:
    """The scopes of a property, each before those in its body; `first` is the number of the first one."""
    for part in parts:
        inside = list(_slots(part.inner, first, first + 1))
        yield Slot(part.opening, part.closing, part.overlapping, parent)
        yield from inside
        first += 1 + len(inside)


def _definitions(signal: Signal) -> Iterator[tuple[str, Expression]]:
    """What signals are computed from: `signal`, and those that it is computed from."""
    if not isinstance(signal.definition, Field):
        yield signal.name, lowered(signal.definition)
        for part in inputs(signal.definition):
            yield from _definitions(part.signal)
