"""What judging by columns needs of properties, made once for all recordings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import count
from typing import NamedTuple

from ltlc.backends.counts import Counting
from ltlc.backends.python.monitors import counted
from ltlc.backends.python.plan import ScopePart, scopes
from ltlc.backends.steps import clock_names
from ltlc.base.source import Source
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.monitoring.columns.atoms import Compared, LoweredAtom, comparisons, lowered_atoms
from ltlc.monitoring.columns.control import Control
from ltlc.monitoring.columns.machine import Slot, machine
from ltlc.monitoring.columns.pauses import MOST_DURATION
from ltlc.monitoring.columns.tables import Tables
from ltlc.program.as_new import states_as_new
from ltlc.program.expressions import Expression, Kept, News, Read
from ltlc.program.lowering import has_sample, lowered
from ltlc.program.machine import State
from ltlc.program.properties import questions
from ltlc.semantics.denotation import opens_by_itself
from ltlc.semantics.timed_atoms import news_of
from ltlc.specification.expressions import Field, Signal
from ltlc.specification.shapes import renamed
from ltlc.specification.specification import Slicing


class Definition(NamedTuple):
    """How a signal is computed, and when it has a sample: that is true if always."""

    value: Expression
    has_sample: Expression


@dataclass(frozen=True)
class Prepared:
    """A property: its `atoms`, what these `compare` with constants, and the `guards` that must not be NaN.

    `tables` are those of its shape, None if there are none. `clocks` are the attributes of its monitor that say when
    its clocks are due, but for its `counts`, whose letters stand behind those of atoms. `states` are its machine's.
    `definitions` are by the names of the signals that it reads and that are computed from others. Of each value at an
    opening, `openings` has the states in which it is the latest; where there are some, nothing is compared before.
    """

    atoms: tuple[LoweredAtom, ...]
    compare: tuple[Compared, ...]
    guards: tuple[Expression, ...]
    slots: tuple[Slot, ...]
    tables: Tables | None
    clocks: tuple[str, ...]
    states: tuple[State, ...]
    definitions: dict[str, Definition]
    inputs: tuple[Read, ...]
    counts: tuple[Counting, ...]
    openings: dict[Kept, frozenset[int]]


def prepare_all(compiled: Sequence[Compiled], source: Source) -> list[Prepared]:
    """What is needed of properties that `source` has the text of; those of one shape have one table."""
    known: dict[object, Tables | None] = {}
    return [_prepared(of, source, known) for of in compiled]


def _prepared(of: Compiled, source: Source, known: dict[object, Tables | None]) -> Prepared:
    runs, atoms = of.machine, lowered_atoms(of.specification.atoms)
    slots = tuple(_slots(scopes(of.specification, source), None, 0))
    openings = {register.kept: register.closed for register in runs.registers}
    return Prepared(
        atoms,
        () if openings else comparisons(atoms),
        runs.guards,
        slots,
        None if openings else _tables(of, slots, known),
        tuple(name for name, clock in zip(clock_names(runs), runs.clocks, strict=True) if clock.occurrences is None),
        runs.states,
        dict(pair for each in of.specification.inputs() for pair in _definitions(each.signal)),
        runs.inputs,
        tuple(counted(of)),
        openings,
    )


def _tables(of: Compiled, slots: tuple[Slot, ...], known: dict[object, Tables | None]) -> Tables | None:
    if not of.specification.atoms or any(opens_by_itself(slot.opening, slot.closing) for slot in slots):
        return None
    if any((each.of.duration or 0) > MOST_DURATION for each in counted(of)):
        return None
    atoms, news = (tuple(each.name for each in some) for some in (of.specification.atoms, news_of(of.formula)))
    names = {atom: str(number) for number, atom in enumerate(atoms)}
    control = _control(of)
    counts = tuple(clock for clock in control.clocks if isinstance(clock, str))
    key = renamed((control, atoms + counts, news, of.specification.alphabet, slots), names)
    may_pause = of.specification.slicing is None
    if (key, may_pause) not in known:
        pausing = partial(machine, *key, has_pauses=True) if may_pause else None
        plain = machine(*key)
        made = pausing() if plain is None and pausing is not None else plain
        known[key, may_pause] = None if made is None else Tables(made, pausing if None in control.clocks else None)
    return known[key, may_pause]


def _control(of: Compiled) -> Control:
    runs, asked = of.machine, questions(of.specification)
    counts = map(str, count(len(of.specification.atoms)))
    clocks = (
        next(counts) if occurrences else age and (asked[News(age.signal)].name, age.duration)
        for age, occurrences in runs.clocks
    )
    by_atom = tuple(asked[atom] for atom in runs.atoms)
    slicing = of.specification.slicing
    as_new = states_as_new(runs, of.specification, slicing) if isinstance(slicing, Slicing) else frozenset[int]()
    return Control(by_atom, tuple(clocks), runs.states, runs.decisions, runs.outcomes, as_new)


def _slots(parts: Sequence[ScopePart], parent: int | None, first: int) -> Iterator[Slot]:
    """The scopes of a property, each before those in its body; `first` is the number of the first one."""
    for part in parts:
        inside = list(_slots(part.inner, first, first + 1))
        yield Slot(part.opening, part.closing, part.overlapping, parent)
        yield from inside
        first += 1 + len(inside)


def _definitions(signal: Signal) -> Iterator[tuple[str, Definition]]:
    """What signals are computed from: `signal`, and those that it is computed from."""
    if not isinstance(signal.definition, Field):
        yield signal.name, Definition(lowered(signal.definition), has_sample(signal))
    for part in signal.inputs:
        yield from _definitions(part.signal)
