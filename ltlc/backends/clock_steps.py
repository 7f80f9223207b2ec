"""What a property in a compiled language keeps for its clock steps: the conditions, and values for scopes that open."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ltlc.backends.spelling import Speller
from ltlc.backends.statements import Do, Statement
from ltlc.backends.steps import Steps
from ltlc.backends.trees import Code, Prefix, Text
from ltlc.backends.wording import Wording
from ltlc.program.expressions import Kept, Read, parts, replaced
from ltlc.program.machine import Machine
from ltlc.program.normal import normal

NEXT = "_next"
"""Ends the names of members whose values another has after a clock step at which a scope opens."""


class ClockSteps:
    """A clock step judges what `held` at the last step, by atom, and would hold if values at an opening were taken.

    Of what scopes that open at clock steps keep, `taken` has the latest values, by register, and `anew` what would hold
    of them. `registers` are the names of the members that keep the former.
    """

    def __init__(self, machine: Machine, wording: Wording, registers: Mapping[Kept, str]) -> None:
        self._machine, self._wording, self._registers = machine, wording, registers
        self.steps = Steps(machine, self._ask, ["time"], wording, held=True, take=self._take)
        self.held = {atom: f"held_{atom}" for atom in sorted(self.steps.asked_atoms())}
        scopes = {machine.registers[number].kept.scope for outcome in machine.outcomes for number in outcome.taken}
        self.taken = {kept: f"{name}{NEXT}" for kept, name in registers.items() if kept.scope in scopes}
        self.anew = {self.held[atom]: scope for scope in sorted(scopes) for atom in self._reading(scope)}

    def _ask(self, atom: int, holds: bool) -> Code:
        asked = Text(f"{self._wording.own}{self.held[atom]}")
        return asked if holds else Prefix("not ", asked)

    def _reading(self, scope: int) -> list[int]:
        """The atoms that clock steps ask and that read values at the opening of the scope."""
        kept = {each for each in self._registers if each.scope == scope}
        return [atom for atom in self.held if not kept.isdisjoint(parts(self._machine.atoms[atom]))]

    def _take(self, registers: Sequence[int]) -> tuple[Statement, ...]:
        """At a clock step at which scopes open, the values at their openings are those that are held."""
        scopes = {self._machine.registers[number].kept.scope for number in registers}
        names = [self._registers[kept] for kept in self.taken if kept.scope in scopes]
        names += [name for name, scope in self.anew.items() if scope in scopes]
        own = self._wording.own
        return tuple(f"{own}{name} = {own}{name}{NEXT}" for name in names)

    def kept(self, speller: Speller) -> Iterator[Statement]:
        """What a step keeps."""
        own = self._wording.own
        latest: dict[Read, Read] = {register.kept: register.latest for register in self._machine.registers}
        for atom, name in self.held.items():
            asked = self._machine.atoms[atom]
            yield Do(f"{own}{name} = ", speller.code(asked))
            if name in self.anew:
                yield Do(f"{own}{name}{NEXT} = ", speller.code(normal(replaced(asked, latest))))
        for kept, name in self.taken.items():
            yield f"{own}{name} = {speller.names[latest[kept]]}"

    def conditions(self) -> tuple[str, ...]:
        """The members that are conditions."""
        return (*self.held.values(), *(f"{name}{NEXT}" for name in self.anew))
