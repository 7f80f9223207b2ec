"""A compiled property as a machine: what was folded, with typed expressions for its atoms, in normal form."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple, assert_never

from ltlc.program.excused import excused
from ltlc.program.expressions import Expression, Kept, Literal, News, Read
from ltlc.program.lowering import condition, lowered, predicate, read, undefined_parts
from ltlc.program.machine import Age, Base, Clock, Machine, Occurrences, Outcome, Register, Set, State
from ltlc.program.normal import normal, pack, positive, reached
from ltlc.program.types import type_of
from ltlc.semantics.diagrams import Diagram, Diagrams
from ltlc.semantics.monitor import Decision, Target
from ltlc.semantics.timed_atoms import Occurred
from ltlc.semantics.timed_monitor import Action, AgeDue, Effect, TimedMonitor
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.atoms import Atom
from ltlc.specification.specification import PropertySpecification


def machine_of(specification: PropertySpecification, monitor: TimedMonitor) -> Machine:
    """The machine that judges a property, of which `monitor` was folded."""
    rows = _Rows(specification, monitor)
    count, inputs = len(rows.states), tuple(map(read, specification.inputs()))
    packed = pack(rows.diagrams, rows.roots(), rows.atoms)
    steps = [step for step in packed.targets[:count] if step is not None]
    found = Machine(
        specification.label,
        specification.text,
        specification.line,
        inputs,
        guards(inputs, specification.atoms),
        packed.atoms,
        (
            *(Clock(None if age is None else _age(specification, age)) for age in monitor.ages),
            *(Clock(occurrences=_count(specification, count)) for count in specification.counts()),
        ),
        tuple(_registers(specification, [monitor.closed[state] for state in rows.states])),
        tuple(map(State, (monitor.verdicts[state] for state in rows.states), steps, packed.targets[count:])),
        packed.decisions,
        packed.outcomes,
        excused(specification),
    )
    return found if found.is_timed else replace(found, clocks=())


class Question(NamedTuple):
    """How an atom of a machine is asked of its property: by one of that one's atoms, or by the negation of one."""

    name: str
    holds: bool


def questions(specification: PropertySpecification) -> dict[Expression, Question]:
    """By what the atoms of the property's machine are asked."""
    found: dict[Expression, Question] = {}
    for atom in specification.atoms:
        expression, holds = positive(condition(atom.condition))
        found.setdefault(expression, Question(atom.name, holds))
    return found


class Words(NamedTuple):
    """Where the machine of a property leads, in the words of the property: that is how verdicts are explained.

    Decisions ask `atoms` of the property and, behind them, clocks, and lead to states. `steps` has where each state
    leads at a step, `expires` where at a clock step: to itself if none comes.
    """

    atoms: tuple[str, ...]
    verdicts: tuple[Verdict, ...]
    steps: tuple[Target, ...]
    expires: tuple[Target, ...]
    decisions: tuple[Decision, ...]


def words(specification: PropertySpecification, machine: Machine) -> Words:
    """The `machine` of a property in its words."""
    asked = questions(specification)
    by = [asked[atom] for atom in machine.atoms]

    def state(target: Target) -> Target:
        return target if target < 0 else machine.outcomes[target].state

    def decision(atom: int, low: Target, high: Target) -> Decision:
        is_so = atom >= len(by) or by[atom].holds
        return Decision(atom, *map(state, (low, high) if is_so else (high, low)))

    return Words(
        tuple(question.name for question in by),
        tuple(each.verdict for each in machine.states),
        tuple(state(each.step) for each in machine.states),
        tuple(number if each.expire is None else state(each.expire) for number, each in enumerate(machine.states)),
        tuple(decision(*each) for each in machine.decisions),
    )


def guards(inputs: Iterable[Read], atoms: Iterable[Atom]) -> tuple[Expression, ...]:
    """What a step of `atoms`, which read `inputs`, must not find to be NaN, each once.

    That is the numbers that are read, and what can be NaN though they are not.
    """
    numbers = (i for i in inputs if i.type.is_number and not isinstance(i, News))
    computed = (normal(lowered(part)) for atom in atoms for part in undefined_parts(atom.condition))
    return tuple(dict.fromkeys([*numbers, *computed]))


def _age(specification: PropertySpecification, age: AgeDue) -> Age:
    return Age(specification.arrival(age.news).signal.name, age.duration)


def _count(specification: PropertySpecification, count: Occurred) -> Occurrences:
    conditions = {atom.name: atom.condition for atom in specification.atoms}
    return Occurrences(
        normal(predicate(count.operand, conditions)), count.begins, count.times, count.within, count.presumed
    )


