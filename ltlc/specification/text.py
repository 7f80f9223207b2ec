"""Expressions as they are written in the language."""

from __future__ import annotations

import math

from ltlc.specification.expressions import (
    Arithmetic,
    Boolean,
    Call,
    Current,
    Expression,
    Negative,
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
