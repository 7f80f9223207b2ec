"""Expressions and state predicates as they are written in the language."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Collection
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from enum import IntEnum
from typing import assert_never

from ltlc.base.source import quoted
from ltlc.semantics import ltl
from ltlc.semantics.ltl import Formula
from ltlc.semantics.timed_atoms import Historically, Occurred, Once, Previously, Since
from ltlc.specification.expressions import (
    Arithmetic,
    Boolean,
    Call,
    Comparison,
    Condition,
    Count,
    Current,
    Element,
    Expression,
    Negative,
    New,
    Number,
    Opening,
    Operator,
    Past,
    Read,
    Recent,
    Relation,
    Slice,
    Slope,
    String,
    When,
)
from ltlc.specification.functions import Function
from ltlc.specification.wire import SINGLES


def number_text(value: float, single: bool = False) -> str:
    """A number as it is written in the language; the shortest text that reads as the same double, or binary32."""
    if isinstance(value, int):
        return str(value)
    if math.isinf(value):
        return "1e999" if value > 0 else "-1e999"
    if single:
        value = _shortest(value)
    written = repr(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    return "-0" if value == 0 and math.copysign(1.0, value) < 0 else written


def _shortest(single: float) -> float:
    """The double with the fewest digits to which `single` is the nearest binary32."""
    rounded = (float(f"{single:.{digits}g}") for digits in range(1, 10))
    return next(number for number in rounded if SINGLES.nearest(number) == single)


def outwards(value: Decimal, step: Decimal, is_upper: bool) -> Decimal:
    """The multiple of `step`, a power of ten, nearest to `value` that is not below it, or not above it."""
    return (value / step).to_integral_value(ROUND_CEILING if is_upper else ROUND_FLOOR) * step


_SUM, _PRODUCT, _FACTOR, _VALUE = range(4)
_STRENGTH = {Operator.PLUS: _SUM, Operator.MINUS: _SUM, Operator.TIMES: _PRODUCT, Operator.OVER: _PRODUCT}


def text(expression: Expression) -> str:
    """`expression` as it is written in the language."""
    return _text(expression, _SUM)


def _text(expression: Expression, context: int) -> str:
    written, strength = _written(expression)
    return f"({written})" if strength < context else written


def _written(expression: Expression) -> tuple[str, int]:
    """The text of `expression` and how tightly it binds."""
    match expression:
        case Number(value, single):
            return number_text(value, single), _FACTOR if math.copysign(1.0, value) < 0 else _VALUE
        case Boolean(value):
            return str(value).lower(), _VALUE
        case String(value):
            return quoted(value), _VALUE
        case Current(signal):
            return signal.name, _VALUE
        case Past(signal, samples):
            return f"@{{{signal.name}, -{samples}}}", _VALUE
        case Recent(signal, samples):
            return f"@{{{signal.name}, -{samples}:}}", _VALUE
        case Opening(signal, scope, label):
            return f"@{{{signal.name}, {opening_text(scope, label)}}}", _VALUE
        case New(signal):
            return f"new {signal.heard}", _VALUE
        case Slope(signal):
            return f"slope({signal.name})", _VALUE
        case Element(array):
            return text(array), _VALUE
        case Slice(array, start, stop):
            ends = ("" if end is None else str(end) for end in (start, stop))
            return f"{text(array)}[{':'.join(ends)}]", _VALUE
        case Count(predicate):
            return f"count({predicate_text(predicate)}{over_text(expression)})", _VALUE
        case When(predicate):
            return predicate_text(predicate), _SUM
        case Negative(operand):
            return f"-{_text(operand, _FACTOR)}", _FACTOR
        case Arithmetic(operator, left, right):
            strength = _STRENGTH[operator]
            return f"{_text(left, strength)} {operator.value} {_text(right, strength + 1)}", strength
        case Call(function, (x, y, *_), zone) if zone:
            return f"{function.value}({text(x)}, {text(y)}, {zone})", _VALUE
        case Call(function, arguments):
            return f"{function.value}({', '.join(text(a) for a in arguments)})", _VALUE
        case _:
            assert_never(expression)


def read_texts(reads: Collection[Read]) -> list[str]:
    """What is read as the author wrote it; openings are distinguished where one property reads several of a signal."""
    times = Counter(each.signal for each in reads if isinstance(each, Opening))
    return [
        text(Opening(each.signal, each.scope if times[each.signal] > 1 else 0) if isinstance(each, Opening) else each)
        for each in reads
    ]


_OPENING = re.compile(r", opening [^{}\"]*\}")


def opening_text(scope: int, label: str) -> str:
    """Which opening is meant: that of the scope with this number in the property `label`; 0 is its beginning."""
    return " ".join(["opening", *([str(scope)] if scope else []), *(["of", label] if label else [])])


def as_written(name: str) -> str:
    """The text of a condition as its author wrote it, who does not say which opening is meant."""
    return _OPENING.sub(", opening}", name)


def ordering_text(comparison: Comparison) -> str:
    """An ordering as it is written in the language, its margin added to its right side; of a zone, what it asks."""
    left, right = comparison.left, comparison.right
    if isinstance(left, Call) and left.function is Function.INSIDE:
        return text(left) if comparison.relation is Relation.AT_LEAST else f"not {text(left)}"
    if comparison.margin:
        operator = Operator.PLUS if comparison.margin > 0 else Operator.MINUS
        right = Arithmetic(operator, right, Number(abs(comparison.margin)))
    return f"{text(left)} {comparison.relation.value} {text(right)}"


class Strength(IntEnum):
    """How tightly the forms of the language bind."""

    TEMPORAL, OR, AND, SINCE, NOT, ATOM = range(6)


def over_text(count: Count) -> str:
    """The lists whose elements are combined, as they are written after a predicate; empty if there are none."""
    lists = (f"({', '.join(text(element.array) for element in elements)})" for elements in count.over)
    return f" over {', '.join(lists)}" if count.over else ""


def predicate_text(predicate: Formula, context: Strength = Strength.OR) -> str:
    """A state predicate as it is written where what binds less tightly than `context` needs parentheses."""
    written, strength = predicate_form(predicate)
    return f"({written})" if strength < context else written


def predicate_form(predicate: Formula) -> tuple[str, Strength]:
    """The text of a state predicate and how tightly it binds."""
    match predicate:
        case ltl.Truth():
            return "true", Strength.ATOM
        case ltl.Not(ltl.Truth()):
            return "false", Strength.ATOM
        case Since(name):
            return name, Strength.SINCE
        case Previously(name) | Once(name) | Historically(name) | Occurred(name):
            return name, Strength.NOT
        case ltl.Atom(name):
            return name, Strength.ATOM
        case ltl.Not(operand):
            return f"not {predicate_text(operand, Strength.NOT)}", Strength.NOT
        case ltl.And(left, right):
            return f"{predicate_text(left, Strength.AND)} and {predicate_text(right, Strength.AND)}", Strength.AND
        case ltl.Or(left, right):
            return f"{predicate_text(left, Strength.OR)} or {predicate_text(right, Strength.OR)}", Strength.OR
        case _:
            raise TypeError(f"not a state predicate: {predicate!r}")


def with_constant(written: str, condition: Condition) -> str:
    """A condition, with the name of the constant of a message that its author compared with: `level == ERROR (2)`."""
    match condition:
        case Comparison(_, _, Number(value, constants=constants)) if constants and not condition.margin:
            name = dict(constants).get(value)
            stem = written.removesuffix(number_text(value))
            return written if name is None or stem == written else f"{stem}{name} ({number_text(value)})"
    return written
