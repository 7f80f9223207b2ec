"""Expressions and state predicates as they are written in the language."""

from __future__ import annotations

import math
from enum import IntEnum

from ltlc.semantics import ltl
from ltlc.semantics.ltl import Formula
from ltlc.semantics.timed_atoms import Historically, Once, Previously, Since
from ltlc.specification.expressions import (
    Arithmetic,
    Boolean,
    Call,
    Current,
    Expression,
    Negative,
    New,
    Number,
    Operator,
    Past,
    Slope,
    String,
)


def number_text(value: float) -> str:
    """A number as it is written in the language; the shortest text that reads as the same double."""
    if math.isinf(value):
        return "1e999" if value > 0 else "-1e999"
    written = repr(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    return "-0" if value == 0 and math.copysign(1.0, value) < 0 else written


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
        case Number(value):
            return number_text(value), _FACTOR if math.copysign(1.0, value) < 0 else _VALUE
        case Boolean(value):
            return str(value).lower(), _VALUE
        case String(value):
            return quoted(value), _VALUE
        case Current(signal):
            return signal.name, _VALUE
        case Past(signal, samples):
            return f"@{{{signal.name}, -{samples}}}", _VALUE
        case New(signal):
            return f"new {signal.name}", _VALUE
        case Slope(signal):
            return f"slope({signal.name})", _VALUE
        case Negative(operand):
            return f"-{_text(operand, _FACTOR)}", _FACTOR
        case Arithmetic(operator, left, right):
            strength = _STRENGTH[operator]
            return f"{_text(left, strength)} {operator.value} {_text(right, strength + 1)}", strength
        case Call(function, arguments):
            return f"{function.value}({', '.join(text(a) for a in arguments)})", _VALUE
    raise TypeError(f"not an expression: {expression!r}")


def quoted(value: str) -> str:
    """A string as it is written in the language."""
    escaped = value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\t", "\\t")
    return f'"{escaped}"'


class Strength(IntEnum):
    """How tightly the forms of the language bind."""

    TEMPORAL, OR, AND, SINCE, NOT, ATOM = range(6)


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
        case Previously(name) | Once(name) | Historically(name):
            return name, Strength.NOT
        case ltl.Atom(name):
            return name, Strength.ATOM
        case ltl.Not(operand):
            return f"not {predicate_text(operand, Strength.NOT)}", Strength.NOT
        case ltl.And(left, right):
            return f"{predicate_text(left, Strength.AND)} and {predicate_text(right, Strength.AND)}", Strength.AND
        case ltl.Or(left, right):
            return f"{predicate_text(left, Strength.OR)} or {predicate_text(right, Strength.OR)}", Strength.OR
    raise TypeError(f"not a state predicate: {predicate!r}")
