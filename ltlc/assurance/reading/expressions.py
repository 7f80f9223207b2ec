"""Trees of emitted text as typed expressions, by the table of functions: what each target spells so, and no more."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import accumulate, pairwise
from typing import NamedTuple, assert_never

from ltlc.assurance.reading import trees as t
from ltlc.assurance.reading.trees import NotUnderstoodError, shown
from ltlc.dataclass import dataclass
from ltlc.program import functions as f
from ltlc.program.expressions import (
    Apply,
    Count,
    Each,
    Expression,
    Literal,
    Read,
    Slice,
    is_nonzero,
    reads_of,
)
from ltlc.program.functions import ROWS, Primitive
from ltlc.program.lowering import compared, negation
from ltlc.program.normal import normal
from ltlc.program.types import BOOL, DOUBLE, INTEGER, TEXT, Type
from ltlc.specification.expressions import Relation

P = Primitive


class Target(NamedTuple):
    """A language, as far as expressions are concerned: how the table spells a row in it for types.

    One that `converts` compares numbers of all types exactly, and its literals have no types; in others, each side of a
    comparison has the type that it is written with.
    """

    spelling: Callable[[f.Row, f.Types], f.Spelling | None]
    converts: bool


_RELATIONS = {
    "<": Relation.LESS,
    "<=": Relation.AT_MOST,
    ">": Relation.GREATER,
    ">=": Relation.AT_LEAST,
    "==": Relation.EQUAL,
}
_ORDERED = {Relation.LESS: P.LESS, Relation.AT_MOST: P.AT_MOST, Relation.EQUAL: P.EQUAL}
_TYPES: Mapping[type, Type] = {bool: BOOL, str: TEXT, int: INTEGER, float: DOUBLE}
_DOES_NOT_CALCULATE = frozenset(
    {P.SMALLEST, P.LARGEST, P.LENGTH, P.MEASURED, P.TO_DOUBLE, P.TO_SIGNED, P.TO_UNSIGNED, P.NOT, P.AND, P.OR}
)


@dataclass(frozen=True)
class Reader:
    """Reads trees of a target over variables and attributes that stand for what is in `names` and `held`.

    Samples of `loose` signals may come as integers where there should be doubles: they can be compared, not
    calculated with.
    """

    target: Target
    names: Mapping[str, Expression]
    held: Mapping[str, Expression]
    loose: frozenset[str] = frozenset()

    def expression(self, tree: t.Tree) -> Expression:
        """What `tree` computes, in normal form. Raises NotUnderstoodError."""
        try:
            return normal(self._expression(tree))
        except (TypeError, ValueError):
            raise NotUnderstoodError(f"`{shown(tree)}` computes with an unsuitable operand") from None

    def _expression(self, tree: t.Tree) -> Expression:
        match tree:
            case t.Variable(name) if name in self.names:
                return self.names[name]
            case t.Attribute(name) if name in self.held:
                return self.held[name]
            case t.Constant(bool() | int() | float() | str() as value, type_):
                return Literal(value, type_ or _TYPES[type(value)])
            case t.Part(array, start, stop):
                return Slice(self._expression(array), start, stop)
            case t.Elements():
                return self._count(tree)
            case t.Apply(function, arguments):
                return self._applied(tree, function, arguments)
            case _:
                raise NotUnderstoodError(f"`{shown(tree)}` has no value")

    def _count(self, tree: t.Elements) -> Expression:
        arrays = tuple(map(self._expression, tree.arrays))
        names = {**self.names, **dict(zip(tree.names, map(Each, arrays), strict=True))}
        ends = list(accumulate(tree.lists or (len(arrays),), initial=0))
        lists = tuple(arrays[start:end] for start, end in pairwise(ends))
        return Count(lists, replace(self, names=names)._expression(tree.guard), tree.is_any)

    def _applied(self, tree: t.Apply, function: str, arguments: tuple[t.Tree, ...]) -> Expression:
        match function, arguments:
            case "-", (t.Constant(int() | float() as value, type_),):
                return self._expression(t.Constant(-value, type_))
            case "not", (operand,):
                return negation(self._expression(operand))
            case "and" | "or", operands:
                return Apply(P.AND if function == "and" else P.OR, tuple(map(self._expression, operands)))
            case "!=", (left, right):
                return negation(self._compared(tree, Relation.EQUAL, left, right))
            case (("<" | "<=" | ">" | ">=" | "=="), (left, right)):
                return self._compared(tree, _RELATIONS[function], left, right)
            case "measured", (operand,):
                return Apply(P.MEASURED, (self._expression(operand),))
            case _:
                return self._called(tree, function, list(map(self._expression, arguments)))

    def _compared(self, tree: t.Tree, relation: Relation, left: t.Tree, right: t.Tree) -> Expression:
        """By the target's own comparison, or by that of 0 with a function that orders numbers of two types."""
        match left:
            case t.Apply(function, (first, second)) if function in _orders(self.target) and right == t.Constant(0.0):
                sides = self._expression(first), self._expression(second)
                return self._by(tree, relation, sides, function)
            case _:
                return self._by(tree, relation, (self._expression(left), self._expression(right)))

    def _by(
        self, tree: t.Tree, relation: Relation, sides: tuple[Expression, Expression], function: str = ""
    ) -> Expression:
        sides = _settled(sides) if not self.target.converts else sides
        types = (sides[0].type, sides[1].type)
        if types[0] == types[1] and types[0] in (BOOL, TEXT) and relation is Relation.EQUAL:
            return Apply(P.SAME, sides)
        if not all(type_.is_number for type_ in types):
            raise NotUnderstoodError(f"`{shown(tree)}` compares something that is not a number")
        if self.target.converts:
            return compared(sides[0], relation, sides[1])
        spelling = self.target.spelling(ROWS[P.LESS], types) if P.LESS in _typed(sides) else None
        used = spelling.function if isinstance(spelling, f.Order) and not spelling.is_mirrored else ""
        if spelling is None or used != function:
            raise NotUnderstoodError(f"`{shown(tree)}` compares numbers of two types")
        if relation in (Relation.GREATER, Relation.AT_LEAST):
            relation, sides = relation.flipped, (sides[1], sides[0])
        return Apply(_ORDERED[relation], sides)

    def _called(self, tree: t.Tree, function: str, arguments: list[Expression]) -> Expression:
        """The one primitive that the table spells so for these arguments, converted where the target does so itself."""
        for operands in (arguments, list(map(self._silently_double, arguments))):
            for primitive in _typed(operands):
                spelling = self.target.spelling(ROWS[primitive], tuple(each.type for each in operands))
                if spelling is not None and function == _name(spelling, operands):
                    made = self._made(tree, primitive, operands)
                    return Apply(P.TO_DOUBLE, (made,)) if isinstance(spelling, f.OfDoubles) else made
        raise NotUnderstoodError(f"`{shown(tree)}` is not in the table of functions")

    def _silently_double(self, found: Expression) -> Expression:
        """Where the target converts by itself, with no text for it."""
        if found.type in (BOOL, TEXT) or ROWS[P.TO_DOUBLE].typed((found.type,)) is None:
            return found
        is_silent = self.target.spelling(ROWS[P.TO_DOUBLE], (found.type,)) == f.Silent()
        return Apply(P.TO_DOUBLE, (found,)) if is_silent else found

    def _made(self, tree: t.Tree, primitive: Primitive, operands: Sequence[Expression]) -> Expression:
        calculates = primitive not in _DOES_NOT_CALCULATE
        if calculates and any(read.signal in self.loose for each in operands for read in _valued(each)):
            raise NotUnderstoodError(f"`{shown(tree)}` is calculated before its operands are doubles")
        return Apply(primitive, tuple(operands))


