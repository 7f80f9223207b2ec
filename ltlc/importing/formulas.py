"""Metric temporal logic with past, as the tools have it from which specifications are imported.

A word is a sequence of positions. Bounds are whole numbers, of positions where a formula is read at points, of
nanoseconds where it is read over signals. Both ends of an interval belong to it; an end of None is none.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from ltlc.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Atom:
    """A state predicate of the language about one step, as it is written there."""

    text: str


@dataclass(frozen=True, slots=True)
class Truth:
    """Holds everywhere."""


@dataclass(frozen=True, slots=True)
class Not:
    """`operand` does not hold."""

    operand: Formula


@dataclass(frozen=True, slots=True)
class And:
    """Both hold."""

    left: Formula
    right: Formula


@dataclass(frozen=True, slots=True)
class Or:
    """At least one holds."""

    left: Formula
    right: Formula


@dataclass(frozen=True, slots=True)
class Next:
    """`operand` holds `steps` positions later; at the end of a finite word, where there is none, this holds."""

    operand: Formula
    steps: int = 1


@dataclass(frozen=True, slots=True)
class Previous:
    """`operand` held `steps` positions earlier, and there is such a position."""

    operand: Formula
    steps: int = 1


@dataclass(frozen=True, slots=True)
class Until:
    """`right` holds at a position that is `start` to `stop` later, and `left` at every one before it, from here on."""

    left: Formula
    right: Formula
    start: int = 0
    stop: int | None = None


@dataclass(frozen=True, slots=True)
class Since:
    """`right` held at a position that is `start` to `stop` earlier, and `left` at every one after it, up to here."""

    left: Formula
    right: Formula
    start: int = 0
    stop: int | None = None


Formula = Atom | Truth | Not | And | Or | Next | Previous | Until | Since

TRUE: Formula = Truth()
FALSE: Formula = Not(TRUE)


def negated(formula: Formula) -> Formula:
    """`not formula`, without a double negation."""
    return formula.operand if isinstance(formula, Not) else Not(formula)


def conjoined(left: Formula, right: Formula) -> Formula:
    """Both, without what is always or never true."""
    if FALSE in (left, right):
        return FALSE
    return right if left in (TRUE, right) else left if right == TRUE else And(left, right)


def disjoined(left: Formula, right: Formula) -> Formula:
    """At least one, without what is always or never true."""
    return (
        negated(conjoined(negated(left), negated(right)))
        if TRUE in (left, right) or FALSE in (left, right)
        else (left if left == right else Or(left, right))
    )


def implies(left: Formula, right: Formula) -> Formula:
    """`right` holds, or `left` does not."""
    return disjoined(negated(left), right)


def equivalent(left: Formula, right: Formula) -> Formula:
    """Both hold, or neither."""
    return conjoined(implies(left, right), implies(right, left))


def eventually(operand: Formula, start: int = 0, stop: int | None = None) -> Formula:
    """`operand` holds at a position that is `start` to `stop` later."""
    if stop is not None:
        return Until(TRUE, operand, start, stop)
    if isinstance(operand, Until) and operand.left == TRUE and not start:
        return eventually(operand.right, operand.start)  # what comes some time after some time comes some time after
    found = Until(TRUE, operand)
    return Next(found, start) if start else found


def always(operand: Formula, start: int = 0, stop: int | None = None) -> Formula:
    """`operand` holds at every position that is `start` to `stop` later."""
    found = eventually(negated(operand), start, stop)
    return Next(Not(found.operand), found.steps) if isinstance(found, Next) else Not(found)


def weak_until(left: Formula, right: Formula) -> Formula:
    """`left` holds at every position before the first with `right`, always if there is none."""
    return Not(Until(negated(right), And(negated(left), negated(right))))


def children(formula: Formula) -> tuple[Formula, ...]:
    """The parts, from left to right."""
    match formula:
        case Atom() | Truth():
            return ()
        case Not(operand) | Next(operand, _) | Previous(operand, _):
            return (operand,)
        case And(left, right) | Or(left, right) | Until(left, right, _, _) | Since(left, right, _, _):
            return (left, right)
        case _:
            assert_never(formula)


def subformulas(formula: Formula) -> Iterator[Formula]:
    """`formula` and all that is inside it."""
    yield formula
    for child in children(formula):
        yield from subformulas(child)


def is_state(formula: Formula) -> bool:
    """Whether the positions up to here decide `formula`."""
    return not any(isinstance(part, Next | Until) for part in subformulas(formula))


def is_boolean(formula: Formula) -> bool:
    """Whether this position alone decides `formula`."""
    return is_state(formula) and not any(isinstance(part, Previous | Since) for part in subformulas(formula))


def horizon(formula: Formula) -> int | None:
    """How many later positions `formula` depends on; None if there is no such number."""
    parts = [horizon(child) for child in children(formula)]
    inner = 0
    for part in parts:
        if part is None:
            return None
        inner = max(inner, part)
    match formula:
        case Next(_, steps):
            return inner + steps
        case Until(_, _, _, stop):
            return None if stop is None else inner + stop
        case _:
            return inner


def earlier(formula: Formula, steps: int) -> Formula:
    """Whether `formula` held `steps` positions ago, decided by the positions up to here; False before there was one.

    `steps` is at least its horizon. Raises UndecidedError.
    """
    if steps == 0 and is_state(formula):
        return formula
    match formula:
        case Atom() | Truth():
            return Previous(formula, steps)
        case Not(operand) if is_boolean(operand):
            return Previous(formula, steps)
        case Not(operand):
            return conjoined(Previous(TRUE, steps), negated(earlier(operand, steps)))
        case And(left, right):
            return (
                Previous(formula, steps) if is_boolean(formula) else _both(earlier(left, steps), earlier(right, steps))
            )
        case Or(left, right):
            return Previous(formula, steps) if is_boolean(formula) else Or(earlier(left, steps), earlier(right, steps))
        case Next(operand, more):
            return conjoined(Previous(TRUE, steps), earlier(operand, steps - more))
        case Previous(operand, more):
            return earlier(operand, steps + more)
        case Since(left, right, start, stop):
            return Since(left if left == TRUE else earlier(left, steps), earlier(right, steps), start, stop)
        case Until(Truth(), right, start, int(stop)):
            return conjoined(Previous(TRUE, steps), Since(TRUE, earlier(right, steps - stop), 0, stop - start))
        case Until(left, right, start, int(stop)):
            return earlier(unrolled(formula), steps)
        case _:
            raise UndecidedError


def _both(left: Formula, right: Formula) -> Formula:
    """Both, without 'there was such a position' where the other says so."""
    if isinstance(left, And) and isinstance(left.left, Previous) and left.left.operand == TRUE:
        left = left.right if isinstance(right, Previous) and right.steps >= left.left.steps else left
    if isinstance(right, And) and isinstance(right.left, Previous) and right.left.operand == TRUE:
        right = right.right if isinstance(left, Previous) and left.steps >= right.left.steps else right
    return conjoined(left, right)


class UndecidedError(Exception):
    """A formula depends on more positions than there may be, or on too many to be written out."""


MOST_UNROLLED = 12
"""So many positions of an `until` within bounds are written out."""


def unrolled(formula: Until) -> Formula:
    """A bounded `until` as what holds at each later position. Raises UndecidedError."""
    if formula.stop is None or formula.stop > MOST_UNROLLED:
        raise UndecidedError
    found: Formula = formula.right
    for _ in range(formula.stop - formula.start):
        found = disjoined(formula.right, conjoined(formula.left, Next(found)))
    for _ in range(formula.start):
        found = conjoined(formula.left, Next(found))
    return found
