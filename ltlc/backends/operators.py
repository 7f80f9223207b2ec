"""Expressions as C and Rust write them, in one line or laid out on several."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.backends.trees import INDENT, LINE_LENGTH, Call, Chain, Code, Infix, Prefix, Text

_OPERATORS = {"and": "&&", "or": "||"}
_STRENGTHS = {"or": 0, "and": 1, "+": 4, "-": 4, "*": 5, "/": 5}
_COMPARISON, _UNARY, _PRIMARY = 3, 6, 7


def strength(code: Code) -> int:
    """How tightly the outermost operator binds."""
    match code:
        case Infix(operator, _):
            return _STRENGTHS[operator]
        case Chain(operands, _):
            return _COMPARISON if len(operands) == 2 else _STRENGTHS["and"]
        case Prefix():
            return _UNARY
        case Text(text) if text.startswith(("-", "(")):
            return _UNARY
        case _:
            return _PRIMARY


def flat(code: Code) -> str:
    """`code` in one line; what a compiler would ask parentheses for has them."""
    match code:
        case Text(text):
            return text
        case Prefix(operator, operand):
            sign = "!" if operator == "not " else operator
            text = _operand(operand, _UNARY)
            return f"{sign}({text})" if sign == "-" and text.startswith("-") else f"{sign}{text}"
        case Infix():
            return " ".join(_pieces(code))
        case Chain(operands, operators):
            parts = [_operand(operand, _COMPARISON + 1) for operand in operands]
            links = zip(parts, operators, parts[1:], strict=False)
            return " && ".join(f"{left} {operator} {right}" for left, operator, right in links)
        case Call(function, arguments):
            return f"{function}({', '.join(map(flat, arguments))})"
        case _:
            raise TypeError(f"not an expression of this language: {code!r}")


def _operand(code: Code, context: int) -> str:
    return f"({flat(code)})" if strength(code) < context else flat(code)


def _pieces(code: Infix) -> list[str]:
    """The first operand, then each further one behind the operator."""
    operator = _OPERATORS.get(code.operator, code.operator)
    own = strength(code)
    first, *rest = code.operands
    inner = own + 1 if code.operator not in _OPERATORS else _STRENGTHS["and"] + (own == 0)
    return [
        _operand(first, max(own, inner if own < _COMPARISON else own)),
        *(f"{operator} {_operand(o, inner)}" for o in rest),
    ]


def layout(prefix: str, code: Code, suffix: str) -> list[str]:
    """`prefix`, `code` and `suffix`: in one line, or broken before the outermost operators, or after commas."""
    line = f"{prefix}{flat(code)}{suffix}"
    if len(line) <= LINE_LENGTH:
        return [line]
    inner = prefix[: len(prefix) - len(prefix.lstrip())] + INDENT * 2
    match code:
        case Infix():
            pieces = _pieces(code)
        case Call(function, arguments):
            prefix, suffix = f"{prefix}{function}(", f"){suffix}"
            pieces = [f"{flat(a)}," for a in arguments[:-1]] + [flat(a) for a in arguments[-1:]]
        case _:
            return [line]
    return filled(prefix, pieces, suffix, inner)


def filled(prefix: str, pieces: Sequence[str], suffix: str, indent: str) -> list[str]:
    """`pieces` between `prefix` and `suffix`, as many on a line as fit; further lines are indented by `indent`."""
    lines, current = [], prefix
    for number, piece in enumerate(pieces):
        text = piece + (suffix if number == len(pieces) - 1 else "")
        gap = " " if current[-1:] not in ("", " ", "(") else ""
        if number and len(current) + len(gap) + len(text) > LINE_LENGTH:
            lines.append(current)
            current, gap = indent, ""
        current += gap + text
    return [*lines, current if pieces else prefix + suffix]
