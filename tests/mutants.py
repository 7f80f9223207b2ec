"""Small changes to monitors and formulas: what the gate has to notice."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TypeVar

from ltlc.semantics.ltl import FALSE, TRUE, And, Atom, Formula, Next, Not, Or, Truth, Until
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter

T = TypeVar("T")

VERDICTS = [verdict for verdict in Verdict if verdict is not Verdict.NOT_STARTED]


def monitor_mutants(monitor: Monitor) -> Iterator[Monitor]:
    """Every monitor with one output, one edge or decision, or the initial state changed."""
    yield from _changed_outputs(monitor)
    yield from _changed_edges(monitor)
    yield from _changed_initial_states(monitor)


def _changed_outputs(monitor: Monitor) -> Iterator[Monitor]:
    for state, verdict in enumerate(monitor.verdicts):
        for other in VERDICTS:
            if other is not verdict:
                yield replace(monitor, verdicts=set_at(monitor.verdicts, state, other))


def _changed_edges(monitor: Monitor) -> Iterator[Monitor]:
    states = range(len(monitor.verdicts))
    for index, target in enumerate(monitor.edges):
        for state in states:
            if state != target:
                yield replace(monitor, edges=set_at(monitor.edges, index, state))
    for index, decision in enumerate(monitor.decisions):
        changed = [decision._replace(low=decision.high, high=decision.low)]
        changed += [decision._replace(low=state) for state in states if state != decision.low]
        changed += [decision._replace(high=state) for state in states if state != decision.high]
        for other in changed:
            yield replace(monitor, decisions=set_at(monitor.decisions, index, other))


def _changed_initial_states(monitor: Monitor) -> Iterator[Monitor]:
    """The first two states changed places, edges and all: the run starts elsewhere."""
    for other in range(1, len(monitor.verdicts)):
        verdicts, edges = list(monitor.verdicts), list(monitor.edges)
        verdicts[0], verdicts[other] = verdicts[other], verdicts[0]
        edges[0], edges[other] = edges[other], edges[0]
        rename = {0: other, other: 0}
        yield replace(
            monitor,
            verdicts=tuple(verdicts),
            edges=tuple(rename.get(e, e) for e in edges),
            decisions=tuple(
                d._replace(low=rename.get(d.low, d.low), high=rename.get(d.high, d.high)) for d in monitor.decisions
            ),
        )


def set_at(items: tuple[T, ...], index: int, item: T) -> tuple[T, ...]:
    return (*items[:index], item, *items[index + 1 :])


def formula_mutants(formula: Formula) -> Iterator[Formula]:
    """Every formula with one node replaced: an operator by another, an operand dropped, a truth value flipped."""
    yield from _replacements(formula)
    match formula:
        case Not(operand):
            yield from (Not(m) for m in formula_mutants(operand))
        case Next(operand):
            yield from (Next(m) for m in formula_mutants(operand))
        case And(left, right) | Or(left, right) | Until(left, right):
            yield from (type(formula)(m, right) for m in formula_mutants(left))
            yield from (type(formula)(left, m) for m in formula_mutants(right))
        case Truth() | Atom():
            pass


def _replacements(formula: Formula) -> Iterator[Formula]:
    match formula:
        case Truth():
            yield FALSE
        case Atom():
            yield from (TRUE, FALSE, Not(formula))
        case Not(operand):
            yield operand
        case And(left, right):
            yield from (Or(left, right), left, right)
        case Or(left, right):
            yield from (And(left, right), left, right)
        case Until(left, right):
            yield from (Until(right, left), Not(Until(Not(left), Not(right))), right, And(left, right))
        case Next():
            pass


def differ(one: Monitor, other: Monitor, letters: Sequence[Letter]) -> bool:
    """Whether some run over `letters` gets different verdicts; the empty run counts."""
    seen = {(0, 0)}
    todo = [(0, 0)]
    while todo:
        a, b = todo.pop()
        if one.verdicts[a] is not other.verdicts[b]:
            return True
        for letter in letters:
            pair = (one.step(a, letter), other.step(b, letter))
            if pair not in seen:
                seen.add(pair)
                todo.append(pair)
    return False
