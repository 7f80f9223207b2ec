"""Normal forms, on which equality of machines rests: of atoms, decisions and states, and where clock steps can come."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple, assert_never

from ltlc.program.expressions import (
    Apply,
    Count,
    Each,
    Expression,
    Held,
    Kept,
    Literal,
    News,
    Recent,
    Slice,
    Slope,
    children,
    may_be_nan,
    parts,
)
from ltlc.program.functions import Primitive
from ltlc.program.machine import Base, Outcome
from ltlc.program.types import BOOL
from ltlc.semantics.diagrams import Diagram, Diagrams
from ltlc.semantics.monitor import Decision, Target


class Literals(NamedTuple):
    """An atom in its normal form, and whether it stands for itself or for its negation."""

    atom: Expression
    holds: bool


_OPPOSITES = {Primitive.LESS: Primitive.AT_MOST, Primitive.AT_MOST: Primitive.LESS}
_DUALS = {Primitive.AND: Primitive.OR, Primitive.OR: Primitive.AND}


def normal(expression: Expression) -> Expression:
    """The one form of what can be written in several ways that differ in nothing.

    Sides of equality are ordered, `min(min(a, b), c)` has three arguments, and so have `and` and `or` in one another.
    What is at most infinite, or equal to itself, is what is not NaN.
    What is counted negates comparisons only: of what is NaN there, it is false.
    """
    match expression:
        case Literal() | Held() | Recent() | Slope() | News() | Kept():
            return expression
        case Slice(array) | Each(array):
            return replace(expression, array=normal(array))
        case Count(lists, guard):
            of_lists = tuple(tuple(map(normal, arrays)) for arrays in lists)
            return replace(expression, lists=of_lists, guard=settled(guard, True))
        case Apply(primitive, arguments):
            return _normal(primitive, tuple(map(normal, arguments)))
        case _:
            assert_never(expression)


def _normal(primitive: Primitive, arguments: tuple[Expression, ...]) -> Expression:
    match primitive, arguments:
        case Primitive.EQUAL, (left, right) if left == right and left.type.scalar.is_integer:
            return Literal(True, BOOL)  # of which C compilers warn
        case Primitive.EQUAL, (left, right) if left == right:
            return _normal(Primitive.MEASURED, (left,))
        case ((Primitive.EQUAL | Primitive.SAME), (left, right)) if _order(left) > _order(right):
            return Apply(primitive, (right, left))
        case Primitive.AT_MOST, (number, Literal(math.inf)):
            return _normal(Primitive.MEASURED, (number,))
        case Primitive.MEASURED, (Apply(Primitive.TO_DOUBLE, (number,)),):
            return Apply(primitive, (number,))
        case ((Primitive.LEAST | Primitive.GREATEST), (Apply(inner, first), *rest)) if inner is primitive:
            return Apply(primitive, (*first, *rest))
        case ((Primitive.AND | Primitive.OR), _):
            return Apply(primitive, tuple(flattened(primitive, arguments)))
        case _:
            return Apply(primitive, arguments)


def flattened(primitive: Primitive, arguments: Iterable[Expression]) -> Iterator[Expression]:
    """The arguments, in place of those that are the same primitive again their own."""
    for each in arguments:
        match each:
            case Apply(inner, own) if inner is primitive:
                yield from own
            case _:
                yield each


def settled(guard: Expression, holds: bool) -> Expression:
    """That `guard` holds, or does not, of what is not NaN."""
    match guard:
        case Literal(bool(value)):
            return replace(guard, value=value == holds)
        case Apply(Primitive.NOT, (inner,)):
            return settled(inner, not holds)
        case Apply(Primitive.AND | Primitive.OR as primitive, arguments):
            joined = primitive if holds else _DUALS[primitive]
            return _normal(joined, tuple(settled(each, holds) for each in arguments))
        case Apply(Primitive.LESS | Primitive.AT_MOST as primitive, (left, right)) if not holds:
            return _normal(_OPPOSITES[primitive], (normal(right), normal(left)))
        case _:
            return normal(guard) if holds else Apply(Primitive.NOT, (normal(guard),))


def positive(atom: Expression) -> Literals:
    """The one form of `atom` where nothing in it is NaN: `1 < x`, `x > 1` and the negation of `x <= 1` are one atom.

    Where it may be NaN at a clock step, orderings stay as they are: neither they nor their opposites hold of NaN.
    """
    match normal(atom):
        case Apply(Primitive.NOT, (inner,)):
            found, holds = positive(inner)
            return Literals(found, not holds)
        case Apply(Primitive.LESS | Primitive.AT_MOST as primitive, (left, right)) as ordered:
            if may_be_nan_when_taken(ordered) or not _is_turned(primitive, left, right):
                return Literals(ordered, True)
            return Literals(_normal(_OPPOSITES[primitive], (right, left)), False)
        case found:
            return Literals(found, True)


def _is_turned(primitive: Primitive, left: Expression, right: Expression) -> bool:
    """Whether an ordering stands as the negation of its opposite: `1 < x`, and `x < x`."""
    return _order(left) > _order(right) or (left == right and primitive is Primitive.LESS)


def may_be_nan_when_taken(atom: Expression) -> bool:
    """Whether a part of `atom` can be NaN for a value at an opening that is taken at a clock step."""
    reads = (part for part in parts(atom) if any(isinstance(inner, Kept) for inner in parts(part)))
    return any(map(may_be_nan, reads))


def _order(side: Expression) -> tuple[bool, bool, str]:
    """What is read comes before what is computed, and that before constants."""
    return isinstance(side, Literal), bool(children(side)), repr(side)


Row = Callable[[int], Iterable[Outcome]]
"""Where a state can lead."""


class _Waiting(NamedTuple):
    """A state that is reached, the clocks that run there, and whether a clock step comes at once."""

    state: int
    running: frozenset[int]
    again: bool
    is_first: bool = False


class Reached(NamedTuple):
    """The states that something leads to, in order, and those of them in which a clock step can come."""

    states: tuple[int, ...]
    waiting: frozenset[int]


def reached(steps: Row, expires: Row, aging: Callable[[int], bool]) -> Reached:
    """What is reached from state 0; clock steps come where a clock runs, one comes in a nanosecond, or ages are asked.

    They are asked in states that are `aging`. Clock steps in other states do not happen, and are not defined.
    """
    todo = [_Waiting(0, frozenset(), False, is_first=True)]
    seen, found = set(todo), set[int]()
    for place in todo:
        waits = not place.is_first and bool(place.running or place.again or aging(place.state))
        found |= {place.state} if waits else set()
        for outcome in (*steps(place.state), *(expires(place.state) if waits else ())):
            after = _after(place, outcome)
            if after not in seen:
                seen.add(after)
                todo.append(after)
    return Reached(tuple(sorted({place.state for place in seen})), frozenset(found))


def _after(place: _Waiting, outcome: Outcome) -> _Waiting:
    if outcome.taken:
        return place._replace(state=outcome.state)
    started = {each.clock for each in outcome.sets if each.base is not Base.NEVER}
    running = (place.running - {each.clock for each in outcome.sets}) | started
    return _Waiting(outcome.state, running, outcome.again)


class Packed(NamedTuple):
    """Diagrams as data: the target that each is, or None, and what they lead through."""

    targets: tuple[Target | None, ...]
    atoms: tuple[Expression, ...]
    decisions: tuple[Decision, ...]
    outcomes: tuple[Outcome, ...]


def pack(diagrams: Diagrams, roots: Sequence[Diagram | None], atoms: Sequence[Expression]) -> Packed:
    """The only numbering of what `roots` lead through: as met from them, low before high.

    Level k asks atom k, and those above ask clocks. Atoms that are not asked are omitted.
    """
    found = list(diagrams.reachable(*(root for root in roots if root is not None)))
    nodes = [node for node in found if not diagrams.is_terminal(node)]
    terminals = [node for node in found if diagrams.is_terminal(node)]
    asked = sorted({level for level, _, _ in map(diagrams.split, nodes) if level < len(atoms)})
    questions = {level: number for number, level in enumerate(asked)}
    targets = {node: number for number, node in enumerate(terminals)} | {node: ~n for n, node in enumerate(nodes)}

    def decision(node: Diagram) -> Decision:
        level, low, high = diagrams.split(node)
        return Decision(questions.get(level, level - len(atoms) + len(asked)), targets[low], targets[high])

    return Packed(
        tuple(None if root is None else targets[root] for root in roots),
        tuple(atoms[level] for level in asked),
        tuple(map(decision, nodes)),
        tuple(map(diagrams.value, terminals)),
    )
