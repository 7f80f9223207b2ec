"""Atoms: the conditions on values that a property is made of."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from typing import Any

from ltlc.semantics.ltl import Formula
from ltlc.source import Span
from ltlc.specification.expressions import Element, Expression, Opening, subexpressions


class Relation(Enum):
    """How a comparison compares. `!=` does not occur: it is the negation of `==`."""

    LESS = "<"
    AT_MOST = "<="
    EQUAL = "=="
    AT_LEAST = ">="
    GREATER = ">"

    @property
    def flipped(self) -> Relation:
        """The relation with its sides exchanged: `a < b` is `b > a`."""
        return Relation(self.value.translate(str.maketrans("<>", "><")))

    @property
    def opposite(self) -> Relation | None:
        """The ordering that holds of two numbers exactly where this one does not; None for equality."""
        return _OPPOSITES.get(self)


_OPPOSITES = {
    Relation.LESS: Relation.AT_LEAST,
    Relation.AT_MOST: Relation.GREATER,
    Relation.AT_LEAST: Relation.LESS,
    Relation.GREATER: Relation.AT_MOST,
}


@dataclass(frozen=True, slots=True)
class Comparison:
    """`left relation right` on numbers, margin included; both sides are valid (not NaN), or there is no step.

    For the orderings `margin` is signed and moves the right side: `left < right + margin`. For `==` it is the largest
    difference that counts as equal: `abs(left - right) <= margin`, or both are the same infinity. Plain equality where
    it is 0.
    """

    left: Expression
    relation: Relation
    right: Expression
    margin: float = 0.0


@dataclass(frozen=True, slots=True)
class Same:
    """`left` and `right` are the same string, or the same boolean."""

    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True)
class IsTrue:
    """A boolean value is true."""

    operand: Expression


Condition = Comparison | Same | IsTrue


@dataclass(frozen=True, slots=True)
class Count(Expression):
    """How many elements of arrays satisfy `predicate`, a state predicate over `conditions` by their names.

    Each `Element` in the conditions stands for the elements of its array one after the other, side by side with those
    of the other arrays, as far as the shortest goes. Where something that the conditions compare is NaN, the elements
    are no measurement and do not count. The count itself is NaN if a part without elements is.
    """

    predicate: Formula
    conditions: tuple[tuple[str, Condition], ...]

    @property
    def children(self) -> tuple[Expression, ...]:
        """What the conditions compare."""
        return tuple(side for _, condition in self.conditions for side in operands(condition))

    @property
    def elements(self) -> tuple[Element, ...]:
        """The elements that its conditions speak of, each once."""
        found = (part for part in subexpressions(self) if isinstance(part, Element))
        return tuple(dict.fromkeys(found))

    @property
    def singles(self) -> tuple[Expression, ...]:
        """The largest parts that speak of no element, each once."""
        return tuple(dict.fromkeys(single for side in self.children for single in _singles(side)))


def _singles(expression: Expression) -> Iterator[Expression]:
    if not any(isinstance(part, Element) for part in subexpressions(expression)):
        yield expression
    elif not isinstance(expression, Element):
        for child in expression.children:
            yield from _singles(child)


@dataclass(frozen=True, slots=True)
class Atom:
    """An atom of core LTL and when it holds.

    `name` is the condition written out in the language, margins applied (`robot.velocity > 2.1`): the same condition
    has the same name wherever it stands. `span` is where it stands first.
    """

    name: str
    condition: Condition
    span: Span


def placed(part: Any, scope: int, label: str) -> Any:
    """A condition, or a part of one, where it stands in the scope number `scope` of the property `label`."""
    return with_openings(part, lambda opening: Opening(opening.signal, scope, label))


def with_openings(part: Any, change: Callable[[Opening], Expression]) -> Any:
    """A condition, or a part of one, with what `change` makes of the values at an opening in it."""
    if isinstance(part, Opening):
        return change(part)
    if isinstance(part, tuple):
        return tuple(with_openings(each, change) for each in part)
    if not isinstance(part, Expression | Condition) or not is_dataclass(part):
        return part
    return type(part)(*(with_openings(getattr(part, each.name), change) for each in fields(part)))


def nested(condition: Condition) -> Iterator[Condition]:
    """`condition`, and those that are asked of elements in it."""
    yield condition
    for part in (part for operand in operands(condition) for part in subexpressions(operand)):
        if isinstance(part, Count):
            yield from (inner for _, inner in part.conditions)


def operands(condition: Condition) -> tuple[Expression, ...]:
    """The expressions that `condition` compares."""
    match condition:
        case Comparison(left, _, right, _) | Same(left, right):
            return (left, right)
        case IsTrue(operand):
            return (operand,)
