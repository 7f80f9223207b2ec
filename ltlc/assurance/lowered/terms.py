"""Typed expressions as terms, in which the conditions of a specification are said a second time (`lowered.meaning`).

A conversion that changes no number is left out: terms compare numbers exactly, whatever their types.
"""

from __future__ import annotations

from typing import assert_never

from ltlc.assurance.lowered.language import NONE, Apply, Constant, Term
from ltlc.assurance.lowered.meaning import Counted, ElementOf, Given
from ltlc.program import expressions as x
from ltlc.program.functions import Primitive
from ltlc.program.types import type_of
from ltlc.specification.expressions import Current, New, Opening, Past, Read, Slope
from ltlc.specification.specification import PropertySpecification
from ltlc.specification.wire import double_or_integer

P = Primitive

_NAMES = {
    P.NEGATE: "negative",
    P.ABS: "abs",
    P.ADD: "+",
    P.SUBTRACT: "-",
    P.TIMES: "*",
    P.OVER: "/",
    P.LEAST: "least",
    P.GREATEST: "greatest",
    P.SQRT: "square_root",
    P.GAP: "gap",
    P.NORM: "norm",
    P.ROLL: "roll",
    P.PITCH: "pitch",
    P.YAW: "yaw",
    P.ANGLE: "angle",
    P.SMALLEST: "smallest",
    P.LARGEST: "largest",
    P.SUM: "sum_of",
    P.MEDIAN: "median_of",
    P.LENGTH: "length_of",
    P.TO_DOUBLE: "double",
    P.LESS: "<",
    P.AT_MOST: "<=",
    P.EQUAL: "==",
    P.SAME: "==",
    P.NOT: "not",
    P.AND: "and",
    P.OR: "or",
    P.MEASURED: "measured",
}


def said(wanted: Read) -> x.Read:
    """What is read of a signal, as machines have it."""
    signal = wanted.signal
    match wanted:
        case Current():
            return x.Held(signal.name, 0, type_of(signal))
        case Past(_, samples):
            return x.Held(signal.name, samples, type_of(signal))
        case Slope():
            return x.Slope(signal.name)
        case New():
            return x.News(signal.name)
        case Opening(_, scope, label):
            return x.Kept(signal.name, scope, label, type_of(signal))
        case _:
            assert_never(wanted)


class Terms:
    """The terms of expressions over what a property reads."""

    def __init__(self, specification: PropertySpecification) -> None:
        self._given = {said(wanted): Given(wanted) for wanted in specification.reads()}

    def term(self, expression: x.Expression) -> Term:
        """What `expression` says. Raises KeyError if it reads what the property does not."""
        match expression:
            case x.Literal(int(value)) if not isinstance(value, bool):
                return Constant(double_or_integer(value))
            case x.Literal(value):
                return Constant(value)
            case x.Held() | x.Slope() | x.News() | x.Kept():
                return self._given[expression]
            case x.Each(array):
                return ElementOf(self.term(array))
            case x.Slice(array, start, stop):
                ends = (NONE if end is None else Constant(end) for end in (start, stop))
                return Apply("slice", (self.term(array), *ends))
            case x.Count(arrays, guard, is_any):
                counted = Counted(frozenset(map(self.term, arrays)), self.term(guard))
                return Apply(">=", (counted, Constant(1.0))) if is_any else counted
            case x.Apply(P.TO_SIGNED | P.TO_UNSIGNED, (integer,)):
                return self.term(integer)
            case x.Apply(primitive, arguments):
                return Apply(_NAMES[primitive], tuple(map(self.term, arguments)))
            case _:
                assert_never(expression)