def _scopes(specification: PropertySpecification) -> list[int]:
    """Of each value at an opening, the number of its scope."""
    clocks = list(specification.openings().values())
    numbers = {clock: number for number, clock in enumerate(dict.fromkeys(clocks))}
    return [numbers[clock] for clock in clocks]


def _registers(specification: PropertySpecification, closed_in: Sequence[Sequence[int]]) -> Iterator[Register]:
    """The values at openings, where `closed_in` has the scopes that are not open in each state.

    If no state determines it, because the first verdict is permanent, they are the latest.
    """
    for opening, scope in zip(specification.openings(), _scopes(specification), strict=True):
        closed = frozenset(q for q, scopes in enumerate(closed_in) if scope in scopes)
        kept = Kept(opening.signal.name, opening.scope, opening.label, type_of(opening.signal))
        yield Register(kept, closed or frozenset(range(len(closed_in))))


class _Rows:
    """The decisions of a folded monitor as diagrams over atoms in normal form, and clocks after them.

    What is counted is asked of its clock, which is late where it does not hold. `states` are those that are left: a
    condition that is always or never true may have led to others.
    """

    def __init__(self, specification: PropertySpecification, monitor: TimedMonitor) -> None:
        self.monitor, self.diagrams = monitor, Diagrams()
        self.counts = [each.name for each in specification.counts()]
        conditions = {atom.name: atom.condition for atom in specification.atoms}
        asked = [name for name in monitor.atoms if name not in self.counts]
        literals = {name: positive(condition(conditions[name])) for name in asked}
        self.atoms = list(dict.fromkeys(atom for atom, _ in literals.values() if not isinstance(atom, Literal)))
        self._asked = [self._literal(*literals[n]) if n in literals else self._reached(n) for n in monitor.atoms]
        self._asked += [self.diagrams.variable(len(self.atoms) + c) for c in range(len(monitor.ages))]
        self._scopes = _scopes(specification)
        self._known: dict[tuple[Target, bool], Diagram] = {}
        self.states, self._waiting = reached(
            lambda state: self.diagrams.values(self._at_step(state)),
            lambda state: self.diagrams.values(self._at_clock_step(state)),
            lambda state: bool(any(monitor.ages) or self.counts) and not monitor.verdicts[state].is_permanent,
        )

    def _reached(self, name: str) -> Diagram:
        clock = len(self.monitor.ages) + self.counts.index(name)
        return self.diagrams.negation(self.diagrams.variable(len(self.atoms) + clock))

    def _literal(self, atom: Expression, holds: bool) -> Diagram:
        if isinstance(atom, Literal):
            return self.diagrams.terminal(atom.value == holds)
        asked = self.diagrams.variable(self.atoms.index(atom))
        return asked if holds else self.diagrams.negation(asked)

    def _at_step(self, state: int) -> Diagram:
        return self._row(self.monitor.edges[state], by_time=False)

    def _at_clock_step(self, state: int) -> Diagram:
        return self._row(self.monitor.held_edges[state], by_time=True)

    def roots(self) -> list[Diagram | None]:
        """Where each state that is left leads at a step, then at a clock step; None where none comes."""
        numbers = {state: number for number, state in enumerate(self.states)}

        def renumbered(row: Diagram) -> Diagram:
            return self.diagrams.combine(lambda outcome: outcome._replace(state=numbers[outcome.state]), row)

        steps = [renumbered(self._at_step(state)) for state in self.states]
        held = [renumbered(self._at_clock_step(q)) if q in self._waiting else None for q in self.states]
        return [*steps, *held]

    def _row(self, target: Target, by_time: bool) -> Diagram:
        key = target, by_time
        if key not in self._known:
            self._known[key] = self._leaf(target, by_time) if target >= 0 else self._branch(target, by_time)
        return self._known[key]

    def _branch(self, target: Target, by_time: bool) -> Diagram:
        question, low, high = self.monitor.decisions[~target]
        return self.diagrams.choose(self._asked[question], self._row(high, by_time), self._row(low, by_time))

    def _leaf(self, target: Target, by_time: bool) -> Diagram:
        state, actions, again, scopes = self.monitor.outcomes[target]
        taken = tuple(register for register, scope in enumerate(self._scopes) if scope in scopes)
        return self.diagrams.terminal(Outcome(state, tuple(_set(each, by_time) for each in actions), again, taken))


def _set(action: Action, by_time: bool) -> Set:
    clock, effect, duration = action
    match effect:
        case Effect.START:
            return Set(clock, Base.NOW, duration)
        case Effect.RELEASE:
            return Set(clock, Base.JUST_BEFORE if by_time else Base.NOW, duration)
        case Effect.EXTEND:
            return Set(clock, Base.DUE, duration)
        case Effect.STOP:
            return Set(clock, Base.NEVER)
        case _:
            assert_never(effect)
