"""The elements of arrays, for z3: how many there are of each kind, distinguished by what is asked of them.

Which conditions an element can satisfy together is a kind; an array has any number of elements of each. So a count is a
sum over kinds, whatever the length of the array, and the smallest element is below a number if some kind is.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Hashable, Iterator, Mapping, Sequence
from dataclasses import field
from itertools import product
from math import prod
from typing import Any

import z3  # noqa: TID251

from ltlc.analysis import thresholds
from ltlc.analysis.groups import grouped
from ltlc.base.source import Span
from ltlc.dataclass import dataclass
from ltlc.semantics.finite import holds
from ltlc.semantics.ltl import Atom as Proposition
from ltlc.semantics.ltl import Formula
from ltlc.semantics.words import Letter
from ltlc.specification.alphabet import alphabet
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import Single, letter
from ltlc.specification.expressions import (
    Arithmetic,
    Call,
    Comparison,
    Condition,
    Count,
    Element,
    Expression,
    Negative,
    Number,
    Operator,
    Relation,
    ValueType,
    children,
    inputs,
    operands,
    subexpressions,
    value_type,
)
from ltlc.specification.functions import Function
from ltlc.specification.numbers import numbers_of
from ltlc.specification.text import ordering_text

Term = Any
"""A term of z3's."""

MOST_TRIED = 10_000
"""Elements that are tried for an example of what is computed from them."""

MOST_KINDS = 256
"""With more kinds of elements than these, counts are left free of one another."""

LONGEST = 10_000
"""Arrays that are longer make no examples."""


@dataclass(frozen=True, slots=True)
class Kind:
    """The conditions that elements satisfy together, and elements that do, as far as such are known."""

    satisfied: Letter
    elements: Mapping[Expression, Any]


@dataclass(slots=True)
class Elements:
    """Elements of `arrays` side by side, or combined, at one step: what has been asked of them so far.

    All of it must have a value, or none of it, of the same elements (`are_plain`).
    """

    elements: tuple[Element, ...]
    arrays: tuple[Hashable, ...]
    name: str
    are_combined: bool = False
    conditions: dict[str, Condition] = field(default_factory=dict)
    _claims: list[tuple[Formula, Term, bool]] = field(default_factory=list)
    counts: dict[Formula, Term] = field(default_factory=dict)
    numbers: list[Term] = field(default_factory=list)
    kinds: list[Kind] = field(default_factory=list)

    def count(self, count: Count) -> Term:
        """How many elements `count` counts."""
        self.conditions |= dict(count.conditions)
        if count.predicate not in self.counts:
            self.counts[count.predicate] = z3.Int(f"{self.name}c{len(self.counts)}")
        return z3.ToReal(self.counts[count.predicate])

    def compare(self, function: Function, relation: Relation, constant: Number, margin: float, term: Term) -> None:
        """`term` says that the smallest, or largest, element is so related to a constant."""
        opposite = relation.opposite
        if opposite is None:
            return
        some = (relation in (Relation.LESS, Relation.AT_MOST)) == (function is Function.MIN)
        asked = Comparison(self.elements[0], relation if some else opposite, constant, margin)
        name = ordering_text(asked)
        self.conditions[name] = asked
        self._claims.append((Proposition(name), term, some))

    def facts(self) -> Iterator[Term]:
        """What is known from all questions; to be called once there are no more."""
        yield from (counted >= 0 for counted in self.counts.values())
        if self.are_combined:
            return
        found = kinds([Atom(name, condition, Span(0, 0)) for name, condition in self.conditions.items()])
        if found is None:
            return
        self.kinds = found
        self.numbers = [z3.Int(f"{self.name}k{number}") for number in range(len(found))]
        yield from (number >= 0 for number in self.numbers)
        for predicate, counted in self.counts.items():
            yield counted == self._of(predicate)
        for predicate, term, some in self._claims:
            yield term == (self._of(predicate) >= 1 if some else self._of(predicate) < 1)

    def _of(self, predicate: Formula) -> Term:
        """How many elements satisfy `predicate`."""
        pairs = zip(self.kinds, self.numbers, strict=True)
        return z3.Sum([z3.IntVal(0), *(n for kind, n in pairs if holds(predicate, (kind.satisfied,)))])

    @property
    def total(self) -> Term:
        """How many elements have a kind: all but those that are NaN; None if that is not known."""
        return z3.Sum([z3.IntVal(0), *self.numbers]) if self.numbers else None

    def values(self, model: Any, element: Element) -> tuple[Single, ...] | None:
        """The values of `element` in a model, one after the other; None if they are not known."""
        numbers = [model.eval(number, model_completion=True).as_long() for number in self.numbers]
        known = all(element in kind.elements for kind, n in zip(self.kinds, numbers, strict=True) if n)
        if not self.kinds or not known or sum(numbers) > LONGEST:
            return None
        return tuple(kind.elements[element] for kind, n in zip(self.kinds, numbers, strict=True) for _ in range(n))


