"""Machines that go on after a violation: what they say of the past is said of the whole run.

A fresh monitor would know nothing of what came before. So of a property that reads the past, the rest of the run is
judged as the body of `after MARK, P` is, where the mark is put at the first instant, and at that after each violation.
"""

from __future__ import annotations

from collections.abc import Container, Hashable, Sequence
from dataclasses import replace
from functools import cached_property

from ltlc.automata import Budget, Exceeded, Task, translate_all
from ltlc.automata.folding import fold
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.program.machine import Machine
from ltlc.program.properties import machine_of
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.encodings import encode_from
from ltlc.semantics.ltl import Atom
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.openings import scope_clocks
from ltlc.semantics.properties import After
from ltlc.semantics.timed_atoms import Age, Late, News, timed_atoms
from ltlc.semantics.verdicts import Verdict

MARK = "from here on"
"""The atom from which on a property is judged anew."""

_KNOWN: dict[Hashable, Monitor | Exceeded] = {}
"""The monitors made so far, by their shapes: who judges many recordings judges by the same properties."""


@dataclass(frozen=True)
class Restarting(Compiled):
    """A property whose machine restarts: it goes on after a violation, with the past as it was.

    Its formula is that of the property on the rest of the run from `MARK` on, which the machine puts itself.
    """

    @cached_property
    def machine(self) -> Machine:
        """What runs."""
        of = self.specification
        marked = After(Atom(MARK), of.property)
        moved = zip(scope_clocks(of.property)[1:], scope_clocks(marked)[2:], strict=True)
        scopes = {to: of.scopes()[clock] for clock, to in moved if clock in of.scopes() and clock and to}
        return machine_of(of, fold(self.formula, _with_mark(of.alphabet), self.monitor, scopes, MARK))


def restarting(compiled: Sequence[Compiled]) -> list[Restarting]:
    """Those of the properties that read the past, with machines that restart; not those that it is too hard for."""
    reading = [each for each in compiled if _reads_past(each)]
    formulas = [encode_from(Atom(MARK), each.specification.property, each.encoding) for each in reading]
    tasks = [Task(f, _with_mark(each.specification.alphabet)) for f, each in zip(formulas, reading, strict=True)]
    return [
        Restarting(each.specification, each.encoding, formula, outcome)
        for each, formula, outcome in zip(reading, formulas, translate_all(tasks, Budget(), known=_KNOWN), strict=True)
        if not isinstance(outcome, Exceeded)
    ]


def _with_mark(alphabet: Alphabet) -> Alphabet:
    return replace(alphabet, atoms=(*alphabet.atoms, MARK))


def can_recur(compiled: Compiled, again: Container[str]) -> bool:
    """Whether violations after the first one are looked for, where `again` has the properties that restart."""
    of = compiled.specification
    return of.slicing is None and (of.label in again or not _reads_past(compiled))


def _reads_past(compiled: Compiled) -> bool:
    can_recur = compiled.specification.slicing is None and Verdict.VIOLATED in compiled.monitor.verdicts[1:]
    return can_recur and not all(isinstance(a, News | Age | Late) for a in timed_atoms(compiled.formula))