def _valued(expression: Expression) -> Iterator[Read]:
    """What is read whose values the value of `expression` is computed from: a length is a double, whatever it is of."""
    match expression:
        case Apply(Primitive.LENGTH, _):
            return
        case Apply(_, arguments):
            for argument in arguments:
                yield from _valued(argument)
        case _:
            yield from reads_of(expression)


def _settled(sides: tuple[Expression, Expression]) -> tuple[Expression, Expression]:
    """An integer without a type of its own has that of what it stands beside, if that has it."""
    left, right = (
        replace(side, type=other.type) if isinstance(side, Literal) and _has(other, side) else side
        for side, other in (sides, sides[::-1])
    )
    return left, right


def _has(other: Expression, side: Literal) -> bool:
    """Whether `side` is an integer without a type of its own, and one of those that `other` can be."""
    numbers = other.type.scalar.integers
    return side.type == INTEGER and isinstance(side.value, int) and numbers is not None and numbers.has(side.value)


def _typed(operands: Sequence[Expression]) -> Iterator[Primitive]:
    """The primitives that take these."""
    types = tuple(each.type for each in operands)
    return (primitive for primitive, row in ROWS.items() if row.typed(types) is not None)


def _orders(target: Target) -> frozenset[str]:
    """The functions of the target that order numbers of two types."""
    return frozenset() if target.converts else _ORDERS


_ORDERS = frozenset({"order_signed", "order_unsigned", "order_integers"})


def _name(spelling: f.Spelling, operands: Sequence[Expression]) -> str | None:
    """The function or operator that a spelling writes; None if it writes none."""
    match spelling:
        case f.Infix(operator) | f.Prefix(operator):
            return operator
        case f.Quotient(name):
            return "/" if is_nonzero(operands[1]) else name
        case f.Function(name) | f.Folded(name) | f.OfArray(name) | f.Components(name) | f.Member(name):
            return name
        case f.OfDoubles(inner):
            return _name(inner, operands) if operands[0].type.is_array else None
        case f.Order() | f.AtMostInfinite() | f.Silent():
            return None
        case _:
            assert_never(spelling)