def kinds(atoms: Sequence[Atom]) -> list[Kind] | None:
    """The sets of `atoms`, conditions of elements, that can hold together; None if there are too many of them."""
    found = [_kinds(part) for part in grouped(atoms, through_definitions=False)]
    parts = [part for part in found if part is not None]
    if len(parts) < len(found) or prod(len(part) for part in parts) > MOST_KINDS:
        return None
    return [
        Kind(frozenset().union(*(k.satisfied for k in row)), {e: v for k in row for e, v in k.elements.items()})
        for row in product(*parts)
    ]


def _kinds(atoms: Sequence[Atom]) -> list[Kind] | None:
    """Those of atoms that have a value in common; of several values more may seem possible than are."""
    known = thresholds.valuations(atoms)
    if known is not None:
        return [Kind(satisfied, dict(values)) for satisfied, values in known.items()]
    possible = alphabet(atoms)
    if possible.count() > MOST_KINDS:
        return None
    tried = _tried(atoms)
    return [Kind(satisfied, tried.get(satisfied, {})) for satisfied in possible.letters()]


def _tried(atoms: Sequence[Atom]) -> dict[Letter, Mapping[Expression, Any]]:
    """Of what is computed from elements alone: sets of `atoms` that some elements around the constants satisfy."""
    asked = [part for atom in atoms for side in operands(atom.condition) for part in subexpressions(side)]
    elements = list(dict.fromkeys(part for part in asked if isinstance(part, Element)))
    is_numeric = all(value_type(part).element is ValueType.NUMBER for side in asked for part in inputs(side))
    reads_whole = any(isinstance(part, Call) and part.array is not None for part in asked)  # as `min(b)` does
    constants = {part.value for part in asked if isinstance(part, Number) and math.isfinite(part.value)}
    values = list(_around(constants))
    found: dict[Letter, Mapping[Expression, Any]] = {}
    if not is_numeric or reads_whole or len(values) ** len(elements) > MOST_TRIED:
        return found
    for row in product(values, repeat=len(elements)):
        given: dict[Expression, Any] = {
            element: numbers_of(element).nearest(value) for element, value in zip(elements, row, strict=True)
        }
        satisfied = letter(tuple(atoms), given)
        if satisfied is not None:
            found.setdefault(satisfied, given)
    return found


def _around(constants: Collection[float]) -> Iterator[float]:
    """Numbers near and far from `constants` and from what makes these of other numbers, simple ones first."""
    largest = math.ceil(max(map(abs, constants), default=0.0)) + 1
    yield from (0.0, float(largest), -float(largest), float(largest**2), -float(largest**2))
    for constant in constants:
        yield from (sign * near for near in (constant, constant / 2, math.sqrt(abs(constant))) for sign in (1.0, -1.0))


def are_plain(count: Count) -> bool:
    """Whether what is asked has a value of each element that is not NaN, and elements go side by side."""
    return len(count.lists) == 1 and all(side in count.singles or _is_plain(side) for side in children(count))


def _is_plain(side: Expression) -> bool:
    match side:
        case Element():
            return True
        case Negative(operand) | Call(Function.ABS, (operand,)):
            return _is_plain(operand)
        case Arithmetic(Operator.PLUS | Operator.MINUS, operand, Number(value)):
            return _is_plain(operand) and math.isfinite(value)
        case _:
            return False
