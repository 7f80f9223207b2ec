"""Atoms: the conditions on values that a property is made of."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from ltlc.source import Span
from ltlc.specification.expressions import Expression


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


@dataclass(frozen=True, slots=True)
class Comparison:
    """`left relation right` on numbers, margin included; both sides are valid (not NaN), or there is no step.

    For the orderings `margin` is signed and moves the right side: `left < right + margin`. For `==` it is the largest
    difference that counts as equal: `abs(left - right) <= margin`, and plain equality where it is 0.
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
class Atom:
    """An atom of core LTL and when it holds.

    `name` is the condition written out in the language, margins applied (`robot.velocity > 2.1`): the same condition
    has the same name wherever it stands. `span` is where it stands first.
    """

    name: str
    condition: Condition
    span: Span


def operands(condition: Condition) -> tuple[Expression, ...]:
    """The expressions that `condition` compares."""
    match condition:
        case Comparison(left, _, right, _) | Same(left, right):
            return (left, right)
        case IsTrue(operand):
            return (operand,)
