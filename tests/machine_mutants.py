"""Machines that are wrong in one place: every field of every part, changed to what it might have been instead."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from ltlc.program.expressions import Apply, Count, Each, Expression, Held, Kept, Literal, News, Slice, Slope
from ltlc.program.functions import ROWS, Primitive
from ltlc.program.machine import Age, Base, Clock, Machine, Outcome, Set
from ltlc.semantics.verdicts import Verdict

Mutant = tuple[str, Machine]
"""What is changed, and the machine with the change."""

DAY = 86_400 * 10**9


def mutants(machine: Machine) -> Iterator[Mutant]:
    """All that are different as data."""
    found = (*_reads(machine), *_atoms(machine), *_registers(machine), *_states(machine), *_outcomes(machine))
    return ((what, mutant) for what, mutant in found if mutant != machine)


def _put(items: tuple[Any, ...], number: int, *instead: Any) -> tuple[Any, ...]:
    return (*items[:number], *instead, *items[number + 1 :])


def _reads(machine: Machine) -> Iterator[Mutant]:
    for number, each in enumerate(machine.inputs):
        yield "inputs", replace(machine, inputs=_put(machine.inputs, number))
        for other in expressions(each):
            yield "inputs", replace(machine, inputs=_put(machine.inputs, number, other))
    for number in range(len(machine.guards)):
        yield "guards", replace(machine, guards=_put(machine.guards, number))
    for clocks in (machine.clocks[:-1], (*machine.clocks, Clock())):
        yield "clocks", replace(machine, clocks=clocks)
    for number, clock in enumerate(machine.clocks):
        for age in _ages(clock.age):
            yield "clocks", replace(machine, clocks=_put(machine.clocks, number, Clock(age)))


def _ages(age: Age | None) -> Iterator[Age | None]:
    if age is None:
        yield Age("speed", 10**9)
        return
    yield None
    yield age._replace(signal=f"{age.signal}2")
    yield from (age._replace(duration=age.duration + more) for more in (1, -1, DAY))


def _atoms(machine: Machine) -> Iterator[Mutant]:
    for number, atom in enumerate(machine.atoms):
        for other in (*expressions(atom), *machine.atoms):
            yield "atoms", replace(machine, atoms=_put(machine.atoms, number, other))
    for number, guard in enumerate(machine.guards):
        for other in expressions(guard):
            yield "guards", replace(machine, guards=_put(machine.guards, number, other))


def _registers(machine: Machine) -> Iterator[Mutant]:
    for number, register in enumerate(machine.registers):
        for state in range(len(machine.states)):
            other = register._replace(closed=register.closed ^ {state})
            yield "closed", replace(machine, registers=_put(machine.registers, number, other))
        for kept in expressions(register.kept):
            other = register._replace(kept=kept)
            yield "kept", replace(machine, registers=_put(machine.registers, number, other))
        yield "registers", replace(machine, registers=_put(machine.registers, number))


def _states(machine: Machine) -> Iterator[Mutant]:
    targets = [*range(len(machine.outcomes)), *(~number for number in range(len(machine.decisions)))]
    for number, state in enumerate(machine.states):
        others = [("verdict", state._replace(verdict=verdict)) for verdict in Verdict]
        others += [("step", state._replace(step=target)) for target in targets]
        others += [("expire", state._replace(expire=target)) for target in (*targets, None)]
        for what, other in others:
            yield what, replace(machine, states=_put(machine.states, number, other))
    for number, decision in enumerate(machine.decisions):
        swapped = decision._replace(low=decision.high, high=decision.low)
        asked = [decision._replace(atom=question) for question in range(len(machine.atoms) + len(machine.clocks))]
        for changed in (swapped, *asked):
            yield "decisions", replace(machine, decisions=_put(machine.decisions, number, changed))


def _outcomes(machine: Machine) -> Iterator[Mutant]:
    for number, outcome in enumerate(machine.outcomes):
        for what, other in _other_outcomes(machine, outcome):
            yield what, replace(machine, outcomes=_put(machine.outcomes, number, other))


def _other_outcomes(machine: Machine, outcome: Outcome) -> Iterator[tuple[str, Outcome]]:
    yield "again", outcome._replace(again=not outcome.again)
    for state in range(len(machine.states)):
        yield "state", outcome._replace(state=state)
    for register in range(len(machine.registers)):
        yield "taken", outcome._replace(taken=tuple(sorted({*outcome.taken} ^ {register})))
    for number, each in enumerate(outcome.sets):
        yield "sets", outcome._replace(sets=_put(outcome.sets, number))
        others = [each._replace(base=base) for base in Base]
        others += [each._replace(duration=each.duration + more) for more in (1, -1, DAY)]
        for other in others:
            yield "sets", outcome._replace(sets=_put(outcome.sets, number, other))
    for clock in range(len(machine.clocks)):
        for base in Base:
            yield "sets", outcome._replace(sets=(*outcome.sets, Set(clock, base, 10**9)))


def expressions(expression: Expression) -> Iterator[Any]:
    """Other expressions of the same type: one thing in it changed."""
    yield from (each for each in _here(expression) if each.type == expression.type and each != expression)
    match expression:
        case Apply(primitive, arguments):
            for number, argument in enumerate(arguments):
                for other in expressions(argument):
                    yield Apply(primitive, _put(arguments, number, other))
        case Count(lists, guard):
            for other in expressions(guard):
                yield replace(expression, guard=other)
            for place, arrays in enumerate(lists):
                for number, array in enumerate(arrays):
                    for other in expressions(array):
                        yield replace(expression, lists=_put(lists, place, _put(arrays, number, other)))
            if len(lists) > 1:
                yield replace(expression, lists=(expression.arrays,))
        case Slice(array) | Each(array):
            for other in expressions(array):
                yield replace(expression, array=other)
        case _:
            pass


def _here(expression: Expression) -> Iterator[Expression]:
    match expression:
        case Literal(bool(value)):
            yield replace(expression, value=not value)
        case Literal(int(value)):
            yield from (replace(expression, value=other) for other in (value + 1, value - 1, -value))
        case Literal(float(value)):
            neighbours = math.nextafter(value, math.inf), math.nextafter(value, -math.inf), -value, value + 1
            yield from (replace(expression, value=other) for other in neighbours)
        case Literal(str(value)):
            yield replace(expression, value=f"{value} ")
        case Held(signal, ago):
            yield replace(expression, ago=ago + 1)
            yield replace(expression, signal=f"{signal}2")
        case Slope(signal) | News(signal) | Kept(signal):
            yield replace(expression, signal=f"{signal}2")
        case Slice(array, start, stop):
            yield array
            yield replace(expression, start=(start or 0) + 1)
            yield replace(expression, stop=None if stop else 3)
        case Count():
            yield replace(expression, is_any=not expression.is_any)
        case Apply(_, arguments):
            yield from _applied(arguments)
        case _:
            pass
    if isinstance(expression, Apply):
        yield from expression.arguments


def _applied(arguments: tuple[Expression, ...]) -> Iterator[Expression]:
    for ordered in (arguments, arguments[::-1], arguments[:-1]):
        types = tuple(argument.type for argument in ordered)
        for primitive in Primitive:
            if types and ROWS[primitive].typed(types) is not None:
                yield Apply(primitive, ordered)
